//! Soft borders: a matte blurred by a bell of finite width.
//!
//! The bell is the quadratic B-spline stretched over twice the radius, integrated over each pixel, so that its width may be
//! any number of pixels and changes smoothly; rows and then columns are blurred by it. A straight border becomes an even,
//! smooth rise that begins a radius before it and ends a radius behind it.

use crate::scene::Raster;

/// The pixels on each side that a blur by a radius reaches over.
pub fn reach(radius: f64) -> usize {
    if radius > 0.0 { (radius + 0.5).ceil() as usize } else { 0 }
}

/// A picture blurred by a radius in pixels, and smaller by [`reach`] on each side: what lies nearer to its border is not
/// known. `None` where `go_on`, asked at each row, says no.
pub fn feathered(picture: &Raster<f32>, radius: f64, go_on: &mut dyn FnMut() -> bool) -> Option<Raster<f32>> {
    let margin = reach(radius);
    if margin == 0 {
        return Some(picture.clone());
    }
    let weights = weights(radius);
    let (width, height) = (picture.width().saturating_sub(2 * margin), picture.height().saturating_sub(2 * margin));
    let mut rows = Raster::new(width, picture.height(), 0.0f32);
    for y in 0..picture.height() {
        if !go_on() {
            return None;
        }
        let (from, to) = (picture.row(y), rows.row_mut(y));
        for (offset, weight) in weights.iter().enumerate() {
            for (sum, value) in to.iter_mut().zip(&from[offset..]) {
                *sum += weight * value;
            }
        }
    }
    let mut result = Raster::new(width, height, 0.0f32);
    for y in 0..height {
        if !go_on() {
            return None;
        }
        let to = result.row_mut(y);
        for (offset, weight) in weights.iter().enumerate() {
            for (sum, value) in to.iter_mut().zip(rows.row(y + offset)) {
                *sum += weight * value;
            }
        }
    }
    Some(result)
}

/// The bell's share of each pixel from one end to the other.
fn weights(radius: f64) -> Vec<f32> {
    let margin = reach(radius) as f64;
    let until = |x: f64| integral(1.5 * x / radius);
    (0..=2 * reach(radius)).map(|k| k as f64 - margin).map(|x| (until(x + 0.5) - until(x - 0.5)) as f32).collect()
}

/// The integral of the quadratic B-spline, whose support is -1.5 to 1.5.
fn integral(x: f64) -> f64 {
    let tail = |x: f64| x.powi(3) / 6.0;
    match x {
        x if x <= -1.5 => 0.0,
        x if x <= -0.5 => tail(x + 1.5),
        x if x <= 0.5 => 0.5 + 0.75 * x - x.powi(3) / 3.0,
        x if x <= 1.5 => 1.0 - tail(1.5 - x),
        _ => 1.0,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_border_becomes_a_rise_of_twice_the_radius() {
        let border = Raster::from_fn(40, 31, |x, _| if x < 20 { 1.0 } else { 0.0 });
        let radius = 5.0;
        let soft = feathered(&border, radius, &mut || true).unwrap();
        let margin = reach(radius);
        assert_eq!((soft.width(), soft.height()), (40 - 2 * margin, 31 - 2 * margin));
        let row = soft.row(9);
        assert!(row.windows(2).all(|pair| pair[0] >= pair[1]));
        let at = |x: usize| row[x - margin];
        assert!((at(14) - 1.0).abs() < 1e-6 && at(26).abs() < 1e-6, "{row:?}");
        assert!((at(19) + at(20) - 1.0).abs() < 1e-5);
    }

    #[test]
    fn weights_sum_to_one_at_any_radius() {
        for radius in [0.01, 0.3, 0.5, 1.0, 2.7, 40.0] {
            let sum: f32 = weights(radius).iter().sum();
            assert!((sum - 1.0).abs() < 1e-5, "{radius} {sum}");
        }
    }

    #[test]
    fn no_radius_changes_nothing_and_it_ends_when_told() {
        let picture = Raster::from_fn(4, 3, |x, y| (x * y) as f32);
        assert_eq!(feathered(&picture, 0.0, &mut || true), Some(picture.clone()));
        assert_eq!(feathered(&picture, 1.0, &mut || false), None);
    }
}
