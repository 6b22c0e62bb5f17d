//! Refinement: moves a roughly placed contour onto the drawing by the colours around it at both keys.
//!
//! Every control point and a point between each two of them is a **sample**.
//!
//! 1. Around a sample each key gives a template of colours in the contour's own frame (tangent and normal), inside and
//!    outside the part ([`template`]).
//! 2. On a frame the templates are compared with the picture over a window around the sample. The result is a small map
//!    of costs ([`response`]).
//! 3. A step of mean shift over this map gives a target place and a weight for each axis. An edge pulls along its
//!    normal only, a corner in both directions, a flat area not at all ([`pull`]). Pulls that are wrong between the keys
//!    count less ([`noise`]).
//! 4. Links between neighbouring control points preserve the shape of the keys, rotated and scaled like their
//!    neighbourhood. They are softer where the keys themselves bend ([`links`]).
//! 5. Targets and links give a linear least-squares problem for all points of a frame ([`solve`]).
//!
//! Steps 3 to 5 are repeated for a few rounds. Then the maps are computed again over a smaller window.
//!
//! **Wide.** A limb that is drawn longer than at the keys has its tips beyond the window, and all of its points have slid along
//! it. So the same is done a second time from the same start, with a first pass over templates and a window twice as large, on
//! the picture of half the size. The result is taken if its templates, the small ones, fit clearly better.
//!
//! The method is a constrained local model (Cristinacce & Cootes 2006; regularised mean shift: Saragih, Lucey & Cohn
//! 2011). Its shape model comes from the two keys.
//!
//! Limits: it converges nearly everywhere from within about 10 px, and by the wide templates tips of limbs come back from 13 px. It cannot correct a contour at a wrong place, and it
//! may pull along a part that slides under others. So the result is kept only if the templates fit better than before
//! ([`Refiner::cost`]).

pub mod links;
pub mod noise;
pub mod pull;
pub mod response;
pub mod samples;
pub mod solve;
pub mod template;
#[cfg(test)]
mod tests;
mod view;

pub use view::{Frame, Key};

use links::Links;
use rayon::prelude::{IntoParallelIterator, ParallelIterator};
use response::Window;
use rototoon_base::geometry::Point;
use samples::Samples;
use template::Templates;

/// A window, and three rounds, each with the reach of the pull (working pixels) and the weight of the links.
type Pass = (Window, [(f64, f64); 3]);

/// The passes.
const PASSES: [Pass; 2] = [
    (Window { reach: [5, 6] }, [(6.0, 0.5), (4.0, 0.3), (3.0, 0.2)]),
    (Window { reach: [2, 3] }, [(3.0, 0.2), (2.0, 0.15), (2.0, 0.1)]),
];
/// The first pass over the wide templates. Its window counts in their steps.
const WIDE: Pass = (Window { reach: [5, 6] }, [(12.0, 0.5), (8.0, 0.3), (6.0, 0.3)]);
/// Least decrease of the templates' cost for which a refined contour is used.
const WORTH: f64 = 0.01;
/// By how much less the contour from the wide templates has to cost than the other one.
const CLEARLY: f64 = 0.01;
/// How far a point is moved along its contour to see whether it could slide, in working pixels.
const SLID: i32 = 5;
/// Upper limit of the cost of a sample.
const LOST: f64 = 0.5;

/// A part's templates and links. They are built once per span.
pub struct Refiner {
    samples: Samples,
    keys: [Vec<Point>; 2],
    templates: Templates,
    wide: Option<Templates>,
    links: Links,
    noise: Vec<noise::Variance>,
}

impl Refiner {
    /// Builds templates and links from both keys. `None` for contours of fewer than three points, which have no shape.
    pub fn new(keys: [Key; 2], closed: bool) -> Option<Self> {
        let count = keys[0].points.len();
        if count < 3 {
            return None;
        }
        let samples = Samples::new(count, closed);
        let templates = Templates::new(&keys, &samples, closed, template::FINE);
        let wide = Some(Templates::new(&keys, &samples, closed, template::COARSE));
        let noise = noise::measured(&keys, &samples, &templates);
        let points = keys.map(|key| key.points.to_vec());
        let links = Links::new(&points, closed);
        Some(Self { samples, keys: points, templates, wide, links, noise })
    }

    /// Forgets the difference between part and background, for measurements without it: offsets outside have the same
    /// cost function as offsets inside.
    pub fn forget_figure(&mut self) {
        self.templates.forget_figure();
        self.wide.iter_mut().for_each(Templates::forget_figure);
    }

    /// Forgets the wide templates, for measurements without them.
    pub fn forget_wide(&mut self) {
        self.wide = None;
    }

    /// Takes every pull for right, for measurements without the noise of the pulls.
    pub fn forget_noise(&mut self) {
        self.noise.fill([0.0; 2]);
    }

    /// Refined control points, or the rough ones if refinement does not lower the cost enough. All places are in
    /// working pixels.
    pub fn improved(&self, frame: &Frame, rough: Vec<Point>) -> Vec<Point> {
        let (fine, before) = self.refine(frame, &rough, &PASSES, &self.templates);
        let cost = self.cost(frame, &fine);
        if let Some(wide) = &self.wide {
            let (nearer, _) = self.refine(frame, &rough, &[WIDE], wide);
            let (far, _) = self.refine(frame, &nearer, &PASSES, &self.templates);
            if self.cost(frame, &far) < cost.min(before) - CLEARLY {
                return far;
            }
        }
        if cost < before - WORTH { fine } else { rough }
    }

    /// Control points that are near already, refined over the small window, or as they are if that does not lower the cost.
    pub fn polished(&self, frame: &Frame, near: Vec<Point>) -> Vec<Point> {
        let (fine, before) = self.refine(frame, &near, &PASSES[1..], &self.templates);
        if self.cost(frame, &fine) < before { fine } else { near }
    }

    /// Refined control points from rough ones, and the cost of the rough ones by these templates, as in [`Refiner::cost`].
    fn refine(&self, frame: &Frame, start: &[Point], passes: &[Pass], templates: &Templates) -> (Vec<Point>, f64) {
        let mut before = None;
        let mut points = start.to_vec();
        for (window, rounds) in passes {
            let (places, angles) = self.samples.frames(&points);
            let maps: Vec<response::Map> = (0..places.len())
                .into_par_iter()
                .map(|s| response::map(frame, window, (places[s], angles[s]), (templates.of(s), templates.grain)))
                .collect();
            before.get_or_insert_with(|| mean_cost(&maps));
            for &(reach, weight) in rounds {
                let now = self.samples.places(&points);
                let pull = |s: usize| {
                    let trust = self.samples.trust(s);
                    pull::pull(&maps[s], (places[s], angles[s]), now[s], (reach, trust), self.noise[s])
                };
                let pulls: Vec<pull::Pull> = (0..places.len()).map(pull).collect();
                let edges = self.links.wanted(&self.keys, &points, frame.share);
                let solved = solve::solve(&self.samples, &pulls, &self.links, &edges, weight, &points, &frame.pins);
                let Some(solved) = solved else { return (points, before.unwrap_or(LOST)) };
                points = solved;
            }
        }
        (points, before.unwrap_or(LOST))
    }

    /// The templates' cost at each control point.
    pub fn costs(&self, frame: &Frame, points: &[Point]) -> Vec<f64> {
        let here = |map: &response::Map| f64::from(map.costs[map.costs.len() / 2]);
        self.at_points(frame, points, &Window { reach: [0, 0] }, here)
    }

    /// By how much the templates' cost of each control point is larger [`SLID`] px away along the contour.
    pub fn slides(&self, frame: &Frame, points: &[Point]) -> Vec<f64> {
        let slide = |map: &response::Map| {
            let row = map.costs.len() / (2 * SLID as usize + 1);
            let ends = map.costs[..row].iter().chain(&map.costs[map.costs.len() - row..]);
            f64::from(ends.copied().fold(f32::INFINITY, f32::min) - map.costs[map.costs.len() / 2])
        };
        self.at_points(frame, points, &Window { reach: [SLID, 2] }, slide)
    }

    /// A number from the map of each control point.
    fn at_points(
        &self,
        frame: &Frame,
        points: &[Point],
        window: &Window,
        of_map: impl Fn(&response::Map) -> f64 + Sync,
    ) -> Vec<f64> {
        let (places, angles) = self.samples.frames(points);
        let control: Vec<usize> = (0..places.len()).filter(|&s| self.samples.terms(s).len() == 1).collect();
        let templates = |s: usize| (self.templates.of(s), self.templates.grain);
        let of_sample = |s: usize| of_map(&response::map(frame, window, (places[s], angles[s]), templates(s)));
        control.into_par_iter().map(of_sample).collect()
    }

    /// How badly the templates fit at control points: the mean of the samples' costs, weighted by how much of each
    /// sample the keys show.
    pub fn cost(&self, frame: &Frame, points: &[Point]) -> f64 {
        let window = Window { reach: [0, 0] };
        let (places, angles) = self.samples.frames(points);
        let maps: Vec<response::Map> = (0..places.len())
            .into_par_iter()
            .map(|s| {
                response::map(frame, &window, (places[s], angles[s]), (self.templates.of(s), self.templates.grain))
            })
            .collect();
        mean_cost(&maps)
    }
}

/// Mean of the samples' costs in the middle of their maps, weighted by how much of each sample the keys show.
fn mean_cost(maps: &[response::Map]) -> f64 {
    let (mut sum, mut weights) = (0.0, 1e-6);
    for map in maps {
        sum += map.shown * f64::from(map.costs[map.costs.len() / 2]).min(LOST);
        weights += map.shown;
    }
    sum / weights
}
