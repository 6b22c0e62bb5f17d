//! Parts that look alike, and where they meet.
//!
//! Two closed parts are *alike* if their areas, outlines and colours at their keys are nearly the same. They *meet* where a share of
//! one's outline is inside the other one. If they meet twice between two frames on which it is known which is which, nothing
//! says so from the first time to the last.

use crate::shared::features::Padded;
use rototoon_base::geometry::{Point, polygon, polyline};
use rototoon_base::numeric::median::median;
use std::ops::RangeInclusive;

/// Largest ratio of two areas and of two outlines, and largest difference of two colours, of parts that are alike.
const AREAS: f64 = 1.3;
const OUTLINES: f64 = 1.2;
const COLOURS: f32 = 0.04;
/// Parts meet where more than this share of one's outline is inside the other one.
const MEETING: f64 = 0.05;
/// Places on an outline that are looked at.
const PLACES: usize = 48;

/// What a closed part looks like at its keys.
pub(super) struct Look {
    area: f64,
    outline: f64,
    colour: Padded,
}

impl Look {
    /// Of a part with these contours at its keys, and this colour inside.
    pub fn new<'a>(keys: impl Iterator<Item = &'a [Point]> + Clone, colour: Padded) -> Self {
        Self {
            area: median(keys.clone().map(|key| polygon::signed_area(key).abs()).collect()),
            outline: median(keys.map(|key| polyline::length(key, true)).collect()),
            colour,
        }
    }

    /// Whether two parts are alike.
    pub fn is_like(&self, other: &Self) -> bool {
        let within = |a: f64, b: f64, ratio: f64| a.max(b) <= ratio * a.min(b);
        within(self.area, other.area, AREAS)
            && within(self.outline, other.outline, OUTLINES)
            && (self.colour - other.colour).abs().max_element() <= COLOURS
    }
}

/// The median of some colours, by channel. Black without any.
pub(super) fn median_colour(colours: impl Iterator<Item = Padded> + Clone) -> Padded {
    let channel = |k: usize| median(colours.clone().map(|colour| f64::from(colour[k])).collect()) as f32;
    Padded::new(channel(0), channel(1), channel(2), 0.0)
}

/// Whether two closed contours overlap.
pub(super) fn meet(a: &[Point], b: &[Point]) -> bool {
    let share = |of: &[Point], within: &[Point]| {
        let places = polyline::resample(of, true, PLACES);
        places.iter().filter(|&&place| polygon::contains(within, place)).count() as f64 / PLACES as f64
    };
    let apart = |low: Point, high: Point| low.x > high.x || low.y > high.y;
    let (Some((low, high)), Some((from, to))) = (polygon::bounds(a), polygon::bounds(b)) else { return false };
    !apart(low, to) && !apart(from, high) && (share(a, b) > MEETING || share(b, a) > MEETING)
}

/// Of a series of frames or drawings, from one where it is known which of two parts is which to the next one: the range from the
/// first meeting to the last. `None` if they meet once or not at all.
pub(super) fn between_meetings(meets: impl Iterator<Item = bool>) -> Option<RangeInclusive<usize>> {
    let meetings: Vec<usize> = meets.enumerate().filter_map(|(k, meets)| meets.then_some(k)).collect();
    let again = meetings.windows(2).any(|two| two[1] - two[0] > 1);
    again.then(|| meetings[0]..=meetings[meetings.len() - 1])
}

#[cfg(test)]
mod tests {
    use super::*;

    fn square(x: f64) -> Vec<Point> {
        [(0.0, 0.0), (10.0, 0.0), (10.0, 10.0), (0.0, 10.0)].map(|(dx, dy)| Point::new(x + dx, dy)).to_vec()
    }

    #[test]
    fn parts_are_alike_by_area_outline_and_colour() {
        let look = |area, outline, grey: f32| Look { area, outline, colour: Padded::new(grey, grey, grey, 0.0) };
        let own = look(100.0, 40.0, 0.5);
        assert!(own.is_like(&look(120.0, 44.0, 0.52)));
        assert!(!own.is_like(&look(140.0, 44.0, 0.52)) && !own.is_like(&look(120.0, 50.0, 0.52)));
        assert!(!own.is_like(&look(100.0, 40.0, 0.6)));
    }

    #[test]
    fn contours_that_touch_do_not_meet() {
        assert!(meet(&square(0.0), &square(8.0)) && meet(&square(0.0), &square(0.5)));
        assert!(!meet(&square(0.0), &square(10.5)) && !meet(&square(0.0), &[]));
    }

    #[test]
    fn parts_that_meet_once_have_nothing_between() {
        let between = |marks: &str| between_meetings(marks.chars().map(|mark| mark == '1'));
        assert_eq!(between("0110010"), Some(1..=5));
        assert_eq!([between("000"), between("0110"), between("1111"), between("")], [None, None, None, None]);
    }
}
