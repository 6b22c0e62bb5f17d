//! Places along the normal of a sample, on a level of the pyramid:
//!
//! ```text
//! p(α) = c / 2ˡ + α n,   n = d^⊥/‖d‖,   ∂p/∂c = 2⁻ˡ,   ∂p/∂d = −(α/‖d‖) d̂ nᵀ
//! ```
//!
//! c is the sample's place, d is the curve's direction there (^⊥ turns x to y), and d̂ = d/‖d‖. Offsets α are in pixels
//! of the level, so the window covers more of the picture on coarse levels. Where the curve has no direction it has no
//! normal: then all offsets read the sample's own place.

use rototoon_base::geometry::Point;

/// The normal of a sample on a level.
#[derive(Clone, Copy, Debug)]
pub struct Profile {
    place: Point,
    along: Point,
    normal: Point,
    /// 1/‖d‖; 0 without a direction.
    slowness: f64,
    /// 2⁻ˡ.
    shrink: f64,
}

impl Profile {
    /// The normal at a place with a direction, both in working pixels.
    pub fn new(place: Point, direction: Point, level: usize) -> Self {
        let shrink = 0.5f64.powi(level as i32);
        let along = direction.normalize_or_zero();
        let slowness = if along == Point::ZERO { 0.0 } else { direction.length_recip() };
        Self { place: place * shrink, along, normal: along.perp(), slowness, shrink }
    }

    /// p(α) in pixels of the level.
    pub fn at(&self, offset: f64) -> Point {
        self.place + offset * self.normal
    }

    /// p(α) in working pixels.
    pub fn in_picture(&self, offset: f64) -> Point {
        self.at(offset) / self.shrink
    }

    /// Derivatives by the place and by the direction of a value that has the gradient `slope` (per pixel of the level)
    /// at p(α).
    pub fn by(&self, offset: f64, slope: Point) -> [Point; 2] {
        [self.shrink * slope, (-offset * self.slowness * slope.dot(self.along)) * self.normal]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_derivatives_are_those_of_the_place() {
        let (place, direction, slope) = (Point::new(31.0, 17.0), Point::new(2.0, -5.0), Point::new(0.7, -1.3));
        for (level, offset) in [(0, 4.0), (2, -3.0), (3, 0.0)] {
            let value = |c: Point, d: Point| slope.dot(Profile::new(c, d, level).at(offset));
            let [by_place, by_direction] = Profile::new(place, direction, level).by(offset, slope);
            for axis in [Point::X, Point::Y] {
                let h = 1e-5 * axis;
                let numeric = (value(place + h, direction) - value(place - h, direction)) / 2e-5;
                assert!((numeric - by_place.dot(axis)).abs() < 1e-8);
                let numeric = (value(place, direction + h) - value(place, direction - h)) / 2e-5;
                assert!((numeric - by_direction.dot(axis)).abs() < 1e-8);
            }
        }
    }

    #[test]
    fn normals_point_to_the_right_of_the_way_on_the_screen() {
        let profile = Profile::new(Point::new(8.0, 4.0), Point::new(3.0, 0.0), 1);
        assert_eq!(profile.at(2.0), Point::new(4.0, 4.0));
        assert_eq!(profile.in_picture(2.0), Point::new(8.0, 8.0));
        assert_eq!(Profile::new(Point::ONE, Point::ZERO, 0).at(9.0), Point::ONE);
    }
}
