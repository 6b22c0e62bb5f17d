//! Shadows: which samples of each hypothesis are hidden by the hypotheses of nearer parts.
//!
//! For every pair of a far and a near part, on every drawing, and for every pair of their hypotheses there is a bit
//! mask of the far part's hidden samples. The near part hides the inside of its contour. The masks make the cost of a
//! choice of hypotheses quick to compute. They are kept for the next call as long as the pools are the same, and each part is
//! in front of the other on the same drawings.
//!
//! Limit: the contours are drawn with pixels of 3 × 3 working pixels.

use super::contender::{Contender, State};
use super::figure::covered::{Covered, covered};
use super::lengths::Lengths;
use super::masks::Masks;
use crate::rototoon::lattice::texture::UNSEEN;
use crate::rototoon::pool::{Hypothesis, Pools};
use rayon::prelude::{IndexedParallelIterator, IntoParallelRefIterator, ParallelIterator};
use rototoon_base::geometry::{Point, polygon};
use rototoon_base::scene::Raster;
use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

/// Cost of a sample that a nearer part hides, as a squared colour difference.
pub const HIDDEN: f32 = UNSEEN;

/// Side of the pixels in which shadows are drawn, in working pixels.
const PIXEL: f64 = 3.0;

/// Masks of one far and one near contender, by the far one's drawing.
type PairMasks = Vec<Masks>;

/// Sample costs of a contender's hypotheses, by drawing and hypothesis.
type Costs = Vec<Vec<SampleCosts>>;

/// Hidden samples of all pairs of contenders, with the costs of the samples.
pub struct Shadows {
    /// By the far contender, then the near one.
    masks: Vec<Vec<Option<Arc<PairMasks>>>>,
    costs: Vec<Arc<Costs>>,
    in_front: Vec<Vec<usize>>,
    behind: Vec<Vec<usize>>,
}

/// Costs of the samples of a hypothesis.
struct SampleCosts {
    seen: f64,
    /// Change of the cost if a sample is hidden, by sample.
    hiding: Vec<f32>,
    bending: f64,
}

/// The inside of a contour, as a raster in its bounding box.
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

    fn mask(&self, places: &[Point], (low, high): (Point, Point)) -> Option<Vec<u64>> {
        let extent = Point::new(self.pixels.width() as f64, self.pixels.height() as f64);
        let (own_low, own_high) = (self.corner * PIXEL, (self.corner + extent) * PIXEL);
        if high.x < own_low.x || high.y < own_low.y || low.x > own_high.x || low.y > own_high.y {
            return None;
        }
        let mut words = vec![0u64; places.len().div_ceil(64)];
        for (i, &p) in places.iter().enumerate() {
            words[i / 64] |= u64::from(self.covers(p)) << (i % 64);
        }
        words.iter().any(|&w| w != 0).then_some(words)
    }
}

/// Computed shadows by the addresses of the pools. The pools are kept too, so that no other pool can get the same
/// address.
#[derive(Default)]
pub struct Memory {
    masks: BTreeMap<(usize, usize), PairCast>,
    costs: BTreeMap<usize, (Arc<Pools>, Arc<Costs>)>,
    covered: BTreeMap<usize, (Arc<Pools>, Arc<Covered>)>,
    lengths: BTreeMap<usize, (Arc<Pools>, Arc<Lengths>)>,
}

/// A far and a near contender, and their masks. `None` if the near one hides no sample.
type Fresh = ((usize, usize), Option<Arc<PairMasks>>);

/// The pools of a far and a near contender, on which drawings of the far one the other one is nearer, and their masks. `None` if the
/// near one hides no sample.
type PairCast = ([Arc<Pools>; 2], Vec<bool>, Option<Arc<PairMasks>>);

impl Memory {
    /// Forgets the shadows of other pools than these.
    pub fn keep_only<'a>(&mut self, pools: impl Iterator<Item = &'a Arc<Pools>>) {
        let present: BTreeSet<usize> = pools.map(address).collect();
        self.masks.retain(|(far, near), _| present.contains(far) && present.contains(near));
        self.costs.retain(|pools, _| present.contains(pools));
        self.covered.retain(|pools, _| present.contains(pools));
        self.lengths.retain(|pools, _| present.contains(pools));
    }

    /// The lengths of motion between the hypotheses of each contender.
    pub fn lengths(&mut self, contenders: &[Contender]) -> Vec<Arc<Lengths>> {
        let of = |c: &Contender| {
            let new = || (c.pools.clone(), Arc::new(Lengths::new(c.pools, c.gaps())));
            self.lengths.entry(address(c.pools)).or_insert_with(new).1.clone()
        };
        contenders.iter().map(of).collect()
    }

    /// The blocks inside the contour of each hypothesis of the contenders, in a picture of so many columns and rows of
    /// blocks. None for those that hide nothing.
    pub fn covered(&mut self, contenders: &[Contender], size: (usize, usize)) -> Vec<Option<Arc<Covered>>> {
        let known = |c: &Contender| {
            let known = self.covered.get(&address(c.pools));
            known.map_or_else(|| Arc::new(covered(c, size)), |(_, known)| known.clone())
        };
        let found: Vec<Option<Arc<Covered>>> =
            contenders.par_iter().with_max_len(1).map(|c| c.hides.then(|| known(c))).collect();
        for (c, covered) in contenders.iter().zip(&found) {
            let keep = |covered: &Arc<Covered>| (c.pools.clone(), covered.clone());
            self.covered.extend(covered.as_ref().map(|covered| (address(c.pools), keep(covered))));
        }
        found
    }
}

fn address(pools: &Arc<Pools>) -> usize {
    Arc::as_ptr(pools).addr()
}

impl Shadows {
    /// Computes the shadows of all hypotheses on all hypotheses of farther parts.
    pub fn cast(contenders: &[Contender], memory: &mut Memory) -> Self {
        let index: Vec<usize> = (0..contenders.len()).collect();
        let pair = |&(f, n): &(usize, usize)| (address(contenders[f].pools), address(contenders[n].pools));
        let pairs: Vec<(usize, usize)> = index
            .iter()
            .flat_map(|&f| index.iter().map(move |&n| (f, n)))
            .filter(|&p| may_hide(contenders, p))
            .collect();
        let is_known = |p: &(usize, usize)| {
            let known = memory.masks.get(&pair(p));
            known.is_some_and(|(_, known, _)| *known == behind(contenders, *p))
        };
        let unknown: Vec<(usize, usize)> = pairs.iter().copied().filter(|p| !is_known(p)).collect();
        let silhouettes: Vec<Silhouettes> = index
            .par_iter()
            .with_max_len(1)
            .map(|&n| if unknown.iter().any(|u| u.1 == n) { silhouettes(&contenders[n]) } else { Vec::new() })
            .collect();
        let fresh: Vec<Vec<Fresh>> =
            index.par_iter().with_max_len(1).map(|&f| masks_on(contenders, &silhouettes, &unknown, f)).collect();
        let costs: Vec<Arc<Costs>> = contenders
            .par_iter()
            .map(|c| memory.costs.get(&address(c.pools)).map_or_else(|| Arc::new(sample_costs(c)), |(_, k)| k.clone()))
            .collect();
        let mut fresh: BTreeMap<_, _> = fresh.into_iter().flatten().collect();
        let mut masks = vec![vec![None; contenders.len()]; contenders.len()];
        for parts in pairs {
            let known = || memory.masks.get(&pair(&parts)).and_then(|(.., masks)| masks.clone());
            let found = fresh.remove(&parts).unwrap_or_else(known);
            let pools = [parts.0, parts.1].map(|c| contenders[c].pools.clone());
            let behind = behind(contenders, parts);
            memory.masks.insert(pair(&parts), (pools, behind, found.clone()));
            masks[parts.0][parts.1] = found;
        }
        for (c, costs) in contenders.iter().zip(&costs) {
            memory.costs.insert(address(c.pools), (c.pools.clone(), costs.clone()));
        }
        let (mut in_front, mut behind) = (vec![Vec::new(); contenders.len()], vec![Vec::new(); contenders.len()]);
        for (far, by) in masks.iter().enumerate() {
            for near in (0..by.len()).filter(|&near| by[near].is_some()) {
                in_front[far].push(near);
                behind[near].push(far);
            }
        }
        Self { masks, costs, in_front, behind }
    }

    /// Whether no part hides another.
    pub fn none(&self) -> bool {
        self.masks.iter().flatten().all(Option::is_none)
    }

    /// The pairs (far, near) of contenders in which the near one hides some sample of the far one. Two that hide each other,
    /// on different drawings, are one pair.
    pub fn pairs(&self) -> Vec<(usize, usize)> {
        let of = |far: usize| self.in_front[far].iter().map(move |&near| (far, near));
        let once = |&(far, near): &(usize, usize)| far < near || !self.in_front[near].contains(&far);
        (0..self.in_front.len()).flat_map(of).filter(once).collect()
    }

    /// The samples of a far hypothesis that a near hypothesis hides, as a bit mask. `parts` is (far, near).
    pub fn mask(&self, parts: (usize, usize), (drawing, hypothesis): State, near_hypothesis: usize) -> Option<&[u64]> {
        self.masks[parts.0][parts.1].as_ref()?[drawing].get(hypothesis, near_hypothesis)
    }

    /// The contenders that may hide one.
    pub fn in_front_of(&self, contender: usize) -> &[usize] {
        &self.in_front[contender]
    }

    /// The contenders that one may hide.
    pub fn behind(&self, contender: usize) -> &[usize] {
        &self.behind[contender]
    }

    /// Number of words of a mask of a hypothesis.
    pub fn words(&self, contender: usize, drawing: usize, hypothesis: usize) -> usize {
        self.costs[contender][drawing][hypothesis].hiding.len().div_ceil(64)
    }

    /// √U of a hypothesis whose samples in the mask `hidden` are unseen.
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

/// Silhouettes by drawing and hypothesis.
type Silhouettes = Vec<Vec<Option<Silhouette>>>;

fn silhouettes(c: &Contender) -> Silhouettes {
    let of_pool = |pool: &Vec<Hypothesis>| pool.iter().map(|h| Silhouette::new(&h.points)).collect();
    c.pools.iter().map(of_pool).collect()
}

/// Whether the second contender of the pair is nearer than the first one on a drawing, shares frames with it and can hide others.
fn may_hide(contenders: &[Contender], pair: (usize, usize)) -> bool {
    let (far, near) = (&contenders[pair.0], &contenders[pair.1]);
    let meet = near.span.first < far.span.last && far.span.first < near.span.last;
    near.hides && meet && behind(contenders, pair).contains(&true)
}

/// By drawing of the first contender of the pair: whether the second one is nearer there.
fn behind(contenders: &[Contender], (far, near): (usize, usize)) -> Vec<bool> {
    let (far, near) = (&contenders[far], &contenders[near]);
    far.frames().map(|frame| near.is_nearer(far, frame)).collect()
}

/// The masks on the contender `f` by the nearer contenders, for the pairs in which it is the far one.
fn masks_on(contenders: &[Contender], silhouettes: &[Silhouettes], pairs: &[(usize, usize)], f: usize) -> Vec<Fresh> {
    let far = &contenders[f];
    let nearer: Vec<usize> = pairs.iter().filter(|pair| pair.0 == f).map(|pair| pair.1).collect();
    if nearer.is_empty() {
        return Vec::new();
    }
    let mut found: Vec<PairMasks> = nearer.iter().map(|_| PairMasks::new()).collect();
    for (d, pool) in far.pools.iter().enumerate() {
        let frame = far.frame_of(d);
        let nearer_there = |&n: &usize| {
            let near = contenders[n].drawing_at(frame)?;
            contenders[n].is_nearer(far, frame).then_some(near)
        };
        let near_drawings: Vec<Option<usize>> = nearer.iter().map(nearer_there).collect();
        for ((by, &n), near) in found.iter_mut().zip(&nearer).zip(&near_drawings) {
            by.push(Masks::new(near.map_or(0, |near| silhouettes[n][near].len())));
        }
        for hypothesis in pool {
            let measured = far.models[hypothesis.model].texture.measured();
            let places: Vec<Point> = measured.iter().map(|t| t.binding.at(&hypothesis.pose.nodes)).collect();
            let bounds = polygon::bounds(&places);
            for ((by, &n), near) in found.iter_mut().zip(&nearer).zip(&near_drawings) {
                let near = near.map_or(&[][..], |near| &silhouettes[n][near]);
                by[d].push(places.len(), near.iter().map(|s| s.as_ref()?.mask(&places, bounds?)));
            }
        }
    }
    let touching = |by: PairMasks| (!by.iter().all(Masks::is_empty)).then(|| Arc::new(by));
    nearer.into_iter().zip(found).map(|(n, by)| ((f, n), touching(by))).collect()
}

fn sample_costs(c: &Contender) -> Costs {
    let of = |h: &Hypothesis| {
        let texture = &c.models[h.model].texture;
        let total: f32 = texture.measured().iter().map(|t| t.weight).sum();
        let share = texture.trust() as f32 / total.max(1e-6);
        let hiding =
            texture.measured().iter().zip(&h.differences).map(|(t, d)| t.weight * share * (HIDDEN - d)).collect();
        let bending = texture.bending(&h.pose.nodes);
        SampleCosts { seen: h.pose.energy - bending, hiding, bending }
    };
    c.pools.iter().map(|pool| pool.iter().map(of).collect()).collect()
}
