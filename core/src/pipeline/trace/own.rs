//! What the artist's own drawings say last, after all frames are traced.
//!
//! - A drawing without strokes is one, too: the artist emptied the frame. It stays empty, and so do the frames that hold it.
//! - A stroke of a drawing that an earlier run had on this frame keeps its number. Where the frame alone is traced once more, the strokes
//!   around may be too far away to say that they are the same, though a run over all frames knew.

use super::Holds;
use crate::project::drawings::Drawing as Drawn;
use crate::project::traced::{TracedDrawing, TracedStroke};
use crate::scene::FrameNumber;
use std::collections::{BTreeMap, BTreeSet};

/// Takes the strokes off the frames that the artist emptied.
pub(super) fn emptied(found: &mut [TracedDrawing], drawn: &[Drawn], holds: &Holds) {
    let by_frame: BTreeMap<FrameNumber, &Drawn> = drawn.iter().map(|drawing| (drawing.frame, drawing)).collect();
    for TracedDrawing { frame, strokes } in found {
        let shown = by_frame.range(holds.first(*frame)..=*frame).next_back();
        if shown.is_some_and(|(_, drawing)| drawing.strokes.is_empty()) {
            strokes.clear();
        }
    }
}

/// Whether the artist emptied a frame. As the first one it is then not kept from an earlier run: the next run would not find it in this one's result, and
/// would give other lines.
pub(super) fn is_emptied(drawn: &[Drawn], frame: FrameNumber) -> bool {
    drawn.iter().any(|drawing| drawing.frame == frame && drawing.strokes.is_empty())
}

/// Gives strokes of the artist the numbers that an `earlier` run had for the same strokes on the same frame. Numbers from `new` on are those
/// of this run. They alone change, and only to earlier ones that nothing else has in `found`.
pub(super) fn numbered(found: &mut [TracedDrawing], drawn: &[Drawn], earlier: &[TracedDrawing], new: usize) {
    let frames: BTreeSet<FrameNumber> = drawn.iter().map(|drawing| drawing.frame).collect();
    let mut used: BTreeSet<usize> =
        found.iter().flat_map(|drawing| &drawing.strokes).map(|stroke| stroke.track).collect();
    let mut names = BTreeMap::new();
    for drawing in found.iter().filter(|drawing| frames.contains(&drawing.frame)) {
        let Some(before) = earlier.iter().find(|before| before.frame == drawing.frame) else { continue };
        for stroke in drawing.strokes.iter().filter(|stroke| stroke.track >= new) {
            let known = before.strokes.iter().find(|known| is_same(known, stroke) && known.track < new);
            if let Some(known) = known.filter(|known| !names.contains_key(&stroke.track) && used.insert(known.track)) {
                names.insert(stroke.track, known.track);
            }
        }
    }
    for stroke in found.iter_mut().flat_map(|drawing| &mut drawing.strokes) {
        stroke.track = names.get(&stroke.track).copied().unwrap_or(stroke.track);
    }
}

fn is_same(a: &TracedStroke, b: &TracedStroke) -> bool {
    // Documents have their points with four digits.
    let near = |(p, q): (&crate::geometry::Point, &crate::geometry::Point)| p.distance(*q) < 1e-3;
    (a.closed, a.points.len()) == (b.closed, b.points.len()) && a.points.iter().zip(&b.points).all(near)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Point;
    use crate::project::drawings::DrawnStroke;
    use crate::scene::{Colour, FrameError, FrameSource, Raster, Silent};
    use std::sync::Arc;

    /// A bar that moves every third frame.
    struct OnThrees;

    impl FrameSource for OnThrees {
        fn picture(&self, frame: FrameNumber) -> Result<Arc<Raster<Colour>>, FrameError> {
            let left = 10 + frame as usize / 3 * 12;
            let ink = |x: usize, y: usize| (left..left + 30).contains(&x) && (40..44).contains(&y);
            Ok(Arc::new(Raster::from_fn(120, 90, |x, y| [if ink(x, y) { 0.1 } else { 1.0 }; 3])))
        }
    }

    fn line(y: f64) -> Vec<Point> {
        vec![Point::new(0.0, y), Point::new(30.0, y)]
    }

    fn traced(frame: FrameNumber, strokes: &[(usize, f64)]) -> TracedDrawing {
        let stroke = |&(track, y): &(usize, f64)| TracedStroke { track, points: line(y), ..TracedStroke::default() };
        TracedDrawing { frame, strokes: strokes.iter().map(stroke).collect() }
    }

    fn drawn(frame: FrameNumber, lines: &[f64]) -> Drawn {
        let stroke = |&y: &f64| DrawnStroke { points: line(y), ..DrawnStroke::default() };
        Drawn { frame, strokes: lines.iter().map(stroke).collect(), ..Drawn::default() }
    }

    #[test]
    fn a_stroke_keeps_its_number_if_nothing_else_has_it() {
        let earlier = [traced(3, &[(7, 10.0), (8, 20.0), (9, 30.0), (40, 60.0)])];
        let drawings = [drawn(3, &[10.0, 20.0, 30.0, 50.0, 60.0])];
        let mut found = vec![
            traced(2, &[(8, 15.0)]),
            traced(3, &[(11, 10.0), (12, 20.0), (2, 30.0), (13, 50.0), (14, 60.0)]),
            traced(4, &[(11, 12.0)]),
        ];
        numbered(&mut found, &drawings, &earlier, 11);
        let numbers = |drawing: &TracedDrawing| drawing.strokes.iter().map(|stroke| stroke.track).collect::<Vec<_>>();
        // 8 is another stroke, 2 was carried here, the fourth line is new, and 40 is a number of this run or of another one's range.
        assert_eq!(found.iter().map(numbers).collect::<Vec<_>>(), [vec![8], vec![7, 12, 2, 13, 14], vec![7]]);
        let mut traced_only = vec![traced(3, &[(11, 10.0)])];
        numbered(&mut traced_only, &[], &earlier, 11);
        assert_eq!(traced_only, [traced(3, &[(11, 10.0)])], "the artist did not draw it");
    }

    #[test]
    fn emptied_frames_stay_empty_as_long_as_they_are_held() {
        let holds = Holds::of(&OnThrees, 0, &(0..=8), None, &Silent).unwrap();
        assert_eq!([3, 4, 5, 6].map(|frame| holds.first(frame)), [3, 3, 3, 6]);
        let lines = |drawings: &[Drawn]| -> Vec<usize> {
            let mut found: Vec<TracedDrawing> = (0..=8).map(|frame| traced(frame, &[(0, 5.0)])).collect();
            emptied(&mut found, drawings, &holds);
            found.iter().map(|drawing| drawing.strokes.len()).collect()
        };
        assert_eq!(lines(&[drawn(3, &[])]), [1, 1, 1, 0, 0, 0, 1, 1, 1]);
        assert_eq!(lines(&[drawn(4, &[]), drawn(5, &[1.0])]), [1, 1, 1, 1, 0, 1, 1, 1, 1]);
        assert_eq!(lines(&[drawn(4, &[1.0])]), [1; 9]);
    }
}
