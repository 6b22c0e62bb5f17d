//! A compact description of clips: cosines over time, principal axes over the key points.
//!
//! **Time.** The basis is the first [`COSINES`] functions of the discrete cosine transform (DCT-II), orthonormal on
//! [`MODEL_FRAMES`] frames. They do not require a periodic clip. Faster motion is taken from the mean motion instead.
//!
//! **Key points.** The axes are the principal axes of what characters add to motions. The part that is equal on both
//! sides of the body and the part that is opposite get axes of their own. A manner that shows on the left in one phase
//! shows on the right half a cycle later. With axes that are even or odd under the exchange of sides a kernel can
//! express this (see `kernels`).

use super::grid::{Row, WIDTH};
use faer::{Mat, Side};
use rototoon_base::scene::skeleton::{COUNT, MIRROR};

/// Number of frames in which clips are compared.
pub(super) const MODEL_FRAMES: usize = 32;

/// Number of cosines.
pub(super) const COSINES: usize = 12;

/// Axes with less than this share of the largest variance are left out.
const NEGLIGIBLE: f64 = 1e-6;

/// Values of the cosines at `frames` frames over the length of a clip: `frames` rows of [`COSINES`].
pub(super) fn cosines(frames: usize) -> Vec<[f64; COSINES]> {
    let n = MODEL_FRAMES as f64;
    let at = |frame: usize| {
        // The first and the last frame coincide with those of the model.
        let share = if frames > 1 { frame as f64 / (frames - 1) as f64 } else { 0.0 };
        let time = (share * (n - 1.0) + 0.5) / n;
        std::array::from_fn(|k| match k {
            0 => (1.0 / n).sqrt(),
            _ => (2.0 / n).sqrt() * (std::f64::consts::PI * k as f64 * time).cos(),
        })
    };
    (0..frames).map(at).collect()
}

/// Orthonormal axes of the space of postures.
pub(super) struct Axes {
    /// The axes; those even under the exchange of sides come first.
    pub vectors: Vec<Row>,
    /// Number of even axes.
    pub even: usize,
}

impl Axes {
    /// Principal axes of postures that have zero mean.
    pub fn of<'a>(residuals: impl Iterator<Item = &'a Row>) -> Self {
        let mut covariance = vec![[0.0; WIDTH]; WIDTH];
        for row in residuals {
            for (i, line) in covariance.iter_mut().enumerate() {
                for (j, value) in line.iter_mut().enumerate() {
                    *value += row[i] * row[j];
                }
            }
        }
        let mut found = [principal(&covariance, &sided(1.0)), principal(&covariance, &sided(-1.0))];
        let largest = found.iter().flatten().fold(0.0f64, |most, (v, _)| most.max(*v));
        for axes in &mut found {
            axes.retain(|(variance, _)| *variance > NEGLIGIBLE * largest);
        }
        let even = found[0].len();
        Self { vectors: found.into_iter().flatten().map(|(_, axis)| axis).collect(), even }
    }

    /// Number of axes.
    pub fn len(&self) -> usize {
        self.vectors.len()
    }

    /// Coordinates of a posture.
    pub fn coordinates(&self, row: &Row) -> Vec<f64> {
        self.vectors.iter().map(|axis| axis.iter().zip(row).map(|(a, b)| a * b).sum()).collect()
    }

    /// The posture of coordinates.
    pub fn posture(&self, coordinates: &[f64]) -> Row {
        let mut row = [0.0; WIDTH];
        for (axis, along) in self.vectors.iter().zip(coordinates) {
            row.iter_mut().zip(axis).for_each(|(value, v)| *value += along * v);
        }
        row
    }
}

/// An orthonormal basis of the postures that the exchange of sides keeps (`sign` 1) or negates (−1).
fn sided(sign: f64) -> Vec<Row> {
    let mut basis = Vec::new();
    for k in 0..COUNT {
        for axis in 0..2 {
            let mut row = [0.0; WIDTH];
            let other = MIRROR[k];
            if other == k && sign > 0.0 {
                row[2 * k + axis] = 1.0;
            } else if other > k {
                row[2 * k + axis] = 0.5f64.sqrt();
                row[2 * other + axis] = sign * 0.5f64.sqrt();
            } else {
                continue;
            }
            basis.push(row);
        }
    }
    basis
}

/// Variances and principal axes within the span of a basis, in descending order.
fn principal(covariance: &[Row], basis: &[Row]) -> Vec<(f64, Row)> {
    let project = |a: &Row, b: &Row| -> f64 {
        (0..WIDTH).map(|i| a[i] * covariance[i].iter().zip(b).map(|(c, v)| c * v).sum::<f64>()).sum()
    };
    let n = basis.len();
    let small = Mat::from_fn(n, n, |i, j| project(&basis[i], &basis[j]));
    let Ok(eigen) = small.self_adjoint_eigen(Side::Lower) else { return Vec::new() };
    (0..n)
        .rev()
        .map(|k| {
            let axis = std::array::from_fn(|d| (0..n).map(|i| eigen.U()[(i, k)] * basis[i][d]).sum());
            (eigen.S()[k], axis)
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cosines_are_orthonormal_on_the_models_frames() {
        let rows = cosines(MODEL_FRAMES);
        for i in 0..COSINES {
            for j in 0..COSINES {
                let product: f64 = rows.iter().map(|row| row[i] * row[j]).sum();
                assert!((product - if i == j { 1.0 } else { 0.0 }).abs() < 1e-12);
            }
        }
        let (fine, coarse) = (cosines(63), cosines(32));
        assert!((0..COSINES).all(|k| (fine[2 * 7][k] - coarse[7][k]).abs() < 1e-12));
    }

    #[test]
    fn axes_are_even_or_odd_and_span_what_varies() {
        let rows: Vec<Row> = (0..80)
            .map(|i| std::array::from_fn(|d| (1.7 * i as f64 + 3.1 * d as f64 + (i * d) as f64).sin()))
            .collect();
        let axes = Axes::of(rows.iter());
        assert_eq!(axes.len(), WIDTH);
        for (a, axis) in axes.vectors.iter().enumerate() {
            let sign = if a < axes.even { 1.0 } else { -1.0 };
            for k in 0..COUNT {
                assert!((axis[2 * MIRROR[k]] - sign * axis[2 * k]).abs() < 1e-12);
            }
        }
        let (row, found) = (&rows[3], axes.coordinates(&rows[3]));
        let back = axes.posture(&found);
        assert!(row.iter().zip(back).all(|(a, b)| (a - b).abs() < 1e-9));
    }

    #[test]
    fn what_never_varies_needs_no_axes() {
        assert_eq!(Axes::of([[0.0; WIDTH]].iter()).len(), 0);
    }
}
