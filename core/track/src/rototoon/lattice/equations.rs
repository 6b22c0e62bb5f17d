//! Linear equations of a lattice's nodes, solved under the artist's constraints.
//!
//! Of all steps x with C x = c, the one of least energy ½ xᵀH x − bᵀx is x₀ + H⁻¹Cᵀ (C H⁻¹ Cᵀ)⁻¹ (c − C x₀), where H
//! x₀ = b. So beside the band matrix H there is a small dense matrix with one row per anchor and axis. Both are
//! factored once and serve every right-hand side.

use super::anchors::Anchors;
use rototoon_base::geometry::Point;
use rototoon_base::numeric::banded::{BandCholesky, BandMatrix};

/// Compliance of a constraint. Several control points in one cell may contradict its bilinear map; then each of them
/// gives way a little. Compared with the lattice's own stiffness (about 1) the constraints are hard.
const YIELD: f64 = 1e-4;

/// Factored equations with their constraints.
pub struct Equations {
    factor: BandCholesky,
    constraints: Option<Constraints>,
}

struct Constraints {
    /// H⁻¹ of each row of C.
    responses: Vec<Vec<f64>>,
    /// C H⁻¹ Cᵀ.
    small: BandCholesky,
}

impl Equations {
    /// Factors the matrix H and the constraints of `anchors`. `None` if one of them is not positive definite.
    pub fn new(matrix: BandMatrix, anchors: &Anchors) -> Option<Self> {
        let size = matrix.size();
        let factor = matrix.factor().ok()?;
        let constraints = if anchors.is_empty() { None } else { Some(Constraints::new(&factor, anchors, size)?) };
        Some(Self { factor, constraints })
    }

    /// Solves for the step from `nodes` with the right-hand side `b`, in place. After the step the anchors are
    /// fulfilled. `anchors` must have the same rows as those given to [`Equations::new`]; their places may differ.
    pub fn solve(&self, b: &mut [f64], nodes: &[Point], anchors: &Anchors) {
        self.factor.solve_in_place(b);
        let Some(Constraints { responses, small }) = &self.constraints else { return };
        let apply = |row: &mut dyn Iterator<Item = (usize, f64)>| row.map(|(i, w)| w * b[i]).sum::<f64>();
        let mut multipliers: Vec<f64> =
            anchors.missing(nodes).zip(anchors.rows()).map(|(missing, mut row)| missing - apply(&mut row)).collect();
        small.solve_in_place(&mut multipliers);
        for (multiplier, response) in multipliers.iter().zip(responses) {
            b.iter_mut().zip(response).for_each(|(x, r)| *x += multiplier * r);
        }
    }
}

impl Constraints {
    fn new(factor: &BandCholesky, anchors: &Anchors, size: usize) -> Option<Self> {
        let response = |row: &mut dyn Iterator<Item = (usize, f64)>| {
            let mut column = vec![0.0; size];
            row.for_each(|(i, w)| column[i] += w);
            factor.solve_in_place(&mut column);
            column
        };
        let responses: Vec<Vec<f64>> = anchors.rows().map(|mut row| response(&mut row)).collect();
        let count = responses.len();
        let mut small = BandMatrix::zeros(count, count.saturating_sub(1));
        for (i, row) in anchors.rows().enumerate() {
            for (j, response) in responses[..=i].iter().enumerate() {
                let value: f64 = row.clone().map(|(k, w)| w * response[k]).sum();
                small.add(i, j, value + if i == j { YIELD } else { 0.0 });
            }
        }
        Some(Self { responses, small: small.factor().ok()? })
    }
}
