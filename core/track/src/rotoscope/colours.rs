//! The colour penalty of Liang et al. (2012): change of the colours from those at the keys.
//!
//! The paper adds to the energy "a color penalty … to bound the searching space. It can be explained by the color
//! configuration of each character in a sequence remaining unchanged", without an equation. Our interpretation: the
//! ribbon on the character's side of the contour has the same colours as at the keys, where the nearer key counts more.
//!
//! ```text
//! E_P = Σ_{0<t<T} Σ_i Σ_α [ (1 − t/T) ‖I_t(p_t(α)) − I_0(p_0(α))‖² + (t/T) ‖I_t(p_t(α)) − I_T(p_T(α))‖² ]
//! p_t(α) = c_t(s_i) + α n_t(s_i)
//! ```
//!
//! α runs over the inner side of a closed contour and over both sides of an open one. Unlike the image term this term
//! does not drift, because every frame is compared with the keys themselves. A place that is hidden on the frame or at
//! a key costs that key's share of [`HIDDEN`].

use super::appearance::{HIDDEN, colours, gradient};
use super::curve::Curve;
use super::pose::Pose;
use super::profile::Profile;
use super::views::Scenery;
use super::{Handle, Sink, Term};
use rototoon_base::geometry::{Point, polygon};
use rototoon_image::sample::read;

/// The term E_P.
pub struct Colours<'a> {
    curve: &'a Curve,
    scenery: &'a Scenery,
    level: usize,
    offsets: Vec<f64>,
    /// By key, then sample and offset: the colours there. None where they are not visible.
    keys: [Vec<Option<[f64; 3]>>; 2],
}

impl<'a> Colours<'a> {
    /// Reads the colours of the keys, which are the first and the last frame of `pose`. `width` is the width of one
    /// side of the ribbon, in pixels of the level.
    pub fn new(curve: &'a Curve, scenery: &'a Scenery, level: usize, pose: &Pose, width: usize) -> Self {
        let closed = curve.chords.len() == curve.places.len() && curve.points > 2;
        let area = pose.places.first().map_or(0.0, |places| polygon::signed_area(places));
        let inside = if area < 0.0 { -1.0 } else { 1.0 };
        let side = (1..=width).map(|alpha| inside * alpha as f64);
        let offsets = if closed { side.collect() } else { super::ribbon::offsets(width) };
        let mut term = Self { curve, scenery, level, offsets, keys: [Vec::new(), Vec::new()] };
        term.keys = [0, pose.frames() - 1].map(|key| term.at_key(key, pose));
        term
    }

    fn at_key(&self, key: usize, pose: &Pose) -> Vec<Option<[f64; 3]>> {
        let at = |i: usize| {
            let profile = Profile::new(pose.places[key][i], pose.tangents[key][i], self.level);
            self.offsets.iter().map(move |&offset| {
                let [r, g, b, _] = read(self.scenery.look(key, self.level), profile.at(offset)).map(f64::from);
                self.scenery.shows(key, profile.in_picture(offset)).then_some([r, g, b])
            })
        };
        self.samples().flat_map(at).collect()
    }

    fn samples(&self) -> impl Iterator<Item = usize> + use<> {
        (0..self.curve.places.len()).step_by(1 << self.level)
    }

    /// Number of compared places per frame.
    pub fn count(&self) -> usize {
        self.samples().count() * self.offsets.len()
    }

    fn walk_samples<S: Sink>(&self, frame: usize, pose: &Pose, sink: &mut S) {
        let share = frame as f64 / (pose.frames() - 1) as f64;
        let shares = [1.0 - share, share];
        for (row, i) in self.samples().enumerate() {
            let profile = Profile::new(pose.places[frame][i], pose.tangents[frame][i], self.level);
            sink.open(&[Handle::earlier(&self.curve.places[i]), Handle::earlier(&self.curve.tangents[i])]);
            for (k, &offset) in self.offsets.iter().enumerate() {
                let shown = self.scenery.shows(frame, profile.in_picture(offset));
                let look = colours::<S>(self.scenery.look(frame, self.level), profile.at(offset));
                for (key, share) in self.keys.iter().zip(shares) {
                    let Some(known) = key[row * self.offsets.len() + k].filter(|_| shown) else {
                        sink.constant(share * HIDDEN);
                        continue;
                    };
                    let root = share.sqrt();
                    for c in 0..3 {
                        let by: [Point; 2] = profile.by(offset, root * gradient(&look, c));
                        sink.residual(root * (f64::from(look.value[c]) - known[c]), &by);
                    }
                }
            }
            sink.close();
        }
    }
}

impl Term for Colours<'_> {
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
        for (points, closed, level) in [(8, true, 0), (6, false, 1), (2, false, 0)] {
            let (curve, x) = curve_case(points, closed);
            let term = Colours::new(&curve, &scenery, level, &pose(&curve, &x), 4);
            let worst = worst_of_pictures(&term, &curve, &x).unwrap();
            assert!(worst.error < 1e-2, "{worst:?}");
        }
    }

    #[test]
    fn the_inner_side_is_found_either_way_round() {
        let scenery = scenery();
        let (curve, mut x) = curve_case(8, true);
        let center = polygon::center(&x[..8]);
        for _ in 0..2 {
            let pose = pose(&curve, &x);
            let term = Colours::new(&curve, &scenery, 0, &pose, 2);
            for (place, tangent) in pose.places[0].iter().zip(&pose.tangents[0]) {
                let at = Profile::new(*place, *tangent, 0).at(term.offsets[0]);
                assert!(at.distance(center) < place.distance(center));
            }
            x.chunks_mut(8).for_each(<[Point]>::reverse);
        }
    }

    #[test]
    fn colours_that_stay_cost_nothing() {
        let scenery = scenery();
        let (curve, x) = curve_case(8, true);
        let frames: Vec<Point> =
            (0..4).flat_map(|f| x[..8].iter().map(move |p| *p + f as f64 * Point::new(2.0, 1.0))).collect();
        let term = Colours::new(&curve, &scenery, 0, &pose(&curve, &frames), 4);
        assert!(residuals(&term, &curve, &frames).1 < 1e-4);
        let term = Colours::new(&curve, &scenery, 0, &pose(&curve, &x), 4);
        assert!(residuals(&term, &curve, &x).1 > 1.0);
    }
}
