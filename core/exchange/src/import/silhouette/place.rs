//! Coordinates of a file and of the picture.
//!
//! The origin of a file is the middle of the picture, y points down, and the unit is the picture's height. With the width W and
//! the height H of the picture and the pixel aspect a of the file, a pixel (X, Y) is at
//!
//! x = (X − W ∕ 2) ∕ H · a, y = (Y − H ∕ 2) ∕ H.

use super::super::ImportError;
use super::super::problem::{number, quoted};
use rototoon_base::geometry::Point;
use rototoon_base::scene::Footage;
use roxmltree::Node;

/// Where coordinates of a file lie in the picture.
pub(super) struct Place {
    width: f64,
    height: f64,
    aspect: f64,
}

impl Place {
    /// The place of a file's coordinates, whose root may have a `pixelAspect`.
    pub fn read(root: Node, footage: &Footage) -> Result<Self, ImportError> {
        let aspect = number(root, "pixelAspect")?.unwrap_or(1.0);
        if !(0.01..=100.0).contains(&aspect) {
            let found = quoted(root.attribute("pixelAspect"));
            return Err(ImportError::at(root, format!("pixelAspect: found {found}, expected 0.01 to 100")));
        }
        Ok(Self { width: footage.width as f64, height: footage.height as f64, aspect })
    }

    /// A point of the file in pixels of the footage.
    pub fn pixels(&self, p: Point) -> Point {
        Point::new(p.x * self.height / self.aspect + 0.5 * self.width, (p.y + 0.5) * self.height)
    }

    /// A point in pixels of the footage in coordinates of the file.
    pub fn own(&self, p: Point) -> Point {
        Point::new((p.x - 0.5 * self.width) / self.height * self.aspect, p.y / self.height - 0.5)
    }
}
