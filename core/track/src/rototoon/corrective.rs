//! Corrective keys: keys that a part has on a frame on which the parts around it have none.
//!
//! **Why.** Artists key a character as a whole on a few frames. Later they draw a single part anew on a frame, because it is
//! wrong there. If such a key ended a span as every other key does, the part would lose what holds it to its body, which has
//! no key there, and its neighbours would lose what holds them to it. On 13 films a correct new key of one part made the
//! other drawings worse in the mean.
//!
//! **How.** A key is corrective if fewer than half of the parts that touch its part, and that are followed through its frame,
//! have a key there. If nothing touches it, all other parts count. All parts are tracked first with corrective keys as complete corrections, within the span that they
//! share with their neighbours. Then the part is tracked between all of its keys while the other parts stay
//! ([`finer`](super::finer)). So a key acts on what it explains.
//!
//! A correction that pins each control point is drawn by the artist too, as when a contour is moved as a whole. So it is the same
//! as a corrective key, whatever other parts have on its frame.
//!
//! **Limits.** A single part has no corrective keys. Nor has a part that is absent between the two keys around
//! the frame: it need not be the same drawing before and after.

use rototoon_base::geometry::{Point, polygon};
use rototoon_base::scene::{FrameNumber, Part, Scene};
use std::collections::{BTreeMap, BTreeSet};

/// The frames of corrective keys, by index of the part. Parts without any are not in it.
pub(super) type Corrective = BTreeMap<usize, BTreeSet<FrameNumber>>;

/// The corrective keys of a scene.
pub(super) fn found(scene: &Scene) -> Corrective {
    let of_part = |p: usize| {
        let part = &scene.parts[p];
        let mut around = None;
        let frames: BTreeSet<FrameNumber> = within(part)
            .filter(|&frame| {
                let around = around.get_or_insert_with(|| neighbours(scene, p));
                let followed: Vec<&&Part> = around.iter().filter(|other| is_followed(other, frame)).collect();
                let keyed = followed.iter().filter(|other| other.keys.contains_key(&frame)).count();
                2 * keyed < followed.len() && !is_absent_around(part, frame)
            })
            .collect();
        (p, frames)
    };
    (0..scene.parts.len()).map(of_part).filter(|(_, frames)| !frames.is_empty()).collect()
}

/// The scene with corrective keys as complete corrections. It has the artist's input only, no tracks.
pub(super) fn as_corrections(scene: &Scene, corrective: &Corrective) -> Scene {
    let of_part = |(p, part): (usize, &Part)| {
        let mut bare = Part {
            name: part.name.clone(),
            closed: part.closed,
            depth: part.depth,
            keys: part.keys.clone(),
            pins: part.pins.clone(),
            centers: part.centers.clone(),
            depths: part.depths.clone(),
            absent: part.absent.clone(),
            ..Part::default()
        };
        for frame in corrective.get(&p).into_iter().flatten() {
            if let Some(points) = bare.keys.remove(frame) {
                bare.pins.insert(*frame, points.into_iter().enumerate().collect());
                bare.centers.remove(frame);
            }
        }
        bare
    };
    Scene { footage: scene.footage.clone(), parts: scene.parts.iter().enumerate().map(of_part).collect() }
}

/// The scene with complete corrections as keys: on these frames each control point is pinned. `None` if there are none. Like
/// corrective keys they are between two keys, and the part is not absent around them.
pub(super) fn completed(scene: &Scene) -> Option<Scene> {
    let complete = |part: &Part| -> Vec<(FrameNumber, Vec<Point>)> {
        let (Some((&first, _)), Some((&last, _))) = (part.keys.first_key_value(), part.keys.last_key_value()) else {
            return Vec::new();
        };
        let between = part.pins.iter().filter(|(frame, _)| first < **frame && **frame < last);
        let free = between.filter(|(frame, _)| !part.keys.contains_key(frame) && !is_absent_around(part, **frame));
        let all = free.filter(|(_, pins)| pins.len() == part.point_count());
        all.map(|(&frame, pins)| (frame, pins.values().copied().collect())).collect()
    };
    let found: Vec<_> = scene.parts.iter().map(complete).collect();
    if found.iter().all(Vec::is_empty) {
        return None;
    }
    let mut all = as_corrections(scene, &Corrective::new());
    for (part, keys) in all.parts.iter_mut().zip(found) {
        for (frame, points) in keys {
            part.pins.remove(&frame);
            part.centers.remove(&frame);
            part.keys.insert(frame, points);
        }
    }
    Some(all)
}

/// The frames of a part's keys but for the first and the last one.
fn within(part: &Part) -> impl Iterator<Item = FrameNumber> {
    part.keys.keys().copied().skip(1).take(part.keys.len().saturating_sub(2))
}

/// The parts around a part: those that touch it, or all others if none does. Two parts touch if the boxes around their contours
/// share a point on a frame on which both have keys.
fn neighbours(scene: &Scene, p: usize) -> Vec<&Part> {
    let part = &scene.parts[p];
    let touches = |other: &&Part| {
        part.keys.iter().any(|(frame, points)| {
            let boxes = (polygon::bounds(points), other.keys.get(frame).and_then(|points| polygon::bounds(points)));
            let (Some((low, high)), Some((a, b))) = boxes else { return false };
            a.x <= high.x && a.y <= high.y && b.x >= low.x && b.y >= low.y
        })
    };
    let others: Vec<&Part> = scene.parts.iter().enumerate().filter(|(q, _)| *q != p).map(|(_, other)| other).collect();
    let touching: Vec<&Part> = others.iter().copied().filter(touches).collect();
    if touching.is_empty() { others } else { touching }
}

/// Whether a part has a key on a frame, or keys before and after it.
fn is_followed(part: &Part, frame: FrameNumber) -> bool {
    part.keys.contains_key(&frame)
        || (part.keys.range(..frame).next().is_some() && part.keys.range(frame..).next().is_some())
}

/// Whether a part is absent somewhere between the keys before and after a frame.
fn is_absent_around(part: &Part, frame: FrameNumber) -> bool {
    let before = part.keys.range(..frame).next_back().map_or(frame, |(&before, _)| before);
    let after = part.keys.range(frame + 1..).next().map_or(frame, |(&after, _)| after);
    part.absent.iter().any(|&[first, last]| first <= after && last >= before)
}

#[cfg(test)]
mod tests {
    use super::*;
    use rototoon_base::scene::Footage;

    /// A square at this place with keys on these frames.
    fn part(at: f64, frames: &[FrameNumber]) -> Part {
        let square = [(0.0, 0.0), (10.0, 0.0), (10.0, 10.0), (0.0, 10.0)].map(|(x, y)| Point::new(x + at, y)).to_vec();
        let keys = frames.iter().map(|&frame| (frame, square.clone())).collect();
        Part { name: format!("at {at}"), closed: true, keys, ..Part::default() }
    }

    fn scene(parts: Vec<Part>) -> Scene {
        let footage =
            Footage { pattern: "%d.png".into(), first: 0, last: 20, fps: 12.0, width: 64, height: 48, held: false };
        Scene { footage, parts }
    }

    fn keys(parts: Vec<Part>) -> Vec<(usize, Vec<FrameNumber>)> {
        found(&scene(parts)).into_iter().map(|(p, frames)| (p, frames.into_iter().collect())).collect()
    }

    #[test]
    fn a_key_that_the_body_has_not_is_corrective() {
        let body = || [part(5.0, &[0, 10, 20]), part(8.0, &[0, 10, 20])];
        let with = |own: Part| keys([own].into_iter().chain(body()).collect());
        assert_eq!(with(part(0.0, &[0, 4, 10, 15, 20])), [(0, vec![4, 15])]);
        assert_eq!(with(part(0.0, &[0, 10, 20])), []);
        // Its first and its last key end its track.
        assert_eq!(with(part(0.0, &[4, 10, 15])), []);
    }

    #[test]
    fn a_key_that_half_of_the_neighbours_have_is_none() {
        assert_eq!(keys(vec![part(0.0, &[0, 4, 9]), part(5.0, &[0, 4, 9]), part(8.0, &[0, 9])]), []);
        let three = vec![part(0.0, &[0, 4, 9]), part(5.0, &[0, 4, 9]), part(7.0, &[0, 9]), part(8.0, &[0, 9])];
        assert_eq!(keys(three), [(0, vec![4]), (1, vec![4])]);
    }

    #[test]
    fn parts_that_touch_count_and_all_others_if_none_does() {
        // A second character far away has no key there.
        let apart = || [part(100.0, &[0, 9]), part(105.0, &[0, 9]), part(108.0, &[0, 9])];
        let with = |own: Vec<Part>| keys(own.into_iter().chain(apart()).collect());
        assert_eq!(with(vec![part(0.0, &[0, 4, 9]), part(5.0, &[0, 4, 9])]), []);
        assert_eq!(with(vec![part(0.0, &[0, 4, 9])]), [(0, vec![4])]);
        assert_eq!(keys(vec![part(0.0, &[0, 4, 9])]), []);
    }

    #[test]
    fn parts_that_are_not_followed_through_the_frame_do_not_count() {
        assert_eq!(keys(vec![part(0.0, &[0, 4, 9]), part(5.0, &[0]), part(6.0, &[5, 9])]), []);
        assert_eq!(keys(vec![part(0.0, &[0, 4, 9]), part(5.0, &[0, 9]), part(6.0, &[5, 9])]), [(0, vec![4])]);
    }

    #[test]
    fn keys_around_a_time_of_absence_are_none() {
        let absent = |range: [FrameNumber; 2]| {
            let own = Part { absent: vec![range], ..part(0.0, &[0, 4, 9, 15, 20]) };
            keys(vec![own, part(5.0, &[0, 20])])
        };
        assert_eq!(absent([5, 8]), [(0, vec![15])]);
        assert_eq!(absent([16, 17]), [(0, vec![4, 9])]);
    }

    #[test]
    fn a_complete_correction_is_a_key() {
        let all = |count: usize| (0..count).map(|k| (k, Point::splat(k as f64))).collect::<BTreeMap<_, _>>();
        let mut own = part(0.0, &[0, 9]);
        own.pins = BTreeMap::from([(2, all(3)), (4, all(4)), (9, all(4)), (12, all(4))]);
        own.centers = BTreeMap::from([(4, Point::ZERO)]);
        let complete = completed(&scene(vec![own.clone(), part(5.0, &[0, 9])])).expect("frame 4 is complete");
        let [found, other] = &complete.parts[..] else { panic!("two parts") };
        assert_eq!(found.keys.keys().copied().collect::<Vec<_>>(), [0, 4, 9]);
        assert_eq!(found.keys[&4], (0..4).map(|k| Point::splat(f64::from(k))).collect::<Vec<_>>());
        assert_eq!(found.pins.keys().copied().collect::<Vec<_>>(), [2, 9, 12]);
        assert!(found.centers.is_empty() && *other == part(5.0, &[0, 9]));
        own.absent = vec![[5, 6]];
        assert_eq!(completed(&scene(vec![own])), None);
    }

    #[test]
    fn corrections_are_complete_and_other_input_stays() {
        let mut own = part(0.0, &[0, 4, 9]);
        own.pins.insert(2, BTreeMap::from([(1, Point::ZERO)]));
        own.centers = BTreeMap::from([(4, Point::ZERO), (5, Point::ONE)]);
        own.tracks.insert(3, vec![Point::ZERO; 4]);
        let before = scene(vec![own.clone(), part(5.0, &[0, 9])]);
        let after = as_corrections(&before, &found(&before));
        let broad = &after.parts[0];
        assert_eq!(broad.keys.keys().copied().collect::<Vec<_>>(), [0, 9]);
        assert_eq!(broad.pins[&4].values().copied().collect::<Vec<_>>(), own.keys[&4]);
        assert_eq!((&broad.pins[&2], broad.pins.len()), (&own.pins[&2], 2));
        assert_eq!(broad.centers, BTreeMap::from([(5, Point::ONE)]));
        assert!(broad.tracks.is_empty());
        assert_eq!(after.parts[1], before.parts[1]);
    }
}
