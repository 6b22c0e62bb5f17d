//! The control points of one frame that fit the pulls and the links best, by linear least squares.
//!
//! It minimises Σ weights (axis · sample − target)² + λ Σ w |x_j − x_i − edge|² + ε |x − now|². Pins are rows with a
//! large weight. The axes of the pulls couple both coordinates. The points are numbered from both ends of the contour
//! towards its middle, so that the matrix of a closed contour has a narrow band too.

use super::links::Links;
use super::pull::Pull;
use super::samples::Samples;
use rototoon_base::geometry::Point;
use rototoon_base::numeric::banded::BandMatrix;
use std::collections::BTreeMap;

/// ε: weight of the present place. It keeps the system definite.
const STAY: f64 = 1e-3;
/// Weight of a pin.
const PIN: f64 = 1e4;
/// Largest difference of the numbers of two coupled points: links reach 4 points, and the numbers alternate between
/// both ends.
const REACH: usize = 9;

/// The new control points. `now` and `pins` are in working pixels, and `weight` is λ. `None` if the system is not
/// positive definite, for example because of NaN.
pub fn solve(
    samples: &Samples,
    pulls: &[Pull],
    links: &Links,
    edges: &[Point],
    weight: f64,
    now: &[Point],
    pins: &BTreeMap<usize, Point>,
) -> Option<Vec<Point>> {
    let count = now.len();
    let place = |j: usize| if 2 * j < count { 2 * j } else { 2 * (count - 1 - j) + 1 };
    let half = (2 * REACH + 1).min(2 * count - 1);
    let mut matrix = BandMatrix::zeros(2 * count, half);
    let mut right = vec![0.0; 2 * count];
    for (s, pull) in pulls.iter().enumerate() {
        for ((axis, w), target) in pull.axes.iter().zip(pull.weights).zip(pull.targets) {
            let row: Vec<(usize, f64)> = (samples.terms(s).iter())
                .flat_map(|&(j, t)| [(2 * place(j), t * axis.x), (2 * place(j) + 1, t * axis.y)])
                .collect();
            add_row(&mut matrix, &mut right, &row, w, target);
        }
    }
    for (&(i, j, w), edge) in links.all.iter().zip(edges) {
        for (axis, wanted) in [edge.x, edge.y].into_iter().enumerate() {
            let row = [(2 * place(i) + axis, -1.0), (2 * place(j) + axis, 1.0)];
            add_row(&mut matrix, &mut right, &row, weight * w, wanted);
        }
    }
    for (j, p) in now.iter().enumerate() {
        let (weight, to) = pins.get(&j).map_or((STAY, *p), |pin| (PIN, *pin));
        for (axis, wanted) in [to.x, to.y].into_iter().enumerate() {
            add_row(&mut matrix, &mut right, &[(2 * place(j) + axis, 1.0)], weight, wanted);
        }
    }
    matrix.factor().ok()?.solve_in_place(&mut right);
    Some((0..count).map(|j| Point::new(right[2 * place(j)], right[2 * place(j) + 1])).collect())
}

/// Adds weight (Σ a x − wanted)² to the normal equations. A control point may occur more than once in a row.
fn add_row(matrix: &mut BandMatrix, right: &mut [f64], row: &[(usize, f64)], weight: f64, wanted: f64) {
    for (k, &(i, a)) in row.iter().enumerate() {
        right[i] += weight * a * wanted;
        for &(j, b) in &row[..k] {
            // A pair and its mirror image are one entry of the matrix; on the diagonal they are two.
            matrix.add(i, j, weight * a * b * if i == j { 2.0 } else { 1.0 });
        }
        matrix.add(i, i, weight * a * a);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_pulled_corner_takes_its_shape_along() {
        let square: Vec<Point> =
            [(0.0, 0.0), (40.0, 0.0), (40.0, 40.0), (0.0, 40.0)].map(|(x, y)| Point::new(x, y)).to_vec();
        let keys = [square.clone(), square.clone()];
        let (samples, links) = (Samples::new(4, true), Links::new(&keys, true));
        let to = Point::new(5.0, 3.0);
        let pulls: Vec<Pull> = (0..samples.count())
            .map(|s| Pull {
                axes: [Point::X, Point::Y],
                weights: if s == 0 { [1.0; 2] } else { [0.0; 2] },
                targets: [to.x, to.y],
            })
            .collect();
        let mut now = square.clone();
        for _ in 0..60 {
            let edges = links.wanted(&keys, &now, 0.5);
            now = solve(&samples, &pulls, &links, &edges, 1.0, &now, &BTreeMap::new()).unwrap();
        }
        for (p, q) in now.iter().zip(&square) {
            assert!(p.distance(*q + to) < 0.2, "{p} for {}", *q + to);
        }
        let pins = BTreeMap::from([(2, Point::new(50.0, 60.0))]);
        let edges = links.wanted(&keys, &now, 0.5);
        let pinned = solve(&samples, &pulls, &links, &edges, 1.0, &now, &pins).unwrap();
        assert!(pinned[2].distance(pins[&2]) < 0.02);
    }
}
