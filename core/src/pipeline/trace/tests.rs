//! After an edit, tracing with a memory gives what tracing anew gives, and works only where the edit matters.

use super::{Drawn, TraceMemory, Tracing};
use crate::geometry::Point;
use crate::lines::Options;
use crate::project::drawings::DrawnStroke;
use crate::project::traced::TracedDrawing;
use crate::scene::{Colour, FrameError, FrameNumber, FrameSource, Raster, Silent};
use std::collections::BTreeMap;
use std::sync::Arc;

const LAST: FrameNumber = 9;

/// Three bars that move to the right. The third one begins on frame 2 and is not drawn by the artist.
struct Film;

impl FrameSource for Film {
    fn picture(&self, frame: FrameNumber) -> Result<Arc<Raster<Colour>>, FrameError> {
        let ink = |x: f64, y: f64| {
            bars(frame).iter().any(|&[left, top]| x >= left && x < left + 40.0 && (y - top).abs() < 1.5)
        };
        let colour = |x: usize, y: usize| if ink(x as f64 + 0.5, y as f64 + 0.5) { [0.1; 3] } else { [1.0; 3] };
        Ok(Arc::new(Raster::from_fn(120, 90, colour)))
    }
}

/// The left ends of the bars.
fn bars(frame: FrameNumber) -> Vec<[f64; 2]> {
    let x = 15.0 + 3.0 * f64::from(frame);
    let mut all = vec![[x, 20.0], [x, 45.0]];
    if frame >= 2 {
        all.push([x + 10.0, 70.0]);
    }
    all
}

/// The first two bars as the artist draws them, `raised` by some pixels.
fn drawn(frame: FrameNumber, raised: f64) -> Drawn {
    let stroke = |[x, y]: [f64; 2]| {
        let points = (0..=8).map(|k| Point::new(x + 5.0 * f64::from(k), y - raised)).collect();
        DrawnStroke { points, ..DrawnStroke::default() }
    };
    let strokes = bars(frame)[..2].iter().map(|&bar| stroke(bar)).collect();
    Drawn { frame, strokes, ..Drawn::default() }
}

fn traced(drawings: &[Drawn], memory: Option<&mut TraceMemory>) -> Vec<TracedDrawing> {
    let mut tracing = Tracing {
        frames: &Film,
        drawn: drawings.iter().collect(),
        options: &Options::default(),
        memory,
        hashes: BTreeMap::new(),
        progress: &Silent,
        all: 1,
        done: 0,
        next: 0,
    };
    let mut found = tracing.all(&(0..=LAST)).unwrap();
    found.sort_by_key(|drawing| drawing.frame);
    found
}

#[test]
fn a_second_run_takes_every_span_from_memory() {
    for drawings in [vec![], vec![drawn(3, 0.0)], vec![drawn(1, 0.0), drawn(4, 0.0), drawn(7, 0.0)]] {
        let mut memory = TraceMemory::default();
        let anew = traced(&drawings, None);
        assert_eq!(traced(&drawings, Some(&mut memory)), anew);
        let spans = memory.spans();
        assert_eq!(traced(&drawings, Some(&mut memory)), anew);
        assert_eq!(memory.spans(), spans, "nothing is traced again");
        assert!(anew.iter().any(|drawing| drawing.strokes.len() == 3), "a stroke begins on the way");
    }
}

#[test]
fn an_edit_is_traced_again_only_where_it_matters() {
    let before = [drawn(1, 0.0), drawn(4, 0.0), drawn(7, 0.0)];
    let mut memory = TraceMemory::default();
    traced(&before, Some(&mut memory));
    assert_eq!(memory.spans(), 4, "to the start, two between, to the end");
    // The last drawing is edited: the span before it and the one behind it are new.
    let after = [drawn(1, 0.0), drawn(4, 0.0), drawn(7, 1.0)];
    assert_eq!(traced(&after, Some(&mut memory)), traced(&after, None));
    assert_eq!(memory.spans(), 6);
    // Undone, all is known.
    assert_eq!(traced(&before, Some(&mut memory)), traced(&before, None));
    assert_eq!(memory.spans(), 6);
    // A further drawing cuts a span in two.
    let cut = [drawn(1, 0.0), drawn(4, 0.0), drawn(5, 0.0), drawn(7, 0.0)];
    assert_eq!(traced(&cut, Some(&mut memory)), traced(&cut, None));
    assert!(memory.spans() <= 9, "at most two between and one behind: {}", memory.spans());
}
