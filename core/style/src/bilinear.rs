//! Separation of style and content with bilinear models (Tenenbaum & Freeman 2000).
//!
//! A posture y of style s and content c is bilinear in a vector of each. A content is one moment of a motion.
//!
//! - **Asymmetric** (their section 3.1): y = A_s b_c, with a matrix A_s for each style. All styles stacked form one
//!   matrix of observations. Its singular value decomposition gives A and B at once.
//! - **Symmetric** (their section 3.2): y_k = Σ_ij w_kij a_i b_j. Their iterated decomposition alternates between the
//!   two sides. On a complete grid it equals the alternating computation of a Tucker decomposition of two modes (De
//!   Lathauwer et al. 2000).
//!
//! The style to be predicted takes no part in the decomposition. Its matrix or vector is fitted to its known motions,
//! with a ridge towards the mean style. Few clips cannot determine 34 × 16 numbers; plain least squares would
//! extrapolate wildly. A few ridges are tried. The chosen one predicts the style's own clips best when each is left out
//! in turn.
//!
//! Limits: key poses shift the result (see `spread`); they do not change the model.

use super::Prediction;
use super::basis::MODEL_FRAMES;
use super::grid::{Grid, Row, WIDTH};
use faer::linalg::solvers::Solve;
use faer::{Mat, Side};
use rototoon_base::scene::clip::between;
use rototoon_base::scene::skeleton::{COUNT, Posture};

/// J: length of the content vectors.
const CONTENT: usize = 16;
/// I: greatest length of the style vectors of the symmetric model.
const STYLE: usize = 5;
/// Ridges tried, as shares of the mean squared content.
const RIDGES: [f64; 5] = [0.01, 0.1, 1.0, 10.0, 100.0];
/// Rounds of the symmetric decomposition. The result hardly changes after five.
const ROUNDS: usize = 8;

/// Which of the two models.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Model {
    /// A matrix for each style.
    Asymmetric,
    /// A vector for each style.
    Symmetric,
}

/// Predicts the requested clip with one of the models; `rank` replaces the length of the content vectors.
pub(super) fn predict(grid: &Grid, keys: &[(usize, Row)], model: Model, rank: Option<usize>) -> Prediction {
    let known: Vec<usize> =
        (0..grid.motions.len()).filter(|&m| m != grid.motion && grid.get(grid.style, m).is_some()).collect();
    let fitted = Fitted::new(grid, model, rank.unwrap_or(CONTENT).max(1));
    let apart = |ridge: f64| held_apart(grid, &known, |rest, left_out| fitted.clip(grid, rest, left_out, ridge));
    let best = RIDGES
        .iter()
        .map(|&ridge| (ridge, apart(ridge)))
        .min_by(|a, b| squares(&a.1).total_cmp(&squares(&b.1)))
        .unwrap_or((1.0, Vec::new()));
    let rows = onto_frames(grid, &fitted.clip(grid, &known, grid.motion, best.0));
    spread(grid, rows, &best.1, keys)
}

fn squares(errors: &[Vec<Row>]) -> f64 {
    errors.iter().flatten().flatten().map(|e| e * e).sum()
}

/// The model fitted to the other characters' clips.
struct Fitted {
    /// B: content vectors, J × moments.
    contents: Mat<f64>,
    /// Style maps W_i, 34 × J. A style with the vector a is the linear map Σ_i a_i W_i of content vectors. Empty for
    /// the asymmetric model.
    maps: Vec<Mat<f64>>,
    /// The mean style as a linear map of content vectors.
    mean: Mat<f64>,
    /// The mean style vector.
    mean_vector: Vec<f64>,
}

impl Fitted {
    fn new(grid: &Grid, model: Model, rank: usize) -> Self {
        let others: Vec<usize> = (0..grid.characters.len()).filter(|&s| s != grid.style).collect();
        let moments = grid.motions.len() * MODEL_FRAMES;
        let mut stacked = Mat::zeros(others.len() * WIDTH, moments);
        for (k, &s) in others.iter().enumerate() {
            for m in 0..grid.motions.len() {
                let clip = grid.rows(s, m, MODEL_FRAMES).or_else(|| grid.mean_without(grid.style, m, MODEL_FRAMES));
                for (t, row) in clip.into_iter().flatten().enumerate() {
                    (0..WIDTH).for_each(|d| stacked[(k * WIDTH + d, m * MODEL_FRAMES + t)] = row[d]);
                }
            }
        }
        let mut contents = leading((stacked.transpose() * &stacked).as_ref(), rank.min(moments));
        let count = others.len();
        let style = |maps: &Mat<f64>, k: usize| maps.subrows(k * WIDTH, WIDTH).to_owned();
        let mean_of = |maps: &Mat<f64>| {
            (0..count).fold(Mat::zeros(WIDTH, maps.ncols()), |sum, k| sum + style(maps, k))
                * faer::Scale(1.0 / count as f64)
        };
        if model == Model::Asymmetric {
            let mean = mean_of(&(&stacked * contents.transpose()));
            return Self { contents, maps: Vec::new(), mean, mean_vector: Vec::new() };
        }
        let mut vectors = Mat::zeros(0, 0);
        for _ in 0..ROUNDS {
            let maps = &stacked * contents.transpose();
            let among = Mat::from_fn(count, count, |a, b| inner(&style(&maps, a), &style(&maps, b)));
            vectors = leading(among.as_ref(), STYLE.min(count)); // I × styles
            let mixed = mix(&vectors, &stacked);
            contents = leading((mixed.transpose() * &mixed).as_ref(), rank.min(moments));
        }
        let w = mix(&vectors, &(&stacked * contents.transpose()));
        let maps: Vec<Mat<f64>> = (0..vectors.nrows()).map(|i| style(&w, i)).collect();
        let mean_vector: Vec<f64> =
            (0..maps.len()).map(|i| (0..count).map(|s| vectors[(i, s)]).sum::<f64>() / count as f64).collect();
        let mean = weighted(&maps, &mean_vector);
        Self { contents, maps, mean, mean_vector }
    }

    /// Predicts the style's clip of the motion `wanted`, with its map fitted to its clips of the `known` motions.
    fn clip(&self, grid: &Grid, known: &[usize], wanted: usize, ridge: f64) -> Vec<Row> {
        let own: Vec<Row> = known.iter().filter_map(|&m| grid.rows(grid.style, m, MODEL_FRAMES)).flatten().collect();
        let b = Mat::from_fn(self.contents.nrows(), own.len(), |j, c| {
            self.contents[(j, known[c / MODEL_FRAMES] * MODEL_FRAMES + c % MODEL_FRAMES)]
        });
        let rest = Mat::from_fn(WIDTH, own.len(), |d, c| own[c][d]) - &self.mean * &b;
        let map = if self.maps.is_empty() { self.matrix(&b, &rest, ridge) } else { self.vector(&b, &rest, ridge) };
        let moments = self.contents.subcols(wanted * MODEL_FRAMES, MODEL_FRAMES);
        let made = map * moments;
        (0..MODEL_FRAMES).map(|t| std::array::from_fn(|d| made[(d, t)])).collect()
    }

    /// Fits a style matrix: min ‖(A − Ā) B − rest‖² + λ‖A − Ā‖².
    fn matrix(&self, b: &Mat<f64>, rest: &Mat<f64>, ridge: f64) -> Mat<f64> {
        let n = b.nrows();
        let mut normal = b * b.transpose();
        add_ridge(&mut normal, ridge);
        match normal.llt(Side::Lower) {
            Ok(factor) => {
                let more = factor.solve(b * rest.transpose()); // J × 34
                Mat::from_fn(WIDTH, n, |d, j| self.mean[(d, j)] + more[(j, d)])
            }
            Err(_) => self.mean.clone(),
        }
    }

    /// Fits a style vector by the same least squares problem.
    fn vector(&self, b: &Mat<f64>, rest: &Mat<f64>, ridge: f64) -> Mat<f64> {
        let made: Vec<Mat<f64>> = self.maps.iter().map(|map| map * b).collect();
        let n = made.len();
        let mut normal = Mat::from_fn(n, n, |i, j| inner(&made[i], &made[j]));
        add_ridge(&mut normal, ridge);
        let right = Mat::from_fn(n, 1, |i, _| inner(&made[i], rest));
        match normal.llt(Side::Lower) {
            Ok(factor) => {
                let more = factor.solve(right);
                let vector: Vec<f64> = (0..n).map(|i| self.mean_vector[i] + more[(i, 0)]).collect();
                weighted(&self.maps, &vector)
            }
            Err(_) => self.mean.clone(),
        }
    }
}

fn add_ridge(normal: &mut Mat<f64>, ridge: f64) {
    let n = normal.nrows();
    let mean = (0..n).map(|i| normal[(i, i)]).sum::<f64>() / n.max(1) as f64;
    (0..n).for_each(|i| normal[(i, i)] += (ridge * mean).max(1e-9));
}

fn inner(a: &Mat<f64>, b: &Mat<f64>) -> f64 {
    (0..a.ncols()).map(|j| a.col_as_slice(j).iter().zip(b.col_as_slice(j)).map(|(x, y)| x * y).sum::<f64>()).sum()
}

fn weighted(maps: &[Mat<f64>], weights: &[f64]) -> Mat<f64> {
    let (rows, columns) = maps.first().map_or((0, 0), |map| (map.nrows(), map.ncols()));
    Mat::from_fn(rows, columns, |d, j| maps.iter().zip(weights).map(|(map, w)| w * map[(d, j)]).sum())
}

/// Mixes blocks of 34 rows, one for each style, with vectors (new × styles).
fn mix(vectors: &Mat<f64>, stacked: &Mat<f64>) -> Mat<f64> {
    Mat::from_fn(vectors.nrows() * WIDTH, stacked.ncols(), |row, c| {
        (0..vectors.ncols()).map(|s| vectors[(row / WIDTH, s)] * stacked[(s * WIDTH + row % WIDTH, c)]).sum()
    })
}

/// The leading eigenvectors of a symmetric matrix, as rows.
fn leading(matrix: faer::MatRef<'_, f64>, count: usize) -> Mat<f64> {
    let n = matrix.nrows();
    match matrix.self_adjoint_eigen(Side::Lower) {
        Ok(eigen) => Mat::from_fn(count, n, |k, i| eigen.U()[(i, n - 1 - k)]),
        Err(_) => Mat::from_fn(count, n, |k, i| if i == k { 1.0 } else { 0.0 }),
    }
}

/// Errors of the style's own clips, each predicted from the others. Empty if there are fewer than two.
pub(super) fn held_apart(grid: &Grid, known: &[usize], clip: impl Fn(&[usize], usize) -> Vec<Row>) -> Vec<Vec<Row>> {
    if known.len() < 2 {
        return Vec::new();
    }
    known
        .iter()
        .filter_map(|&left_out| {
            let rest: Vec<usize> = known.iter().copied().filter(|&m| m != left_out).collect();
            let truth = grid.rows(grid.style, left_out, MODEL_FRAMES)?;
            let made = clip(&rest, left_out);
            Some(made.iter().zip(&truth).map(|(a, b)| std::array::from_fn(|d| a[d] - b[d])).collect())
        })
        .collect()
}

/// Resamples a clip from the model's frames to the frames of the content.
pub(super) fn onto_frames(grid: &Grid, rows: &[Row]) -> Vec<Row> {
    let postures: Vec<Posture> = rows.iter().map(super::grid::posture).collect();
    let step = (MODEL_FRAMES - 1) as f64 / grid.frames.saturating_sub(1).max(1) as f64;
    if grid.frames == MODEL_FRAMES {
        return rows.to_vec();
    }
    (0..grid.frames).map(|frame| super::grid::row(&between(&postures, frame as f64 * step))).collect()
}

/// Shifts a clip to its key poses and estimates its standard deviation.
///
/// The offsets at the key poses are interpolated linearly over the frames between them. The deviation comes from the
/// errors of clips that were predicted while left out. If key poses are given, only the variation of these errors about
/// their mean counts, since the key poses correct the mean. Without such errors the spread of the motion among the
/// other characters takes their place.
pub(super) fn spread(grid: &Grid, mut rows: Vec<Row>, errors: &[Vec<Row>], keys: &[(usize, Row)]) -> Prediction {
    let offsets: Vec<(usize, Row)> =
        keys.iter().map(|(f, key)| (*f, std::array::from_fn(|d| key[d] - rows[*f][d]))).collect();
    for (frame, row) in rows.iter_mut().enumerate() {
        let after = offsets.partition_point(|(f, _)| *f < frame);
        let offset = match (after.checked_sub(1).map(|k| &offsets[k]), offsets.get(after)) {
            (Some((f, a)), Some((g, b))) => {
                let part = (frame - f) as f64 / (g - f) as f64;
                std::array::from_fn(|d| a[d] + part * (b[d] - a[d]))
            }
            (Some((_, a)), None) | (None, Some((_, a))) => *a,
            (None, None) => [0.0; WIDTH],
        };
        row.iter_mut().zip(offset).for_each(|(value, o)| *value += o);
    }
    let mean = grid.mean_without(grid.style, grid.motion, MODEL_FRAMES).unwrap_or_default();
    let others: Vec<Vec<Row>>;
    let sample = if errors.is_empty() {
        let clips = (0..grid.characters.len()).filter_map(|s| grid.rows(s, grid.motion, MODEL_FRAMES));
        let less = |clip: Vec<Row>| clip.iter().zip(&mean).map(|(a, b)| std::array::from_fn(|d| a[d] - b[d])).collect();
        others = clips.map(less).collect();
        &others
    } else {
        errors
    };
    let mut variance = [0.0; COUNT];
    for clip in sample {
        for d in 0..WIDTH {
            let middle =
                if keys.is_empty() { 0.0 } else { clip.iter().map(|row| row[d]).sum::<f64>() / clip.len() as f64 };
            let total: f64 = clip.iter().map(|row| (row[d] - middle).powi(2)).sum();
            variance[d / 2] += 0.5 * total / (clip.len() * sample.len()) as f64;
        }
    }
    let deviation = vec![variance.map(f64::sqrt); rows.len()];
    Prediction { rows, deviation, sure: None }
}
