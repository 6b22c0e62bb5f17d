//! The box around the selection. Its inside moves the selection, its corners scale it about the opposite corner, its sides
//! scale it along one axis, and the handle above it rotates it about its middle.

use super::Lens;
use rototoon::geometry::Point;

/// Largest distance at which a handle is picked, in screen pixels.
const NEAR: f64 = 7.0;
/// Distance of the box from the points, in screen pixels.
const MARGIN: f64 = 14.0;
/// Distance of the handle for rotation from the box, in screen pixels.
const STEM: f64 = 24.0;
/// Least extent that is scaled, in screen pixels. A flat selection is not scaled across.
const FLAT: f64 = 0.5;

/// A part of the box that the pen drags.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Handle {
    /// A corner or a side: −1, 0 or 1 in x and y.
    Scale(i8, i8),
    /// The handle for rotation.
    Rotate,
}

/// The box around points.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Handles {
    /// Upper left corner of the points.
    least: Point,
    /// Lower right corner of the points.
    most: Point,
    /// From the points to the box.
    margin: Point,
    stem: f64,
}

/// A change of all selected points: about a centre they are scaled, turned and then shifted.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Transform {
    /// The point that scaling and rotation keep.
    pub about: Point,
    /// Factors of x and y.
    pub scale: Point,
    /// Cosine and sine of the rotation.
    pub turn: Point,
    /// How far the points move.
    pub shift: Point,
    /// Width and height of a pixel on the screen. Rotation keeps shapes there.
    pub pixel: Point,
}

impl Transform {
    /// A shift.
    pub fn shift(by: Point) -> Self {
        Self { about: Point::ZERO, scale: Point::ONE, turn: Point::X, shift: by, pixel: Point::ONE }
    }

    /// Where a point goes. A shift is added exactly.
    pub fn apply(&self, p: Point) -> Point {
        if self.is_shift() {
            return p + self.shift;
        }
        self.about + self.turn.rotate((p - self.about) * self.scale * self.pixel) / self.pixel + self.shift
    }

    /// Whether it is only a shift.
    pub fn is_shift(&self) -> bool {
        self.scale == Point::ONE && self.turn == Point::X
    }
}

impl Handles {
    /// The box around points; `None` for fewer than two.
    pub fn around(points: impl IntoIterator<Item = Point>, lens: &Lens) -> Option<Self> {
        let (mut least, mut most, mut count) = (Point::MAX, Point::MIN, 0);
        for p in points {
            (least, most, count) = (least.min(p), most.max(p), count + 1);
        }
        let margin = lens.footage(Point::splat(MARGIN));
        (count > 1).then(|| Self { least, most, margin, stem: lens.footage(Point::splat(STEM)).y })
    }

    /// The corners of the box in order.
    pub fn corners(&self) -> [Point; 4] {
        let (a, b) = (self.least - self.margin, self.most + self.margin);
        [a, Point::new(b.x, a.y), b, Point::new(a.x, b.y)]
    }

    /// All handles with their places.
    pub fn places(&self) -> Vec<(Handle, Point)> {
        let (a, b) = (self.least - self.margin, self.most + self.margin);
        let middle = (a + b) * 0.5;
        let at = |k: i8, low: f64, mid: f64, high: f64| match k {
            -1 => low,
            0 => mid,
            _ => high,
        };
        let mut places = vec![(Handle::Rotate, Point::new(middle.x, a.y - self.stem))];
        for (x, y) in [(-1, -1), (0, -1), (1, -1), (1, 0), (1, 1), (0, 1), (-1, 1), (-1, 0)] {
            let place = Point::new(at(x, a.x, middle.x, b.x), at(y, a.y, middle.y, b.y));
            places.push((Handle::Scale(x, y), place));
        }
        places
    }

    /// The handle under the pen.
    pub fn hit(&self, lens: &Lens, pen: Point) -> Option<Handle> {
        let near = self.places().into_iter().map(|(handle, at)| (handle, lens.distance(at, pen)));
        let near = near.filter(|(_, distance)| *distance <= NEAR);
        near.min_by(|(_, a), (_, b)| a.total_cmp(b)).map(|(handle, _)| handle)
    }

    /// What dragging a handle from one place to another does. With `even`, both axes are scaled alike, and rotation goes in
    /// steps of 15 degrees.
    pub fn drag(&self, handle: Handle, from: Point, to: Point, even: bool, lens: &Lens) -> Transform {
        let middle = (self.least + self.most) * 0.5;
        let pixel = lens.screen(Point::ONE);
        let same = Transform { about: middle, pixel, ..Transform::shift(Point::ZERO) };
        match handle {
            Handle::Rotate => {
                let (a, b) = (lens.screen(from - middle), lens.screen(to - middle));
                if a.length_squared() == 0.0 || b.length_squared() == 0.0 {
                    return same;
                }
                let mut angle = b.to_angle() - a.to_angle();
                if even {
                    let step = 15f64.to_radians();
                    angle = (angle / step).round() * step;
                }
                Transform { turn: Point::from_angle(angle), ..same }
            }
            Handle::Scale(x, y) => {
                let fixed = |k: i8, low: f64, mid: f64, high: f64| match k {
                    -1 => high,
                    0 => mid,
                    _ => low,
                };
                let about = Point::new(
                    fixed(x, self.least.x, middle.x, self.most.x),
                    fixed(y, self.least.y, middle.y, self.most.y),
                );
                let size = lens.screen(self.most - self.least);
                let factor = |k: i8, from: f64, to: f64, size: f64| {
                    if k == 0 || size < FLAT || from.abs() < 1e-9 { 1.0 } else { to / from }
                };
                let (a, b) = (from - about, to - about);
                let mut scale = Point::new(factor(x, a.x, b.x, size.x), factor(y, a.y, b.y, size.y));
                if even && x != 0 && y != 0 {
                    let along = if a.length_squared() > 0.0 { b.dot(a) / a.length_squared() } else { 1.0 };
                    scale = Point::splat(along);
                }
                Transform { about, scale, ..same }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn p(x: f64, y: f64) -> Point {
        Point::new(x, y)
    }

    #[test]
    fn handles_scale_about_the_opposite_side_and_rotate_about_the_middle() {
        let lens = Lens::new(Point::ONE);
        let handles = Handles::around([p(10.0, 10.0), p(30.0, 20.0)], &lens).unwrap();
        let place = |wanted| handles.places().into_iter().find(|(handle, _)| *handle == wanted).unwrap().1;
        let corner = Handle::Scale(1, 1);
        assert_eq!(handles.hit(&lens, place(corner) + p(3.0, -2.0)), Some(corner));
        assert_eq!(handles.hit(&lens, p(20.0, 15.0)), None);
        let doubled = handles.drag(corner, p(30.0, 20.0), p(50.0, 30.0), false, &lens);
        assert_eq!(doubled.apply(p(10.0, 10.0)), p(10.0, 10.0));
        assert_eq!(doubled.apply(p(30.0, 20.0)), p(50.0, 30.0));
        let wide = handles.drag(Handle::Scale(-1, 0), p(10.0, 15.0), p(20.0, 99.0), false, &lens);
        assert_eq!(wide.apply(p(10.0, 10.0)), p(20.0, 10.0));
        let turned = handles.drag(Handle::Rotate, p(20.0, 5.0), p(30.0, 15.0), false, &lens);
        assert!(turned.apply(p(30.0, 15.0)).distance(p(20.0, 25.0)) < 1e-12);
        let stepped = handles.drag(Handle::Rotate, p(20.0, 5.0), p(29.0, 14.0), true, &lens);
        assert!((stepped.turn.to_angle().to_degrees() - 90.0).abs() < 1e-9);
        let even = handles.drag(corner, p(30.0, 20.0), p(50.0, 30.0), true, &lens);
        assert_eq!(even.scale, Point::splat(2.0));
    }

    #[test]
    fn a_flat_selection_is_not_scaled_across_and_hits_are_in_screen_pixels() {
        let lens = Lens::new(p(0.1, 0.2));
        let handles = Handles::around([p(10.0, 10.0), p(300.0, 10.0)], &lens).unwrap();
        let tall = handles.drag(Handle::Scale(0, 1), p(155.0, 80.0), p(155.0, 400.0), false, &lens);
        assert_eq!(tall.apply(p(10.0, 10.0)), p(10.0, 10.0));
        let (handle, at) = handles.places()[3];
        assert_eq!(handles.hit(&lens, at + p(60.0, 0.0)), Some(handle));
        assert_eq!(handles.hit(&lens, at + p(80.0, 0.0)), None);
        assert_eq!(Handles::around([p(1.0, 1.0)], &lens), None);
    }
}
