//! Brings a part nearer to the viewer, or farther away, past the next part.
//!
//! The order is that of the picture: by depth, and of parts of equal depth by their place in the document. As a rule only
//! the part's own depth changes. Where it does not fit between two others, because they have the same depth or nearly so,
//! all that lies beyond makes room by one. That keeps every other order, also that of depths of single frames.

use super::Refused;
use rototoon::project::Document;
use rototoon::scene::{FrameNumber, Part, Scene};

/// Least distance of depths between which a part is put.
const ROOM: f64 = 1e-3;

/// Sorts parts by their order on a frame, the farthest first.
pub fn sort_on(scene: &Scene, frame: FrameNumber, parts: &mut [usize]) {
    let depth = |part: usize| scene.parts[part].depth_at(frame);
    parts.sort_by(|&a, &b| depth(a).total_cmp(&depth(b)).then(a.cmp(&b)));
}

/// Indices of the parts, the farthest first, on frames on which no part has a depth of its own.
pub fn farthest_first(scene: &Scene) -> Vec<usize> {
    let mut order: Vec<usize> = (0..scene.parts.len()).collect();
    order.sort_by(|&a, &b| scene.parts[a].depth.total_cmp(&scene.parts[b].depth).then(a.cmp(&b)));
    order
}

/// Moves a part past the part that is next in the picture's order: in front of it if `nearer`, else behind it.
pub fn shift(document: &mut Document, part: usize, nearer: bool) -> Result<(), Refused> {
    let scene = &mut document.scene;
    let mut wanted = farthest_first(scene);
    let place = wanted.iter().position(|&k| k == part).ok_or_else(|| Refused::new("the part is gone"))?;
    let next = if nearer { place.checked_add(1) } else { place.checked_sub(1) };
    let Some(next) = next.filter(|next| *next < wanted.len()) else {
        let (name, end) = (&scene.parts[part].name, if nearer { "nearest" } else { "farthest" });
        return Err(Refused::new(format!("{name:?} is the {end} part already")));
    };
    let passed = wanted[next];
    wanted.swap(place, next);
    let mut beyond = wanted.clone();
    if !nearer {
        beyond.reverse();
    }
    let beyond = beyond.split_off(beyond.iter().position(|&k| k == part).map_or(0, |own| own + 1));
    let limit = scene.parts[passed].depth;
    let room = |parts: &[Part]| beyond.first().is_none_or(|&k| (parts[k].depth - limit).abs() > ROOM);
    if !room(&scene.parts) {
        make_room(&mut scene.parts, &beyond, limit, if nearer { 1.0 } else { -1.0 });
    }
    scene.parts[part].depth = match beyond.first() {
        Some(&other) => between(limit, scene.parts[other].depth),
        None if nearer => limit.floor() + 1.0,
        None => limit.ceil() - 1.0,
    };
    if farthest_first(scene) != wanted || scene.parts.iter().any(|part| !part.depth.is_finite()) {
        let name = &scene.parts[part].name;
        return Err(Refused::new(format!("{name:?} does not fit between two parts: their depths are too large")));
    }
    Ok(())
}

/// Moves a part to a place in the picture's order, counted from the nearest part, which has place 1. Returns whether it moved.
pub fn move_to(document: &mut Document, part: usize, place: usize) -> Result<bool, Refused> {
    let count = document.scene.parts.len();
    let wanted = count.saturating_sub(place.clamp(1, count.max(1)));
    let now = farthest_first(&document.scene).iter().position(|&k| k == part);
    let now = now.ok_or_else(|| Refused::new("the part is gone"))?;
    for _ in 0..now.abs_diff(wanted) {
        shift(document, part, wanted > now)?;
    }
    Ok(now != wanted)
}

/// A depth between two: a whole number if there is one.
fn between(a: f64, b: f64) -> f64 {
    let middle = 0.5 * (a + b);
    let whole = middle.round();
    if whole > a.min(b) && whole < a.max(b) { whole } else { middle }
}

/// Moves what lies beyond a depth by `by`: these parts, and depths of single frames of all parts.
fn make_room(parts: &mut [Part], beyond: &[usize], limit: f64, by: f64) {
    for (index, part) in parts.iter_mut().enumerate() {
        if beyond.contains(&index) {
            part.depth += by;
        }
        for depth in part.depths.values_mut().filter(|depth| (**depth - limit) * by > 0.0) {
            *depth += by;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use rototoon::geometry::Point;
    use rototoon::scene::Footage;

    fn document(depths: &[f64]) -> Document {
        let keys = [(0, vec![Point::ZERO, Point::X, Point::Y])];
        let part = |(k, depth): (usize, &f64)| Part {
            name: format!("part {k}"),
            closed: true,
            depth: *depth,
            keys: keys.clone().into(),
            ..Part::default()
        };
        let footage =
            Footage { pattern: "%d.png".into(), first: 0, last: 9, fps: 24.0, width: 8, height: 8, held: false };
        Document::new(Scene { footage, parts: depths.iter().enumerate().map(part).collect() })
    }

    fn depths(document: &Document) -> Vec<f64> {
        document.scene.parts.iter().map(|part| part.depth).collect()
    }

    #[test]
    fn a_part_passes_the_next_one_in_either_direction() {
        let mut document = document(&[0.0, 1.0, 2.0, 5.0]);
        for (part, nearer, wanted) in [
            (1, true, [0.0, 4.0, 2.0, 5.0]),
            (1, true, [0.0, 6.0, 2.0, 5.0]),
            (1, false, [0.0, 4.0, 2.0, 5.0]),
            (2, false, [0.0, 4.0, -1.0, 5.0]),
        ] {
            shift(&mut document, part, nearer).unwrap();
            assert_eq!(depths(&document), wanted);
        }
        let before = document.clone();
        assert!(shift(&mut document, 3, true).unwrap_err().0.contains("the nearest part already"));
        assert!(shift(&mut document, 2, false).unwrap_err().0.contains("the farthest part already"));
        assert_eq!(depths(&document), depths(&before));
    }

    #[test]
    fn of_parts_of_equal_depth_one_is_passed_and_the_others_make_room() {
        let mut document = document(&[0.0; 4]);
        document.scene.parts[0].depths = [(3, -7.0), (4, 0.0), (5, 2.0)].into();
        shift(&mut document, 1, true).unwrap();
        assert_eq!(depths(&document), [0.0, 0.5, 0.0, 1.0]);
        assert_eq!(document.scene.parts[0].depths, [(3, -7.0), (4, 0.0), (5, 3.0)].into());
        shift(&mut document, 1, false).unwrap();
        assert_eq!(farthest_first(&document.scene), [0, 1, 2, 3]);
    }

    #[test]
    fn a_part_moves_to_a_place_counted_from_the_nearest() {
        let mut document = document(&[0.0, 0.0, 2.0, 5.0]);
        for (part, place, moved, order) in [
            (0, 1, true, [1, 2, 3, 0]),
            (0, 1, false, [1, 2, 3, 0]),
            (3, 4, true, [3, 1, 2, 0]),
            (1, 2, true, [3, 2, 1, 0]),
            (1, 99, true, [1, 3, 2, 0]),
        ] {
            assert_eq!(move_to(&mut document, part, place).unwrap(), moved);
            assert_eq!(farthest_first(&document.scene), order, "{part} to {place}");
        }
        assert!(move_to(&mut document, 9, 1).is_err());
    }

    #[test]
    fn depths_of_single_frames_count_there() {
        let mut document = document(&[2.0, 1.0, 1.0]);
        document.scene.parts[0].depths = [(3, 0.5)].into();
        let on = |frame| {
            let mut parts = vec![2, 0, 1];
            sort_on(&document.scene, frame, &mut parts);
            parts
        };
        assert_eq!((on(2), on(3)), (vec![1, 2, 0], vec![0, 1, 2]));
    }

    #[test]
    fn what_cannot_be_told_apart_is_refused() {
        let mut far = document(&[1e300, 1e300, 1e300]);
        assert!(shift(&mut far, 0, true).unwrap_err().0.contains("too large"));
    }

    proptest! {
        /// The same moves on a list of names, as the naive reference.
        #[test]
        fn many_moves_are_those_of_a_list(
            start in prop::collection::vec(-2i8..3, 2..7),
            moves in prop::collection::vec((0usize..7, any::<bool>()), 0..60),
        ) {
            let mut document = document(&start.iter().map(|&depth| f64::from(depth)).collect::<Vec<_>>());
            let mut list = farthest_first(&document.scene);
            for (part, nearer) in moves.into_iter().filter(|(part, _)| *part < start.len()) {
                let place = list.iter().position(|&k| k == part).unwrap();
                let next = if nearer { place + 1 } else { place.wrapping_sub(1) };
                let done = shift(&mut document, part, nearer);
                prop_assert_eq!(done.is_ok(), next < list.len());
                if next < list.len() {
                    list.swap(place, next);
                }
                prop_assert_eq!(&farthest_first(&document.scene), &list);
            }
        }
    }
}
