//! Evidence about the place of each control point between two keys. [`confidence`](super::confidence) makes a
//! probability of it.
//!
//! | measurement | what it says |
//! | --- | --- |
//! | rival | ln((E + 0.001) / (R + 0.001)): E is the energy of the part's pose, R the least energy of any hypothesis at another place, at most [`WORST`]. A wrong place that fits as well is a warning. |
//! | look | ln((e + 0.001) / (e' + 0.001)), mean over the part's points: e is the colour difference around a point ([`local_errors`]), e' the same of this key's model on the *other key's* picture, where the right place is known. So e is measured against the change that the footage itself shows from key to key. |
//! | cost | ln(c + 0.02): c is the cost of the contour's own colour templates before refinement ([`super::refine`]) |
//! | apart | ln(d + 0.5): d is the distance in working pixels from the nearest place that the other key's model gives the point, at most 50 |
//! | slide | by how much c is larger 5 px away along the contour, −0.3 to 0.5: a point that could slide along its contour is not known there |
//! | edge | ln((g + 0.004) / (g' + 0.004)), −2 to 0.7: g is the strength of the picture's edge across the contour around the point, g' that at the keys. A contour must lie on an edge or a line if it did so at its keys. |
//! | margin | ln(m + 0.01): m is the energy by which the joint choice prefers the part's place to every other one ([`super::joint::margin`]), at most 1, in steps of [`STEP`] |
//!
//! Rival, look and margin are the same for all points of a part, because points of a part fail together.
//!
//! The first six are seen on the drawing alone. The margin depends on the choices of other parts.

use super::confidence::local_errors;
use super::joint::margin::ELSEWHERE;
use super::lattice::texture::WORST;
use super::pool::Hypothesis;
use super::refine::{Frame, Refiner};
use super::stage::Stage;
use crate::shared::features::{Features, total};
use rototoon_base::geometry::Point;
use rototoon_base::scene::Span;
use std::collections::BTreeMap;

/// Number of measurements of a point.
pub const COUNT: usize = 7;
/// Names of the measurements, in the order of [`Evidence`].
pub const NAMES: [&str; COUNT] = ["rival", "look", "cost", "apart", "slide", "edge", "margin"];
/// The measurements of a control point.
pub type Evidence = [f64; COUNT];
/// Those of a control point that are seen on the drawing: all but the margin.
pub type Seen = [f64; COUNT - 1];

/// By part and span: of each frame the index of its drawing, and the evidence about each control point, which is empty on
/// the keys' drawings.
pub type BySpan = BTreeMap<(String, Span), Vec<(usize, Vec<Evidence>)>>;

/// Upper limit of d, in working pixels: a larger distance adds no information.
const FURTHEST_APART: f64 = 50.0;
/// Steps of the margin's logarithm. A correction moves the joint energy of parts far from it by amounts that mean nothing. In
/// steps their confidence stays the same.
const STEP: f64 = 0.125;
/// Limits of the slide and of the edge.
const SLIDE: (f64, f64) = (-0.3, 0.5);
const EDGE: (f64, f64) = (-2.0, 0.7);
/// Cost and slide of a contour without templates: their means over the footage of the fit.
const NO_TEMPLATES: (f64, f64) = (0.061, 0.041);
/// Places on a half segment at which the edge is measured, as shares of the segment.
const ALONG: [f64; 4] = [0.05, 0.2, 0.35, 0.5];
/// Distances from the contour at which the edge is looked for, in working pixels.
const ACROSS: [f64; 3] = [-2.0, 0.0, 2.0];
/// Level (index in `LEVELS`) whose slopes show edges.
const LEVEL: usize = 2;

/// What the keys say about each other: how well a right contour fits in this footage.
pub(super) struct Reference {
    /// By model: local errors around the other key's control points.
    looks: [Vec<f64>; 2],
    /// By key: strength of the edge around each control point.
    edges: [Vec<f64>; 2],
}

/// A drawing between the keys with its result.
pub(super) struct Found<'a> {
    pub drawing: usize,
    pub pool: &'a [Hypothesis],
    /// The chosen pose, aligned to what is visible.
    pub own: &'a Hypothesis,
    /// Control points before refinement, and after it.
    pub rough: &'a [Point],
    pub points: &'a [Point],
    /// Share of the time from the first key to the second.
    pub share: f64,
}

impl Reference {
    pub fn new(stage: &Stage) -> Self {
        let ends = [0, stage.features.len() - 1];
        let keys = [0, 1].map(|k: usize| stage.job.keys[k].iter().map(|&p| p / stage.scale).collect::<Vec<Point>>());
        let look = |k: usize| {
            let (model, there) = (&stage.models[k], ends[1 - k]);
            let pose = model.seen(&stage.scenery(k, there), &model.there);
            let right = Hypothesis::new(k, pose, keys[1 - k].clone(), Vec::new());
            local_errors(model, &stage.features[there], &stage.models[1 - k].cover, &right)
        };
        let edge = |k: usize| edges(&stage.features[ends[k]], &keys[k], stage.job.closed);
        Self { looks: [look(0), look(1)], edges: [edge(0), edge(1)] }
    }
}

/// The evidence about a control point of a part with this margin on its drawing.
pub(super) fn with_margin(seen: &Seen, margin: f64) -> Evidence {
    let [rival, look, cost, apart, slide, edge] = *seen;
    let steps = ((margin + 0.01).ln() / STEP).round();
    [rival, look, cost, apart, slide, edge, steps * STEP]
}

/// What is seen at each control point of a drawing.
pub(super) fn of_drawing(stage: &Stage, refiner: Option<&Refiner>, reference: &Reference, found: &Found) -> Vec<Seen> {
    let (own, count) = (found.own, found.points.len());
    let model = &stage.models[own.model];
    let (picture, cover) = (&*stage.features[found.drawing], &stage.covers[found.drawing]);
    let size = model.texture.mesh.size;
    let elsewhere = |h: &&Hypothesis| h.distance(own) > ELSEWHERE.0 + ELSEWHERE.1 * size;
    let rival = found.pool.iter().filter(elsewhere).map(|h| h.pose.energy).fold(f64::from(WORST), f64::min);
    let rival = ratio(own.pose.energy, rival, 0.001);
    let looks = local_errors(model, picture, cover, own);
    let relative = looks.iter().zip(&reference.looks[own.model]).map(|(now, key)| ratio(*now, *key, 0.001));
    let look = relative.sum::<f64>() / count.max(1) as f64;
    let frame = Frame { picture, cover, share: found.share, pins: BTreeMap::new() };
    let cost = refiner.map(|refiner| refiner.costs(&frame, found.rough));
    let slide = refiner.map(|refiner| refiner.slides(&frame, found.points));
    let edges = edges(picture, found.points, stage.job.closed);
    let others = || found.pool.iter().filter(|h| h.model != own.model);
    let of_point = |j: usize| {
        let cost = cost.as_ref().map_or(NO_TEMPLATES.0, |costs| costs[j]);
        let slide = slide.as_ref().map_or(NO_TEMPLATES.1, |slides| slides[j]);
        let apart = others().map(|h| h.points[j].distance(own.points[j])).fold(FURTHEST_APART, f64::min);
        let at_keys = reference.edges[0][j] + (reference.edges[1][j] - reference.edges[0][j]) * found.share;
        let edge = ratio(edges[j], at_keys, 0.004).clamp(EDGE.0, EDGE.1);
        [rival, look, (cost.max(0.0) + 0.02).ln(), (apart + 0.5).ln(), slide.clamp(SLIDE.0, SLIDE.1), edge]
    };
    (0..count).map(of_point).collect()
}

/// Logarithm of the ratio of two numbers that are not negative, each made larger by `least`.
fn ratio(a: f64, b: f64, least: f64) -> f64 {
    ((a.max(0.0) + least) / (b.max(0.0) + least)).ln()
}

/// Strength of the picture's edge across the contour around each control point, per working pixel.
fn edges(picture: &Features, points: &[Point], closed: bool) -> Vec<f64> {
    let count = points.len();
    let level = picture.level(LEVEL);
    let on_half = |a: Point, b: Point| {
        let normal = (b - a).normalize_or(Point::X).perp();
        let strength = |place: Point| {
            let sample = level.sample(place);
            let slope = sample.slopes[0] * normal.x as f32 + sample.slopes[1] * normal.y as f32;
            f64::from(total(slope * slope)).sqrt()
        };
        let best =
            |t: f64| ACROSS.map(|offset| strength(a.lerp(b, t) + normal * offset)).into_iter().fold(0.0, f64::max);
        ALONG.map(best).into_iter().sum::<f64>() / ALONG.len() as f64
    };
    let around = |j: usize| {
        let before = (j > 0 || closed).then(|| points[(j + count - 1) % count]);
        let after = (j + 1 < count || closed).then(|| points[(j + 1) % count]);
        let halves: Vec<f64> = before.into_iter().chain(after).map(|q| on_half(points[j], q)).collect();
        halves.iter().sum::<f64>() / halves.len().max(1) as f64
    };
    (0..count).map(around).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn margins_that_differ_little_are_the_same_evidence() {
        let seen: Seen = [-2.0, 0.0, -2.5, 0.5, 0.05, 0.0];
        let margin = |margin: f64| with_margin(&seen, margin)[COUNT - 1];
        assert_eq!(margin(0.2), margin(0.2 + 1e-4));
        assert!(margin(0.0) < margin(0.005) && margin(0.2) < margin(0.3));
        assert!((margin(0.2) - 0.21f64.ln()).abs() <= STEP / 2.0);
        assert_eq!(with_margin(&seen, 0.2)[..COUNT - 1], seen);
    }
}
