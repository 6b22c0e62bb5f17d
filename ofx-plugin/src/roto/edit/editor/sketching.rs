//! The contour that is being drawn: its points, and what becomes of it when it is finished.

use super::{CLICK, Edit, Editor, Outcome, Sketch, Tool, Work};
use crate::roto::edit::{Selection, contour, hit};
use rototoon::geometry::Point;

impl Editor {
    /// The unfinished contour, which [`Self::restore`] takes back where its edit cannot be stored.
    pub fn unfinished(&self) -> Option<Sketch> {
        self.sketch.clone()
    }

    /// Whether the pen holds nothing and draws nothing, so that its movements mean nothing here.
    pub fn is_idle(&self) -> bool {
        self.drag.is_none() && self.sketch.is_none()
    }

    /// Takes an unfinished contour back.
    pub fn restore(&mut self, sketch: Option<Sketch>) {
        self.sketch = sketch;
    }

    pub(super) fn set_point(&mut self, work: &Work, pen: Point) -> Outcome {
        let sketch = self.sketch.take().filter(|sketch| sketch.frame == work.frame);
        let mut sketch = sketch.unwrap_or(Sketch { frame: work.frame, points: Vec::new(), pen });
        let near = |at: Option<&Point>| at.is_some_and(|at| work.lens.distance(*at, pen) <= hit::NEAR_POINT);
        let ends = if work.closed {
            sketch.points.len() > 2 && near(sketch.points.first())
        } else {
            sketch.points.len() > 1 && near(sketch.points.last())
        };
        if ends {
            return self.finish(work, sketch);
        }
        // A double click sets one point.
        if !near(sketch.points.last()) || sketch.points.is_empty() {
            sketch.points.push(pen);
        }
        sketch.pen = pen;
        self.sketch = Some(sketch);
        Outcome::Shown
    }

    pub(super) fn finish(&mut self, work: &Work, sketch: Sketch) -> Outcome {
        let set = work.tool != Tool::Freehand;
        let points =
            if set { sketch.points.clone() } else { contour::simplified(&sketch.points, work.closed, &work.lens) };
        let mut document = work.draft();
        match contour::draw(&mut document, work.frame, work.name, points, work.closed, set) {
            Ok(part) => {
                self.select(Selection::part(part, &document.scene), &document.scene);
                Outcome::Edited(Edit { label: "Draw contour", document })
            }
            Err(refused) => {
                // A click with the freehand tool is no stroke that could be finished.
                let long = |at: &Point| work.lens.distance(*at, sketch.points[0]) > CLICK;
                self.sketch = (set || sketch.points.iter().any(long)).then_some(sketch);
                Outcome::Refused(refused)
            }
        }
    }
}
