//! A contact sheet: small pictures of the frames with their contours and strokes, over their painted regions, in the order of
//! time. Frames on which a part or a stroke is lost have a red border, those on which one or a region is doubtful an amber one.
//! Lost and doubtful strokes have their numbers. A frame whose picture cannot be read is hatched and says "no picture", and a frame without a file that holds an
//! earlier one, because the footage says so, says which.

use super::gaps::Gap;
use super::sheet_drawn::Contents;
use super::sheet_marks::{DOUBTFUL, LOST, PLAIN, hatched, length, put, say_no_picture, write, write_strokes};
use super::{PipelineError, frames, memory};
use crate::image::resize::resize;
use crate::project::Document;
use crate::render::{OverlayOptions, overlay};
use crate::scene::{Colour, Footage, FrameNumber, FrameSource, Outcome, Progress, Raster, Scene, Verdict};
use rayon::iter::{IndexedParallelIterator, IntoParallelRefIterator, ParallelIterator};
use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;
use std::sync::atomic::{AtomicUsize, Ordering};

/// Greatest number of pictures. Longer footage shows its worst frames and some between.
const PICTURES: usize = 48;
/// Pictures in a row.
const COLUMNS: usize = 6;
/// Greatest width and height of a picture in pixels.
const SIZE: usize = 320;
/// Width of a picture's border in pixels.
const BORDER: usize = 5;
/// Space between pictures in pixels.
const GAP: usize = 4;
/// Height of the strip with the frame's number.
const STRIP: usize = 21;
/// Width of the contours in pixels of the small picture.
const LINE: f64 = 1.6;
/// Side of a dot of a digit in pixels.
const DOT: usize = 3;
/// Colour of a frame's number.
const INK: Colour = [0.95; 3];

/// Colour of what is said beside the number.
const QUIET: Colour = [0.6; 3];

/// A contact sheet.
#[derive(Debug)]
pub struct Sheet {
    /// The sheet.
    pub picture: Raster<Colour>,
    /// Frames of it whose pictures cannot be read ([`PipelineError::Gaps`]).
    pub gaps: Option<PipelineError>,
}

/// What a cell of the sheet says of its frame.
#[derive(Clone, Copy, Debug, Default)]
struct Said {
    verdict: Option<Verdict>,
    /// The frame whose picture it shows, if that is another one. Of a frame without a picture nothing.
    holds: Option<FrameNumber>,
    has_picture: bool,
}

/// Draws the contact sheet of a document in `folder`. It runs on the caller's rayon pool.
///
/// # Errors
///
/// An invalid pattern, no frame that can be read, strokes or regions that cannot be read, or [`PipelineError::Cancelled`].
pub fn sheet(document: &Document, folder: &Path, progress: &dyn Progress) -> Result<Sheet, PipelineError> {
    let sequence = frames(document, folder)?;
    memory::to_follow(&document.scene.footage)?;
    let contents = Contents::of(document)?;
    let mut verdicts = verdicts(&contents.scene);
    contents.doubts().for_each(|(frame, verdict)| worse(&mut verdicts, frame, verdict));
    let chosen = chosen(&document.scene.footage, &verdicts);
    let done = AtomicUsize::new(0);
    let cells = chosen.par_iter().with_max_len(1).map(|&frame| {
        let verdict = verdicts.get(&frame).copied();
        let drawn = match sequence.picture(frame) {
            Ok(picture) => {
                let painted = contents.below(frame, &picture);
                let holds = Some(sequence.shown(frame)).filter(|shown| *shown != frame);
                let said = Said { verdict, holds, has_picture: true };
                (cell(&contents.scene, frame, painted.as_ref().unwrap_or(&*picture), said), None)
            }
            Err(error) => {
                let Footage { width, height, .. } = document.scene.footage;
                let below = hatched(width, height, 1.0 / scale(width, height));
                (cell(&contents.scene, frame, &below, Said { verdict, ..Said::default() }), Some((frame, error)))
            }
        };
        let finished = done.fetch_add(1, Ordering::Relaxed) + 1;
        progress.report("Drawing", finished as f64 / chosen.len() as f64)?;
        Ok(drawn)
    });
    let (cells, gaps): (Vec<_>, Vec<_>) = cells.collect::<Result<Vec<_>, PipelineError>>()?.into_iter().unzip();
    let gaps: Vec<Gap> = gaps.into_iter().flatten().collect();
    let drawn = [cells.len() - gaps.len(), cells.len()];
    let gaps = (!gaps.is_empty()).then_some(PipelineError::Gaps { gaps, drawn: Some(drawn) });
    match gaps {
        Some(none) if drawn[0] == 0 => Err(none),
        gaps => Ok(Sheet { picture: arranged(&cells), gaps }),
    }
}

/// The size of a small picture divided by that of its frame.
fn scale(width: usize, height: usize) -> f64 {
    (SIZE as f64 / width.max(height) as f64).min(1.0)
}

/// The worst verdict on any part, by frame.
fn verdicts(scene: &Scene) -> BTreeMap<FrameNumber, Verdict> {
    let mut worst = BTreeMap::new();
    for part in &scene.parts {
        let Outcome { sure, doubtful, lost } = Outcome::of(part);
        for (frames, verdict) in [(sure, Verdict::Sure), (doubtful, Verdict::Doubtful), (lost, Verdict::Lost)] {
            frames.into_iter().for_each(|frame| worse(&mut worst, frame, verdict));
        }
    }
    worst
}

/// Takes a verdict on a frame, if it is worse than the known one.
fn worse(worst: &mut BTreeMap<FrameNumber, Verdict>, frame: FrameNumber, verdict: Verdict) {
    let known = worst.entry(frame).or_insert(verdict);
    *known = verdict.max(*known);
}

/// The frames of the sheet: all if they are few, otherwise the worst ones and some between.
fn chosen(footage: &Footage, verdicts: &BTreeMap<FrameNumber, Verdict>) -> Vec<FrameNumber> {
    let (first, last) = (i64::from(footage.first), i64::from(footage.last));
    if last - first < PICTURES as i64 {
        return (footage.first..=footage.last).collect();
    }
    let within = |frame: &FrameNumber| (footage.first..=footage.last).contains(frame);
    let bad = verdicts.iter().filter(|(frame, verdict)| **verdict != Verdict::Sure && within(frame));
    let mut bad: Vec<(FrameNumber, Verdict)> = bad.map(|(&frame, &verdict)| (frame, verdict)).collect();
    bad.sort_by_key(|&(frame, verdict)| (std::cmp::Reverse(verdict), frame));
    let mut chosen: BTreeSet<FrameNumber> = bad.into_iter().map(|(frame, _)| frame).take(PICTURES / 2).collect();
    let steps = (PICTURES - chosen.len()) as i64 - 1;
    chosen.extend((0..=steps).map(|step| (first + (last - first) * step / steps) as FrameNumber));
    chosen.into_iter().collect()
}

fn cell(scene: &Scene, frame: FrameNumber, below: &Raster<Colour>, said: Said) -> Raster<Colour> {
    let scale = scale(below.width(), below.height());
    let options = OverlayOptions { line_width: LINE / scale, points: false, confidence: true };
    let small = |length: usize| ((length as f64 * scale).round() as usize).max(1);
    let mut drawn = resize(&overlay(scene, frame, below, None, &options), small(below.width()), small(below.height()));
    write_strokes(&mut drawn, scene, frame, scale);
    if !said.has_picture {
        say_no_picture(&mut drawn);
    }
    let border = match said.verdict {
        Some(Verdict::Lost) => LOST,
        Some(Verdict::Doubtful) => DOUBTFUL,
        _ => PLAIN,
    };
    let number = frame.to_string();
    let beside = said.holds.map_or_else(String::new, |held| format!("HOLDS {held}"));
    // A narrow picture stands in a wider cell, because the number must be readable.
    let at = length(&number, DOT) + 2 * DOT;
    let inside = drawn.width().max(at + if beside.is_empty() { 0 } else { 3 * DOT + length(&beside, DOT) });
    let mut cell = Raster::new(inside + 2 * BORDER, drawn.height() + 2 * BORDER + STRIP, border);
    put(&mut cell, &Raster::new(inside, drawn.height() + STRIP, PLAIN), (BORDER, BORDER));
    put(&mut cell, &drawn, (BORDER + (inside - drawn.width()) / 2, BORDER + STRIP));
    write(&mut cell, &number, (BORDER + DOT, BORDER + DOT), DOT, INK);
    write(&mut cell, &beside, (BORDER + at + 2 * DOT, BORDER + DOT), DOT, QUIET);
    cell
}

fn arranged(cells: &[Raster<Colour>]) -> Raster<Colour> {
    let most = |length: fn(&Raster<Colour>) -> usize| cells.iter().map(length).max().unwrap_or(1) + GAP;
    let (width, height) = (most(Raster::width), most(Raster::height));
    let (columns, rows) = (COLUMNS.min(cells.len()).max(1), cells.len().div_ceil(COLUMNS).max(1));
    let mut sheet = Raster::new(columns * width + GAP, rows * height + GAP, PLAIN);
    for (i, cell) in cells.iter().enumerate() {
        put(&mut sheet, cell, (GAP + i % COLUMNS * width, GAP + i / COLUMNS * height));
    }
    sheet
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Point;
    use crate::scene::Part;

    fn scene(last: FrameNumber, confidence: &[(FrameNumber, f64)]) -> Scene {
        let footage =
            Footage { pattern: "%d.png".into(), first: 0, last, fps: 24.0, width: 64, height: 48, held: false };
        let square = [(10.0, 10.0), (30.0, 10.0), (30.0, 30.0), (10.0, 30.0)].map(|(x, y)| Point::new(x, y)).to_vec();
        let part = Part {
            closed: true,
            keys: [(0, square.clone())].into(),
            tracks: confidence.iter().map(|&(frame, _)| (frame, square.clone())).collect(),
            confidence: confidence.iter().map(|&(frame, value)| (frame, vec![value; 4])).collect(),
            ..Part::default()
        };
        Scene { footage, parts: vec![part] }
    }

    fn seen(verdict: Option<Verdict>) -> Said {
        Said { verdict, has_picture: true, ..Said::default() }
    }

    #[test]
    fn frames_that_do_not_show_their_own_picture_say_so() {
        let scene = scene(3, &[]);
        let counted = |cell: &Raster<Colour>, colour| cell.data().iter().filter(|own| **own == colour).count();
        let white = Raster::new(320, 240, [1.0; 3]);
        let plain = cell(&scene, 1, &white, seen(None));
        let held = cell(&scene, 1, &white, Said { holds: Some(0), ..seen(None) });
        assert_eq!(counted(&plain, QUIET), 0);
        assert_eq!(counted(&held, QUIET), (11 + 8 + 7 + 10 + 7 + 12) * DOT * DOT, "the dots of HOLDS 0");
        assert_eq!((held.width(), held.height()), (plain.width(), plain.height()));
        let missing = cell(&scene, 1, &hatched(320, 240, 1.0), Said::default());
        assert_eq!((missing.width(), missing.height()), (plain.width(), plain.height()));
        assert!(counted(&missing, INK) > counted(&plain, INK) + 60 * DOT * DOT, "words in the cell");
        // A cell is as wide as what it says.
        let narrow = cell(&scene, 1001, &Raster::new(8, 90, [1.0; 3]), Said { holds: Some(1000), ..seen(None) });
        assert_eq!(
            counted(&narrow, QUIET),
            counted(&cell(&scene, 1, &white, Said { holds: Some(1000), ..seen(None) }), QUIET)
        );
    }

    #[test]
    fn long_footage_shows_its_worst_frames_and_its_course() {
        let few = scene(9, &[]);
        assert_eq!(chosen(&few.footage, &verdicts(&few)), (0..10).collect::<Vec<_>>());
        let many = scene(1000, &[(501, 0.6), (777, 0.1), (778, 0.95)]);
        let frames = chosen(&many.footage, &verdicts(&many));
        assert!(frames.len() <= PICTURES && frames.len() > PICTURES - 4, "{}", frames.len());
        assert!([0, 501, 777, 1000].iter().all(|frame| frames.contains(frame)), "{frames:?}");
    }

    #[test]
    fn lost_frames_have_a_red_border_and_numbers_are_written() {
        let scene = scene(3, &[(1, 0.1), (2, 0.6), (3, 0.9)]);
        let verdicts = verdicts(&scene);
        let picture = Raster::new(64, 48, [1.0; 3]);
        let border = |frame| cell(&scene, frame, &picture, seen(verdicts.get(&frame).copied())).get(1, 1);
        let [key, lost, doubtful, sure] = [0, 1, 2, 3].map(border);
        assert!(key == PLAIN && sure == PLAIN && lost[0] > 0.8 && lost[1] < 0.3 && doubtful[1] > 0.5);
        let cell = cell(&scene, 1, &picture, seen(None));
        let inked = (0..STRIP).flat_map(|y| cell.row(BORDER + y)).filter(|colour| **colour == INK).count();
        assert_eq!(inked, 8 * DOT * DOT, "the figure 1 has eight dots");
        let sheet = arranged(&vec![cell.clone(); 7]);
        assert_eq!((sheet.width(), sheet.height()), (6 * (cell.width() + GAP) + GAP, 2 * (cell.height() + GAP) + GAP));
    }

    #[test]
    fn a_picture_of_any_size_has_a_readable_number() {
        let scene = scene(3, &[]);
        let inked = |cell: &Raster<Colour>| cell.data().iter().filter(|colour| **colour == INK).count();
        let wide = Raster::new(300, 20, [1.0; 3]);
        let sizes = [1, 2, 7, 24, 32, 48, 64, 400].iter().flat_map(|&w| [1, 3, 32, 1920].map(|h| (w, h)));
        for (width, height) in sizes {
            for frame in [0, 10, 1001, 86_400, 1_000_000, -101, FrameNumber::MIN] {
                let small = cell(&scene, frame, &Raster::new(width, height, [1.0; 3]), seen(None));
                let expected = inked(&cell(&scene, frame, &wide, seen(None)));
                assert_eq!(inked(&small), expected, "{width}x{height}, frame {frame}");
                let sheet = arranged(&[small.clone(), small]);
                assert_eq!(inked(&sheet), 2 * expected, "{width}x{height}, frame {frame}");
            }
        }
    }
}
