//! Doubts parts that may have changed places (an *identity switch*).
//!
//! **Why.** The near leg of a walk looks like the far one. Where the two come together, part, and come together again, a
//! tracker may take each for the other one in between. Both contours fit their drawings then, move smoothly, and are right at
//! both keys. So the fit, the margin of the joint choice, and the agreement of the two keys all say that they are sure.
//!
//! **How.** A frame is *known* for two parts if one of them has a key or a correction there, or shows a key's drawing. Between two frames
//! that are known one after the other, parts that meet once cannot be exchanged: each key says which is which on its side. If parts
//! that are [alike](super::alike) meet twice or more, nothing says so from the first time to the last. There the probability of each
//! point is multiplied by that of no exchange, 1 − [`EXCHANGED`].
//!
//! **One key.** Beside a single key nothing follows that says which is which. So two such parts are undecided from where they first
//! meet to the end of their tracks on that side, if they part again.
//!
//! The sign was found on films with their own keys and with two to four, and checked on a walk in pencil. Of the sure contours 29 of
//! 3575 were lost on the first, and 25 of 353 on the second. Now 8 of 3372 and 1 of 278 are. `docs/src/methods/confidence.md` has the tables.
//!
//! **Limits.** The right contours of a walk are doubted too, until a key or a correction between the two meetings says which leg is
//! which. Open lines are not looked at, nor a part with one key beside one with more. Parts with one key have a further sign
//! ([`twins`](crate::shared::twins)).

use super::alike::{Look, between_meetings, median_colour, meet};
use super::confidence::HELD;
use super::stage::Kit;
use crate::contract::error::TrackError;
use crate::contract::tracking::{Exchange, PartTrack, Tracking};
use crate::shared::features::{Padded, working_scale};
use rototoon_base::geometry::{Point, polygon};
use rototoon_base::scene::{FrameNumber, Part, Scene};
use std::collections::BTreeSet;

/// Share of lost contours among those that have the sign and a mean of 0.5 or more: 141 of 492.
const EXCHANGED: f64 = 0.28;
/// Level (index in `LEVELS`) whose colours are compared, and the distance between two places that are, in its pixels.
const LEVEL: usize = 2;
const EACH: f64 = 2.0;

/// Makes the points of parts that may have changed places less sure, and names these parts.
///
/// # Errors
///
/// The error of a picture that cannot be read.
pub(super) fn doubt(kit: Kit, scene: &Scene, tracking: &mut Tracking) -> Result<(), TrackError> {
    let looks = scene.parts.iter().map(|part| look(kit, scene, part)).collect::<Result<Vec<_>, TrackError>>()?;
    let mut exchanges = Vec::new();
    for (a, of_a) in looks.iter().enumerate() {
        let alike = |b: &usize| matches!((of_a, &looks[*b]), (Some(x), Some(y)) if x.is_like(y));
        let is_single = |p: usize| scene.parts[p].keys.len() == 1;
        for b in (a + 1..looks.len()).filter(alike).filter(|b| is_single(*b) == is_single(a)) {
            let pair = [a, b].map(|p| (&scene.parts[p], &tracking.parts[p]));
            let frames = if is_single(a) { undecided_beyond(pair) } else { undecided(pair) };
            if !frames.is_empty() {
                exchanges.push(Exchange { parts: [a, b], frames });
            }
        }
    }
    // A part that may be at either of two others is doubted once.
    let of =
        |exchange: &Exchange| exchange.parts.map(|p| exchange.frames.iter().map(move |&f| (p, f)).collect::<Vec<_>>());
    let doubted: BTreeSet<(usize, FrameNumber)> = exchanges.iter().flat_map(of).flatten().collect();
    for (p, frame) in doubted {
        let points = tracking.parts[p].confidence.entry(frame).or_default();
        points.iter_mut().for_each(|point| *point *= 1.0 - EXCHANGED);
    }
    tracking.exchanges = exchanges;
    Ok(())
}

/// The look of a closed part at its first and its last key. `None` for other parts, and parts too thin for a look.
fn look(kit: Kit, scene: &Scene, part: &Part) -> Result<Option<Look>, TrackError> {
    let ends = [part.keys.first_key_value(), part.keys.last_key_value()];
    let [Some((&first, a)), Some((&last, b))] = ends else { return Ok(None) };
    if !part.closed || part.point_count() < 3 {
        return Ok(None);
    }
    let scale = working_scale(scene.footage.height);
    let colours = (inside(kit, first, a, scale)?, inside(kit, last, b, scale)?);
    let (Some(a), Some(b)) = colours else { return Ok(None) };
    Ok(Some(Look::new(part.keys.values().map(Vec::as_slice), (a + b) / 2.0)))
}

/// The median colour inside a contour, by channel. `None` if no place is inside.
fn inside(kit: Kit, frame: FrameNumber, contour: &[Point], scale: f64) -> Result<Option<Padded>, TrackError> {
    let features = kit.colours(frame)?;
    let level = features.level(LEVEL);
    let contour: Vec<Point> = contour.iter().map(|&p| p / scale).collect();
    let Some((low, high)) = polygon::bounds(&contour) else { return Ok(None) };
    let step = level.pixel() * EACH;
    let count = |from: f64, to: f64| ((to - from) / step).clamp(0.0, 1000.0) as usize + 1;
    let mut colours = Vec::new();
    for y in 0..count(low.y, high.y) {
        for x in 0..count(low.x, high.x) {
            let place = low + Point::new(x as f64 + 0.5, y as f64 + 0.5) * step;
            if polygon::contains(&contour, place) {
                colours.push(level.colour(place));
            }
        }
    }
    Ok((!colours.is_empty()).then(|| median_colour(colours.iter().copied())))
}

/// The frames on which both of two parts have a contour.
fn both_on([a, b]: [&PartTrack; 2]) -> Vec<FrameNumber> {
    a.tracks.keys().filter(|frame| b.tracks.contains_key(frame)).copied().collect()
}

/// The frames on which nothing says which of two parts with one key each is which. Between two frames on which it is known
/// they are those of [`undecided`].
fn undecided_beyond([a, b]: [(&Part, &PartTrack); 2]) -> Vec<FrameNumber> {
    let both = both_on([a.1, b.1]);
    // A frame that is held from the only key shows exactly the key.
    let shows_key =
        |(part, track): (&Part, &PartTrack), frame| part.keys.values().any(|key| *key == track.tracks[&frame]);
    let is_known = |frame: FrameNumber| [a, b].into_iter().any(|of| is_known(of, frame) || shows_key(of, frame));
    let known: Vec<usize> = (0..both.len()).filter(|&k| is_known(both[k])).collect();
    let (Some(&first), Some(&last)) = (known.first(), known.last()) else { return Vec::new() };
    let meets = |k: &usize| meet(&a.1.tracks[&both[*k]], &b.1.tracks[&both[*k]]);
    // From a known frame outward: from the first meeting on, if they part again.
    let outward = |way: Vec<usize>| {
        let met = way.iter().position(meets).filter(|&met| !way[met..].iter().all(meets));
        met.map_or_else(Vec::new, |met| way[met.max(1)..].to_vec())
    };
    let mut undecided: Vec<usize> = outward((0..=first).rev().collect());
    for ends in known.windows(2) {
        let between = between_meetings((ends[0]..=ends[1]).map(|k| meets(&k)));
        undecided.extend(between.into_iter().flatten().map(|k| ends[0] + k).filter(|k| !ends.contains(k)));
    }
    undecided.extend(outward((last..both.len()).collect()));
    undecided.sort_unstable();
    undecided.into_iter().map(|k| both[k]).collect()
}

/// The frames on which nothing says which of two parts is which.
fn undecided([a, b]: [(&Part, &PartTrack); 2]) -> Vec<FrameNumber> {
    let both = both_on([a.1, b.1]);
    let known = |frame: FrameNumber| is_known(a, frame) || is_known(b, frame);
    let meets = |frame: FrameNumber| meet(&a.1.tracks[&frame], &b.1.tracks[&frame]);
    let mut undecided = Vec::new();
    let mut start = 0;
    for end in (1..both.len()).filter(|&k| known(both[k])) {
        // Meetings on known frames count: what parts there may still be mistaken.
        let between = between_meetings((start..=end).map(|k| meets(both[k])));
        let inside = between.into_iter().flatten().map(|k| start + k).filter(|&k| k != start && k != end);
        undecided.extend(inside.map(|k| both[k]));
        start = end;
    }
    undecided
}

/// Whether a part has a key or a correction on a frame, or a key's drawing.
fn is_known((part, track): (&Part, &PartTrack), frame: FrameNumber) -> bool {
    let corrected = part.pins.contains_key(&frame) || part.centers.contains_key(&frame);
    let held = || track.confidence.get(&frame).is_some_and(|points| points.iter().all(|point| *point == HELD));
    part.keys.contains_key(&frame) || corrected || held()
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeMap;

    const LAST: FrameNumber = 12;

    fn square(x: f64) -> Vec<Point> {
        [(0.0, 0.0), (10.0, 0.0), (10.0, 10.0), (0.0, 10.0)].map(|(dx, dy)| Point::new(x + dx, dy)).to_vec()
    }

    /// A part with keys on the first and the last frame, and its track along these places.
    fn part(at: &dyn Fn(FrameNumber) -> f64) -> (Part, PartTrack) {
        let tracks: BTreeMap<FrameNumber, Vec<Point>> = (0..=LAST).map(|frame| (frame, square(at(frame)))).collect();
        let keys = [0, LAST].map(|frame| (frame, tracks[&frame].clone())).into();
        let confidence = tracks.keys().map(|&frame| (frame, vec![0.9; 4])).collect();
        (Part { closed: true, keys, ..Part::default() }, PartTrack { tracks, confidence, ends: Vec::new() })
    }

    /// A part that stands, and one that is on its place on these frames and beside it on the others.
    fn two(meetings: &[FrameNumber]) -> [(Part, PartTrack); 2] {
        [part(&|_| 0.0), part(&|frame| if meetings.contains(&frame) { 3.0 } else { 30.0 })]
    }

    fn found(pair: &[(Part, PartTrack); 2]) -> Vec<FrameNumber> {
        undecided([0, 1].map(|k| (&pair[k].0, &pair[k].1)))
    }

    #[test]
    fn parts_that_meet_twice_between_two_keys_are_undecided_from_the_first_time_to_the_last() {
        assert_eq!(found(&two(&[3, 4, 8])), [3, 4, 5, 6, 7, 8]);
        assert_eq!(found(&two(&[0, 8])), [1, 2, 3, 4, 5, 6, 7, 8], "from a key on");
        assert_eq!(found(&two(&[3, 12])), (3..12).collect::<Vec<_>>(), "up to a key");
    }

    #[test]
    fn parts_that_meet_once_are_told_apart_by_the_keys() {
        assert!(found(&two(&[])).is_empty());
        assert!(found(&two(&[5])).is_empty());
        assert!(found(&two(&[4, 5, 6])).is_empty());
        assert!(found(&two(&(0..=LAST).collect::<Vec<_>>())).is_empty(), "always together");
    }

    #[test]
    fn parts_with_one_key_are_undecided_from_where_they_first_meet() {
        let single = |meetings: &[FrameNumber], keys: [FrameNumber; 2]| {
            let mut pair = two(meetings);
            for ((part, track), key) in pair.iter_mut().zip(keys) {
                // A track is never exactly the key elsewhere.
                let moved = |(&frame, points): (&FrameNumber, &mut Vec<Point>)| points[0].y += 0.01 * f64::from(frame);
                track.tracks.iter_mut().for_each(moved);
                part.keys = BTreeMap::from([(key, track.tracks[&key].clone())]);
            }
            pair
        };
        let beyond = |pair: &[(Part, PartTrack); 2]| undecided_beyond([0, 1].map(|k| (&pair[k].0, &pair[k].1)));
        assert_eq!(beyond(&single(&[5], [0, 0])), (5..=12).collect::<Vec<_>>());
        assert_eq!(beyond(&single(&[5], [12, 12])), (0..=5).collect::<Vec<_>>(), "before the key");
        assert_eq!(beyond(&single(&[4, 9], [6, 6])), [0, 1, 2, 3, 4, 9, 10, 11, 12], "on both sides");
        assert_eq!(beyond(&single(&[6], [6, 6])), [0, 1, 2, 3, 4, 5, 7, 8, 9, 10, 11, 12], "on the key's frame");
        assert!(beyond(&single(&[5], [0, 12])).is_empty(), "a key on each side");
        assert_eq!(beyond(&single(&[3, 5], [0, 12])), [3, 4, 5]);
        assert!(beyond(&single(&[], [0, 0])).is_empty());
        assert!(beyond(&single(&(8..=LAST).collect::<Vec<_>>(), [0, 0])).is_empty(), "they do not part again");
        let mut pinned = single(&[5], [0, 0]);
        pinned[1].0.pins.insert(8, BTreeMap::from([(1, Point::ZERO)]));
        assert!(beyond(&pinned).is_empty(), "a correction behind it");
        let mut held = single(&[0], [0, 0]);
        let key = held[0].0.keys[&0].clone();
        held[0].1.tracks.insert(1, key);
        assert_eq!(beyond(&held), Vec::<FrameNumber>::new(), "apart on a frame that shows the key");
    }

    #[test]
    fn a_key_a_correction_or_a_keys_drawing_between_tells_them_apart() {
        let mut keyed = two(&[3, 8]);
        keyed[1].0.keys.insert(5, square(30.0));
        assert!(found(&keyed).is_empty());
        let mut pinned = two(&[3, 8]);
        pinned[0].0.pins.insert(6, BTreeMap::from([(1, Point::ZERO)]));
        assert!(found(&pinned).is_empty());
        let mut held = two(&[1, 8]);
        // The mean of twelve is not the same number.
        held[1].1.confidence.insert(2, vec![HELD; 12]);
        assert!(found(&held).is_empty());
        held[1].1.confidence.insert(2, vec![0.998; 12]);
        assert_eq!(found(&held), (1..=8).collect::<Vec<_>>(), "sure for another reason");
        let mut beyond = two(&[3, 8]);
        beyond[1].0.keys.insert(10, square(30.0));
        assert_eq!(found(&beyond), [3, 4, 5, 6, 7, 8]);
    }
}
