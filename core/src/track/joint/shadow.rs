//! What of each hypothesis the hypotheses of nearer parts hide.

use super::Contender;
use super::cost::State;
use crate::geometry::{Point, polygon};
use crate::scene::Raster;
use crate::track::lattice::texture::UNSEEN;
use crate::track::pool::Hypothesis;
use rayon::prelude::{IntoParallelRefIterator, ParallelIterator};
use std::collections::BTreeMap;

/// Cost of a sample that a nearer part hides, as a squared colour difference.
pub const HIDDEN: f32 = UNSEEN;

/// Side of the pixels that shadows are drawn in, in working pixels.
const PIXEL: f64 = 3.0;

/// Samples of a hypothesis under one of a nearer part: a bit each, none where no sample is.
pub type Mask = Option<Box<[u64]>>;

/// Masks on a contender by a nearer one: by far drawing, far hypothesis, near hypothesis.
type Masks = Vec<Vec<Vec<Mask>>>;

/// Which samples are hidden, by (far contender, near contender): by far drawing, far hypothesis, near hypothesis.
pub struct Shadows {
    masks: BTreeMap<(usize, usize), Masks>,
    costs: Vec<Vec<Vec<SampleCosts>>>,
    in_front: Vec<Vec<usize>>,
    behind: Vec<Vec<usize>>,
}

/// What the samples of a hypothesis cost, seen and hidden.
struct SampleCosts {
    seen: f64,
    /// What hiding a sample adds.
    hiding: Vec<f32>,
    bending: f64,
}

/// The inside of a contour in its bounding box.
struct Silhouette {
    corner: Point,
    pixels: Raster<bool>,
}

impl Silhouette {
    fn new(contour: &[Point]) -> Option<Self> {
        let (low, high) = polygon::bounds(contour)?;
        let corner = (low / PIXEL).floor();
        let extent = (high / PIXEL).ceil() - corner;
        if !(extent.x * extent.y <= 1e6 && extent.min_element() >= 1.0) {
            return None;
        }
        let mut pixels = Raster::new(extent.x as usize, extent.y as usize, false);
        let moved: Vec<Point> = contour.iter().map(|&p| p / PIXEL - corner).collect();
        let (width, height) = (pixels.width(), pixels.height());
        polygon::for_each_span(&moved, width, height, |y, x0, x1| pixels.row_mut(y)[x0..x1].fill(true));
        Some(Self { corner, pixels })
    }

    fn covers(&self, p: Point) -> bool {
        let at = p / PIXEL - self.corner;
        at.x >= 0.0
            && at.y >= 0.0
            && at.x < self.pixels.width() as f64
            && at.y < self.pixels.height() as f64
            && self.pixels.row(at.y as usize)[at.x as usize]
    }

    fn mask(&self, places: &[Point], (low, high): (Point, Point)) -> Mask {
        let extent = Point::new(self.pixels.width() as f64, self.pixels.height() as f64);
        let (own_low, own_high) = (self.corner * PIXEL, (self.corner + extent) * PIXEL);
        if high.x < own_low.x || high.y < own_low.y || low.x > own_high.x || low.y > own_high.y {
            return None;
        }
        let mut words = vec![0u64; places.len().div_ceil(64)];
        for (i, &p) in places.iter().enumerate() {
            words[i / 64] |= u64::from(self.covers(p)) << (i % 64);
        }
        words.iter().any(|&w| w != 0).then(|| words.into_boxed_slice())
    }
}

impl Shadows {
    /// Casts the shadows of all hypotheses on all farther ones.
    pub fn cast(contenders: &[Contender]) -> Self {
        let silhouettes: Vec<Vec<Vec<Option<Silhouette>>>> = contenders
            .par_iter()
            .map(|c| {
                let of_pool = |pool: &Vec<Hypothesis>| {
                    pool.iter().map(|h| if c.hides { Silhouette::new(&h.points) } else { None }).collect()
                };
                c.pools.iter().map(of_pool).collect()
            })
            .collect();
        let index: Vec<usize> = (0..contenders.len()).collect();
        let far: Vec<_> = index.par_iter().map(|&f| masks_on(contenders, &silhouettes, f)).collect();
        let costs = contenders.par_iter().map(sample_costs).collect();
        let masks: BTreeMap<_, _> = far.into_iter().flatten().collect();
        let (mut in_front, mut behind) = (vec![Vec::new(); contenders.len()], vec![Vec::new(); contenders.len()]);
        for &(far, near) in masks.keys() {
            in_front[far].push(near);
            behind[near].push(far);
        }
        Self { masks, costs, in_front, behind }
    }

    /// Whether nothing hides anything.
    pub fn none(&self) -> bool {
        self.masks.is_empty()
    }

    /// The pairs (far, near) of contenders of which one may hide the other.
    pub fn pairs(&self) -> Vec<(usize, usize)> {
        self.masks.keys().copied().collect()
    }

    /// The samples of a far hypothesis that a near one hides.
    pub fn mask(&self, parts: (usize, usize), (drawing, hypothesis): State, near_hypothesis: usize) -> Option<&[u64]> {
        self.masks.get(&parts)?[drawing][hypothesis].get(near_hypothesis)?.as_deref()
    }

    /// The contenders that may hide one.
    pub fn in_front_of(&self, contender: usize) -> &[usize] {
        &self.in_front[contender]
    }

    /// The contenders that one may hide.
    pub fn behind(&self, contender: usize) -> &[usize] {
        &self.behind[contender]
    }

    /// Number of words of a mask.
    pub fn words(&self, contender: usize, drawing: usize, hypothesis: usize) -> usize {
        self.costs[contender][drawing][hypothesis].hiding.len().div_ceil(64)
    }

    /// √U of a hypothesis of which the samples in `hidden` are unseen.
    pub fn cost(&self, contender: usize, (drawing, hypothesis): State, hidden: &[u64]) -> f64 {
        let costs = &self.costs[contender][drawing][hypothesis];
        let mut sum = costs.seen;
        for (w, &word) in hidden.iter().enumerate() {
            let mut rest = word;
            while rest != 0 {
                sum += f64::from(costs.hiding[w * 64 + rest.trailing_zeros() as usize]);
                rest &= rest - 1;
            }
        }
        (sum + costs.bending).max(0.0).sqrt()
    }
}

/// The masks on one contender by all nearer ones.
fn masks_on(
    contenders: &[Contender],
    silhouettes: &[Vec<Vec<Option<Silhouette>>>],
    f: usize,
) -> Vec<((usize, usize), Masks)> {
    let far = &contenders[f];
    let nearer = |n: &usize| {
        let near = &contenders[*n];
        near.hides && near.depth > far.depth && near.span.first < far.span.last && far.span.first < near.span.last
    };
    let nearer: Vec<usize> = (0..contenders.len()).filter(nearer).collect();
    let mut found: Vec<Masks> = nearer.iter().map(|_| Vec::new()).collect();
    for (d, pool) in far.pools.iter().enumerate() {
        found.iter_mut().for_each(|by| by.push(vec![Vec::new(); pool.len()]));
        for (h, hypothesis) in pool.iter().enumerate() {
            let measured = far.models[hypothesis.model].texture.measured();
            let places: Vec<Point> = measured.iter().map(|t| t.binding.at(&hypothesis.pose.nodes)).collect();
            let Some(bounds) = polygon::bounds(&places) else { continue };
            for (by, &n) in found.iter_mut().zip(&nearer) {
                let Some(near_drawing) = contenders[n].drawing_at(far.frame_of(d)) else { continue };
                by[d][h] = silhouettes[n][near_drawing]
                    .iter()
                    .map(|s| s.as_ref().and_then(|s| s.mask(&places, bounds)))
                    .collect();
            }
        }
    }
    let touches = |by: &Masks| by.iter().flatten().flatten().any(Option::is_some);
    nearer.into_iter().zip(found).filter(|(_, by)| touches(by)).map(|(n, by)| ((f, n), by)).collect()
}

fn sample_costs(c: &Contender) -> Vec<Vec<SampleCosts>> {
    let of = |h: &Hypothesis| {
        let texture = &c.models[h.model].texture;
        let total: f32 = texture.measured().iter().map(|t| t.weight).sum();
        let share = 1.0 / total.max(1e-6);
        let hiding =
            texture.measured().iter().zip(&h.differences).map(|(t, d)| t.weight * share * (HIDDEN - d)).collect();
        let bending = texture.bending(&h.pose.nodes);
        SampleCosts { seen: h.pose.energy - bending, hiding, bending }
    };
    c.pools.iter().map(|pool| pool.iter().map(of).collect()).collect()
}
