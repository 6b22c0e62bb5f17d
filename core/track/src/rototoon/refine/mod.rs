//! Roughly placed contours brought onto the drawing by the colours around them at both keys.
//!
//! Every control point, and a point between each two, is a **sample**. Around it each key gives a template of colours in
//! the contour's own frame (tangent and normal), inside and outside ([`template`]). On a frame the templates are tried
//! over a window around the sample ([`response`]): what comes back is a little map of costs, from which a step of mean
//! shift takes the place that it speaks for and how surely, along either axis: an edge pulls along its normal only, a
//! corner both ways, a flat area not at all ([`pull`]). Links between neighbouring control points hold the shape of the
//! keys, each turned and scaled as its neighbourhood is, softer where the keys themselves bend ([`links`]); both make a
//! linear least squares for all points of a frame ([`solve`]). A few rounds of that, then windows and colours anew.
//!
//! It is a constrained local model (Cristinacce & Cootes 2006; regularised mean shift: Saragih, Lucey & Cohn 2011) whose
//! shape model is what two keys say. From within about 10 px it converges nearly everywhere; a contour in a wrong place
//! it cannot mend, and a part that slides under others it may drag along. So the result is kept only where the templates
//! fit better than they did before: [`Refiner::cost`].

pub mod links;
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

/// The windows of the passes, and for each its rounds: reach of the pull (working pixels) and weight of the links.
const PASSES: [(Window, [(f64, f64); 3]); 2] = [
    (Window { reach: [5, 6] }, [(6.0, 0.5), (4.0, 0.3), (3.0, 0.2)]),
    (Window { reach: [2, 3] }, [(3.0, 0.2), (2.0, 0.15), (2.0, 0.1)]),
];
/// Fall of the templates' cost that makes a refined contour worth taking.
const WORTH: f64 = 0.01;
/// A cost counts at most this much: a sample cannot be worse than lost.
const LOST: f64 = 0.5;

/// A part's templates and links. Made once a span.
pub struct Refiner {
    samples: Samples,
    keys: [Vec<Point>; 2],
    templates: Templates,
    links: Links,
}

impl Refiner {
    /// From both keys; `None` for contours of fewer than three points, which have no shape.
    pub fn new(keys: [Key; 2], closed: bool) -> Option<Self> {
        let count = keys[0].points.len();
        if count < 3 {
            return None;
        }
        let samples = Samples::new(count, closed);
        let templates = Templates::new(&keys, &samples, closed);
        let points = keys.map(|key| key.points.to_vec());
        let links = Links::new(&points, closed);
        Some(Self { samples, keys: points, templates, links })
    }

    /// Forgets what tells the part from its ground: every wrong colour is just wrong.
    pub fn forget_figure(&mut self) {
        self.templates.forget_figure();
    }

    /// Refined control points, or the rough ones where the templates fit those no worse.
    pub fn improved(&self, frame: &Frame, rough: Vec<Point>) -> Vec<Point> {
        let (fine, before) = self.refine(frame, &rough);
        if self.cost(frame, &fine) < before - WORTH { fine } else { rough }
    }

    /// Refined control points, from rough ones, and how badly the templates fit at those, as [`Refiner::cost`] says it.
    fn refine(&self, frame: &Frame, start: &[Point]) -> (Vec<Point>, f64) {
        let mut before = None;
        let mut points = start.to_vec();
        for (window, rounds) in &PASSES {
            let (places, angles) = self.samples.frames(&points);
            let maps: Vec<response::Map> = (0..places.len())
                .into_par_iter()
                .map(|s| response::map(frame, window, (places[s], angles[s]), self.templates.of(s)))
                .collect();
            before.get_or_insert_with(|| mean_cost(&maps));
            for &(reach, weight) in rounds {
                let now = self.samples.places(&points);
                let pulls: Vec<pull::Pull> = (0..places.len())
                    .map(|s| pull::pull(&maps[s], (places[s], angles[s]), now[s], reach, self.samples.trust(s)))
                    .collect();
                let edges = self.links.wanted(&self.keys, &points, frame.share);
                let solved = solve::solve(&self.samples, &pulls, &self.links, &edges, weight, &points, &frame.pins);
                let Some(solved) = solved else { return (points, before.unwrap_or(LOST)) };
                points = solved;
            }
        }
        (points, before.unwrap_or(LOST))
    }

    /// How badly the templates fit at control points: mean of each sample's cost, by how much of it a key shows.
    pub fn cost(&self, frame: &Frame, points: &[Point]) -> f64 {
        let window = Window { reach: [0, 0] };
        let (places, angles) = self.samples.frames(points);
        let maps: Vec<response::Map> = (0..places.len())
            .into_par_iter()
            .map(|s| response::map(frame, &window, (places[s], angles[s]), self.templates.of(s)))
            .collect();
        mean_cost(&maps)
    }
}

/// Mean of the samples' costs where they are, by how much of each a key shows.
fn mean_cost(maps: &[response::Map]) -> f64 {
    let (mut sum, mut weights) = (0.0, 1e-6);
    for map in maps {
        sum += map.shown * f64::from(map.costs[map.costs.len() / 2]).min(LOST);
        weights += map.shown;
    }
    sum / weights
}
