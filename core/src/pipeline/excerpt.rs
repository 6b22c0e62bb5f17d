//! An excerpt of a document for other programs: some of its parts, some of its frames, and other numbers for the frames.
//!
//! Plates of films commonly begin on frame 1001 or 86400, and drawings on 1. The offset is what is added to a frame of the document to get
//! the frame of the other program. So an import subtracts it ([`super::import_shifted`]).
//!
//! - Parts that were not asked for stay in their places without contours. So the others keep colours and numbers, which come from
//!   their place in the document. No form writes a part without contours.
//! - Other programs move the shapes of a part that has nothing but keys from key to key. Where the excerpt ends between two keys, the
//!   part gets the contour that such a program shows there.
//! - Drawings, strokes and painted regions stay as they are. An export writes those on frames of the footage, which is shorter here.

use super::{PipelineError, frames_of};
use crate::geometry::Point;
use crate::project::Document;
use crate::project::schema::MAX_FRAME_NUMBER;
use crate::scene::{Footage, FrameNumber, Part};
use std::collections::BTreeMap;
use std::ops::RangeInclusive;

/// What is taken of a document.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Excerpt {
    /// Names of the parts; `None` takes all.
    pub parts: Option<Vec<String>>,
    /// The frames, in the numbers of the document; `None` takes all of the footage.
    pub frames: Option<RangeInclusive<FrameNumber>>,
    /// What is added to the numbers of the frames.
    pub offset: FrameNumber,
}

/// The excerpt as a document of its own.
///
/// # Errors
///
/// [`PipelineError::Option`] if there is no such part, if frames are not of the footage, or if the new numbers are too large.
pub fn excerpt(document: &Document, asked: &Excerpt) -> Result<Document, PipelineError> {
    let mut document = document.clone();
    if let Some(names) = &asked.parts {
        let indices = super::render::indices(&document.scene, names)?;
        for (_, part) in document.scene.parts.iter_mut().enumerate().filter(|(index, _)| !indices.contains(index)) {
            *part = Part { name: std::mem::take(&mut part.name), ..Part::default() };
        }
    }
    let range = frames_of(&document.scene.footage, asked.frames.clone())?;
    (document.scene.footage.first, document.scene.footage.last) = (*range.start(), *range.end());
    if asked.frames.is_some() {
        document.scene.parts.iter_mut().for_each(|part| cut(part, &range));
    }
    document.scene.footage = shifted(&document.scene.footage, asked.offset)?;
    if asked.offset != 0 {
        document.scene.parts.iter_mut().for_each(|part| part.shift(asked.offset));
    }
    Ok(document)
}

/// A footage with the numbers that its frames have in another program.
///
/// # Errors
///
/// [`PipelineError::Option`] if they are too large.
pub(super) fn shifted(footage: &Footage, offset: FrameNumber) -> Result<Footage, PipelineError> {
    let moved = |frame: FrameNumber| {
        let sum = i64::from(frame) + i64::from(offset);
        let number = FrameNumber::try_from(sum).ok().filter(|_| sum.abs() <= MAX_FRAME_NUMBER);
        number.ok_or_else(|| {
            let reason =
                format!("found {offset}: frame {frame} becomes {sum}, expected at most {MAX_FRAME_NUMBER} away from 0");
            PipelineError::option("frame-offset", reason)
        })
    };
    Ok(Footage { first: moved(footage.first)?, last: moved(footage.last)?, ..footage.clone() })
}

/// Leaves a part its contours on the frames of a range.
fn cut(part: &mut Part, range: &RangeInclusive<FrameNumber>) {
    let all = part.keys.clone();
    let ends = [range.clone().find(|&f| !part.is_absent(f)), range.clone().rev().find(|&f| !part.is_absent(f))];
    fn keep<T>(map: &mut BTreeMap<FrameNumber, T>, range: &RangeInclusive<FrameNumber>) {
        map.retain(|frame, _| range.contains(frame));
    }
    keep(&mut part.keys, range);
    if part.tracks.is_empty() {
        for end in ends.into_iter().flatten() {
            part.keys.extend(between(&all, end).map(|points| (end, points)));
        }
    }
    keep(&mut part.tracks, range);
    // The number of a part's points is that of its keys. Without one its snapped paths would belong to nothing.
    if part.keys.is_empty()
        && let Some((frame, points)) = part.tracks.first_key_value()
    {
        part.keys.insert(*frame, points.clone());
    }
    keep(&mut part.confidence, range);
    keep(&mut part.curves, range);
}

/// The contour on the even way between two keys; `None` on a key and outside of all.
fn between(keys: &BTreeMap<FrameNumber, Vec<Point>>, frame: FrameNumber) -> Option<Vec<Point>> {
    let ((from, a), (to, b)) = (keys.range(..frame).next_back()?, keys.range(frame..).next()?);
    let share = (f64::from(frame) - f64::from(*from)) / (f64::from(*to) - f64::from(*from));
    (*to > frame && a.len() == b.len()).then(|| a.iter().zip(b).map(|(a, b)| a.lerp(*b, share)).collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::export;
    use crate::pipeline::{ShapeFormat, import_shifted};
    use crate::scene::Scene;

    fn square(left: f64) -> Vec<Point> {
        [(0.0, 0.0), (8.0, 0.0), (8.0, 8.0), (0.0, 8.0)].map(|(x, y)| Point::new(left + x, 10.0 + y)).to_vec()
    }

    fn document() -> Document {
        let on = |frames: &[FrameNumber]| frames.iter().map(|&f| (f, square(f64::from(f)))).collect();
        let part = |name: &str, keys: &[FrameNumber], tracks: &[FrameNumber]| Part {
            name: name.into(),
            closed: true,
            keys: on(keys),
            tracks: on(tracks),
            ..Part::default()
        };
        let mut keyed = part("keyed", &[1, 9], &[]);
        keyed.absent = vec![[6, 7]];
        let parts = vec![keyed, part("tracked", &[1, 4], &[1, 2, 3, 4]), part("late", &[8, 9], &[8, 9])];
        let footage =
            Footage { pattern: "%d.png".into(), first: 1, last: 9, fps: 24.0, width: 64, height: 48, held: false };
        Document::new(Scene { footage, parts })
    }

    fn taken(parts: Option<&[&str]>, frames: Option<RangeInclusive<FrameNumber>>, offset: FrameNumber) -> Excerpt {
        Excerpt { parts: parts.map(|names| names.iter().map(ToString::to_string).collect()), frames, offset }
    }

    fn frames(part: &Part) -> Vec<FrameNumber> {
        part.keys.keys().chain(part.tracks.keys()).copied().collect()
    }

    #[test]
    fn parts_that_are_not_asked_for_have_no_contours_and_leave_the_others_their_colours() {
        let (whole, some) = (document(), excerpt(&document(), &taken(Some(&["late"]), None, 0)).unwrap());
        let contours: Vec<usize> = some.scene.parts.iter().map(|part| frames(part).len()).collect();
        assert_eq!((some.scene.parts.len(), contours), (3, vec![0, 0, 4]));
        let text = export::svg(&some.scene, &export::SvgOptions::default());
        let whole = export::svg(&whole.scene, &export::SvgOptions::default());
        let own = |text: &str| text.split("<path ").find(|path| path.contains("<title>late")).unwrap().to_owned();
        assert_eq!((own(&text), text.matches("<path ").count()), (own(&whole), 1));
        let error = excerpt(&document(), &taken(Some(&["leg"]), None, 0)).unwrap_err().to_string();
        assert!(error.starts_with("parts: no part \"leg\"") && error.contains("\"tracked\""), "{error}");
    }

    #[test]
    fn a_snapped_part_follows_its_paths_between_its_keys_too() {
        let mut whole = document();
        let paths = |left: f64| {
            let corners = square(left);
            let bent = |k: usize| vec![corners[k], corners[k] + Point::new(1.0, 2.0), corners[(k + 1) % 4]];
            (0..4).map(bent).collect::<Vec<_>>()
        };
        whole.scene.parts[1].curves = (1..=4).map(|frame| (frame, paths(f64::from(frame)))).collect();
        for frames in [2..=2, 2..=3, 3..=4] {
            let some = excerpt(&whole, &taken(None, Some(frames.clone()), 0)).unwrap();
            for frame in frames {
                let [own, of_all] = [&some, &whole].map(|document| document.scene.parts[1].outline(frame));
                assert_eq!((own.as_ref().map(Vec::len), own), (Some(8), of_all), "{frame}");
            }
        }
    }

    #[test]
    fn an_excerpt_between_keys_begins_and_ends_with_the_form_there() {
        let some = excerpt(&document(), &taken(None, Some(3..=7), 0)).unwrap();
        assert_eq!((some.scene.footage.first, some.scene.footage.last), (3, 7));
        // On 6 and 7 the part is not there, so its last contour is that of 5.
        assert_eq!(frames(&some.scene.parts[0]), [3, 5]);
        assert_eq!(some.scene.parts[0].keys[&3], square(3.0));
        assert_eq!(frames(&some.scene.parts[1]), [4, 3, 4], "a tracked part has its own contours");
        assert!(frames(&some.scene.parts[2]).is_empty());
        assert!(excerpt(&document(), &taken(None, Some(3..=10), 0)).unwrap_err().to_string().starts_with("frames: "));
    }

    #[test]
    fn what_goes_out_with_an_offset_comes_in_with_it() {
        for offset in [0, 1000, -5] {
            let out = excerpt(&document(), &taken(None, None, offset)).unwrap();
            let keys = |document: &Document| {
                document.scene.parts.iter().map(|p| (p.keys.clone(), p.absent.clone())).collect::<Vec<_>>()
            };
            for (text, format) in [
                (export::nuke(&out.scene, 2.0), ShapeFormat::Nuke { still: 1 }),
                (export::natron_project(&out.scene, 2.0), ShapeFormat::Natron { still: 1 }),
                (export::silhouette(&out.scene, 2.0), ShapeFormat::Silhouette),
            ] {
                let mut found = document();
                assert_eq!(
                    import_shifted(&mut found, &text, format, offset).unwrap().warnings,
                    [""; 0],
                    "{offset} {format:?}"
                );
                assert_eq!((found.scene.footage.first, found.scene.footage.last), (1, 9));
                let mut plain = document();
                let own = excerpt(&document(), &Excerpt::default()).unwrap();
                let text = match format {
                    ShapeFormat::Nuke { .. } => export::nuke(&own.scene, 2.0),
                    ShapeFormat::Natron { .. } => export::natron_project(&own.scene, 2.0),
                    _ => export::silhouette(&own.scene, 2.0),
                };
                import_shifted(&mut plain, &text, format, 0).unwrap();
                assert_eq!(keys(&found), keys(&plain), "{offset} {format:?}");
            }
        }
        let out = excerpt(&document(), &taken(None, None, 1000)).unwrap();
        assert_eq!(frames(&out.scene.parts[2]), [1008, 1009, 1008, 1009]);
        assert!(export::silhouette(&out.scene, 2.0).contains("sessionStartFrame=\"1001\""));
        assert!(export::natron(&out.scene, 2.0).contains("(1008, ["));
    }

    #[test]
    fn an_offset_beyond_the_numbers_of_frames_is_refused() {
        let error = excerpt(&document(), &taken(None, None, 1_000_000_000)).unwrap_err().to_string();
        assert!(error.starts_with("frame-offset: found 1000000000: frame 1 becomes 1000000001, expected"), "{error}");
    }
}
