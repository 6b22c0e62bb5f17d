//! Parts that have no contour on frames between their keys, because they were not tracked there.

use crate::scene::{Part, Scene};

/// Number of parts that a message names.
const NAMED: usize = 5;

/// Whether a part lacks its contour on a frame between its first and its last key on which it is there.
fn is_untracked(part: &Part) -> bool {
    let frames = part.keys.keys().next().zip(part.keys.keys().next_back());
    frames.is_some_and(|(&first, &last)| {
        (first..=last).any(|frame| part.points_at(frame).is_none() && !part.is_absent(frame))
    })
}

/// The parts that are drawn on some of their frames only, as a message for the user. `None` if all are tracked.
pub fn untracked(scene: &Scene) -> Option<String> {
    let listed = named(scene.parts.iter().filter(|part| is_untracked(part)))?;
    Some(format!("not tracked on all frames between its keys: {listed}; run `rototoon track` first"))
}

/// The names of parts, as many as a message can take. `None` if there are no parts.
pub(super) fn named<'a>(parts: impl Iterator<Item = &'a Part>) -> Option<String> {
    let names: Vec<String> = parts.map(|part| format!("{:?}", part.name)).collect();
    let more = names.len().saturating_sub(NAMED);
    let listed = names[..names.len() - more].join(", ");
    let more = if more > 0 { format!(" and {more} more") } else { String::new() };
    (!names.is_empty()).then(|| format!("{listed}{more}"))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Point;
    use crate::scene::{Footage, FrameNumber};

    fn part(name: &str, keys: &[FrameNumber], tracks: &[FrameNumber]) -> Part {
        let on = |frames: &[FrameNumber]| frames.iter().map(|&frame| (frame, vec![Point::ZERO; 3])).collect();
        Part { name: name.into(), closed: true, keys: on(keys), tracks: on(tracks), ..Part::default() }
    }

    fn told(parts: Vec<Part>) -> Option<String> {
        let footage =
            Footage { pattern: "%d.png".into(), first: 0, last: 9, fps: 12.0, width: 64, height: 48, held: false };
        untracked(&Scene { footage, parts })
    }

    #[test]
    fn parts_that_lack_a_contour_between_keys_are_named() {
        let hidden = Part { absent: vec![[1, 3]], ..part("hidden", &[0, 4], &[]) };
        assert_eq!(
            told(vec![part("tracked", &[0, 3], &[1, 2]), part("next", &[4, 5], &[]), part("one", &[2], &[]), hidden]),
            None
        );
        let said = told(vec![part("arm", &[0, 3], &[2]), part("leg", &[0, 2], &[])]).unwrap();
        assert!(said.contains(r#"keys: "arm", "leg"; run"#), "{said}");
        let many = (0..7).map(|k| part(&k.to_string(), &[0, 2], &[])).collect();
        assert!(told(many).unwrap().contains(r#""4" and 2 more; run"#));
    }
}
