//! Keys that contradict each other: all frames from the one to the other show the same drawing, and their contours differ.
//!
//! One of the two is not where the drawing is. The tracker holds the first one up to the second, sure of it on every frame, and there the contour
//! jumps. Only the artist knows which one is wrong.
//!
//! Whether frames show one drawing is the tracker's own question ([`crate::track::drawings`]). First it is asked about the pictures of the two keys
//! alone, since most differ. A picture of one colour shows no drawing.

use super::PipelineError;
use crate::geometry::Point;
use crate::scene::{FrameNumber, FrameSource, Part, Progress, Scene, Silent};
use crate::track::{TrackError, drawings};
use std::collections::BTreeMap;
use std::fmt;

/// Mean distance of the points of two contours above which they differ, in pixels of a picture of [`LINES`] lines. Below it are the hand and the mouse.
const APART: f64 = 1.0;
/// See [`APART`].
const LINES: f64 = 540.0;

/// Two keys of a part on one drawing.
#[derive(Clone, Debug, PartialEq)]
pub struct Contradiction {
    /// Name of the part.
    pub part: String,
    /// The frames of the keys, the earlier one first.
    pub keys: [FrameNumber; 2],
    /// Mean distance of their points, in pixels.
    pub apart: f64,
}

impl fmt::Display for Contradiction {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        let ([first, last], apart) = (self.keys, self.apart);
        write!(
            out,
            "frames {first}-{last} show one drawing, but the keys on {first} and {last} differ by {apart:.1} px: correct or remove the wrong one"
        )
    }
}

/// The neighbouring keys of each part that contradict each other. Frames that cannot be read show no drawing.
///
/// # Errors
///
/// [`PipelineError::Cancelled`].
pub fn contradicted(
    scene: &Scene,
    frames: &dyn FrameSource,
    progress: &dyn Progress,
) -> Result<Vec<Contradiction>, PipelineError> {
    let least = APART * scene.footage.height as f64 / LINES;
    let (mut found, mut known) = (Vec::new(), BTreeMap::new());
    for (part, keys, apart) in scene.parts.iter().flat_map(pairs).filter(|(_, _, apart)| *apart > least) {
        progress.report("Comparing drawings", 0.0)?;
        let same = match known.get(&keys) {
            Some(same) => *same,
            None => *known.entry(keys).or_insert(show_one_drawing(frames, keys, progress)?),
        };
        if same {
            found.push(Contradiction { part: part.name.clone(), keys, apart });
        }
    }
    Ok(found)
}

/// Neighbouring keys of a part between which it is never absent, with the mean distance of their points.
fn pairs(part: &Part) -> impl Iterator<Item = (&Part, [FrameNumber; 2], f64)> {
    let mean = |a: &[Point], b: &[Point]| a.iter().zip(b).map(|(a, b)| a.distance(*b)).sum::<f64>() / a.len() as f64;
    part.keys.iter().zip(part.keys.iter().skip(1)).filter_map(move |((first, a), (last, b))| {
        let comparable = a.len() == b.len() && !a.is_empty();
        let is_there = || part.absent.iter().all(|[from, to]| to < first || from > last);
        (comparable && is_there()).then(|| (part, [*first, *last], mean(a, b)))
    })
}

fn show_one_drawing(
    frames: &dyn FrameSource,
    [first, last]: [FrameNumber; 2],
    progress: &dyn Progress,
) -> Result<bool, PipelineError> {
    let Ok(picture) = frames.picture(first) else { return Ok(false) };
    let colour = picture.get(0, 0);
    if (0..picture.height()).all(|y| picture.row(y).iter().all(|other| *other == colour)) {
        return Ok(false);
    }
    // Of the two alone nothing is reported: they are no share of anything.
    if !drawings(frames, [first, last], None, &Silent).is_ok_and(|found| found.len() == 1) {
        return Ok(false);
    }
    match drawings(frames, first..=last, None, progress) {
        Ok(found) => Ok(found.len() == 1),
        Err(TrackError::Cancelled(cancelled)) => Err(cancelled.into()),
        Err(_) => Ok(false),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{Colour, Footage, FrameError, Raster};
    use std::sync::Arc;

    /// A disc that stays on frames 0 to 5 and moves from then on. Frame 3 of the second film is another drawing; the third film is white.
    struct Film(u8);

    impl FrameSource for Film {
        fn picture(&self, frame: FrameNumber) -> Result<Arc<Raster<Colour>>, FrameError> {
            if frame > 9 {
                return Err(FrameError::Outside { frame, first: 0, last: 9 });
            }
            let mut picture = Raster::new(96, 54, [1.0; 3]);
            let is_other = self.0 == 1 && frame == 3;
            let center = if is_other { 60.0 } else { 30.0 + 6.0 * f64::from((frame - 5).max(0)) };
            for y in 0..54 {
                for (x, colour) in picture.row_mut(y).iter_mut().enumerate() {
                    let off = (x as f64 + 0.5 - center).hypot(y as f64 + 0.5 - 27.0);
                    if off < 12.0 && self.0 < 2 {
                        *colour = [0.2, 0.3, 0.6];
                    }
                }
            }
            Ok(Arc::new(picture))
        }
    }

    fn told(film: u8, keys: &[(FrameNumber, f64)], absent: &[[FrameNumber; 2]]) -> Vec<String> {
        let contour = |x: f64| vec![Point::new(x, 15.0), Point::new(x + 12.0, 27.0), Point::new(x, 39.0)];
        let part = Part {
            name: "body".into(),
            keys: keys.iter().map(|(frame, x)| (*frame, contour(30.0 + x))).collect(),
            absent: absent.to_vec(),
            ..Part::default()
        };
        let footage =
            Footage { pattern: "%d.png".into(), first: 0, last: 9, fps: 12.0, width: 96, height: 54, held: false };
        let scene = Scene { footage, parts: vec![part] };
        contradicted(&scene, &Film(film), &Silent).unwrap().iter().map(ToString::to_string).collect()
    }

    #[test]
    fn keys_that_differ_on_one_drawing_are_told() {
        let said =
            "frames 0-5 show one drawing, but the keys on 0 and 5 differ by 3.0 px: correct or remove the wrong one";
        assert_eq!(told(0, &[(0, 0.0), (5, 3.0)], &[]), [said]);
        for (film, keys, absent, why) in [
            (0, [(0, 0.0), (5, 0.05)], &[][..], "it is the hand"),
            (0, [(0, 0.0), (7, 12.0)], &[], "it moves"),
            (0, [(0, 0.0), (5, 3.0)], &[[2, 3]], "it is away in between"),
            (1, [(0, 0.0), (5, 3.0)], &[], "there is another drawing in between"),
            (2, [(0, 0.0), (5, 3.0)], &[], "nothing is drawn"),
            (0, [(0, 0.0), (12, 3.0)], &[], "a frame cannot be read"),
        ] {
            assert_eq!(told(film, &keys, absent), [""; 0], "{why}");
        }
        assert_eq!(told(0, &[(0, 0.0), (2, 3.0), (5, 3.0), (9, 24.0)], &[]).len(), 1);
    }
}
