//! Checks an analytic Jacobian against central differences.
//!
//! (r(x + h e) − r(x − h e)) / 2h differs from the derivative by O(h²), and by a rounding error of about ε|r|/h. If h is near
//! the cube root of ε, both are small for residuals and variables of moderate size. Entries outside of the pattern are checked
//! too: they must be zero. Choose an x where r is smooth, for example not at the pixel borders of a bilinear picture.

use super::sparse_least_squares::Problem;

/// The entry of the Jacobian with the greatest error.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WorstEntry {
    /// Index of the residual.
    pub row: usize,
    /// Index of the variable.
    pub column: usize,
    /// The analytic value.
    pub analytic: f64,
    /// The central difference.
    pub numeric: f64,
    /// |analytic − numeric| / max(1, |numeric|).
    pub error: f64,
}

/// Compares every entry of the Jacobian at `x`, stepping each variable by `h`. `None` if there are no entries.
pub fn worst_entry(problem: &impl Problem, x: &[f64], h: f64) -> Option<WorstEntry> {
    let (n, m) = (problem.variables(), problem.residuals());
    let pattern = problem.pattern();
    let mut residuals = vec![0.0; m];
    let mut values = vec![0.0; pattern.len()];
    problem.linearise(x, &mut residuals, &mut values);
    let mut analytic = vec![0.0; n * m];
    for (&(row, column), &value) in pattern.iter().zip(&values) {
        analytic[column * m + row] += value;
    }
    let mut x = x.to_vec();
    let (mut after, mut before) = (vec![0.0; m], vec![0.0; m]);
    let mut worst: Option<WorstEntry> = None;
    for column in 0..n {
        let here = x[column];
        x[column] = here + h;
        problem.evaluate(&x, &mut after);
        x[column] = here - h;
        problem.evaluate(&x, &mut before);
        x[column] = here;
        for row in 0..m {
            let numeric = (after[row] - before[row]) / (2.0 * h);
            let analytic = analytic[column * m + row];
            let error = (analytic - numeric).abs() / numeric.abs().max(1.0);
            // In this form an error that is not a number counts as the greatest.
            if !worst.is_some_and(|w| error <= w.error || w.error.is_nan()) {
                worst = Some(WorstEntry { row, column, analytic, numeric, error });
            }
        }
    }
    worst
}

#[cfg(test)]
mod tests {
    use super::*;

    /// r = (x², xy), with the derivative of the second residual by y claimed to be `claimed` × x.
    struct Claim {
        claimed: f64,
    }

    impl Problem for Claim {
        fn variables(&self) -> usize {
            2
        }
        fn residuals(&self) -> usize {
            2
        }
        fn pattern(&self) -> Vec<(usize, usize)> {
            vec![(0, 0), (1, 0), (1, 1)]
        }
        fn evaluate(&self, x: &[f64], residuals: &mut [f64]) {
            residuals.copy_from_slice(&[x[0] * x[0], x[0] * x[1]]);
        }
        fn linearise(&self, x: &[f64], residuals: &mut [f64], jacobian: &mut [f64]) {
            self.evaluate(x, residuals);
            jacobian.copy_from_slice(&[2.0 * x[0], x[1], self.claimed * x[0]]);
        }
    }

    #[test]
    fn a_right_jacobian_passes() {
        assert!(worst_entry(&Claim { claimed: 1.0 }, &[3.0, -2.0], 1e-5).unwrap().error < 1e-8);
    }

    #[test]
    fn a_wrong_entry_is_named() {
        let worst = worst_entry(&Claim { claimed: 1.5 }, &[3.0, -2.0], 1e-5).unwrap();
        assert_eq!((worst.row, worst.column, worst.analytic), (1, 1, 4.5));
        assert!((worst.numeric - 3.0).abs() < 1e-8 && (worst.error - 0.5).abs() < 1e-8);
    }
}
