//! Change of the colours along the normals from frame to frame (Agarwala et al. 2004):
//!
//! ```text
//! E_I = Σ_t Σ_i Σ_k ‖ I_t(c_t(s_i) + k n_t(s_i)) − I_{t+1}(c_{t+1}(s_i) + k n_{t+1}(s_i)) ‖²
//! ```
//!
//! The offsets k are in a small window, here −4 to 4 pixels of the level as in the authors' system. There are three
//! colour channels. On level l every 2ˡ-th sample is used, so that the distance of the samples is the same in pixels of
//! the level. A place that is hidden by a nearer part or outside the picture on either frame costs a constant instead:
//! it neither attracts nor repels.
//!
//! The derivative is that of the bilinear picture and of the normal. (The authors' system reads gradients smoothed by
//! σ = 1 and keeps the normal's length fixed. With the exact derivative the decrease that the trust region's model
//! predicts agrees with the real one.)
//!
//! Because the constant has no slope, a step that would move many samples behind a nearer part is rejected as a whole
//! and not bent. The curve converges early there.
//!
//! Limits: neighbouring frames are compared, never a frame with a key, so a curve that has slipped off stays off. Both
//! sides of the contour count, although the background does not move with the part.

use super::curve::Curve;
use super::pose::Pose;
use super::profile::Profile;
use super::views::{Look, Scenery};
use super::{Handle, Sink, Term};
use rototoon_base::geometry::Point;
use rototoon_base::scene::Raster;
use rototoon_image::sample::{Slope, read, read_slope};

/// Cost of a place that cannot be compared, in squared 8-bit levels: the constant of the authors' system.
pub const HIDDEN: f64 = 5000.0;

/// The window of Agarwala et al. 2004, in pixels of the level.
pub const WINDOW: [f64; 9] = [-4.0, -3.0, -2.0, -1.0, 0.0, 1.0, 2.0, 3.0, 4.0];

/// The term E_I.
#[derive(Clone, Copy)]
pub struct Appearance<'a> {
    /// The curve with its samples.
    pub curve: &'a Curve,
    /// The pictures of all frames.
    pub scenery: &'a Scenery,
    /// Level of the pyramid.
    pub level: usize,
    /// Offsets along the normal, in pixels of the level.
    pub offsets: &'a [f64],
}

impl Appearance<'_> {
    /// Number of compared places per step from frame to frame.
    pub fn count(&self) -> usize {
        self.curve.places.len().div_ceil(1 << self.level) * self.offsets.len()
    }

    fn colours<S: Sink>(&self, frame: usize, p: Point) -> Slope<Look> {
        colours::<S>(self.scenery.look(frame, self.level), p)
    }
}

/// The view's values at a place, with slopes if the sink needs them.
pub(super) fn colours<S: Sink>(picture: &Raster<Look>, p: Point) -> Slope<Look> {
    if S::SLOPES { read_slope(picture, p) } else { Slope { value: read(picture, p), dx: [0.0; 4], dy: [0.0; 4] } }
}

/// The gradient of a channel.
pub(super) fn gradient(slope: &Slope<Look>, channel: usize) -> Point {
    Point::new(f64::from(slope.dx[channel]), f64::from(slope.dy[channel]))
}

impl Term for Appearance<'_> {
    fn walk(&self, frame: usize, pose: &Pose, sink: &mut impl Sink) {
        walk_samples(self, frame, pose, sink);
    }
}

fn walk_samples<S: Sink>(term: &Appearance<'_>, frame: usize, pose: &Pose, sink: &mut S) {
    for i in (0..term.curve.places.len()).step_by(1 << term.level) {
        let (place, tangent) = (&term.curve.places[i], &term.curve.tangents[i]);
        let [now, next] = [frame, frame + 1].map(|f| Profile::new(pose.places[f][i], pose.tangents[f][i], term.level));
        let handles = [Handle::earlier(place), Handle::earlier(tangent), Handle::later(place), Handle::later(tangent)];
        sink.open(&handles);
        for &offset in term.offsets {
            let shown = term.scenery.shows(frame, now.in_picture(offset))
                && term.scenery.shows(frame + 1, next.in_picture(offset));
            if !shown {
                sink.constant(HIDDEN);
                continue;
            }
            let a = term.colours::<S>(frame, now.at(offset));
            let b = term.colours::<S>(frame + 1, next.at(offset));
            for c in 0..3 {
                let [by_place, by_tangent] = now.by(offset, gradient(&a, c));
                let [by_next, by_next_tangent] = next.by(offset, gradient(&b, c));
                let value = f64::from(a.value[c]) - f64::from(b.value[c]);
                sink.residual(value, &[by_place, by_tangent, -by_next, -by_next_tangent]);
            }
        }
        sink.close();
    }
}

#[cfg(test)]
mod tests {
    use super::super::tests::{curve_case, residuals, scenery, scenery_with, worst_of_pictures};
    use super::*;

    #[test]
    fn the_jacobian_is_right() {
        let scenery = scenery();
        for (points, closed, level) in [(8, true, 0), (6, false, 1), (3, true, 0), (2, false, 0), (8, true, 2)] {
            let (curve, x) = curve_case(points, closed);
            let term = Appearance { curve: &curve, scenery: &scenery, level, offsets: &WINDOW };
            let worst = worst_of_pictures(&term, &curve, &x).unwrap();
            assert!(worst.error < 1e-2, "level {level}: {worst:?}");
        }
    }

    #[test]
    fn hidden_places_cost_a_constant_and_pull_nowhere() {
        let all = [(0.0, 0.0), (128.0, 0.0), (128.0, 128.0), (0.0, 128.0)].map(|(x, y)| Point::new(x, y)).to_vec();
        let (curve, x) = curve_case(8, true);
        // Frame 2 is hidden, so two of the three steps, to it and from it, cannot be compared.
        let scenery = scenery_with(&[vec![], vec![], vec![all], vec![]]);
        let term = Appearance { curve: &curve, scenery: &scenery, level: 0, offsets: &WINDOW };
        let (rows, cost) = residuals(&term, &curve, &x);
        assert_eq!(rows, 3 * term.count());
        let constants = 2.0 * term.count() as f64 * HIDDEN;
        assert!(cost > constants && cost < 1.01 * constants);
    }

    #[test]
    fn pictures_that_move_with_the_curve_cost_nothing() {
        let scenery = scenery();
        let (curve, x) = curve_case(8, true);
        let term = Appearance { curve: &curve, scenery: &scenery, level: 0, offsets: &WINDOW };
        // The pictures are planes that shift by (2, 1) per frame.
        let moved: Vec<Point> = x[..8].iter().map(|p| *p + Point::new(2.0, 1.0)).collect();
        assert!(residuals(&term, &curve, &[&x[..8], &moved].concat()).1 < 1e-4);
        assert!(residuals(&term, &curve, &[&x[..8], &x[..8]].concat()).1 > 10.0);
        assert_eq!(term.count(), 9 * curve.places.len());
    }
}
