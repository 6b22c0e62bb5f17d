//! Draws lines, marks and texts over the viewer. Places are in pixels of the footage, sizes in screen pixels.

use super::edit::Lens;
use super::placement::Placement;
use crate::ofx::interact::View;
use rototoon::geometry::Point;

/// Length of a dash and of a gap, in screen pixels.
const DASH: f64 = 6.0;

/// Draws in pixels of the footage.
pub struct Pen<'a> {
    /// The viewer.
    pub view: &'a View<'a>,
    /// The placement of the footage.
    pub placement: &'a Placement,
    /// Distances on the screen.
    pub lens: Lens,
}

impl Pen<'_> {
    fn place(&self, p: Point) -> [f64; 2] {
        self.placement.shown(p)
    }

    /// A line. `width` is in screen pixels.
    pub fn line(&self, points: &[Point], closed: bool, colour: [f32; 4], width: f32) {
        let points: Vec<[f64; 2]> = points.iter().map(|&p| self.place(p)).collect();
        self.view.line(&points, closed, colour, width);
    }

    /// A square of a half side in screen pixels. A filled one has its diagonals too, because overlays only draw lines.
    pub fn square(&self, at: Point, half: f64, colour: [f32; 4], filled: bool) {
        let [x, y] = self.place(at);
        let [w, h] = self.view.pixel.map(|pixel| half * pixel);
        let corners = [[x - w, y - h], [x + w, y - h], [x + w, y + h], [x - w, y + h]];
        self.view.line(&corners, true, colour, 1.0);
        if filled {
            let rows = (-(half as i32) + 1)..(half as i32);
            for row in rows {
                let y = y + f64::from(row) * self.view.pixel[1];
                self.view.line(&[[x - w, y], [x + w, y]], false, colour, 1.0);
            }
        }
    }

    /// A cross whose arms have a length in screen pixels.
    pub fn cross(&self, at: Point, half: f64, colour: [f32; 4]) {
        let [x, y] = self.place(at);
        let [w, h] = self.view.pixel.map(|pixel| half * pixel);
        self.view.line(&[[x - w, y], [x + w, y]], false, colour, 1.0);
        self.view.line(&[[x, y - h], [x, y + h]], false, colour, 1.0);
    }

    /// A dashed line. `width` is in screen pixels.
    pub fn dashes(&self, points: &[Point], closed: bool, colour: [f32; 4], width: f32) {
        let mut along = 0.0;
        for (a, b) in rototoon::geometry::polyline::segments(points, closed) {
            let length = self.lens.distance(a, b);
            let mut done = 0.0;
            while done < length {
                let left = DASH - along % DASH;
                let next = (done + left).min(length);
                if (along / DASH) as i64 % 2 == 0 {
                    self.line(&[a.lerp(b, done / length), a.lerp(b, next / length)], false, colour, width);
                }
                along += next - done;
                done = next;
                // Rounding must not end on the same dash for ever.
                if left < 1e-9 {
                    along += 1e-6;
                }
            }
        }
    }

    /// A text at a point of the footage, moved by screen pixels right and up. A dark copy behind it keeps it legible on
    /// white paper.
    pub fn text(&self, text: &str, at: Point, [right, up]: [f64; 2], colour: [f32; 4]) {
        let ([x, y], [w, h]) = (self.place(at), self.view.pixel);
        let place = |right: f64, up: f64| [x + right * w, y + up * h];
        self.view.text(text, place(right + 1.0, up - 1.0), [0.0, 0.0, 0.0, colour[3]]);
        self.view.text(text, place(right, up), colour);
    }
}
