//! The artist's edits of the scene. An edit that is refused changes nothing.

use rototoon::geometry::Point;
use rototoon::scene::{FrameNumber, NoSuchPart, Part, Scene};

/// Largest absolute coordinate, in pixels. A larger one is a mistake of the caller.
const MAX_COORDINATE: f64 = 1e6;

/// Why an edit was refused. The scene is unchanged.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum EditError {
    /// The document has no part of that name.
    #[error(transparent)]
    NoSuchPart(#[from] NoSuchPart),
    /// The part has no key on that frame.
    #[error("part {part:?}: no key on frame {frame}")]
    NoSuchKey {
        /// Name of the part.
        part: String,
        /// The requested frame.
        frame: FrameNumber,
    },
    /// The key has another number of points than the part's other keys, or none.
    #[error("part {part:?}, key on frame {frame}: found {found} {}, expected {expected}", if *found == 1 { "point" } else { "points" })]
    PointCount {
        /// Name of the part.
        part: String,
        /// The key's frame.
        frame: FrameNumber,
        /// Number of points given.
        found: usize,
        /// Number of points needed, and why.
        expected: String,
    },
    /// The number of coordinates is odd.
    #[error(
        "part {part:?}, key on frame {frame}: found {found} coordinates, expected an even number (x, y, x, y, ...)"
    )]
    OddCoordinates {
        /// Name of the part.
        part: String,
        /// The key's frame.
        frame: FrameNumber,
        /// Number of coordinates given.
        found: usize,
    },
    /// A coordinate is not finite, or very large.
    #[error("part {part:?}, frame {frame}, point {index}: found ({x}, {y}), expected pixels within ±{MAX_COORDINATE}")]
    Coordinate {
        /// Name of the part.
        part: String,
        /// The frame.
        frame: FrameNumber,
        /// Index of the point; 0 for a centre.
        index: usize,
        /// The x that was found, in pixels.
        x: f64,
        /// The y that was found, in pixels.
        y: f64,
    },
    /// The part has no control point of that index.
    #[error("part {part:?}: no point {index}; it has {count}, counted from 0")]
    NoSuchPoint {
        /// Name of the part.
        part: String,
        /// The requested index.
        index: i64,
        /// Number of the part's points.
        count: usize,
    },
    /// A correction on a frame that takes none: it is a key frame, or outside the part's keys.
    #[error("part {part:?}: frame {frame} is {what}; a correction needs a frame between the part's keys")]
    NotBetweenKeys {
        /// Name of the part.
        part: String,
        /// The requested frame.
        frame: FrameNumber,
        /// Where the frame is, for the message.
        what: &'static str,
    },
    /// A range of frames that ends before it begins.
    #[error("part {part:?}: found frames {first} to {last}, expected the first one not after the last")]
    FrameOrder {
        /// Name of the part.
        part: String,
        /// The first frame given.
        first: FrameNumber,
        /// The last frame given.
        last: FrameNumber,
    },
    /// The footage has no picture on that frame.
    #[error("part {part:?}: frame {frame} is outside the footage, which has frames {first} to {last}")]
    OutsideFootage {
        /// Name of the part.
        part: String,
        /// The requested frame.
        frame: FrameNumber,
        /// First frame of the footage.
        first: FrameNumber,
        /// Last frame of the footage.
        last: FrameNumber,
    },
}

fn part_mut<'a>(scene: &'a mut Scene, name: &str) -> Result<&'a mut Part, EditError> {
    let index = scene.part_index(name)?;
    Ok(&mut scene.parts[index])
}

/// Sets the artist's contour of a part on a frame. `coordinates` are x, y, x, y, ... in pixels.
///
/// Corrections on the frame are removed. If the part's only key gets another number of points, the part loses all
/// corrections and results, because they belong to points that no longer exist. A part whose last key was removed keeps its corrections if the new
/// key has their points.
pub fn set_key(scene: &mut Scene, name: &str, frame: FrameNumber, coordinates: &[f64]) -> Result<(), EditError> {
    let (first, last) = (scene.footage.first, scene.footage.last);
    let part = part_mut(scene, name)?;
    if !(first..=last).contains(&frame) {
        return Err(EditError::OutsideFootage { part: name.into(), frame, first, last });
    }
    let points = key_points(part, frame, coordinates)?;
    let pinned = part.pins.values().filter_map(|pins| pins.keys().next_back()).max();
    let fits = match part.keys.is_empty() {
        true => pinned.is_none_or(|&last| last < points.len()),
        false => points.len() == part.point_count(),
    };
    if !fits {
        part.pins.clear();
        part.centers.clear();
    }
    // Results beside no key, which a document may have, are not those of the new one.
    if !fits || part.keys.is_empty() {
        forget_results(part, |_| true);
    }
    part.pins.remove(&frame);
    part.centers.remove(&frame);
    part.curves.remove(&frame);
    if let Some(track) = part.tracks.get_mut(&frame) {
        track.clone_from(&points);
        part.confidence.insert(frame, vec![1.0; points.len()]);
    }
    part.keys.insert(frame, points);
    part.wants_key.clear();
    if part.keys.len() == 2 {
        // Tracking from a single key reaches beyond the two keys. Those results are no longer valid.
        forget_outside_keys(part);
    }
    Ok(())
}

fn key_points(part: &Part, frame: FrameNumber, coordinates: &[f64]) -> Result<Vec<Point>, EditError> {
    let name = || part.name.clone();
    let (pairs, rest) = coordinates.as_chunks::<2>();
    if !rest.is_empty() {
        return Err(EditError::OddCoordinates { part: name(), frame, found: coordinates.len() });
    }
    let points: Vec<Point> = pairs.iter().map(|&pair| Point::from(pair)).collect();
    let others = part.keys.iter().find(|(other, _)| **other != frame).map(|(other, key)| (other, key.len()));
    let expected = match others {
        _ if points.is_empty() => "at least 1".into(),
        Some((other, count)) if count != points.len() => format!("{count} as on frame {other}"),
        _ => String::new(),
    };
    if !expected.is_empty() {
        return Err(EditError::PointCount { part: name(), frame, found: points.len(), expected });
    }
    for (index, point) in points.iter().enumerate() {
        check_point(part, frame, index, *point)?;
    }
    Ok(points)
}

fn check_point(part: &Part, frame: FrameNumber, index: usize, point: Point) -> Result<(), EditError> {
    // The comparison is false for NaN, so NaN is refused too.
    if point.x.abs() <= MAX_COORDINATE && point.y.abs() <= MAX_COORDINATE {
        return Ok(());
    }
    Err(EditError::Coordinate { part: part.name.clone(), frame, index, x: point.x, y: point.y })
}

/// Removes a key, and the results on frames that are no longer between keys.
pub fn remove_key(scene: &mut Scene, name: &str, frame: FrameNumber) -> Result<(), EditError> {
    let part = part_mut(scene, name)?;
    part.keys.remove(&frame).ok_or_else(|| EditError::NoSuchKey { part: name.into(), frame })?;
    part.wants_key.clear();
    forget_outside_keys(part);
    Ok(())
}

fn forget_outside_keys(part: &mut Part) {
    let range = part.keys.keys().next().copied().zip(part.keys.keys().next_back().copied());
    forget_results(part, |frame| range.is_none_or(|(first, last)| frame < first || frame > last));
}

fn forget_results(part: &mut Part, forget: impl Fn(FrameNumber) -> bool) {
    part.tracks.retain(|frame, _| !forget(*frame));
    part.confidence.retain(|frame, _| !forget(*frame));
    part.curves.retain(|frame, _| !forget(*frame));
}

/// Refuses a correction that would have no effect. A correction needs a frame between two keys, or, if the part has a
/// single key, any other frame of the footage.
fn check_correctable(scene: &Scene, name: &str, frame: FrameNumber) -> Result<(), EditError> {
    let (first, last) = (scene.footage.first, scene.footage.last);
    let part = &scene.parts[scene.part_index(name)?];
    let single = part.keys.len() == 1 && !part.keys.contains_key(&frame);
    if single && !(first..=last).contains(&frame) {
        return Err(EditError::OutsideFootage { part: name.into(), frame, first, last });
    }
    let what = if single {
        return Ok(());
    } else if part.keys.contains_key(&frame) {
        "a key frame, where the key itself is edited"
    } else if part.keys.range(..frame).next().is_none() {
        "before the first key"
    } else if part.keys.range(frame..).next().is_none() {
        "after the last key"
    } else {
        return Ok(());
    };
    Err(EditError::NotBetweenKeys { part: part.name.clone(), frame, what })
}

/// Fixes a control point on a frame between keys, or on any other frame of the footage if the part has a single key.
pub fn pin(scene: &mut Scene, name: &str, frame: FrameNumber, index: i64, point: Point) -> Result<(), EditError> {
    check_correctable(scene, name, frame)?;
    let part = part_mut(scene, name)?;
    let count = part.point_count();
    let known = usize::try_from(index).ok().filter(|index| *index < count);
    let known = known.ok_or_else(|| EditError::NoSuchPoint { part: name.into(), index, count })?;
    check_point(part, frame, known, point)?;
    part.pins.entry(frame).or_default().insert(known, point);
    Ok(())
}

/// Releases a control point on a frame, or all of them with index −1. It is no error if none is fixed.
pub fn unpin(scene: &mut Scene, name: &str, frame: FrameNumber, index: i64) -> Result<(), EditError> {
    let part = part_mut(scene, name)?;
    let count = part.point_count();
    if index < -1 || index >= count as i64 {
        return Err(EditError::NoSuchPoint { part: name.into(), index, count });
    }
    if let Some(pins) = part.pins.get_mut(&frame) {
        pins.retain(|pinned, _| index >= 0 && *pinned as i64 != index);
        if pins.is_empty() {
            part.pins.remove(&frame);
        }
    }
    Ok(())
}

/// Fixes the mean of the control points on a frame between keys, or on any other frame of the footage if the part has
/// a single key.
pub fn set_center(scene: &mut Scene, name: &str, frame: FrameNumber, center: Point) -> Result<(), EditError> {
    check_correctable(scene, name, frame)?;
    let part = part_mut(scene, name)?;
    check_point(part, frame, 0, center)?;
    part.centers.insert(frame, center);
    Ok(())
}

/// Releases the centre on a frame. It is no error if it is not fixed.
pub fn clear_center(scene: &mut Scene, name: &str, frame: FrameNumber) -> Result<(), EditError> {
    part_mut(scene, name)?.centers.remove(&frame);
    Ok(())
}

/// Marks a part as not there on the frames from `first` to `last`, or as there again. Its results on frames without it are
/// removed. Keys stay, and a part is always there on its keys.
pub fn set_absent(
    scene: &mut Scene,
    name: &str,
    [first, last]: [FrameNumber; 2],
    absent: bool,
) -> Result<(), EditError> {
    let (start, end) = (scene.footage.first, scene.footage.last);
    let part = part_mut(scene, name)?;
    if first > last {
        return Err(EditError::FrameOrder { part: name.into(), first, last });
    }
    if let Some(frame) = [first, last].into_iter().find(|frame| !(start..=end).contains(frame)) {
        return Err(EditError::OutsideFootage { part: name.into(), frame, first: start, last: end });
    }
    if absent {
        part.set_absent(first, last);
    } else {
        part.clear_absent(first, last);
    }
    part.forget_where_absent();
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use rototoon::scene::Footage;

    const KEY: [f64; 4] = [1.0, 2.0, 3.0, 4.0];

    fn scene() -> Scene {
        let footage =
            Footage { pattern: "%d.png".into(), first: 0, last: 9, fps: 25.0, width: 8, height: 8, held: false };
        let points = vec![Point::new(0.0, 0.0), Point::new(4.0, 0.0)];
        let keys = [(0, points.clone()), (8, points.clone())].into();
        let tracks = (0..=8).map(|frame| (frame, points.clone())).collect();
        let confidence = (0..=8).map(|frame| (frame, vec![0.5; 2])).collect();
        let part = Part { name: "arm".into(), keys, tracks, confidence, ..Part::default() };
        Scene { footage, parts: vec![part] }
    }

    /// The error message of an edit. Checks that the edit is refused and changes nothing.
    fn refused(edit: impl Fn(&mut Scene) -> Result<(), EditError>) -> String {
        let mut edited = scene();
        let message = edit(&mut edited).unwrap_err().to_string();
        assert_eq!(edited, scene());
        message
    }

    #[test]
    fn key_replaces_corrections_and_track_of_its_frame() {
        let mut scene = scene();
        pin(&mut scene, "arm", 4, 1, Point::ONE).unwrap();
        set_center(&mut scene, "arm", 4, Point::ONE).unwrap();
        set_key(&mut scene, "arm", 4, &KEY).unwrap();
        let part = &scene.parts[0];
        let points = vec![Point::new(1.0, 2.0), Point::new(3.0, 4.0)];
        assert_eq!((&part.keys[&4], &part.tracks[&4], &part.confidence[&4]), (&points, &points, &vec![1.0; 2]));
        assert!(part.pins.is_empty() && part.centers.is_empty());
    }

    #[test]
    fn removing_a_key_removes_the_results_outside_the_remaining_keys() {
        let mut scene = scene();
        set_key(&mut scene, "arm", 4, &KEY).unwrap();
        remove_key(&mut scene, "arm", 8).unwrap();
        assert_eq!(scene.parts[0].tracks.keys().copied().collect::<Vec<_>>(), [0, 1, 2, 3, 4]);
        remove_key(&mut scene, "arm", 0).unwrap();
        remove_key(&mut scene, "arm", 4).unwrap();
        assert!(scene.parts[0].tracks.is_empty() && scene.parts[0].confidence.is_empty());
    }

    #[test]
    fn pins_are_set_and_released() {
        let mut scene = scene();
        for index in 0..2 {
            pin(&mut scene, "arm", 3, index, Point::ONE).unwrap();
        }
        unpin(&mut scene, "arm", 3, 0).unwrap();
        assert_eq!(scene.parts[0].pins[&3].keys().copied().collect::<Vec<_>>(), [1]);
        pin(&mut scene, "arm", 3, 0, Point::ONE).unwrap();
        unpin(&mut scene, "arm", 3, -1).unwrap();
        unpin(&mut scene, "arm", 3, -1).unwrap();
        assert!(scene.parts[0].pins.is_empty());
    }

    #[test]
    fn beside_a_single_key_any_frame_of_the_footage_takes_corrections() {
        let mut scene = scene();
        remove_key(&mut scene, "arm", 8).unwrap();
        scene.parts[0].tracks.insert(1, vec![Point::ZERO; 2]);
        scene.parts[0].wants_key = vec![5];
        pin(&mut scene, "arm", 9, 0, Point::ONE).unwrap();
        set_center(&mut scene, "arm", 2, Point::ONE).unwrap();
        let message = pin(&mut scene, "arm", 10, 0, Point::ONE).unwrap_err().to_string();
        assert!(message.contains("outside the footage"), "{message}");
        let message = pin(&mut scene, "arm", 0, 0, Point::ONE).unwrap_err().to_string();
        assert!(message.contains("frame 0 is a key"), "{message}");
        set_key(&mut scene, "arm", 4, &KEY).unwrap();
        assert!(scene.parts[0].wants_key.is_empty());
        set_key(&mut scene, "arm", 0, &KEY).unwrap();
        assert_eq!(scene.parts[0].tracks.keys().copied().collect::<Vec<_>>(), [0, 1], "between its keys now");
    }

    #[test]
    fn only_key_may_change_its_number_of_points() {
        let mut scene = scene();
        remove_key(&mut scene, "arm", 8).unwrap();
        set_key(&mut scene, "arm", 0, &[1.0, 2.0]).unwrap();
        assert_eq!(scene.parts[0].point_count(), 1);
        assert!(scene.parts[0].tracks.is_empty());
    }

    #[test]
    fn results_without_a_key_do_not_stay_beside_a_new_one() {
        let mut scene = scene();
        scene.parts[0].keys.clear();
        set_key(&mut scene, "arm", 4, &KEY[..2]).unwrap();
        let part = &scene.parts[0];
        assert!(part.point_count() == 1 && part.tracks.is_empty() && part.confidence.is_empty());
    }

    #[test]
    fn a_part_loses_its_results_where_it_is_absent_but_not_its_keys() {
        let mut scene = scene();
        scene.parts[0].wants_key = vec![5, 9];
        set_absent(&mut scene, "arm", [5, 9], true).unwrap();
        let part = &scene.parts[0];
        assert_eq!(part.absent, [[5, 9]]);
        assert_eq!(part.tracks.keys().copied().collect::<Vec<_>>(), [0, 1, 2, 3, 4, 8], "8 is a key");
        assert!(part.wants_key.is_empty() && part.confidence.len() == 6 && part.keys.len() == 2);
        set_absent(&mut scene, "arm", [6, 9], false).unwrap();
        assert_eq!(scene.parts[0].absent, [[5, 5]]);
    }

    #[test]
    fn refusals_name_part_frame_and_expectation() {
        let cases = [
            (refused(|s| set_key(s, "leg", 0, &KEY)), r#"no part "leg"; the document has "arm""#),
            (refused(|s| set_key(s, "arm", 10, &KEY)), "frame 10 is outside the footage, which has frames 0 to 9"),
            (refused(|s| set_key(s, "arm", 4, &KEY[..2])), "key on frame 4: found 1 point, expected 2 as on frame 0"),
            (refused(|s| set_key(s, "arm", 4, &[])), "found 0 points, expected at least 1"),
            (refused(|s| set_key(s, "arm", 4, &KEY[..3])), "found 3 coordinates, expected an even number"),
            (refused(|s| set_key(s, "arm", 4, &[0.0, 0.0, f64::NAN, 0.0])), "frame 4, point 1: found (NaN, 0)"),
            (refused(|s| remove_key(s, "arm", 4)), "no key on frame 4"),
            (refused(|s| pin(s, "arm", 8, 0, Point::ONE)), "frame 8 is a key frame, where the key itself is edited;"),
            (refused(|s| pin(s, "arm", 9, 0, Point::ONE)), "frame 9 is after the last key"),
            (refused(|s| pin(s, "arm", -1, 0, Point::ONE)), "frame -1 is before the first key"),
            (refused(|s| pin(s, "arm", 4, 2, Point::ONE)), "no point 2; it has 2, counted from 0"),
            (refused(|s| pin(s, "arm", 4, -1, Point::ONE)), "no point -1"),
            (refused(|s| pin(s, "arm", 4, 0, Point::INFINITY)), "found (inf, inf), expected pixels"),
            (refused(|s| unpin(s, "arm", 4, -2)), "no point -2"),
            (refused(|s| set_center(s, "arm", 0, Point::ONE)), "frame 0 is a key"),
            (refused(|s| set_center(s, "arm", 4, Point::NAN)), "found (NaN, NaN)"),
            (refused(|s| set_absent(s, "arm", [4, 3], true)), "found frames 4 to 3, expected the first one not after"),
            (refused(|s| set_absent(s, "arm", [4, 10], true)), "frame 10 is outside the footage"),
            (refused(|s| clear_center(s, "leg", 4)), r#"no part "leg""#),
        ];
        for (message, expected) in cases {
            assert!(message.contains(expected), "{message:?} should say {expected:?}");
        }
    }
}
