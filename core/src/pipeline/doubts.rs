//! Which traced strokes deserve a look, and where.

use super::bare;
use super::report::runs;
use crate::project::traced::TracedDrawing;
use crate::scene::outcome::Verdict;
use crate::scene::{Footage, FrameNumber};
use std::collections::{BTreeMap, BTreeSet};

/// Strokes that are named one by one, at most: those that are in doubt on most frames.
const NAMED: usize = 20;

/// A stroke that is in doubt somewhere.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Doubt {
    /// Its number.
    pub track: usize,
    /// Frames on which a look at it is worth while.
    pub doubtful: Vec<FrameNumber>,
    /// Frames on which it is probably another stroke.
    pub lost: Vec<FrameNumber>,
}

/// The strokes that are in doubt, by number. Drawings ascend.
pub fn doubts(drawings: &[TracedDrawing]) -> Vec<Doubt> {
    let mut found: BTreeMap<usize, Doubt> = BTreeMap::new();
    for (frame, stroke) in drawings.iter().flat_map(|drawing| drawing.strokes.iter().map(|s| (drawing.frame, s))) {
        let verdict = Verdict::of(stroke.confidence.unwrap_or(1.0));
        if verdict == Verdict::Sure {
            continue;
        }
        let own = found.entry(stroke.track).or_insert_with(|| Doubt { track: stroke.track, ..Doubt::default() });
        if verdict == Verdict::Lost { own.lost.push(frame) } else { own.doubtful.push(frame) }
    }
    found.into_values().collect()
}

/// What a person is told of traced drawings, a line each: how much was traced, on which frames hardly anything was found, and which
/// strokes are in doubt.
pub fn traced_lines(drawings: &[TracedDrawing], footage: &Footage) -> Vec<String> {
    let numbers: BTreeSet<usize> = drawings.iter().flat_map(|d| d.strokes.iter().map(|s| s.track)).collect();
    let doubts = doubts(drawings);
    let counted = |count: usize, what: &str| format!("{count} {what}{}", if count == 1 { "" } else { "s" });
    let mut first = format!("{} on {}", counted(numbers.len(), "stroke"), counted(drawings.len(), "frame"));
    if !doubts.is_empty() {
        first += &format!(", {} in doubt somewhere", doubts.len());
    }
    let mut worst: Vec<&Doubt> = doubts.iter().collect();
    worst.sort_by_key(|doubt| (std::cmp::Reverse((doubt.lost.len(), doubt.doubtful.len())), doubt.track));
    worst.truncate(NAMED);
    worst.sort_by_key(|doubt| doubt.track);
    let line = |doubt: &&Doubt| {
        let named = [("doubtful", &doubt.doubtful), ("lost", &doubt.lost)];
        let places = named.iter().filter(|(_, frames)| !frames.is_empty());
        let places: Vec<String> = places.map(|(what, frames)| format!("{what}: {}", runs(frames))).collect();
        format!("stroke {}: {}", doubt.track, places.join("; "))
    };
    let mut lines = vec![first];
    lines.extend(bare::lines(drawings, footage.height));
    lines.extend(worst.iter().map(line));
    if doubts.len() > NAMED {
        lines.push(format!("{} more strokes are in doubt on fewer frames", doubts.len() - NAMED));
    }
    lines
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Point;
    use crate::project::traced::TracedStroke;

    fn footage() -> Footage {
        Footage { pattern: "%d.png".into(), first: 0, last: 9, fps: 24.0, width: 100, height: 100, held: false }
    }

    fn drawing(frame: FrameNumber, strokes: &[(usize, Option<f64>)]) -> TracedDrawing {
        let stroke = |&(track, confidence): &(usize, Option<f64>)| {
            let points = vec![Point::ZERO, Point::new(50.0, 0.0)];
            TracedStroke { track, confidence, points, ..TracedStroke::default() }
        };
        TracedDrawing { frame, strokes: strokes.iter().map(stroke).collect() }
    }

    #[test]
    fn doubtful_and_lost_strokes_are_named_with_their_frames() {
        let drawings = [
            drawing(3, &[(0, None), (1, None)]),
            drawing(4, &[(0, Some(0.95)), (1, Some(0.7))]),
            drawing(5, &[(0, Some(0.9)), (1, Some(0.6))]),
            drawing(6, &[(0, Some(0.79)), (1, Some(0.3))]),
        ];
        let lines = [
            "2 strokes on 4 frames, 2 in doubt somewhere",
            "stroke 0: doubtful: 6",
            "stroke 1: doubtful: 4-5; lost: 6",
        ];
        assert_eq!(traced_lines(&drawings, &footage()), lines);
        assert_eq!(traced_lines(&drawings[..1], &footage()), ["2 strokes on 1 frame"]);
        let blank = TracedDrawing { frame: 3, strokes: Vec::new() };
        assert_eq!(
            traced_lines(&[blank], &footage())[1],
            "frame 3: no line was found; a higher --sensitivity finds fainter ink"
        );
    }

    #[test]
    fn the_worst_of_many_strokes_are_named() {
        let all: Vec<(usize, Option<f64>)> =
            (0..30).map(|track| (track, Some(if track < 10 { 0.7 } else { 0.2 }))).collect();
        let lines = traced_lines(&[drawing(0, &all)], &footage());
        assert_eq!(
            (lines.len(), &lines[1][..], &lines[21][..]),
            (22, "stroke 10: lost: 0", "10 more strokes are in doubt on fewer frames")
        );
    }
}
