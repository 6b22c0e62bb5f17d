//! How the handles of a shape are written.
//!
//! Public descriptions disagree on which handle of a point leads forward, and on whether handles are places or offsets from their
//! point. Exporters write both forms. The reading with the shortest control polygon over all keys of a shape is taken: handles are
//! near their points in one reading only. Where that is not clear, as for a few points with long handles, it is the reading that an export of ours has.

use super::super::path::Path;
use super::key::{Form, Knot};
use rototoon_base::geometry::Point;
use rototoon_base::scene::Footage;

/// Share of the length of the reading with places, the second point forward, that another one must be below.
const CLEARLY: f64 = 0.8;

/// How the handles of a shape are written.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Reading {
    /// Whether the third point of a knot leads forward, and not the second.
    swapped: bool,
    /// Where an offset of nothing was read to, if handles are offsets from their points.
    origin: Option<Point>,
}

impl Reading {
    /// The reading with the shortest control polygons of all forms, if it is clearly the shortest.
    pub fn of(keys: &[&Form], footage: &Footage) -> Self {
        let middle = Point::new(footage.width as f64, footage.height as f64) * 0.5;
        let forms =
            [None, Some(middle)].into_iter().flat_map(|origin| [false, true].map(|swapped| Self { swapped, origin }));
        let known = Self { swapped: false, origin: None };
        let length = |form: Self| keys.iter().map(|key| length(&form.path(key))).sum::<f64>();
        let mut best = (CLEARLY * length(known), known);
        for form in forms {
            let length = length(form);
            if length < best.0 {
                best = (length, form);
            }
        }
        best.1
    }

    /// A knot as point, forward handle, backward handle.
    fn knot(&self, [at, a, b]: Knot) -> Knot {
        let place = |handle: Point| self.origin.map_or(handle, |origin| at + handle - origin);
        if self.swapped { [at, place(b), place(a)] } else { [at, place(a), place(b)] }
    }

    /// The path of a form.
    pub fn path(&self, form: &Form) -> Path {
        if form.spline {
            let guides: Vec<Point> = form.knots.iter().map(|knot| knot[0]).collect();
            return Path::spline(&guides, form.closed);
        }
        let knots: Vec<Knot> = form.knots.iter().map(|knot| self.knot(*knot)).collect();
        Path::through(&knots, form.closed)
    }
}

/// Length of a control polygon.
fn length(path: &Path) -> f64 {
    let mut from = path.start;
    path.segments.iter().flatten().map(|&p| std::mem::replace(&mut from, p).distance(p)).sum()
}
