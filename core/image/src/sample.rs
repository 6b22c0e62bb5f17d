//! Bilinear reading at points between pixels, with derivatives.
//!
//! Points are picture coordinates: the centre of the top left pixel is (0.5, 0.5). Between centres the value is
//! bilinear. Beyond the outermost centres the border continues unchanged. The value is therefore defined and continuous
//! on the complete plane.
//!
//! The derivative is that of this function, not a filtered gradient. A solver that compares its step with the value
//! therefore never finds a contradiction. The derivative by x does not change along x within a cell, nor that by y
//! along y. It jumps on the lines through pixel centres, where it is the one towards larger coordinates. It is zero
//! where the border continues.
//!
//! Limits: a point with a NaN coordinate reads as NaN.

use super::pixel::Pixel;
use rototoon_base::geometry::Point;
use rototoon_base::scene::Raster;

/// A value and its derivatives by x and y, per pixel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Slope<T> {
    /// The value that [`read`] returns.
    pub value: T,
    /// Derivative by x.
    pub dx: T,
    /// Derivative by y.
    pub dy: T,
}

/// The position of a coordinate on an axis.
struct Place {
    low: usize,
    high: usize,
    share: f32,
    inside: bool,
}

#[inline]
fn place(coordinate: f64, len: usize) -> Place {
    let from_centre = coordinate - 0.5;
    let last = len - 1;
    let held = from_centre.clamp(0.0, last as f64);
    let low = held as usize;
    Place {
        low,
        high: (low + 1).min(last),
        share: (held - low as f64) as f32,
        inside: from_centre >= 0.0 && low < last,
    }
}

/// The value at `point`, in picture coordinates.
///
/// # Panics
///
/// If the picture is empty.
#[inline]
pub fn read<T: Pixel>(picture: &Raster<T>, point: Point) -> T {
    let (x, y) = (place(point.x, picture.width()), place(point.y, picture.height()));
    let (top, bottom) = (picture.row(y.low), picture.row(y.high));
    let (u, v) = (x.share, y.share);
    T::ZERO
        .plus((1.0 - u) * (1.0 - v), top[x.low])
        .plus(u * (1.0 - v), top[x.high])
        .plus((1.0 - u) * v, bottom[x.low])
        .plus(u * v, bottom[x.high])
}

/// The value at `point`, in picture coordinates, and its derivatives.
///
/// # Panics
///
/// If the picture is empty.
#[inline]
pub fn read_slope<T: Pixel>(picture: &Raster<T>, point: Point) -> Slope<T> {
    let (x, y) = (place(point.x, picture.width()), place(point.y, picture.height()));
    let (top, bottom) = (picture.row(y.low), picture.row(y.high));
    let [a, b, c, d] = [top[x.low], top[x.high], bottom[x.low], bottom[x.high]];
    let (u, v) = (x.share, y.share);
    let value = T::ZERO.plus((1.0 - u) * (1.0 - v), a).plus(u * (1.0 - v), b).plus((1.0 - u) * v, c).plus(u * v, d);
    let dx = if x.inside { T::ZERO.plus(1.0 - v, b).plus(v - 1.0, a).plus(v, d).plus(-v, c) } else { T::ZERO };
    let dy = if y.inside { T::ZERO.plus(1.0 - u, c).plus(u - 1.0, a).plus(u, d).plus(-u, b) } else { T::ZERO };
    Slope { value, dx, dy }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn pictures() -> impl Strategy<Value = Raster<f32>> {
        (1usize..9, 1usize..9).prop_flat_map(|(w, h)| {
            prop::collection::vec(0.0f32..1.0, w * h).prop_map(move |data| Raster::from_vec(w, h, data).unwrap())
        })
    }

    proptest! {
        #[test]
        fn slope_is_the_difference_of_values(picture in pictures(), x in -3.0f64..12.0, y in -3.0f64..12.0) {
            // Differences across a line of pixel centres would mix two slopes.
            let h = 1e-2;
            let clear = |c: f64| ((c - 0.5).rem_euclid(1.0) - 0.5).abs() < 0.5 - 2.0 * h;
            prop_assume!(clear(x) && clear(y));
            let slope = read_slope(&picture, Point::new(x, y));
            let at = |dx, dy| read(&picture, Point::new(x + dx, y + dy)) as f64;
            prop_assert_eq!(slope.value, read(&picture, Point::new(x, y)));
            prop_assert!((slope.dx as f64 - (at(h, 0.0) - at(-h, 0.0)) / (2.0 * h)).abs() < 1e-4);
            prop_assert!((slope.dy as f64 - (at(0.0, h) - at(0.0, -h)) / (2.0 * h)).abs() < 1e-4);
        }

        #[test]
        fn colours_read_channel_by_channel(picture in pictures(), x in -1.0f64..9.0, y in -1.0f64..9.0) {
            let coloured = picture.map(|v| [v, 1.0 - v, 0.5]);
            let p = Point::new(x, y);
            let (all, one) = (read_slope(&coloured, p), read_slope(&picture, p));
            prop_assert_eq!((all.value[0], all.dx[0], all.dy[0]), (one.value, one.dx, one.dy));
            prop_assert!((all.value[1] - (1.0 - one.value)).abs() < 1e-6);
            prop_assert!((all.value[2] - 0.5).abs() < 1e-6 && all.dx[2].abs() < 1e-6);
        }
    }

    #[test]
    fn centres_and_borders() {
        let picture = Raster::from_fn(2, 2, |x, y| (x + 2 * y) as f32);
        assert_eq!(read(&picture, Point::new(0.5, 0.5)), 0.0);
        assert_eq!(read(&picture, Point::new(1.5, 1.5)), 3.0);
        assert_eq!(read(&picture, Point::new(1.0, 1.0)), 1.5);
        let outside = read_slope(&picture, Point::new(-1e300, f64::INFINITY));
        assert_eq!(outside, Slope { value: 2.0, dx: 0.0, dy: 0.0 });
        let middle = read_slope(&picture, Point::new(1.0, 1.0));
        assert_eq!((middle.dx, middle.dy), (1.0, 2.0));
    }

    #[test]
    fn one_pixel_is_flat() {
        let picture = Raster::new(1, 1, [0.25f32; 3]);
        let slope = read_slope(&picture, Point::new(7.0, -3.0));
        assert_eq!(slope, Slope { value: [0.25; 3], dx: [0.0; 3], dy: [0.0; 3] });
        assert!(read(&picture, Point::new(f64::NAN, 0.0))[0].is_nan());
    }
}
