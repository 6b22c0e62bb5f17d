//! Other bends of a slender part, as places to start from.
//!
//! A limb is longer than it is wide, and it bends across its length: at its elbow or knee if it is an arm or a leg, all
//! along if it is a tail. Two keys show two bends; the drawings between them may show others, and an alignment from
//! either key's bend does not find them: half of the limb lies elsewhere. So a slender lattice is bent beforehand.
//!
//! How: s(cell) is the distance from one end of the part to the cell, through the lattice, as a share of the distance
//! from end to end. A bend by θ turns each cell by φ(s), which rises from 0 to θ over the middle of the part; the
//! nodes are those whose cells are nearest to being turned so (the global step of as-rigid-as-possible surface modelling,
//! Sorkine & Alexa 2007): one linear solve.

use super::mesh::Mesh;
use super::shape;
use crate::geometry::Point;

/// Length of a part, from end to end, over its width from which on it is slender.
const SLENDER: f64 = 3.0;
/// The bends, in degrees.
const BENDS: [f64; 4] = [-90.0, -45.0, 45.0, 90.0];
/// Shares of the length between which a part bends.
const MIDDLE: (f64, f64) = (0.25, 0.75);

/// The lattice in other bends than at the key; none of a part that is not slender.
pub fn bends(mesh: &Mesh) -> Vec<Vec<Point>> {
    let (along, length) = along(mesh);
    let area = (mesh.size - 1.0).powi(2);
    if length * length < SLENDER * area {
        return Vec::new();
    }
    let mut matrix = shape::stiffness(mesh);
    (0..matrix.size()).for_each(|i| matrix.add(i, i, 1e-6));
    let Ok(factor) = matrix.factor() else { return Vec::new() };
    let bent = |degrees: f64| {
        let turn = |s: &f64| {
            Point::from_angle(degrees.to_radians() * ((s - MIDDLE.0) / (MIDDLE.1 - MIDDLE.0)).clamp(0.0, 1.0))
        };
        let turns: Vec<Point> = along.iter().map(turn).collect();
        let mut step = vec![0.0; 2 * mesh.rest.len()];
        shape::add_gradient(mesh, &mesh.rest, &turns, -1.0, &mut step);
        factor.solve_in_place(&mut step);
        mesh.rest.iter().enumerate().map(|(n, &p)| p + Point::new(step[2 * n], step[2 * n + 1])).collect()
    };
    BENDS.into_iter().map(bent).collect()
}

/// Of each cell, how far along the part it lies: 0 to 1; and the length of the part.
fn along(mesh: &Mesh) -> (Vec<f64>, f64) {
    let mut cells_of = vec![Vec::new(); mesh.rest.len()];
    for (c, cell) in mesh.cells.iter().enumerate() {
        cell.iter().for_each(|&n| cells_of[n].push(c));
    }
    let center = |c: usize| mesh.cells[c].iter().map(|&n| mesh.rest[n]).sum::<Point>() / 4.0;
    let distances = |from: usize| {
        let mut distance = vec![f64::INFINITY; mesh.cells.len()];
        let mut done = vec![false; mesh.cells.len()];
        distance[from] = 0.0;
        loop {
            let next = (0..distance.len()).filter(|&c| !done[c]).min_by(|&a, &b| distance[a].total_cmp(&distance[b]));
            let Some(c) = next.filter(|&c| distance[c].is_finite()) else { return distance };
            done[c] = true;
            for &other in mesh.cells[c].iter().flat_map(|&n| &cells_of[n]) {
                let d = distance[c] + center(c).distance(center(other));
                distance[other] = distance[other].min(d);
            }
        }
    };
    let farthest = |distance: &[f64]| {
        let finite = (0..distance.len()).filter(|&c| distance[c].is_finite());
        finite.max_by(|&a, &b| distance[a].total_cmp(&distance[b])).unwrap_or(0)
    };
    let end = farthest(&distances(0));
    let from_end = distances(end);
    let length = from_end[farthest(&from_end)].max(1e-9);
    (from_end.iter().map(|d| (d / length).min(1.0)).collect(), length)
}
