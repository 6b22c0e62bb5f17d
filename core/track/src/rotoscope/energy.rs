//! The terms of one level joined into the energy, as an objective for [`trust_region`](rototoon_base::numeric::trust_region).
//!
//! The variables are the coordinates of all control points on all frames, in working pixels. Keys, pins and corrected
//! centres are kept by projection.

use super::appearance::Appearance;
use super::blocks::{Blocks, Cost, Link};
use super::colours::Colours;
use super::curvature::Curvature;
use super::curve::Curve;
use super::edge::Edge;
use super::length::Length;
use super::pose::Pose;
use super::velocity::Velocity;
use super::views::Scenery;
use super::{Sink, weighted};
use rayon::prelude::{IntoParallelIterator, ParallelIterator};
use rototoon_base::geometry::Point;
use rototoon_base::numeric::trust_region::Objective;

/// Weights of the terms. 0 switches a term off.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Weights {
    /// w_L, of the length term.
    pub length: f64,
    /// w_C, of the curvature term.
    pub curvature: f64,
    /// w_V, of the velocity term.
    pub velocity: f64,
    /// w_I, of the image term.
    pub image: f64,
    /// w_G, of the edge term.
    pub edge: f64,
    /// w_P, of the colour penalty.
    pub colours: f64,
}

impl Default for Weights {
    /// The weights of the authors' system, without a colour penalty.
    fn default() -> Self {
        Self { length: 500.0, curvature: 40_000.0, velocity: 0.1, image: 1.0, edge: 2000.0, colours: 0.0 }
    }
}

/// The differences between the two presets.
#[derive(Clone, Debug, PartialEq)]
pub struct Method {
    /// Weights of the terms.
    pub weights: Weights,
    /// Offsets along the normals that the image term compares, in pixels of the level.
    pub offsets: Vec<f64>,
    /// Width of one side of the colour penalty's ribbon, in pixels of the level.
    pub ribbon: usize,
}

/// The constraints of the curves.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Fixed {
    /// By frame and point: whether it is fixed (a key or pin).
    pub points: Vec<Vec<bool>>,
    /// By frame: whether the centre is fixed, that is, the sum of the points.
    pub centers: Vec<bool>,
}

/// The energy on one level of the pyramid.
pub struct Energy<'a> {
    curve: &'a Curve,
    fixed: &'a Fixed,
    weights: Weights,
    length: Length<'a>,
    curvature: Curvature<'a>,
    velocity: Velocity<'a>,
    appearance: Appearance<'a>,
    edge: Edge<'a>,
    colours: Colours<'a>,
    blocks: Blocks,
}

impl<'a> Energy<'a> {
    /// The energy of curves on a level. `start` are the control points by frame in working pixels; the first and the
    /// last frame are the keys.
    pub fn new(
        method: &'a Method,
        curve: &'a Curve,
        scenery: &'a Scenery,
        level: usize,
        fixed: &'a Fixed,
        start: &[Vec<Point>],
    ) -> Self {
        let pose = Pose::new(curve, start.iter().map(Vec::as_slice));
        Self {
            weights: method.weights,
            length: Length(curve),
            curvature: Curvature(curve),
            velocity: Velocity(curve),
            appearance: Appearance { curve, scenery, level, offsets: &method.offsets },
            edge: Edge::new(curve, scenery, level, &pose),
            colours: Colours::new(curve, scenery, level, &pose, method.ribbon),
            blocks: Blocks::new(start.len(), curve.points),
            curve,
            fixed,
        }
    }

    fn pose(&self, x: &[f64]) -> Pose {
        let points: Vec<Point> = x.chunks_exact(2).map(|p| Point::new(p[0], p[1])).collect();
        Pose::new(self.curve, points.chunks(self.curve.points))
    }

    fn walk(&self, frame: usize, pose: &Pose, sink: &mut impl Sink) {
        let steps = (pose.frames() - 1) as f64;
        let mean = |weight: f64, count: usize| weight / count.max(1) as f64;
        // The factor F cancels the mean over the F steps. The edge term has no factor F.
        weighted(&self.length, mean(self.weights.length, self.curve.chords.len()), frame, pose, sink);
        weighted(&self.curvature, mean(self.weights.curvature, self.curve.seconds.len()), frame, pose, sink);
        weighted(&self.velocity, mean(self.weights.velocity, self.curve.places.len()), frame, pose, sink);
        weighted(&self.appearance, mean(self.weights.image, self.appearance.count()), frame, pose, sink);
        weighted(&self.colours, mean(self.weights.colours, self.colours.count()), frame, pose, sink);
        let edges = mean(self.weights.edge, self.edge.count()) / (steps - 1.0).max(1.0);
        weighted(&self.edge, edges, frame, pose, sink);
    }
}

impl Objective for Energy<'_> {
    fn cost(&self, x: &[f64]) -> f64 {
        let pose = self.pose(x);
        let cost = |t: usize| {
            let mut cost = Cost::default();
            self.walk(t, &pose, &mut cost);
            cost.0
        };
        let costs: Vec<f64> = (0..pose.frames() - 1).into_par_iter().map(cost).collect();
        costs.iter().sum()
    }

    fn linearise(&mut self, x: &[f64]) -> f64 {
        let pose = self.pose(x);
        let link = |t: usize| {
            let mut link = Link::new(self.curve.points);
            self.walk(t, &pose, &mut link);
            link
        };
        let links = (0..pose.frames() - 1).into_par_iter().map(link).collect();
        self.blocks.assemble(links)
    }

    fn gradient(&self) -> &[f64] {
        self.blocks.gradient()
    }

    fn multiply(&self, v: &[f64], product: &mut [f64]) {
        self.blocks.multiply(v, product);
    }

    fn precondition(&self, v: &mut [f64]) {
        self.blocks.precondition(v);
    }

    fn project(&self, v: &mut [f64]) {
        let frames = v.chunks_exact_mut(2 * self.curve.points).zip(&self.fixed.points);
        for ((v, fixed), &center) in frames.zip(&self.fixed.centers) {
            let mut sum = (Point::ZERO, 0usize);
            for (p, fixed) in v.chunks_exact_mut(2).zip(fixed) {
                if *fixed {
                    p.fill(0.0);
                } else {
                    sum = (sum.0 + Point::new(p[0], p[1]), sum.1 + 1);
                }
            }
            if !center || sum.1 == 0 {
                continue;
            }
            let mean = sum.0 / sum.1 as f64;
            for (p, _) in v.chunks_exact_mut(2).zip(fixed).filter(|(_, fixed)| !**fixed) {
                p[0] -= mean.x;
                p[1] -= mean.y;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::ribbon;
    use super::super::tests::{curve_case, scenery};
    use super::*;

    fn method(colours: f64) -> Method {
        let weights = Weights { colours, ..Weights::default() };
        Method { weights, offsets: ribbon::offsets(4), ribbon: 4 }
    }

    #[test]
    fn the_gradient_is_that_of_the_cost() {
        let scenery = scenery();
        for (points, closed, level) in [(8, true, 0), (12, true, 1), (6, false, 0)] {
            let (curve, x) = curve_case(points, closed);
            let start: Vec<Vec<Point>> = x.chunks(points).map(<[Point]>::to_vec).collect();
            let (method, fixed) = (method(0.7), Fixed::default());
            let mut energy = Energy::new(&method, &curve, &scenery, level, &fixed, &start);
            let mut x: Vec<f64> = x.iter().flat_map(|p| [p.x, p.y]).collect();
            let cost = energy.linearise(&x);
            assert!((cost - energy.cost(&x)).abs() < 1e-6 * cost);
            let gradient = energy.gradient().to_vec();
            let size = gradient.iter().fold(0.0f64, |most, g| most.max(g.abs()));
            for k in (0..x.len()).step_by(3) {
                let (here, h) = (x[k], 2e-3);
                x[k] = here + h;
                let after = energy.cost(&x);
                x[k] = here - h;
                let before = energy.cost(&x);
                x[k] = here;
                let numeric = (after - before) / (4.0 * h);
                assert!((numeric - gradient[k]).abs() < 1e-3 * size, "{k}: {numeric} for {}", gradient[k]);
            }
        }
    }

    #[test]
    fn the_projection_keeps_fixed_points_and_centres() {
        let scenery = scenery();
        let (curve, x) = curve_case(3, true);
        let start: Vec<Vec<Point>> = x.chunks(3).map(<[Point]>::to_vec).collect();
        let free = vec![false; 3];
        let fixed = Fixed {
            points: vec![vec![true; 3], vec![false, true, false], free, vec![true; 3]],
            centers: vec![false, true, false, true],
        };
        let method = method(0.0);
        let energy = Energy::new(&method, &curve, &scenery, 0, &fixed, &start);
        let mut v: Vec<f64> = (0..24).map(f64::from).collect();
        energy.project(&mut v);
        assert_eq!(v[..6], [0.0; 6]);
        assert_eq!(v[6..12], [-2.0, -2.0, 0.0, 0.0, 2.0, 2.0]);
        assert_eq!((v[12], v[17], &v[18..]), (12.0, 17.0, &[0.0; 6][..]));
    }
}
