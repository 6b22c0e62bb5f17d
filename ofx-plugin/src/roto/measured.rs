//! The scale at which a host really gives its pixels.
//!
//! By OpenFX the bounds of a complete image are its region times the render scale, divided by the pixel aspect ratio. Some
//! hosts give images at a reduced size and say that the scale is 1, or keep the region of another size. A figure would then
//! come out too small or too large. Such bounds can be recognised, because they contradict the region:
//!
//! - the rectangle of the complete picture, which the image names, has another size than the region; or
//! - the image is larger than its region, which no tile is; or
//! - the host has no tiles, and an image is smaller than its region.
//!
//! In each case width and height must differ by the same factor. That factor is the missing part of the scale. It must be far from 1: a
//! host may render a bit more than the region, such as the whole frame around shapes that nearly fill it. An output as large as the
//! frame at the scale that is said is the frame, however small the region of the shapes is.

use crate::ofx::effect::Region;
use crate::ofx::{Bounds, Clip, Image, host};

/// Differences of at most this many pixels are rounding.
const ROUNDING: f64 = 2.0;
/// Most by which the factors of width and height differ, as a share.
const UNEQUAL: f64 = 0.03;
/// Factors between this and its inverse are none.
const NEAR: f64 = 1.25;

/// The scale of the pixels of an image of a clip. `scale` is what the host says, and `frame` a rectangle that an honest image may have
/// beside its region.
pub fn scale(
    (clip, image): (&Clip, &Image),
    frame: Option<Region>,
    window: Bounds,
    time: f64,
    scale: [f64; 2],
) -> [f64; 2] {
    let Some(region) = clip.region(time) else { return scale };
    let seen = Seen { bounds: image.bounds, whole: image.whole, window, tiles: host::tiles(), frame };
    let factor = seen.factor(&region, [scale[0] / clip.pixel_aspect(), scale[1]]);
    scale.map(|scale| scale * factor)
}

/// The scale of a render: that of the output's pixels, or of the source's if the output's do not contradict. `frame` is the format of the
/// project.
pub fn of_render(
    output: (&Clip, &Image),
    source: Option<(&Clip, &Image)>,
    frame: Option<Region>,
    window: Bounds,
    time: f64,
    said: [f64; 2],
) -> [f64; 2] {
    let found = scale(output, frame, window, time, said);
    match source {
        Some((clip, image)) if found == said => scale((clip, image), None, image.bounds, time, said),
        _ => found,
    }
}

/// What an image says of itself.
#[derive(Clone, Copy, Debug)]
struct Seen {
    bounds: Bounds,
    whole: Option<Bounds>,
    window: Bounds,
    tiles: bool,
    frame: Option<Region>,
}

impl Seen {
    /// The factor by which the pixels differ from a region at a scale; 1 if they do not contradict it.
    fn factor(&self, region: &Region, scale: [f64; 2]) -> f64 {
        let wanted = [(region.x2 - region.x1) * scale[0], (region.y2 - region.y1) * scale[1]];
        let size = |b: Bounds| [f64::from(b.x2) - f64::from(b.x1), f64::from(b.y2) - f64::from(b.y1)];
        let larger = |found: [f64; 2]| found.iter().zip(wanted).all(|(f, w)| *f > w + ROUNDING);
        let smaller = |found: [f64; 2]| found.iter().zip(wanted).all(|(f, w)| *f < w - ROUNDING);
        let own = size(self.bounds);
        if larger(own) && self.frame.is_some_and(|frame| self.is_all_of(&frame, scale)) {
            return 1.0;
        }
        let complete = self.bounds == self.window;
        let found = match self.whole.map(size) {
            Some(whole) if complete && (larger(whole) || smaller(whole)) && whole == own => whole,
            _ if complete && larger(own) => own,
            _ if complete && !self.tiles && smaller(own) => own,
            _ => return 1.0,
        };
        let factors = [found[0] / wanted[0], found[1] / wanted[1]];
        let corner = [f64::from(self.bounds.x1), f64::from(self.bounds.y1)];
        let origin = [region.x1 * scale[0] * factors[0], region.y1 * scale[1] * factors[1]];
        let placed = corner.iter().zip(origin).all(|(a, b)| (a - b).abs() <= ROUNDING);
        let equal = (factors[0] / factors[1] - 1.0).abs() <= UNEQUAL;
        let far = factors.iter().all(|f| f.is_finite() && *f > 0.0 && !(NEAR.recip()..=NEAR).contains(f));
        if placed && equal && far { factors[1] } else { 1.0 }
    }

    /// Whether the image is as large as a rectangle at a scale, and in its place.
    fn is_all_of(&self, frame: &Region, scale: [f64; 2]) -> bool {
        let sides = [self.bounds.x1, self.bounds.y1, self.bounds.x2, self.bounds.y2].map(f64::from);
        let wanted = [frame.x1 * scale[0], frame.y1 * scale[1], frame.x2 * scale[0], frame.y2 * scale[1]];
        sides.iter().zip(wanted).all(|(side, wanted)| (side - wanted).abs() <= ROUNDING)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const REGION: Region = Region { x1: 0.0, y1: 0.0, x2: 960.0, y2: 540.0 };

    fn bounds(x1: i32, y1: i32, x2: i32, y2: i32) -> Bounds {
        Bounds { x1, y1, x2, y2 }
    }

    #[test]
    fn contradicting_sizes_give_their_factor() {
        let (full, half) = (bounds(0, 0, 960, 540), bounds(0, 0, 480, 270));
        let seen = |bounds, whole, tiles| Seen { bounds, whole, window: bounds, tiles, frame: None };
        assert_eq!(seen(full, Some(full), true).factor(&REGION, [1.0; 2]), 1.0);
        assert_eq!(seen(half, Some(half), true).factor(&REGION, [0.5; 2]), 1.0);
        assert_eq!(seen(half, Some(half), true).factor(&REGION, [1.0; 2]), 0.5);
        assert_eq!(seen(full, None, true).factor(&REGION, [0.5; 2]), 2.0);
        assert_eq!(seen(half, None, false).factor(&REGION, [1.0; 2]), 0.5);
    }

    #[test]
    fn tiles_and_other_shapes_do_not_contradict() {
        let (full, half) = (bounds(0, 0, 960, 540), bounds(0, 0, 480, 270));
        let tile = Seen { bounds: half, whole: Some(full), window: half, tiles: true, frame: None };
        assert_eq!(tile.factor(&REGION, [1.0; 2]), 1.0);
        let unsaid = Seen { bounds: half, whole: None, window: half, tiles: true, frame: None };
        assert_eq!(unsaid.factor(&REGION, [1.0; 2]), 1.0);
        let square = bounds(0, 0, 500, 500);
        let odd = Seen { bounds: square, whole: Some(square), window: square, tiles: false, frame: None };
        assert_eq!(odd.factor(&REGION, [1.0; 2]), 1.0);
        let margin = bounds(-3, -3, 963, 543);
        let larger = Seen { bounds: margin, whole: Some(full), window: full, tiles: true, frame: None };
        assert_eq!(larger.factor(&REGION, [1.0; 2]), 1.0);
    }

    #[test]
    fn a_frame_around_shapes_that_nearly_fill_it_is_no_other_scale() {
        let seen = |bounds, frame| Seen { bounds, whole: None, window: bounds, tiles: true, frame };
        let shapes = Region { x1: 1.0, y1: 1.0, x2: 61.0, y2: 45.5 };
        assert_eq!(seen(bounds(0, 0, 64, 48), None).factor(&shapes, [1.0; 2]), 1.0);
        // A quarter of the frame: only what the frame is tells it from a picture of twice the size.
        let quarter = Region { x1: 0.0, y1: 0.0, x2: 480.0, y2: 270.0 };
        let full = bounds(0, 0, 960, 540);
        assert_eq!(seen(full, Some(REGION)).factor(&quarter, [1.0; 2]), 1.0);
        assert_eq!(seen(full, None).factor(&quarter, [1.0; 2]), 2.0);
        assert_eq!(seen(full, Some(REGION)).factor(&REGION, [0.5; 2]), 2.0);
    }
}
