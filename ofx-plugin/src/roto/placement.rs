//! Places the footage's pixels in the host's picture: converts between the core's coordinates and the host's.
//!
//! The core has y down from the upper left corner of the footage. The host's canonical coordinates have y up and square
//! pixels at full size. Its pixel coordinates are the canonical ones times the render scale; x is also divided by the pixel
//! aspect ratio. Drawing uses **pixels with y turned down**: row `v` is the host's row `-1 - v`. So it does not depend on
//! the height of a picture.

use super::rectangles::{self, Rectangles};
use crate::description::OUTPUT;
use crate::ofx::effect::Region;
use crate::ofx::{Bounds, Effect, Failure};
use rototoon::geometry::Point;
use rototoon::render::coverage::Window;
use rototoon::render::mask;
use rototoon::scene::Footage;

/// Converts footage coordinates to pixels with y turned down, and to and from canonical coordinates.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Placement {
    factor: Point,
    shift: Point,
    /// Pixels per canonical unit.
    scale: Point,
    /// Whether the footage is not stretched: one of its pixels is one pixel of the host's picture at full size.
    pub matches: bool,
}

impl Placement {
    /// Places the footage on the rectangle of the whole picture ([`Rectangles::chosen`]).
    pub fn of(effect: &Effect, footage: &Footage, time: f64, render_scale: [f64; 2]) -> Result<Self, Failure> {
        let aspect = effect.clip(OUTPUT)?.pixel_aspect();
        let own = Region { x1: 0.0, y1: 0.0, x2: footage.width as f64 * aspect, y2: footage.height as f64 };
        let known = Rectangles::of(effect, time)?;
        let chosen = known.chosen([own.x2, own.y2], || rectangles::first_region(effect, footage, time));
        let (region, matches) = chosen.unwrap_or((own, true));
        Ok(Self::new(footage, &region, aspect, render_scale, matches))
    }

    /// Stretches the footage over a region of canonical coordinates. `aspect` is the width of a pixel over its height.
    pub fn new(footage: &Footage, region: &Region, aspect: f64, render_scale: [f64; 2], matches: bool) -> Self {
        let scale = Point::new(render_scale[0] / aspect, render_scale[1]);
        let size = Point::new(region.x2 - region.x1, region.y2 - region.y1);
        let factor = size * scale / Point::new(footage.width.max(1) as f64, footage.height.max(1) as f64);
        Self { factor, shift: Point::new(region.x1, -region.y2) * scale, scale, matches }
    }

    /// Converts a point of the footage to pixels with y turned down.
    pub fn place(&self, p: Point) -> Point {
        p * self.factor + self.shift
    }

    /// The number of pixels for each pixel of the footage, on the axis on which there are more.
    pub fn magnification(&self) -> f64 {
        self.factor.max_element()
    }

    /// Converts a point of the footage, times [`Self::magnification`], to pixels with y turned down. So widths at that scale are
    /// squeezed with the footage where it is stretched.
    pub fn place_magnified(&self, p: Point) -> Point {
        p * (self.factor / self.magnification()) + self.shift
    }

    /// Converts a point of the footage to canonical coordinates.
    pub fn shown(&self, p: Point) -> [f64; 2] {
        let placed = self.place(p) / self.scale;
        [placed.x, -placed.y]
    }

    /// Converts canonical coordinates to a point of the footage.
    pub fn footage(&self, [x, y]: [f64; 2]) -> Point {
        (Point::new(x, -y) * self.scale - self.shift) / self.factor
    }

    /// Converts a length in pixels at full size to pixels at the render scale.
    pub fn length(&self, pixels: f64) -> f64 {
        pixels * self.scale.y
    }

    /// Converts a region of canonical coordinates to a window of whole pixels with y turned down that contains it.
    pub fn window(&self, region: &Region) -> Window {
        let [least, most] =
            [Point::new(region.x1, -region.y2), Point::new(region.x2, -region.y1)].map(|corner| corner * self.scale);
        let [left, top] = least.floor().to_array().map(|value| value as i64);
        let [right, bottom] = most.ceil().to_array().map(|value| value as i64);
        Window { left, top, right, bottom }
    }

    /// Converts bounds in pixels with y turned down to canonical coordinates.
    pub fn canonical(&self, bounds: &mask::Bounds) -> Region {
        let (least, most) = (bounds.least / self.scale, bounds.most / self.scale);
        Region { x1: least.x, y1: -most.y, x2: most.x, y2: -least.y }
    }
}

/// Converts a rectangle of the host's pixels to a window with y turned down.
pub fn window(bounds: &Bounds) -> Window {
    // Turned down in 64 bits: a host may say "infinite" with the least 32-bit number, which has no positive counterpart.
    let [left, y1, right, y2] = [bounds.x1, bounds.y1, bounds.x2, bounds.y2].map(i64::from);
    Window { left, top: -y2, right, bottom: -y1 }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn footage(width: usize, height: usize) -> Footage {
        Footage { pattern: "%d.png".into(), first: 0, last: 1, fps: 24.0, width, height, held: false }
    }

    #[test]
    fn corners_are_converted_both_ways() {
        let region = Region { x1: 10.0, y1: 20.0, x2: 110.0, y2: 70.0 };
        let placement = Placement::new(&footage(100, 50), &region, 1.0, [1.0, 1.0], true);
        assert_eq!(placement.place(Point::ZERO), Point::new(10.0, -70.0));
        assert_eq!(placement.place(Point::new(100.0, 50.0)), Point::new(110.0, -20.0));
        let half = Placement::new(&footage(100, 50), &region, 2.0, [0.5, 0.5], true);
        let bounds = mask::Bounds { least: half.place(Point::ZERO), most: half.place(Point::new(100.0, 50.0)) };
        assert_eq!(half.canonical(&bounds), region);
        let p = Point::new(13.0, 37.5);
        assert_eq!((half.magnification(), half.place_magnified(p * 0.5)), (0.5, Point::new(5.75, -16.25)));
        assert_eq!(half.place_magnified(p * 0.5), half.place(p));
        assert_eq!(half.footage(half.shown(p)), p);
        assert_eq!(half.shown(Point::ZERO), [10.0, 70.0]);
        assert_eq!(half.place(Point::new(100.0, 50.0)), Point::new(27.5, -10.0));
    }

    #[test]
    fn rows_are_turned_down() {
        let bounds = Bounds { x1: 1, y1: 2, x2: 5, y2: 9 };
        assert_eq!(window(&bounds), Window { left: 1, top: -9, right: 5, bottom: -2 });
    }

    #[test]
    fn infinite_rectangles_are_turned_down_too() {
        let all = Bounds { x1: i32::MIN, y1: i32::MIN, x2: i32::MAX, y2: i32::MAX };
        let (least, most) = (i64::from(i32::MIN), i64::from(i32::MAX));
        assert_eq!(window(&all), Window { left: least, top: -most, right: most, bottom: -least });
    }
}
