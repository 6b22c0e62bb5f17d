//! A colour that becomes another one: a coat that is green from a drawing on.
//!
//! The artist clicks into all parts of the coat that the drawing shows. Parts that are hidden there have no click. When they come back, the model drawing shows them in
//! the old colour, and would be believed.
//!
//! So clicks on a drawing that was carried are looked at together. The old colour has *become* the new one if
//!
//! - no drawing known so far has the new colour: clicks that mend a mistake give a colour that the model drawing has;
//! - what was clicked had the old colour surely: the mean confidence is at least [`SURE`]. What came in, such as a bird, is given the colour of something else with
//!   little confidence;
//! - it was at least [`WHOLE`] of the area of the old colour on the drawing.
//!
//! From there on the model drawing says the new colour where it has the old one. If it was less, but at least [`PART`], either may be meant. Then nothing is changed, and what comes back in the old colour is in doubt.
//!
//! # Limits
//!
//! A colour without a name is all that looks like it. If coat and boots are blue, and only the coat becomes green, it is the second case.

use crate::layout::Layout;
use crate::page::{Page, Paint};
use std::collections::BTreeMap;

/// Least mean confidence in the old colour.
const SURE: f64 = 0.5;
/// Least share of the old colour's area that has the new one: that of all of it, and of a part.
const WHOLE: f64 = 0.9;
const PART: f64 = 0.5;
/// Confidence in an old colour that comes back, where it may have become another one.
const DOUBT: f64 = 0.4;

/// A colour that clicks have changed, by the numbers in the palette.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Change {
    /// The old colour.
    pub from: usize,
    /// The new one.
    pub to: usize,
    /// Whether all of the old colour was changed.
    pub whole: bool,
}

/// The colours that clicks have changed on a page. `known` are the painted drawings from which it was carried.
pub fn changes(page: &Page, before: &Paint, after: &Paint, known: &[&Paint]) -> Vec<Change> {
    of_layout(&page.layout, before, after, known)
}

fn of_layout(layout: &Layout, before: &Paint, after: &Paint, known: &[&Paint]) -> Vec<Change> {
    // By old colour its area; by old and new colour the area, and the sum of its confidence.
    let mut all: BTreeMap<usize, f64> = BTreeMap::new();
    let mut changed: BTreeMap<(usize, usize), (f64, f64)> = BTreeMap::new();
    for region in 1..layout.figures.len() {
        let (Some(from), area) = (before.painted(region), layout.figures[region].area) else { continue };
        *all.entry(from).or_default() += area;
        if let Some(to) = after.painted(region).filter(|to| *to != from) {
            let own = changed.entry((from, to)).or_default();
            own.0 += area;
            own.1 += area * before.confidence(region);
        }
    }
    let is_known = |colour: usize| known.iter().any(|paint| paint.has(colour));
    let change = |((from, to), (area, sure)): ((usize, usize), (f64, f64))| {
        let share = area / all[&from].max(1.0);
        let meant = share >= PART && sure >= SURE * area && !is_known(to);
        meant.then_some(Change { from, to, whole: share >= WHOLE })
    };
    changed.into_iter().filter_map(change).collect()
}

impl Paint {
    /// The colours that regions of the drawing `last` have, and no region here. No paint is none of them.
    pub fn lacks(&self, last: &Self) -> Vec<usize> {
        (0..self.blank).filter(|&colour| last.has(colour) && !self.has(colour)).collect()
    }

    /// Whether a region has a colour.
    fn has(&self, colour: usize) -> bool {
        (1..self.tracks.len()).any(|region| self.colour(region) == Some(colour))
    }

    /// From here on a colour is another one. Painted regions whose colour changes get numbers from `next` on.
    pub fn becomes(&mut self, change: Change, next: &mut usize) {
        for region in 1..self.colours.len() {
            let before = self.colour(region);
            let row = &mut self.colours[region];
            row[change.to] += std::mem::take(&mut row[change.from]);
            if before == Some(change.from) && self.tracks[region].is_some() {
                self.tracks[region] = Some(*next);
                *next += 1;
            }
        }
    }

    /// Puts regions of a colour in doubt that have come back: the drawing before, `last`, has no region of their number.
    pub fn doubt_returns(&mut self, colour: usize, last: &Self) {
        for region in 1..self.tracks.len() {
            let is_back = self.tracks[region].is_some_and(|own| !last.tracks.contains(&Some(own)));
            if is_back && self.colour(region) == Some(colour) {
                self.confidence[region] = self.confidence[region].min(DOUBT);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::regions::Regions;
    use rototoon_base::scene::Raster;

    /// Three rooms side by side and the rest; colours by region.
    fn rooms(colours: [usize; 4]) -> (Layout, Paint) {
        let ink = |x: usize, y: usize| {
            y.abs_diff(50) == 20 && x < 91 || x.is_multiple_of(30) && x <= 90 && y.abs_diff(50) <= 20
        };
        let layout = Layout::new(&Regions::new(&Raster::from_fn(120, 100, ink)));
        assert_eq!(layout.figures.len(), 5);
        let mut paint = Paint::nothing(4, 5);
        for (k, colour) in colours.into_iter().enumerate() {
            (paint.colours[k + 1][colour], paint.confidence[k + 1], paint.tracks[k + 1]) = (1.0, 0.9, Some(k));
        }
        (layout, paint)
    }

    #[test]
    fn a_new_colour_on_all_of_an_old_one_is_a_change() {
        let (layout, before) = rooms([0, 1, 1, 2]);
        let after = |colours| of_layout(&layout, &before, &rooms(colours).1, &[&before]);
        assert_eq!(after([0, 3, 3, 2]), [Change { from: 1, to: 3, whole: true }]);
        assert_eq!(after([0, 3, 1, 2]), [Change { from: 1, to: 3, whole: false }], "half of it");
        assert_eq!(after([0, 2, 2, 2]), [], "a mistake is mended: the colour was there before");
        assert_eq!(after([0, 1, 1, 2]), []);
        let mut unsure = before.clone();
        unsure.confidence.fill(0.3);
        assert_eq!(of_layout(&layout, &unsure, &rooms([0, 3, 3, 2]).1, &[&before]), [], "it probably was no coat");
    }

    #[test]
    fn what_becomes_another_colour_has_a_new_number_and_what_comes_back_is_in_doubt() {
        let (_, mut paint) = rooms([0, 1, 1, 2]);
        let mut next = 7;
        paint.becomes(Change { from: 1, to: 3, whole: true }, &mut next);
        assert_eq!((1..5).map(|k| paint.colour(k)).collect::<Vec<_>>(), [Some(0), Some(3), Some(3), Some(2)]);
        assert_eq!((&paint.tracks[1..], next), (&[Some(0), Some(7), Some(8), Some(3)][..], 9));
        let (_, last) = rooms([0, 1, 1, 2]);
        paint.doubt_returns(3, &last);
        assert_eq!(paint.confidence[1..], [0.9, DOUBT, DOUBT, 0.9]);
    }
}
