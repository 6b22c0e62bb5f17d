//! Frames on which tracing has found no line, or hardly any.
//!
//! That is right for an empty frame. More often the ink is fainter than what was looked for, or `--sensitivity` is too low; so it is said. A frame
//! counts as nearly empty if its lines are together shorter than [`SHORT`] of the picture's height, or than [`FEW`] of what the film's frames
//! have in the middle.

use super::report::runs;
use crate::geometry::polyline;
use crate::project::traced::TracedDrawing;
use crate::scene::FrameNumber;

/// Length of hardly any lines, in heights of the picture.
const SHORT: f64 = 0.3;
/// Length of hardly any lines, as a share of the film's median.
const FEW: f64 = 0.1;

/// A line of text for the frames without a line, and one for those with hardly any.
pub(super) fn lines(drawings: &[TracedDrawing], height: usize) -> Vec<String> {
    let length = |drawing: &TracedDrawing| -> f64 {
        drawing.strokes.iter().map(|stroke| polyline::length(&stroke.points, stroke.closed)).sum()
    };
    let lengths: Vec<(FrameNumber, f64)> = drawings.iter().map(|drawing| (drawing.frame, length(drawing))).collect();
    let mut sorted: Vec<f64> = lengths.iter().map(|own| own.1).collect();
    sorted.sort_by(f64::total_cmp);
    let median = sorted.get(sorted.len() / 2).copied().unwrap_or(0.0);
    let least = (SHORT * height as f64).max(FEW * median);
    let told = |what: &str, is: &dyn Fn(f64) -> bool| {
        let frames: Vec<FrameNumber> = lengths.iter().filter(|own| is(own.1)).map(|own| own.0).collect();
        let them = if frames.len() == 1 { "frame" } else { "frames" };
        (!frames.is_empty())
            .then(|| format!("{them} {}: {what}; a higher --sensitivity finds fainter ink", runs(&frames)))
    };
    let found = [
        told("no line was found", &|length| length == 0.0),
        told("hardly any line was found", &|length| length > 0.0 && length < least),
    ];
    found.into_iter().flatten().collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Point;
    use crate::project::traced::TracedStroke;

    /// A drawing of one line of this length.
    fn drawing(frame: FrameNumber, length: f64) -> TracedDrawing {
        let line = TracedStroke { points: vec![Point::ZERO, Point::new(length, 0.0)], ..TracedStroke::default() };
        TracedDrawing { frame, strokes: if length > 0.0 { vec![line] } else { Vec::new() } }
    }

    #[test]
    fn frames_without_lines_and_with_hardly_any_are_told_apart() {
        let drawings: Vec<TracedDrawing> = [0.0, 900.0, 80.0, 95.0, 1000.0, 20.0, 0.0]
            .into_iter()
            .zip(1..)
            .map(|(length, k)| drawing(k, length))
            .collect();
        let advice = "a higher --sensitivity finds fainter ink";
        let none = format!("frames 1, 7: no line was found; {advice}");
        assert_eq!(lines(&drawings, 100), [none.clone(), format!("frame 6: hardly any line was found; {advice}")]);
        assert_eq!(lines(&drawings, 300), [none, format!("frames 3, 6: hardly any line was found; {advice}")]);
        assert!(lines(&drawings[1..2], 100).is_empty() && lines(&[], 100).is_empty());
        let film: Vec<TracedDrawing> = (1..=9).map(|k| drawing(k, if k == 4 { 40.0 } else { 500.0 })).collect();
        assert_eq!(
            lines(&film, 100),
            [format!("frame 4: hardly any line was found; {advice}")],
            "a tenth of the others"
        );
    }
}
