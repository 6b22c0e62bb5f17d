//! The order of traced strokes from back to front, which is one for the film.
//!
//! Fills are behind lines, and a larger fill is behind a smaller one, such as its hole. A fill is as large as on the frame on which it is largest: so no fill
//! changes its place while it grows or shrinks. What an artist drew over a fill stays over it, however small the fill is.
//!
//! A line with a fill of its own hides what is drawn before it. Where the film has one, strokes keep the order in which they were drawn.

use super::super::order;
use super::Found;
use crate::geometry::{Point, polygon};
use crate::lines::{Stroke, Tracked};
use crate::scene::FrameNumber;
use std::cmp::Ordering;
use std::collections::{BTreeMap, BTreeSet};

/// Puts the strokes of each frame into the order of the film. `drawn` are the frames that an artist drew.
pub(super) fn arrange(found: &mut Found, drawn: &BTreeSet<FrameNumber>) {
    let strokes = || found.iter().flat_map(|(_, strokes)| strokes);
    if strokes().any(|own| own.stroke.fill_colour.is_some()) {
        return;
    }
    let mut sizes: BTreeMap<usize, f64> = BTreeMap::new();
    for own in strokes().filter(|own| own.stroke.fill) {
        let size = sizes.entry(own.track).or_default();
        *size = size.max(area(&own.stroke.points));
    }
    let of_drawing = |strokes: &Vec<Tracked>| -> Vec<usize> {
        strokes.iter().filter(|own| own.stroke.fill).map(|own| own.track).collect()
    };
    let mut by_frame: Vec<&(FrameNumber, Vec<Tracked>)> =
        found.iter().filter(|(frame, _)| drawn.contains(frame)).collect();
    by_frame.sort_by_key(|(frame, _)| *frame);
    let by_hand = order::common(&by_frame.iter().map(|(_, strokes)| of_drawing(strokes)).collect::<Vec<_>>());
    let mut over: f64 = 0.0;
    for track in by_hand.iter().rev() {
        let size = sizes.entry(*track).or_default();
        over = over.max(*size);
        *size = over;
    }
    let ranks: BTreeMap<usize, usize> = by_hand.into_iter().zip(0..).collect();
    let place = |own: &Tracked| (own.stroke.fill, sizes.get(&own.track).copied().unwrap_or_default());
    let rank = |own: &Tracked| ranks.get(&own.track).filter(|_| own.stroke.fill);
    for (_, strokes) in found.iter_mut() {
        strokes.sort_by(|a, b| behind(place(a), place(b)).then_with(|| rank(a).cmp(&rank(b))));
    }
}

/// The order of the strokes of one drawing: what is farther back comes first.
pub(super) fn behind_first(a: &Stroke, b: &Stroke) -> Ordering {
    behind((a.fill, area(&a.points)), (b.fill, area(&b.points)))
}

/// The order from back to front: fills are behind lines, and a larger fill is behind a smaller one.
fn behind(a: (bool, f64), b: (bool, f64)) -> Ordering {
    match (a.0, b.0) {
        (true, true) => b.1.total_cmp(&a.1),
        (fill, other) => other.cmp(&fill),
    }
}

/// The area within an outline, in square pixels.
fn area(points: &[Point]) -> f64 {
    polygon::signed_area(points).abs()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A square, filled or as a line.
    fn square(track: usize, side: f64, fill: bool) -> Tracked {
        let points = [[0.0, 0.0], [side, 0.0], [side, side], [0.0, side]].map(Point::from).to_vec();
        Tracked::sure(track, Stroke { points, closed: true, fill, ..Stroke::default() })
    }

    fn arranged(frames: &[Vec<Tracked>], drawn: &[FrameNumber]) -> Vec<Vec<usize>> {
        let mut found: Found = (0..).zip(frames.iter().cloned()).collect();
        arrange(&mut found, &drawn.iter().copied().collect());
        found.iter().map(|(_, strokes)| strokes.iter().map(|own| own.track).collect()).collect()
    }

    #[test]
    fn a_shape_that_grows_keeps_its_place() {
        let frames = [10.0, 40.0].map(|side| vec![square(2, 5.0, false), square(1, 30.0, true), square(0, side, true)]);
        assert_eq!(arranged(&frames, &[]), [[0, 1, 2], [0, 1, 2]]);
    }

    #[test]
    fn what_an_artist_drew_in_front_stays_in_front() {
        let frames =
            [20.0, 10.0, 40.0].map(|side| vec![square(0, side, true), square(1, 50.0, true), square(5, 3.0, true)]);
        assert_eq!(arranged(&frames, &[0]), [[0, 1, 5]; 3]);
        assert_eq!(arranged(&frames, &[]), [[1, 0, 5]; 3]);
    }

    #[test]
    fn with_a_fill_under_a_line_the_order_stays_on_all_frames() {
        let mut frames = [1, 2].map(|_| vec![square(0, 9.0, false), square(1, 5.0, true), square(2, 8.0, true)]);
        frames[0][0].stroke.fill_colour = Some([1.0, 0.0, 0.0]);
        assert_eq!(arranged(&frames, &[]), [[0, 1, 2]; 2]);
    }
}
