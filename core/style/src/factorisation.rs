//! Non-negative style factorisation (Liang et al. 2012, section 4, algorithm 1): X ≈ UV.
//!
//! X (n × d, no negative entries) has a posture in each row. U (n × k) contains the codes, V (k × d) a basis of
//! postures. The paper minimises ½‖X − UV‖² + α ΣV + a class term of weight β (eq. 7) by alternating steps:
//!
//! 1. U ← U − μ [(UV − X)Vᵀ + β (UW − Y)Wᵀ], μ = 1/λ, λ a bound on the largest eigenvalue of VVᵀ + β WWᵀ. The printed
//!    formula lacks the step size. The inverse of the Lipschitz constant is the largest step that never overshoots.
//! 2. Negative entries of U become zero. The paper prints "set all U_ij to 0", which would clear the matrix;
//!    [`Reading::Literal`] does so.
//! 3. Columns of U get root mean square 1, and the scale moves into V. The paper prints rows of unit length, which
//!    loses the magnitude of each frame.
//! 4. V ← V ∘ (UᵀX) / (UᵀUV + α), the multiplicative step of Hoyer (2002), as printed.
//! 5. At the end, V̄ = V A Aᵀ, where A contains the leading eigenvectors of VᵀV (eq. 6; as printed it has rank one and
//!    cannot satisfy UV̄ ≈ X). Negative entries become zero.
//!
//! The printed class term, ‖WV − Y‖² with W = YVᵀ(VVᵀ)⁻¹, multiplies matrices whose sizes do not match, and it never
//! enters the updates. Labels belong to postures, so the codes should predict them: Y ≈ UW. Here W comes from ridge
//! regression, and β weights its influence on U.
//!
//! The steps repeat until the relative error changes by less than a tolerance over ten rounds, or up to a limit. The
//! start is pseudo-random with a fixed seed.
//!
//! **Speed.** XVᵀ and UᵀX are matrix products of n·d·k operations; everything else is smaller. Postures are processed
//! in pieces of [`ROWS`] rows that fit a processor's cache, in parallel on all threads. Sums over the pieces are added
//! in order, so the result is the same on any number of threads. The products use faer's kernels. The objective follows
//! from products that are already known, ‖X − UV‖² = ‖X‖² − 2⟨V, UᵀX⟩ + ⟨V, UᵀUV⟩, without another pass over X.
//!
//! Limits: the minimum is local and depends on the seed. Two factorisations of different matrices share no order of
//! components (see `liang2012`).

use faer::linalg::matmul::matmul;
use faer::{Accum, Mat, MatMut, MatRef, Par, Side};
use rayon::prelude::{IndexedParallelIterator, IntoParallelIterator, ParallelIterator};
use rototoon_base::numeric::vector::dot;

/// Rounds between checks of the error.
const LOOK: usize = 10;
/// Rows in a piece.
const ROWS: usize = 512;
/// Keeps denominators away from zero.
const TINY: f64 = 1e-12;
/// Ridge of the class regression, as a share of the mean squared code.
const CLASS_RIDGE: f64 = 1e-2;
/// Steps of V in a round. With UᵀU and UᵀX known another step is cheap (Gillis & Glineur 2012, "Accelerated
/// Multiplicative Updates").
const BASIS_STEPS: usize = 3;
/// Steps of U in a round when the codes are few. Then XVᵀ costs more than a step.
const CODE_STEPS: usize = 2;
/// Power iterations for the bound λ in each round. V changes little between rounds, so few are enough.
const POWER_STEPS: usize = 2;

/// The reading of the paper's algorithm.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Reading {
    /// The reading described above.
    #[default]
    Consistent,
    /// As printed: any negative entry clears U, rows of U get unit length, and eq. 6 keeps one direction.
    Literal,
}

/// Options of a factorisation.
#[derive(Clone, Debug, PartialEq)]
pub struct Options {
    /// k: number of basis postures.
    pub rank: usize,
    /// α: sparseness of V.
    pub sparseness: f64,
    /// β: weight of the class term, which makes the codes separate the classes.
    pub class_weight: f64,
    /// r of eq. 6: number of directions that V keeps; `None` keeps all.
    pub directions: Option<usize>,
    /// Greatest number of rounds.
    pub rounds: usize,
    /// The rounds end when the relative error changes by less than this over ten rounds.
    pub tolerance: f64,
    /// Seed of the pseudo-random start.
    pub seed: u64,
    /// The reading of the algorithm.
    pub reading: Reading,
}

impl Default for Options {
    fn default() -> Self {
        Self {
            rank: 24,
            sparseness: 0.0,
            class_weight: 0.0,
            directions: None,
            rounds: 200,
            tolerance: 1e-5,
            seed: 1,
            reading: Reading::Consistent,
        }
    }
}

/// Why the rounds ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Ended {
    /// The error changed by less than the tolerance.
    Converged,
    /// The limit of rounds was reached.
    Rounds,
    /// All codes became zero. Further steps cannot change that.
    Wiped,
}

/// A factorisation.
#[derive(Clone, Debug)]
pub struct Factorisation {
    /// U: codes, n × k.
    pub codes: Mat<f64>,
    /// V: basis postures, k × d.
    pub basis: Mat<f64>,
    /// W: class weights, k × classes; the codes predict the classes as UW.
    pub classes: Mat<f64>,
    /// ‖X − UV‖ / ‖X‖.
    pub error: f64,
    /// Rounds done.
    pub rounds: usize,
    /// Why the rounds ended.
    pub ended: Ended,
}

/// Why a matrix cannot be factored.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum FactorError {
    /// An entry is negative or not finite.
    #[error("row {row}, column {column}: found {found}, expected a finite number of at least 0")]
    Entry {
        /// Its row.
        row: usize,
        /// Its column.
        column: usize,
        /// What was found.
        found: f64,
    },
    /// The number of labels differs from the number of rows.
    #[error("labels: found {found}, expected one for each of {rows} rows")]
    Labels {
        /// Number of labels.
        found: usize,
        /// Number of rows.
        rows: usize,
    },
    /// The rank is 0.
    #[error("rank: found 0, expected at least 1")]
    Rank,
}

/// The class of each row as an indicator matrix, rows × classes, of zeros and ones.
pub fn indicator(labels: &[usize]) -> Mat<f64> {
    let classes = labels.iter().max().map_or(0, |most| most + 1);
    Mat::from_fn(labels.len(), classes, |row, class| if labels[row] == class { 1.0 } else { 0.0 })
}

/// Factors a matrix X (postures × coordinates) without negative entries. `labels` contains the class of each row, or is
/// empty.
///
/// # Errors
///
/// A [`FactorError`] if the rank is 0, the number of labels is wrong, or an entry is negative or not finite.
pub fn factor(x: MatRef<'_, f64>, labels: &[usize], options: &Options) -> Result<Factorisation, FactorError> {
    check(x, labels, options)?;
    let (n, d, k) = (x.nrows(), x.ncols(), options.rank);
    let y = indicator(labels);
    let (mut u, mut v) = start(x, options);
    let norm = x.squared_norm_l2();
    let mut state = Work::new(n, d, k);
    let (mut error, mut ended, mut rounds) = (f64::INFINITY, Ended::Rounds, options.rounds);
    let mut w = Mat::zeros(k, y.ncols());
    for round in 0..options.rounds {
        if options.class_weight > 0.0 && !labels.is_empty() {
            w = regression(&u, &y);
        }
        state.step_codes(x, &mut u, &v, (&w, &y), options);
        if u.squared_norm_l2() == 0.0 {
            (ended, rounds, error) = (Ended::Wiped, round + 1, 1.0);
            break;
        }
        normalise(&mut u, &mut v, options.reading);
        let residual = state.step_basis(x, &u, &mut v, options.sparseness, norm);
        if (round + 1) % LOOK == 0 {
            let now = (residual.max(0.0) / norm.max(TINY)).sqrt();
            if (error - now).abs() < options.tolerance {
                (ended, rounds) = (Ended::Converged, round + 1);
                break;
            }
            error = now;
        }
    }
    if ended != Ended::Wiped {
        let keep = if options.reading == Reading::Literal { Some(1) } else { options.directions };
        remodel(&mut v, keep);
        let mut rest = x.to_owned();
        matmul(&mut rest, Accum::Add, &u, &v, -1.0, Par::Seq);
        error = (rest.squared_norm_l2() / norm.max(TINY)).sqrt();
        w = regression(&u, &y);
    }
    Ok(Factorisation { codes: u, basis: v, classes: w, error, rounds, ended })
}

fn check(x: MatRef<'_, f64>, labels: &[usize], options: &Options) -> Result<(), FactorError> {
    if options.rank == 0 {
        return Err(FactorError::Rank);
    }
    if !labels.is_empty() && labels.len() != x.nrows() {
        return Err(FactorError::Labels { found: labels.len(), rows: x.nrows() });
    }
    for column in 0..x.ncols() {
        for row in 0..x.nrows() {
            let found = x[(row, column)];
            if !(found >= 0.0 && found.is_finite()) {
                return Err(FactorError::Entry { row, column, found });
            }
        }
    }
    Ok(())
}

/// Pseudo-random start of U and V: numbers from 0.1 to 1.1, with V scaled so that the mean of UV equals that of X.
fn start(x: MatRef<'_, f64>, options: &Options) -> (Mat<f64>, Mat<f64>) {
    let (n, d, k) = (x.nrows(), x.ncols(), options.rank);
    let mut state = options.seed;
    let mut next = || {
        // SplitMix64 (Steele, Lea & Flood 2014).
        state = state.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = (state ^ (state >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        ((z ^ (z >> 31)) >> 11) as f64 / (1u64 << 53) as f64 + 0.1
    };
    let mut u = Mat::zeros(n, k);
    let mut v = Mat::zeros(k, d);
    (0..k).for_each(|j| (0..n).for_each(|i| u[(i, j)] = next()));
    (0..d).for_each(|j| (0..k).for_each(|i| v[(i, j)] = next()));
    let mean = x.sum() / (n * d).max(1) as f64;
    let made = u.sum() / (n * k).max(1) as f64 * v.sum() / (k * d).max(1) as f64 * k as f64;
    v *= faer::Scale(mean / made.max(TINY));
    (u, v)
}

/// Buffers for the matrices that every round computes.
struct Work {
    vv: Mat<f64>,
    step: Mat<f64>,
    target: Mat<f64>,
    direction: Mat<f64>,
    uu: Mat<f64>,
    ux: Mat<f64>,
    uuv: Mat<f64>,
}

impl Work {
    fn new(n: usize, d: usize, k: usize) -> Self {
        Self {
            vv: Mat::zeros(k, k),
            step: Mat::zeros(n, k),
            target: Mat::zeros(n, k),
            direction: Mat::from_fn(k, 1, |_, _| 1.0),
            uu: Mat::zeros(k, k),
            ux: Mat::zeros(k, d),
            uuv: Mat::zeros(k, d),
        }
    }

    /// Steps 1 and 2.
    fn step_codes(
        &mut self,
        x: MatRef<'_, f64>,
        u: &mut Mat<f64>,
        v: &Mat<f64>,
        (w, y): (&Mat<f64>, &Mat<f64>),
        options: &Options,
    ) {
        let beta = if y.ncols() > 0 { options.class_weight } else { 0.0 };
        matmul(&mut self.vv, Accum::Replace, v, v.transpose(), 1.0, Par::Seq);
        if beta > 0.0 {
            matmul(&mut self.vv, Accum::Add, w, w.transpose(), beta, Par::Seq);
            matmul(&mut self.target, Accum::Replace, y, w.transpose(), beta, Par::Seq);
        }
        let target_so_far = if beta > 0.0 { Accum::Add } else { Accum::Replace };
        let mu = 1.0 / self.largest().max(TINY);
        let few = 2 * u.ncols() <= x.ncols() && options.reading == Reading::Consistent;
        let steps = if few { CODE_STEPS } else { 1 };
        let vv = &self.vv;
        let pieces = pieces_mut(u.as_mut()).into_par_iter().zip(pieces_mut(self.step.as_mut()));
        let pieces = pieces.zip(pieces_mut(self.target.as_mut())).zip(pieces_of(x));
        let move_piece = |(((mut u, mut step), mut target), x): (((MatMut<f64>, _), MatMut<f64>), _)| {
            matmul(&mut target, target_so_far, x, v.transpose(), 1.0, Par::Seq);
            (0..steps).fold(false, |negative, _| negative | code_step(&mut u, &mut step, &target, vv, mu))
        };
        let negative = pieces.map(move_piece).reduce(|| false, |a, b| a | b);
        if negative && options.reading == Reading::Literal {
            u.fill(0.0);
        }
    }

    /// An upper bound of the largest eigenvalue of the matrix that multiplies U. After some power iterations the
    /// Collatz–Wielandt ratio max (Av)_i / v_i is an upper bound for a matrix without negative entries. With negative
    /// entries the largest sum of absolute values of a row is used.
    fn largest(&mut self) -> f64 {
        let k = self.vv.nrows();
        let mut bound = f64::INFINITY;
        for _ in 0..POWER_STEPS {
            let next = &self.vv * &self.direction;
            let ratio = (0..k).map(|i| next[(i, 0)] / self.direction[(i, 0)].max(TINY)).fold(0.0, f64::max);
            bound = bound.min(ratio);
            let size = next.norm_max().max(TINY);
            self.direction = Mat::from_fn(k, 1, |i, _| (next[(i, 0)] / size).max(1e-3));
        }
        let sums = (0..k).map(|i| (0..k).map(|j| self.vv[(i, j)].abs()).sum::<f64>()).fold(0.0, f64::max);
        let mixed = (0..k).any(|j| self.vv.col_as_slice(j).iter().any(|v| *v < 0.0));
        if mixed { sums } else { bound.min(sums) }
    }

    /// Step 4. Returns ‖X − UV‖² for V before the step.
    fn step_basis(&mut self, x: MatRef<'_, f64>, u: &Mat<f64>, v: &mut Mat<f64>, alpha: f64, norm: f64) -> f64 {
        let mut first = 0.0;
        let products = |(u, x): (MatRef<f64>, MatRef<f64>)| (u.transpose() * u, u.transpose() * x);
        let pieces = pieces_of(u.as_ref()).into_par_iter().zip(pieces_of(x));
        let sums: Vec<(Mat<f64>, Mat<f64>)> = pieces.map(products).collect();
        self.uu.fill(0.0);
        self.ux.fill(0.0);
        for (uu, ux) in sums {
            self.uu += uu;
            self.ux += ux;
        }
        for step in 0..BASIS_STEPS {
            matmul(&mut self.uuv, Accum::Replace, &self.uu, &*v, 1.0, Par::Seq);
            let mut residual = norm;
            for j in 0..v.ncols() {
                let (ux, uuv) = (self.ux.col_as_slice(j), self.uuv.col_as_slice(j));
                for (k, value) in v.col_as_slice_mut(j).iter_mut().enumerate() {
                    residual += *value * (uuv[k] - 2.0 * ux[k]);
                    *value *= ux[k] / (uuv[k] + alpha + TINY);
                }
            }
            if step == 0 {
                first = residual;
            }
        }
        first
    }
}

/// One step of the codes of some postures; negative codes become zero. Returns whether any were negative.
fn code_step(u: &mut MatMut<f64>, step: &mut MatMut<f64>, target: &MatMut<f64>, vv: &Mat<f64>, mu: f64) -> bool {
    let mut negative = false;
    matmul(step.as_mut(), Accum::Replace, u.as_ref(), vv, -1.0, Par::Seq);
    for j in 0..u.ncols() {
        let (step, target) = (step.as_ref().col(j), target.as_ref().col(j));
        let along = step.iter().zip(target.iter());
        for (value, (step, target)) in u.as_mut().col_mut(j).iter_mut().zip(along) {
            *value += mu * (step + target);
            negative |= *value < 0.0;
            *value = value.max(0.0);
        }
    }
    negative
}

/// Splits the rows of a matrix into pieces of [`ROWS`] rows.
fn pieces_of(matrix: MatRef<'_, f64>) -> Vec<MatRef<'_, f64>> {
    let starts = (0..matrix.nrows()).step_by(ROWS);
    starts.map(|first| matrix.subrows(first, ROWS.min(matrix.nrows() - first))).collect()
}

/// The same as [`pieces_of`], for writing.
fn pieces_mut(mut rest: MatMut<'_, f64>) -> Vec<MatMut<'_, f64>> {
    let mut pieces = Vec::new();
    while rest.nrows() > 0 {
        let rows = ROWS.min(rest.nrows());
        let (piece, below) = rest.split_at_row_mut(rows);
        pieces.push(piece);
        rest = below;
    }
    pieces
}

/// Step 3.
fn normalise(u: &mut Mat<f64>, v: &mut Mat<f64>, reading: Reading) {
    if reading == Reading::Literal {
        for i in 0..u.nrows() {
            let size = (0..u.ncols()).map(|j| u[(i, j)].powi(2)).sum::<f64>().sqrt();
            (0..u.ncols()).for_each(|j| u[(i, j)] /= size.max(TINY));
        }
        return;
    }
    let n = u.nrows().max(1) as f64;
    for j in 0..u.ncols() {
        let column = u.col_as_slice_mut(j);
        let size = (dot(column, column) / n).sqrt();
        if size > TINY {
            let inverse = 1.0 / size;
            column.iter_mut().for_each(|v| *v *= inverse);
            (0..v.ncols()).for_each(|c| v[(j, c)] *= size);
        }
    }
}

/// W of Y ≈ UW by ridge regression.
fn regression(u: &Mat<f64>, y: &Mat<f64>) -> Mat<f64> {
    if y.ncols() == 0 {
        return Mat::zeros(u.ncols(), 0);
    }
    let mut products = u.transpose() * u;
    let ridge = CLASS_RIDGE * (0..u.ncols()).map(|j| products[(j, j)]).sum::<f64>() / u.ncols() as f64;
    (0..u.ncols()).for_each(|j| products[(j, j)] += ridge.max(TINY));
    let right = u.transpose() * y;
    match products.llt(Side::Lower) {
        Ok(factor) => faer::linalg::solvers::Solve::solve(&factor, &right),
        Err(_) => Mat::zeros(u.ncols(), y.ncols()),
    }
}

/// Step 5.
fn remodel(v: &mut Mat<f64>, directions: Option<usize>) {
    let Some(keep) = directions.filter(|keep| *keep < v.ncols().min(v.nrows())) else { return };
    let Ok(eigen) = (v.transpose() * &*v).self_adjoint_eigen(Side::Lower) else { return };
    let leading = eigen.U().subcols(v.ncols() - keep, keep).to_owned();
    let mut modelled = &*v * &leading * leading.transpose();
    for j in 0..modelled.ncols() {
        modelled.col_as_slice_mut(j).iter_mut().for_each(|value| *value = value.max(0.0));
    }
    *v = modelled;
}

#[cfg(test)]
mod tests;
