//! Edges where both keys have edges (Agarwala et al. 2004):
//!
//! ```text
//! E_G = Σ_{0<t<T} Σ_i ( G_t(c_t(s_i)) / M(s_i) )²,   M(s_i) = max(G_0(c_0(s_i)), G_T(c_T(s_i)))
//! ```
//!
//! G is the [edge measure](super::views), which is small on edges. M is that of the key with the weaker edge. A sample
//! that is on edges at both keys should be on edges between them. If a key has no edge at the sample, M is large and
//! the term has little effect. M is at least [`FLOOR`], so a residual is at most 2. A hidden sample costs the
//! constant 2. A sample that is hidden at a key has no term. Both rules are those of the authors' system.
//!
//! Limit: every edge is accepted, whatever its direction and colours.

use super::appearance::{colours, gradient};
use super::curve::Curve;
use super::pose::Pose;
use super::profile::Profile;
use super::views::{STRONGEST, Scenery};
use super::{Handle, Sink, Term};
use rototoon_base::geometry::Point;
use rototoon_image::sample::read;

/// Least M, half of the largest G. Without it M could be 0, because on ink both keys may have G = 0.
pub const FLOOR: f64 = 0.5 * STRONGEST as f64;
/// Cost of a hidden sample.
const HIDDEN: f64 = 2.0;

/// The term E_G.
pub struct Edge<'a> {
    curve: &'a Curve,
    scenery: &'a Scenery,
    level: usize,
    /// M by sample used on the level. None where the sample is not visible at a key.
    weakest: Vec<Option<f64>>,
}

impl<'a> Edge<'a> {
    /// Reads the edge measures at the keys, which are the first and the last frame of `pose`.
    pub fn new(curve: &'a Curve, scenery: &'a Scenery, level: usize, pose: &Pose) -> Self {
        let keys = [0, pose.frames() - 1];
        let measure = |key: usize, i: usize| {
            let place = pose.places[key][i];
            let at = Profile::new(place, Point::ZERO, level).at(0.0);
            scenery.shows(key, place).then(|| f64::from(read(scenery.look(key, level), at)[3]))
        };
        let weakest = (0..curve.places.len()).step_by(1 << level).map(|i| {
            let [a, b] = keys.map(|key| measure(key, i));
            Some(a?.max(b?).max(FLOOR))
        });
        Self { weakest: weakest.collect(), curve, scenery, level }
    }

    /// Number of samples per frame.
    pub fn count(&self) -> usize {
        self.weakest.iter().flatten().count()
    }

    fn walk_samples<S: Sink>(&self, frame: usize, pose: &Pose, sink: &mut S) {
        for (row, weakest) in self.weakest.iter().enumerate() {
            let Some(weakest) = *weakest else { continue };
            let i = row << self.level;
            let place = pose.places[frame][i];
            if !self.scenery.shows(frame, place) {
                sink.constant(HIDDEN);
                continue;
            }
            let profile = Profile::new(place, Point::ZERO, self.level);
            let look = colours::<S>(self.scenery.look(frame, self.level), profile.at(0.0));
            let [by, _] = profile.by(0.0, gradient(&look, 3) / weakest);
            sink.open(&[Handle::earlier(&self.curve.places[i])]);
            sink.residual(f64::from(look.value[3]) / weakest, &[by]);
            sink.close();
        }
    }
}

impl Term for Edge<'_> {
    fn walk(&self, frame: usize, pose: &Pose, sink: &mut impl Sink) {
        if frame > 0 {
            self.walk_samples(frame, pose, sink);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::tests::{curve_case, pose, residuals, scenery, worst_of_pictures};
    use super::*;

    #[test]
    fn the_jacobian_is_right() {
        let scenery = scenery();
        for (points, closed, level) in [(8, true, 0), (6, false, 1), (2, false, 0), (1, false, 0)] {
            let (curve, x) = curve_case(points, closed);
            let term = Edge::new(&curve, &scenery, level, &pose(&curve, &x));
            let worst = worst_of_pictures(&term, &curve, &x).unwrap();
            assert!(worst.error < 1e-4, "{worst:?}");
        }
    }

    #[test]
    fn keys_pay_nothing_and_the_least_measure_is_bounded() {
        let scenery = scenery();
        let (curve, x) = curve_case(8, true);
        let term = Edge::new(&curve, &scenery, 0, &pose(&curve, &x));
        assert_eq!(residuals(&term, &curve, &x).0, 2 * term.count());
        assert!(term.weakest.iter().flatten().all(|m| (FLOOR..=70.0).contains(m)));
        assert!(term.count() > 0);
    }
}
