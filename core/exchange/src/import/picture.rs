//! The picture of a file, and where its pixels lie in the footage.
//!
//! A plate is delivered again at another size, or shapes were drawn on a proxy. If the file names the size of its picture, and that has
//! the proportions of the footage, its shapes are scaled to it. Otherwise their pixels stay, counted from the lower left corner, and a warning says both
//! sizes.

use rototoon_base::geometry::Point;
use rototoon_base::scene::Footage;

/// Greatest difference of two proportions that are the same, as a share: sizes are whole numbers.
const SAME: f64 = 0.01;

/// Places pixels of a file with y up in the footage, with y down.
#[derive(Clone, Debug)]
pub(super) struct Picture {
    height: f64,
    scale: f64,
}

impl Picture {
    /// The picture of a file of this width and height; `None` if it does not say. The text is a warning.
    pub(super) fn of(size: Option<[f64; 2]>, footage: &Footage) -> (Self, Option<String>) {
        let own = [footage.width as f64, footage.height as f64];
        let plain = Self { height: own[1], scale: 1.0 };
        let Some(size) = size.filter(|size| size.iter().all(|side| *side >= 1.0) && *size != own) else {
            return (plain, None);
        };
        let scales = [own[0] / size[0], own[1] / size[1]];
        if (scales[0] / scales[1] - 1.0).abs() <= SAME {
            return (Self { height: size[1], scale: scales[1] }, None);
        }
        let sizes = format!("{}×{}, the footage {}×{}", size[0], size[1], own[0], own[1]);
        (
            plain,
            Some(format!("the file's picture has {sizes}: its shapes keep their pixels, from the lower left corner")),
        )
    }

    /// A place in pixels of the footage.
    pub(super) fn pixels(&self, p: Point) -> Point {
        Point::new(p.x, self.height - p.y) * self.scale
    }
}

/// The first two numbers of a text that begins with a width and a height.
pub(super) fn size(text: &str, between: char) -> Option<[f64; 2]> {
    let mut numbers = text.trim().split(between).map(|word| word.trim().parse::<f64>().ok().filter(|n| n.is_finite()));
    Some([numbers.next()??, numbers.next()??])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_picture_of_the_same_proportions_is_scaled() {
        let footage = Footage { pattern: "%d".into(), first: 1, last: 9, fps: 1.0, width: 96, height: 72, held: false };
        let at = |size| Picture::of(size, &footage).0.pixels(Point::new(12.0, 6.0));
        assert_eq!(at(None), Point::new(12.0, 66.0));
        assert_eq!(at(Some([96.0, 72.0])), Point::new(12.0, 66.0));
        assert_eq!(at(Some([48.0, 36.0])), Point::new(24.0, 60.0));
        assert_eq!(at(Some([128.0, 72.0])), Point::new(12.0, 66.0));
        let told = |size| Picture::of(Some(size), &footage).1;
        assert_eq!(told([48.0, 36.0]), None);
        assert!(told([128.0, 72.0]).unwrap().contains("128×72, the footage 96×72"), "{:?}", told([128.0, 72.0]));
    }

    #[test]
    fn sizes_are_read_from_the_names_of_formats() {
        assert_eq!(size("480 360 0 0 480 360 1 ", ' '), Some([480.0, 360.0]));
        assert_eq!(size("480x360", 'x'), Some([480.0, 360.0]));
        assert_eq!((size("HD", 'x'), size("2K", ' ')), (None, None));
    }
}
