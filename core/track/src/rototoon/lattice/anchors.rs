//! Anchors: the artist's corrections as linear constraints on a lattice's nodes.
//!
//! A pin fixes a control point, which is a weighted sum of the four nodes of a cell. A corrected centre fixes the mean
//! of all control points, which is a weighted sum of many nodes.

use super::mesh::Mesh;
use super::unknowns::Unknowns;
use crate::contract::job::Correction;
use rototoon_base::geometry::{Point, similarity::Similarity};

/// One constraint: a weighted sum of nodes is at a place.
#[derive(Clone, Debug)]
struct Anchor {
    terms: Vec<(usize, f64)>,
    place: Point,
}

impl Anchor {
    fn missing(&self, nodes: &[Point]) -> Point {
        self.place - self.terms.iter().map(|&(n, w)| nodes[n] * w).sum::<Point>()
    }
}

/// The constraints of one frame. Places are in working pixels.
#[derive(Clone, Debug, Default)]
pub struct Anchors {
    anchors: Vec<Anchor>,
}

impl Anchors {
    /// The constraints of a correction. `scale` is the number of picture pixels per working pixel.
    pub fn new(mesh: &Mesh, correction: &Correction, scale: f64) -> Self {
        let pin = |(&j, &p): (&usize, &Point)| {
            let binding = mesh.control[j];
            Anchor { terms: binding.nodes.into_iter().zip(binding.weights).collect(), place: p / scale }
        };
        let mut anchors: Vec<Anchor> = correction.pins.iter().map(pin).collect();
        if let Some(center) = correction.center {
            let mut weights = vec![0.0; mesh.rest.len()];
            for binding in &mesh.control {
                for (n, w) in binding.nodes.into_iter().zip(binding.weights) {
                    weights[n] += w / mesh.control.len() as f64;
                }
            }
            let terms = weights.into_iter().enumerate().filter(|(_, w)| *w != 0.0).collect();
            anchors.push(Anchor { terms, place: center / scale });
        }
        Self { anchors }
    }

    /// Whether nothing is fixed.
    pub fn is_empty(&self) -> bool {
        self.anchors.is_empty()
    }

    /// The same constraints, with their places moved back to the share `share` of the way from the present nodes.
    pub fn toward(&self, nodes: &[Point], share: f64) -> Self {
        let nearer = |a: &Anchor| Anchor { terms: a.terms.clone(), place: a.place - a.missing(nodes) * (1.0 - share) };
        Self { anchors: self.anchors.iter().map(nearer).collect() }
    }

    /// The constraints on the shifts of an alignment's unknowns, if the nodes are at `nodes`.
    pub fn of_shifts(&self, nodes: &[Point], unknowns: &Unknowns) -> Self {
        let of_shifts = |a: &Anchor| Anchor { terms: unknowns.terms(&a.terms), place: a.missing(nodes) };
        Self { anchors: self.anchors.iter().map(of_shifts).collect() }
    }

    /// A pose rotated by `angle` radians about the mean of its anchored places.
    pub fn turned(&self, nodes: &[Point], angle: f64) -> Vec<Point> {
        let from: Point = self.anchors.iter().map(|a| a.place - a.missing(nodes)).sum();
        let center = from / self.anchors.len().max(1) as f64;
        let turn = Point::from_angle(angle);
        nodes.iter().map(|&p| turn.rotate(p - center) + center).collect()
    }

    /// Moves a pose rigidly towards its anchors: one anchor shifts it, several shift and rotate it.
    pub fn approach(&self, nodes: &[Point]) -> Vec<Point> {
        let from: Vec<Point> = self.anchors.iter().map(|a| a.place - a.missing(nodes)).collect();
        let to: Vec<Point> = self.anchors.iter().map(|a| a.place).collect();
        let mut motion = Similarity::fit(&from, &to);
        motion.factor = motion.factor.normalize_or(Point::X);
        nodes.iter().map(|&p| motion.apply(p)).collect()
    }

    /// The rows of the constraints, one per anchor and axis: node coordinates and their weights.
    pub fn rows(&self) -> impl Iterator<Item = impl Iterator<Item = (usize, f64)> + Clone + '_> + Clone + '_ {
        self.anchors.iter().flat_map(|a| [0, 1].map(|axis| a.terms.iter().map(move |&(n, w)| (2 * n + axis, w))))
    }

    /// The residual of each of the [`Anchors::rows`].
    pub fn missing(&self, nodes: &[Point]) -> impl Iterator<Item = f64> {
        self.anchors.iter().flat_map(|a| a.missing(nodes).to_array())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rototoon::lattice::align;
    use std::collections::BTreeMap;

    #[test]
    fn a_lattice_without_texture_follows_its_anchors_rigidly() {
        let bar: Vec<Point> =
            [(0.0, 0.0), (90.0, 0.0), (90.0, 20.0), (0.0, 20.0)].map(|(x, y)| Point::new(x, y)).to_vec();
        let mesh = Mesh::new(&bar, true);
        let pins = BTreeMap::from([(0, Point::new(50.0, 0.0)), (1, Point::new(50.0, 90.0))]);
        let anchors = Anchors::new(&mesh, &Correction { pins, center: None }, 1.0);
        let found = mesh.control_points(&align::settle(&mesh, &mesh.rest, &anchors));
        for (p, want) in found.iter().zip([(50.0, 0.0), (50.0, 90.0), (30.0, 90.0), (30.0, 0.0)]) {
            assert!(p.distance(Point::new(want.0, want.1)) < 0.1, "{p}");
        }
    }

    #[test]
    fn held_nodes_stay_while_the_others_move_to_the_anchor() {
        let bar: Vec<Point> =
            [(0.0, 0.0), (160.0, 0.0), (160.0, 20.0), (0.0, 20.0)].map(|(x, y)| Point::new(x, y)).to_vec();
        let mesh = Mesh::new(&bar, true);
        let hold: Vec<f64> = mesh.rest.iter().map(|q| if q.x < 80.0 { 0.3 } else { 0.0 }).collect();
        let pins = BTreeMap::from([(1, Point::new(130.0, 70.0))]);
        let anchors = Anchors::new(&mesh, &Correction { pins, center: None }, 1.0);
        let found = mesh.control_points(&align::draw(&mesh, &mesh.rest, &anchors, &hold));
        assert!(found[0].distance(bar[0]) < 3.0 && found[3].distance(bar[3]) < 3.0, "{found:?}");
        assert!(found[1].distance(Point::new(130.0, 70.0)) < 0.1, "{found:?}");
        let end = found[1].distance(found[2]);
        assert!((end - 20.0).abs() < 8.0, "the end keeps its width, nearly: {end}");
    }

    #[test]
    fn a_corrected_center_shifts_the_part() {
        let square: Vec<Point> = [(0.0, 0.0), (30.0, 0.0), (30.0, 30.0)].map(|(x, y)| Point::new(x, y)).to_vec();
        let mesh = Mesh::new(&square, true);
        let correction = Correction { pins: BTreeMap::new(), center: Some(Point::new(220.0, 110.0)) };
        let anchors = Anchors::new(&mesh, &correction, 1.0);
        let found = mesh.control_points(&align::settle(&mesh, &mesh.rest, &anchors));
        assert!(found[0].distance(Point::new(200.0, 100.0)) < 0.1, "{found:?}");
    }
}
