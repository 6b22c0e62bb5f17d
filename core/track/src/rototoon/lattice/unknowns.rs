//! The unknowns of an alignment: all nodes of a lattice, or a coarser lattice that moves them together with their
//! neighbours.
//!
//! The coarse levels of the pyramid hardly distinguish neighbouring nodes, because a cell is only one to three pixels
//! wide on the coarsest level. So on these levels the nodes are moved by a lattice with cells of twice the side,
//! bilinearly: x = x₀ + P δ. P contains the weights of the coarse nodes at each node, and δ are the shifts of the
//! coarse nodes. The normal equations become PᵀHP δ = Pᵀb (Galerkin's coarse equations; Briggs, Henson & McCormick, *A
//! Multigrid Tutorial*, ch. 10). Finer bends that a pose already has stay.
//!
//! There are a quarter of the unknowns and half of the bandwidth, so the equations take a sixteenth of the time. Less
//! noise is fitted too: over fourteen sequences 0.1 points of 100 more are right.
//!
//! Each cell of the lattice is completely inside one cell of the coarse one. So a place in a cell is moved by the four
//! nodes of one coarse cell, bilinearly too.

use super::grid::Numbered;
use rototoon_base::geometry::Point;
use rototoon_base::numeric::banded::BandMatrix;

/// Nodes of the unknowns with their weights. There are always four entries; a node may be named twice or have the
/// weight 0.
type Shares = [(usize, f64); 4];

/// The nodes whose shifts are the unknowns, and their effect on the nodes of a lattice.
#[derive(Clone, Debug)]
pub struct Unknowns {
    /// The nodes of each cell of the unknowns: top left, top right, bottom left, bottom right.
    pub cells: Vec<[usize; 4]>,
    /// For each cell of the lattice the cell of the unknowns that contains it.
    pub cell_of: Vec<usize>,
    /// P: for each node of the lattice the nodes that move it.
    shares: Vec<Shares>,
    count: usize,
    half: usize,
}

impl Unknowns {
    /// Every node of the lattice is an unknown by itself.
    pub fn every(lattice: &Numbered) -> Self {
        Self {
            cells: lattice.cells.clone(),
            cell_of: (0..lattice.cells.len()).collect(),
            shares: (0..lattice.nodes.len()).map(|n| [(n, 1.0), (n, 0.0), (n, 0.0), (n, 0.0)]).collect(),
            count: lattice.nodes.len(),
            half: 2 * lattice.reach + 1,
        }
    }

    /// The nodes of a lattice with cells of twice the side. `lattice` is on a grid of `columns` × `rows` squares; a
    /// coarse cell exists if it contains one of its cells.
    pub fn coarse(lattice: &Numbered, columns: usize, rows: usize) -> Self {
        let (wide, high) = (columns.div_ceil(2), rows.div_ceil(2));
        let mut taken = vec![false; wide * high];
        let mut squares = Vec::with_capacity(lattice.cells.len());
        for (square, _) in lattice.cell_of.iter().enumerate().filter(|(_, cell)| cell.is_some()) {
            let coarse = square / columns / 2 * wide + square % columns / 2;
            taken[coarse] = true;
            squares.push(coarse);
        }
        let coarse = Numbered::new(wide, high, &taken);
        let mut node_of = vec![0; (wide + 1) * (high + 1)];
        coarse.nodes.iter().enumerate().for_each(|(n, &(c, r))| node_of[r * (wide + 1) + c] = n);
        // A node between two coarse lines gets half of its weight from each.
        let along = |at: usize| [at / 2, at.div_ceil(2)];
        let shares = |&(c, r): &(usize, usize)| {
            let ([c0, c1], [r0, r1]) = (along(c), along(r));
            [(c0, r0), (c1, r0), (c0, r1), (c1, r1)].map(|(c, r)| (node_of[r * (wide + 1) + c], 0.25))
        };
        Self {
            cell_of: squares.iter().filter_map(|&square| coarse.cell_of[square]).collect(),
            shares: lattice.nodes.iter().map(shares).collect(),
            count: coarse.nodes.len(),
            half: 2 * coarse.reach + 1,
            cells: coarse.cells,
        }
    }

    /// The zero matrix over the unknowns' coordinates. Unknown 2 n is x of node n, and 2 n + 1 is its y.
    pub fn matrix(&self) -> BandMatrix {
        BandMatrix::zeros(2 * self.count, self.half)
    }

    /// PᵀAP of a matrix A over the coordinates of the lattice's nodes.
    pub fn restricted_matrix(&self, matrix: &BandMatrix) -> BandMatrix {
        let mut restricted = self.matrix();
        for i in 0..matrix.size() {
            // Nodes that share no cell have zero entries, which may be outside the band of the unknowns.
            for (j, value) in matrix.row_range(i).map(|j| (j, matrix.get(i, j))).filter(|(_, value)| *value != 0.0) {
                for (a, share_a) in self.shares[i / 2] {
                    for (b, share_b) in self.shares[j / 2] {
                        let (row, column) = (2 * a + i % 2, 2 * b + j % 2);
                        // An entry represents its mirror image too.
                        if row <= column {
                            restricted.add(row, column, share_a * share_b * value);
                        }
                    }
                }
            }
        }
        restricted
    }

    /// Pᵀv of a vector v over the coordinates of the lattice's nodes.
    pub fn restricted(&self, values: &[f64]) -> Vec<f64> {
        let mut restricted = vec![0.0; 2 * self.count];
        for (shares, value) in self.shares.iter().zip(values.as_chunks::<2>().0) {
            for (n, share) in shares {
                restricted[2 * n] += share * value[0];
                restricted[2 * n + 1] += share * value[1];
            }
        }
        restricted
    }

    /// P δ: shift of each node of the lattice, from the shifts of the unknowns.
    pub fn spread(&self, shifts: &[f64]) -> Vec<Point> {
        let shift = |n: usize| Point::new(shifts[2 * n], shifts[2 * n + 1]);
        self.shares.iter().map(|shares| shares.iter().map(|&(n, share)| shift(n) * share).sum()).collect()
    }

    /// A weighted sum of the lattice's nodes as a weighted sum of the unknowns' nodes, ordered by node.
    pub fn terms(&self, terms: &[(usize, f64)]) -> Vec<(usize, f64)> {
        let mut weights = vec![0.0; self.count];
        for &(n, weight) in terms {
            self.shares[n].iter().for_each(|(u, share)| weights[*u] += weight * share);
        }
        weights.into_iter().enumerate().filter(|(_, weight)| *weight != 0.0).collect()
    }

    /// The weights of a point in a cell of the lattice, converted to the nodes of the unknowns' cell. `nodes` are the
    /// nodes of the lattice's cell.
    pub fn weights(&self, cell: usize, nodes: &[usize; 4], weights: &[f64; 4]) -> [f64; 4] {
        let of_node = |u: usize| {
            let share = |n: usize| self.shares[n].iter().filter(|s| s.0 == u).map(|s| s.1).sum::<f64>();
            nodes.iter().zip(weights).map(|(&n, weight)| weight * share(n)).sum()
        };
        self.cells[self.cell_of[cell]].map(of_node)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// A lattice on 5 × 4 squares without the squares given.
    fn lattice(missing: &[usize]) -> Numbered {
        let taken: Vec<bool> = (0..20).map(|square| !missing.contains(&square)).collect();
        Numbered::new(5, 4, &taken)
    }

    fn both(missing: &[usize]) -> [(Numbered, Unknowns); 2] {
        let lattice = lattice(missing);
        let (every, coarse) = (Unknowns::every(&lattice), Unknowns::coarse(&lattice, 5, 4));
        [(lattice.clone(), every), (lattice, coarse)]
    }

    #[test]
    fn a_coarse_lattice_has_a_quarter_of_the_nodes_and_half_of_the_band() {
        let [(_, every), (_, coarse)] = both(&[]);
        assert_eq!([every.count, coarse.count], [6 * 5, 4 * 3]);
        assert_eq!([every.half, coarse.half], [2 * 6 + 1, 2 * 4 + 1]);
    }

    proptest! {
        #[test]
        fn linear_shifts_stay_linear(missing in prop::collection::vec(0usize..20, 0..12), by in prop::array::uniform4(-3.0f64..3.0)) {
            let shift = |p: Point| Point::new(by[0] * p.x - by[1] * p.y, by[2] * p.x + by[3]);
            for (lattice, unknowns) in both(&missing) {
                let at = |(c, r): (usize, usize)| Point::new(c as f64, r as f64);
                // The places of the unknowns' nodes follow from the cells of the lattice that they move.
                let mut places = vec![Point::NAN; unknowns.count];
                let side = if unknowns.count == lattice.nodes.len() { 1.0 } else { 2.0 };
                for (cell, nodes) in lattice.cells.iter().enumerate() {
                    let corner = (at(lattice.nodes[nodes[0]]) / side).floor() * side;
                    let corners = [Point::ZERO, Point::X, Point::Y, Point::ONE].map(|p| corner + p * side);
                    unknowns.cells[unknowns.cell_of[cell]].iter().zip(corners).for_each(|(&u, p)| places[u] = p);
                }
                let shifts: Vec<f64> = places.iter().flat_map(|&p| shift(p).to_array()).collect();
                for (node, got) in lattice.nodes.iter().zip(unknowns.spread(&shifts)) {
                    prop_assert!(got.distance(shift(at(*node))) < 1e-12);
                }
            }
        }

        #[test]
        fn equations_are_those_of_the_spread_shifts(
            missing in prop::collection::vec(0usize..20, 0..12),
            values in prop::collection::vec(-1.0f64..1.0, 80),
        ) {
            for (lattice, unknowns) in both(&missing) {
                let mut matrix = BandMatrix::zeros(2 * lattice.nodes.len(), 2 * lattice.reach + 1);
                for cell in &lattice.cells {
                    for (k, &i) in cell.iter().flat_map(|n| [2 * n, 2 * n + 1]).collect::<Vec<_>>().iter().enumerate() {
                        matrix.add(i, 2 * cell[3], values[k]);
                        matrix.add(i, i, 1.0);
                    }
                }
                let spread = |shifts: &[f64]| unknowns.spread(shifts).iter().flat_map(|p| p.to_array()).collect::<Vec<_>>();
                let form = |matrix: &BandMatrix, x: &[f64]| {
                    (0..x.len()).flat_map(|i| (0..x.len()).map(move |j| (i, j))).map(|(i, j)| x[i] * matrix.get(i, j) * x[j]).sum::<f64>()
                };
                let shifts = &values[..2 * unknowns.count];
                let (got, want) = (form(&unknowns.restricted_matrix(&matrix), shifts), form(&matrix, &spread(shifts)));
                prop_assert!((got - want).abs() < 1e-9, "{got} for {want}");
                // `restricted` is the transpose of `spread`, and `terms` gives the same sum of nodes.
                let fine: Vec<f64> = (0..matrix.size()).map(|i| values[79 - i]).collect();
                let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
                prop_assert!((dot(&unknowns.restricted(&fine), shifts) - dot(&fine, &spread(shifts))).abs() < 1e-9);
                for (cell, nodes) in lattice.cells.iter().enumerate() {
                    let weights = [0.4, 0.3, 0.2, 0.1];
                    let sum = |terms: &[(usize, f64)], shifts: &[f64]| terms.iter().map(|(n, w)| w * shifts[2 * n]).sum::<f64>();
                    let terms: Vec<(usize, f64)> = nodes.iter().copied().zip(weights).collect();
                    let of_cell: Vec<(usize, f64)> =
                        unknowns.cells[unknowns.cell_of[cell]].into_iter().zip(unknowns.weights(cell, nodes, &weights)).collect();
                    let want = sum(&terms, &spread(shifts));
                    prop_assert!((sum(&unknowns.terms(&terms), shifts) - want).abs() < 1e-12);
                    prop_assert!((sum(&of_cell, shifts) - want).abs() < 1e-12);
                }
            }
        }
    }
}
