//! Frames before a part's first key and after its last one. The part is not there, and pictures show nothing of it.
//!
//! A part that has several keys goes from its first one to its last one. Whoever keys the last drawing of a shot and not its last
//! frame gets empty mattes at the end, which are found late.

use super::report::runs;
use super::untracked::named;
use super::{Picture, RenderJob, frames_of};
use crate::project::Document;
use crate::scene::{FrameNumber, Part, Scene};
use std::collections::BTreeMap;

/// Groups of parts that a message lists.
const LISTED: usize = 4;

/// The parts that end before the footage does, as a message for the user. `None` if there are none.
///
/// Frames on which the artist has marked a part absent do not count.
pub fn beyond(scene: &Scene) -> Option<String> {
    let mut parts: BTreeMap<Vec<FrameNumber>, Vec<&Part>> = BTreeMap::new();
    for part in scene.parts.iter().filter(|part| part.keys.len() > 1) {
        let (Some(&begin), Some(&end)) = (part.keys.keys().next(), part.keys.keys().next_back()) else { continue };
        for (first, last) in
            [(scene.footage.first, begin.saturating_sub(1)), (end.saturating_add(1), scene.footage.last)]
        {
            let lacking: Vec<FrameNumber> = (first..=last).filter(|&frame| lacks(part, frame)).collect();
            if !lacking.is_empty() {
                parts.entry(lacking).or_default().push(part);
            }
        }
    }
    let told: Vec<String> = parts
        .iter()
        .filter_map(|(frames, parts)| Some(format!("{} on {}", named(parts.iter().copied())?, runs(frames))))
        .collect();
    let more = told.len().saturating_sub(LISTED);
    let listed = told[..told.len() - more].join(", ");
    let more = if more > 0 { format!(", and {more} more") } else { String::new() };
    let what = "no contour before the first key and after the last one";
    (!told.is_empty())
        .then(|| format!("{what}: {listed}{more}; a key on the first and on the last frame keeps a part there"))
}

/// The frames of a job on which none of its closed parts has a contour, and the open parts that it asks for, as messages for the user. None for pictures of
/// something else. Frames on which a part is marked absent do not count.
pub fn empty(document: &Document, job: &RenderJob) -> Vec<String> {
    if job.picture.shows_regions() || job.picture.shows_strokes() || matches!(job.picture, Picture::Overlay(_)) {
        return Vec::new();
    }
    let scene = &document.scene;
    let asked = job.parts.as_ref().map(|names| super::render::indices(scene, names)).transpose();
    let (Ok(asked), Ok(range)) = (asked, frames_of(&scene.footage, job.frames.clone())) else { return Vec::new() };
    let is_asked = |index: &usize| asked.as_ref().is_none_or(|indices| indices.contains(index));
    let parts = (0..scene.parts.len()).filter(is_asked).map(|index| &scene.parts[index]);
    let (closed, open): (Vec<&Part>, Vec<&Part>) = parts.partition(|part| part.closed);
    let lacking: Vec<FrameNumber> = range.filter(|&frame| closed.iter().all(|part| lacks(part, frame))).collect();
    let nothing = (!lacking.is_empty())
        .then(|| format!("frames {} show nothing: no closed part has a contour there", runs(&lacking)));
    let open = named(open.into_iter()).filter(|_| asked.is_some());
    let open = open.map(|names| format!("open parts have no area, so nothing of them is shown: {names}"));
    nothing.into_iter().chain(open).collect()
}

/// Whether a part has no contour on a frame on which it is not marked absent.
fn lacks(part: &Part, frame: FrameNumber) -> bool {
    part.points_at(frame).is_none() && !part.is_absent(frame)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Point;
    use crate::render::form::Form;
    use crate::scene::Footage;

    fn document(parts: Vec<Part>) -> Document {
        let footage =
            Footage { pattern: "%d.png".into(), first: 1, last: 20, fps: 12.0, width: 64, height: 48, held: false };
        Document::new(Scene { footage, parts })
    }

    fn part(name: &str, [first, last]: [FrameNumber; 2]) -> Part {
        let points = vec![Point::ZERO, Point::X, Point::Y];
        let on = |frames: Vec<FrameNumber>| frames.into_iter().map(|frame| (frame, points.clone())).collect();
        Part {
            name: name.into(),
            closed: true,
            keys: on(vec![first, last]),
            tracks: on((first..=last).collect()),
            ..Part::default()
        }
    }

    #[test]
    fn parts_that_end_before_the_footage_are_named_with_the_frames() {
        let parts = vec![part("arm", [1, 17]), part("leg", [1, 17]), part("cap", [4, 20]), part("head", [1, 20])];
        let told = beyond(&document(parts).scene).unwrap();
        assert!(told.contains(r#": "cap" on 1-3, "arm", "leg" on 18-20; "#), "{told}");
        let gone = Part { absent: vec![[18, 20]], ..part("arm", [1, 17]) };
        let mut one = part("eye", [3, 4]);
        one.keys.remove(&4);
        assert_eq!(beyond(&document(vec![gone, one, part("head", [1, 20])]).scene), None);
    }

    #[test]
    fn frames_without_any_contour_are_named() {
        let document = document(vec![part("arm", [1, 17]), part("leg", [3, 9])]);
        let job = |frames, parts: Option<&str>| RenderJob {
            picture: Picture::Matte,
            frames,
            offset: 0,
            parts: parts.map(|name| vec![name.to_owned()]),
            scale: 1.0,
            form: Form::default(),
            output: "m.%d.png".into(),
        };
        assert!(empty(&document, &job(Some(1..=17), None)).is_empty());
        let told = empty(&document, &job(None, None)).join("\n");
        assert!(told.starts_with("frames 18-20 show nothing"), "{told}");
        let told = empty(&document, &job(Some(2..=10), Some("leg"))).join("\n");
        assert!(told.starts_with("frames 2, 10 show nothing"), "{told}");
    }

    #[test]
    fn open_parts_show_nothing() {
        let open = |name| Part { closed: false, ..part(name, [1, 20]) };
        let job = |parts: Option<&[&str]>| RenderJob {
            picture: Picture::Matte,
            frames: None,
            offset: 0,
            parts: parts.map(|names| names.iter().map(|name| (*name).to_owned()).collect()),
            scale: 1.0,
            form: Form::default(),
            output: "m.%d.png".into(),
        };
        let nothing = "frames 1-20 show nothing: no closed part has a contour there";
        let sleeve = r#"open parts have no area, so nothing of them is shown: "sleeve""#;
        assert_eq!(empty(&document(vec![open("sleeve")]), &job(None)), [nothing]);
        let document = document(vec![open("sleeve"), part("arm", [1, 20])]);
        assert!(empty(&document, &job(None)).is_empty());
        assert_eq!(empty(&document, &job(Some(&["sleeve"]))), [nothing, sleeve]);
        assert_eq!(empty(&document, &job(Some(&["sleeve", "arm"]))), [sleeve]);
    }
}
