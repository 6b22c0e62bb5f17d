//! As few strokes as a person would draw: what the pencil left beside its lines is dropped.
//!
//! - A stroke that hangs on another one and is hardly longer than lines are wide is a blot's edge, not a line.
//! - In a rough drawing, a stroke that runs along a longer one within the width of the sketched line is that same line,
//!   drawn again. The longer strokes are kept, since they are what the line is about.

use crate::stroke::Style;
use crate::strokes::Walked;
use rototoon_base::geometry::Point;
use std::collections::BTreeMap;

/// Length of the shortest stroke that hangs on another one: in widths, and in pixels of 540 lines.
const STUB_WIDTHS: f64 = 1.0;
const STUB: f64 = 2.0;
/// Length of the shortest mark that stands alone, in widths; its round ends count.
const ALONE_WIDTHS: f64 = 1.6;
/// Half the width of a sketched line: in widths of its strokes, and in pixels of 540 lines.
const SKETCHED_WIDTHS: f64 = 0.75;
const SKETCHED: f64 = 1.0;
/// Share of its length that a repeated stroke has beside longer ones.
const REPEATED: f64 = 0.8;

/// The length of the shortest stroke that hangs on another one.
pub fn stub(width: f64, unit: f64) -> f64 {
    STUB_WIDTHS * width + STUB * unit
}

/// Drops strokes. `width` is the usual width of lines, and `unit` the size of a pixel of 540 lines.
pub fn thrifty(strokes: Vec<Walked>, width: f64, unit: f64, style: Style) -> Vec<Walked> {
    let rough = style == Style::Rough;
    let stub = stub(width, unit);
    let keep = |stroke: &Walked| {
        if stroke.fill {
            return true;
        }
        let thick = 2.0 * stroke.radii.iter().copied().fold(0.0, f64::max);
        if stroke.free == [true; 2] || stroke.closed {
            stroke.length() + thick >= ALONE_WIDTHS * width
        } else {
            stroke.length() >= stub
        }
    };
    let kept: Vec<Walked> = strokes.into_iter().filter(keep).map(dot).collect();
    if rough { without_repeated(kept, SKETCHED_WIDTHS * width + SKETCHED * unit) } else { kept }
}

/// A mark of one point gets two: a dot is a stroke too.
fn dot(mut stroke: Walked) -> Walked {
    if let ([point], [radius]) = (&stroke.points[..], &stroke.radii[..]) {
        let half = Point::new(0.5, 0.0);
        stroke =
            Walked { points: vec![*point - half, *point + half], radii: vec![*radius; 2], closed: false, ..stroke };
    }
    stroke
}

/// Drops strokes that run beside longer ones, within `reach` pixels.
fn without_repeated(strokes: Vec<Walked>, reach: f64) -> Vec<Walked> {
    let mut order: Vec<(f64, usize)> = strokes.iter().enumerate().map(|(k, stroke)| (stroke.length(), k)).collect();
    order.sort_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));
    let mut seen = Near::new(reach);
    let mut keep = vec![true; strokes.len()];
    for (_, k) in order {
        if strokes[k].fill {
            continue;
        }
        let points = &strokes[k].points;
        let beside = points.iter().filter(|&&p| seen.holds(p)).count();
        keep[k] = (beside as f64) < REPEATED * points.len() as f64;
        if keep[k] {
            points.iter().for_each(|&p| seen.add(p));
        }
    }
    strokes.into_iter().zip(keep).filter(|(_, keep)| *keep).map(|(stroke, _)| stroke).collect()
}

/// Points in cells, to find one within a distance.
struct Near {
    reach: f64,
    cells: BTreeMap<(i64, i64), Vec<Point>>,
}

impl Near {
    fn new(reach: f64) -> Self {
        Self { reach: reach.max(1e-3), cells: BTreeMap::new() }
    }

    fn cell(&self, p: Point) -> (i64, i64) {
        ((p.x / self.reach).floor() as i64, (p.y / self.reach).floor() as i64)
    }

    fn add(&mut self, p: Point) {
        self.cells.entry(self.cell(p)).or_default().push(p);
    }

    fn holds(&self, p: Point) -> bool {
        let (x, y) = self.cell(p);
        let mut cells = (-1..=1).flat_map(|dy| (-1..=1).map(move |dx| (x + dx, y + dy)));
        cells.any(|cell| self.cells.get(&cell).is_some_and(|own| own.iter().any(|q| q.distance(p) <= self.reach)))
    }
}
