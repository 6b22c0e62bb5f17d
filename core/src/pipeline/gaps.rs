//! Frames of the footage without a picture.
//!
//! Work that needs pictures asks for all of them before it begins: is the file there, is it a picture, and has it the size of the
//! footage? So a gap in a sequence ends the work in its first second, and one message names all gaps. Only the heads of files are read.
//!
//! Limits: a file that ends too early, or has other damage behind its head, is found when it is decoded. `check` decodes all frames.

use super::PipelineError;
use super::report::runs;
use crate::pictures::Sequence;
use crate::project::Document;
use crate::scene::{FrameError, FrameNumber, Scene};
use rayon::iter::{IntoParallelIterator, ParallelIterator};
use std::collections::BTreeSet;
use std::path::Path;

/// A frame without a picture, and why it has none.
pub type Gap = (FrameNumber, FrameError);

/// Checks that there is a picture for each of the frames, which are in their order.
///
/// # Errors
///
/// [`PipelineError::Gaps`] with all frames that have none.
pub(super) fn none(sequence: &Sequence, frames: impl IntoIterator<Item = FrameNumber>) -> Result<(), PipelineError> {
    let frames: Vec<FrameNumber> = frames.into_iter().collect();
    let found = frames.into_par_iter().map(|frame| Some((frame, sequence.probe(frame).err()?)));
    let gaps: Vec<Gap> = found.collect::<Vec<_>>().into_iter().flatten().collect();
    if gaps.is_empty() { Ok(()) } else { Err(PipelineError::Gaps { gaps, drawn: None }) }
}

/// Says which frames of a document in `folder` have no file and show that of an earlier frame, because the footage says that gaps are held. `None` if none do.
/// What is made on such a frame is as good as the drawing that it shows: the artist may have meant another one.
///
/// # Errors
///
/// An invalid pattern.
pub fn held_gaps(document: &Document, folder: &Path) -> Result<Option<String>, PipelineError> {
    let footage = &document.scene.footage;
    let sequence = Sequence::keeping(footage, folder, 0)?;
    let held: Vec<FrameNumber> =
        (footage.first..=footage.last).filter(|&frame| sequence.shown(frame) != frame).collect();
    let (count, all) = (held.len(), i64::from(footage.last) - i64::from(footage.first) + 1);
    let have = if count == 1 { "frame has no file and shows" } else { "frames have no file and show" };
    let told = || format!("footage.gaps: {count} of {all} {have} that of the frame before: {}", runs(&held));
    Ok((count > 0).then(told))
}

/// The frames between the keys of parts, which tracking looks at, also where a part is absent: drawings before and after are compared across them. How far a part
/// with one key is followed is not known before.
pub(super) fn between_keys(scene: &Scene) -> BTreeSet<FrameNumber> {
    let (first, last) = (scene.footage.first, scene.footage.last);
    let frames = scene.parts.iter().flat_map(|part| part.spans().into_iter().flat_map(|span| span.frames()));
    frames.filter(|frame| (first..=last).contains(frame)).collect()
}

/// The frames on which a part has a contour.
pub(super) fn with_contours(scene: &Scene) -> impl Iterator<Item = FrameNumber> {
    let has = |frame: &FrameNumber| scene.parts.iter().any(|part| part.points_at(*frame).is_some());
    (scene.footage.first..=scene.footage.last).filter(has)
}

/// A line for each run of neighbouring frames with the same kind of error: that of the first frame, and how many follow.
pub(super) fn lines(gaps: &[Gap]) -> Vec<String> {
    let same = |a: &Gap, b: &Gap| b.0 == a.0 + 1 && one_cause(&a.1, &b.1);
    let line = |run: &[Gap]| {
        let (_, error) = run.first()?;
        let (last, _) = run.last()?;
        Some(match run.len() - 1 {
            0 => error.to_string(),
            1 => format!("{error} (the same on frame {last})"),
            more => format!("{error} (the same on the next {more} frames, up to {last})"),
        })
    };
    gaps.chunk_by(same).filter_map(line).collect()
}

/// The lines of gaps, and how many of how many frames were drawn nevertheless.
pub(super) fn told(gaps: &[Gap], drawn: Option<[usize; 2]>) -> String {
    let mut lines = lines(gaps);
    lines.extend(drawn.map(|[drawn, all]| match (drawn, all) {
        (0, 1) => "the frame was not drawn".to_owned(),
        (0, _) => format!("none of {all} frames was drawn"),
        (1, _) => format!("1 of {all} frames was drawn; those named are missing"),
        _ => format!("{drawn} of {all} frames were drawn; those named are missing"),
    }));
    lines.join("\n")
}

fn one_cause(a: &FrameError, b: &FrameError) -> bool {
    match (a, b) {
        (FrameError::Missing { .. }, FrameError::Missing { .. }) | (FrameError::Gap { .. }, FrameError::Gap { .. }) => {
            true
        }
        (FrameError::Unreadable { reason, .. }, FrameError::Unreadable { reason: other, .. }) => reason == other,
        (
            FrameError::WrongSize { found_width: width, found_height: height, .. },
            FrameError::WrongSize { found_width, found_height, .. },
        ) => (width, height) == (found_width, found_height),
        _ => false,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Point;
    use crate::scene::{Footage, Part};

    fn part(keys: &[FrameNumber], absent: &[[FrameNumber; 2]]) -> Part {
        let keys = keys.iter().map(|&frame| (frame, vec![Point::ZERO; 3])).collect();
        Part { keys, absent: absent.to_vec(), ..Part::default() }
    }

    #[test]
    fn tracking_needs_all_frames_between_keys() {
        let footage =
            Footage { pattern: "%d.png".into(), first: 0, last: 20, fps: 12.0, width: 64, height: 48, held: false };
        let scene = Scene { footage, parts: vec![part(&[2, 6], &[[4, 4]]), part(&[9], &[]), part(&[19, 22], &[])] };
        assert_eq!(between_keys(&scene).into_iter().collect::<Vec<_>>(), [2, 3, 4, 5, 6, 19, 20]);
        assert_eq!(with_contours(&scene).collect::<Vec<_>>(), [2, 6, 9, 19]);
    }

    #[test]
    fn neighbours_with_one_cause_have_one_line() {
        let missing = |frame| (frame, FrameError::Missing { frame, path: format!("{frame}.png").into() });
        let broken = |frame| {
            (frame, FrameError::Unreadable { frame, path: format!("{frame}.png").into(), reason: "torn".into() })
        };
        let gaps = [missing(1), missing(2), missing(3), broken(4), missing(7), missing(8), missing(11)];
        assert_eq!(
            told(&gaps, Some([5, 12])).lines().collect::<Vec<_>>(),
            [
                "frame 1: no file \"1.png\" (the same on the next 2 frames, up to 3)",
                "frame 4: cannot read \"4.png\": torn",
                "frame 7: no file \"7.png\" (the same on frame 8)",
                "frame 11: no file \"11.png\"",
                "5 of 12 frames were drawn; those named are missing",
            ]
        );
        let last = |drawn| told(&[missing(1)], Some(drawn)).lines().last().map(str::to_owned).unwrap();
        assert_eq!(last([0, 1]), "the frame was not drawn");
        assert_eq!(last([1, 2]), "1 of 2 frames was drawn; those named are missing");
    }
}
