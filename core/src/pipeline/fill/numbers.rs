//! Numbers of regions where only some frames are painted: those of the frames that stay.
//!
//! A run counts its regions from 0 on, so its numbers say nothing of those that an earlier run gave. But both painted the same places of some
//! frames: those that are painted anew, and those on the way to them from the model drawing. A region gets the earlier number with which it
//! has most in common there. All others get numbers that no region had.
//!
//! A number has one colour. So a region with another colour than before is another one.

use crate::geometry::{Point, polygon};
use crate::project::fills::{FilledDrawing, FilledRegion};
use std::collections::{BTreeMap, BTreeSet};

/// Regions that are less alike than this are not the same place.
const ALIKE: f64 = 0.5;

/// Gives the regions of painted frames the numbers that they had. `way` are the other frames that this run has painted, and `earlier` all
/// drawings of the document before it.
pub(super) fn as_before(found: &mut [FilledDrawing], way: &[FilledDrawing], earlier: &[FilledDrawing]) {
    let known = shared(found.iter().chain(way), earlier);
    let mut renamed: BTreeMap<usize, usize> = BTreeMap::new();
    let mut taken: BTreeSet<usize> = BTreeSet::new();
    for (_, number, before) in known {
        if !renamed.contains_key(&number) && taken.insert(before) {
            renamed.insert(number, before);
        }
    }
    let numbers = earlier.iter().flat_map(|drawing| &drawing.regions).map(|region| region.track + 1);
    let mut next = numbers.max().unwrap_or(0);
    for region in found.iter_mut().flat_map(|drawing| &mut drawing.regions) {
        region.track = *renamed.entry(region.track).or_insert_with(|| {
            next += 1;
            next - 1
        });
    }
}

/// How much each new number has in common with an earlier one: the most first, and of equals the smaller numbers.
fn shared<'a>(painted: impl Iterator<Item = &'a FilledDrawing>, earlier: &[FilledDrawing]) -> Vec<(f64, usize, usize)> {
    let before: BTreeMap<_, _> = earlier.iter().map(|drawing| (drawing.frame, drawing)).collect();
    let mut common: BTreeMap<(usize, usize), f64> = BTreeMap::new();
    for drawing in painted {
        let old: Vec<Place> =
            before.get(&drawing.frame).iter().flat_map(|own| &own.regions).filter_map(Place::of).collect();
        for place in drawing.regions.iter().filter_map(Place::of) {
            let alike = old.iter().map(|own| (place.alike(own), own.region.track));
            let best = alike.filter(|own| own.0 >= ALIKE).max_by(|a, b| a.0.total_cmp(&b.0).then(b.1.cmp(&a.1)));
            if let Some((alike, number)) = best {
                *common.entry((place.region.track, number)).or_default() += alike;
            }
        }
    }
    let mut list: Vec<_> = common.into_iter().map(|((number, before), alike)| (alike, number, before)).collect();
    list.sort_by(|a, b| b.0.total_cmp(&a.0).then((a.1, a.2).cmp(&(b.1, b.2))));
    list
}

/// Where a region is.
struct Place<'a> {
    region: &'a FilledRegion,
    low: Point,
    high: Point,
    middle: Point,
    area: f64,
}

impl<'a> Place<'a> {
    fn of(region: &'a FilledRegion) -> Option<Self> {
        let (low, high) = polygon::bounds(&region.outline)?;
        let (middle, area) = (polygon::center(&region.outline), polygon::signed_area(&region.outline).abs());
        Some(Self { region, low, high, middle, area })
    }

    /// How alike two regions are in place, size and colour: 1 if they are the same.
    fn alike(&self, other: &Self) -> f64 {
        let of_box = |low: Point, high: Point| (high - low).max(Point::ZERO).element_product();
        let both = of_box(self.low.max(other.low), self.high.min(other.high));
        let any = of_box(self.low, self.high) + of_box(other.low, other.high) - both;
        if any <= 0.0 || !self.region.hue().is_same(&other.region.hue()) {
            return 0.0;
        }
        let size = self.area.min(other.area) / self.area.max(other.area).max(f64::MIN_POSITIVE);
        let apart = self.middle.distance(other.middle) / any.sqrt();
        both / any * size * (1.0 - apart).max(0.0)
    }
}
