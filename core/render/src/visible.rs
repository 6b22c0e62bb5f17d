//! The visible area of every part in each pixel, nearer parts over farther ones.
//!
//! The visible area of a part is the coverage of the union of the part and all nearer parts, minus the coverage of the
//! union of the nearer parts. Both come from [`super::coverage`], so the shares of a pixel are areas and not products
//! of opacities. Parts that touch along a border leave no third colour there, and the shares of all parts sum to their
//! matte. Of parts of equal depth the later in the document is in front.
//!
//! Most pixels need no union. If the nearer parts leave a pixel free, a part shows with its own coverage; if the part
//! covers the pixel, it shows with what they leave. Only where the borders of several parts meet in a pixel is their
//! union computed, and only from the parts that show there. So the cost grows with the number of pixels that parts
//! cover, not with pixels times parts, and not with the number of parts that lie behind each other.
//!
//! Pictures are computed in bands of rows, and each part within its own bounds.

use super::coverage::{Shape, Window};
use rototoon_base::geometry::Point;
use rototoon_base::scene::{FrameNumber, Raster, Scene};

/// Number of rows computed together.
const BAND: i64 = 64;
/// A smaller share is rounding, not area.
pub(super) const LEAST: f32 = 1.0 / (1 << 18) as f32;

/// The visible share of a part in a pixel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Share {
    /// Index of the part in the scene.
    pub part: usize,
    /// Area of the pixel, above 0 and at most 1.
    pub coverage: f32,
}

/// The shares of every pixel.
#[derive(Clone, Debug, PartialEq)]
pub struct Visible {
    width: usize,
    height: usize,
    /// For each pixel the index of its first share, and a final entry for the end.
    starts: Vec<usize>,
    shares: Vec<Share>,
}

impl Visible {
    /// Pixels in a row.
    pub fn width(&self) -> usize {
        self.width
    }

    /// Number of rows.
    pub fn height(&self) -> usize {
        self.height
    }

    /// The shares of each pixel, row by row from the top left; the nearest part first.
    pub fn pixels(&self) -> impl Iterator<Item = &[Share]> {
        self.starts.windows(2).map(|ends| &self.shares[ends[0]..ends[1]])
    }

    /// The shares of a picture that is computed in bands of rows. `shares` gives those of each pixel of a band.
    pub(super) fn in_bands(width: usize, height: usize, shares: impl Fn(Window) -> Vec<Vec<Share>>) -> Self {
        let mut result = Self { width, height, starts: vec![0], shares: Vec::new() };
        result.starts.reserve(width * height);
        for top in (0..height as i64).step_by(BAND as usize) {
            let band = Window { left: 0, top, right: width as i64, bottom: (top + BAND).min(height as i64) };
            for pixel in shares(band) {
                result.shares.extend(pixel);
                result.starts.push(result.shares.len());
            }
        }
        result
    }

    /// The shares of each pixel of a row, as [`Self::pixels`] has them.
    pub fn row(&self, y: usize) -> impl Iterator<Item = &[Share]> {
        let ends = &self.starts[y * self.width..=(y + 1) * self.width];
        ends.windows(2).map(|ends| &self.shares[ends[0]..ends[1]])
    }

    /// Greatest number of shares of a pixel.
    pub fn most(&self) -> usize {
        self.pixels().map(<[Share]>::len).max().unwrap_or(0)
    }
}

/// A part's outline and its bounds in whole pixels.
#[derive(Clone, Debug)]
struct Outline {
    part: usize,
    points: Vec<Point>,
    bounds: Window,
}

/// Closed outlines that lie over each other, the nearest first.
#[derive(Clone, Debug)]
pub struct Stack(Vec<Outline>);

impl Stack {
    /// A stack of outlines with the indices of their parts, the nearest first. Outlines without points, and with a
    /// coordinate that is not finite, are left out.
    pub fn new(outlines: impl IntoIterator<Item = (usize, Vec<Point>)>) -> Self {
        let outline = |(part, points): (usize, Vec<Point>)| {
            let bounds = Window::around(&points)?;
            Some(Outline { part, points, bounds })
        };
        Self(outlines.into_iter().filter_map(outline).collect())
    }

    /// A rectangle of whole pixels that contains all outlines; `None` if there are none.
    pub fn bounds(&self) -> Option<Window> {
        self.0.iter().map(|outline| outline.bounds).reduce(Window::united)
    }

    /// The shares of each pixel of a window, row by row; the nearest part first. `None` if `go_on`, called for each row
    /// of each part, returns false.
    pub fn shares(&self, window: Window, go_on: &mut dyn FnMut() -> bool) -> Option<Vec<Vec<Share>>> {
        shares(&self.0, window, go_on)
    }
}

/// The visible areas of closed parts on a frame. `parts` selects parts by index; `None` takes all. Snapped paths are
/// used where they exist.
pub fn visible(scene: &Scene, frame: FrameNumber, parts: Option<&[usize]>) -> Visible {
    let order = nearest_first(scene, frame, parts);
    let stack = Stack::new(order.into_iter().filter_map(|part| Some((part, scene.parts[part].outline(frame)?))));
    Visible::in_bands(scene.footage.width, scene.footage.height, |band| {
        stack.shares(band, &mut || true).unwrap_or_default()
    })
}

/// The indices of closed parts, the nearest on a frame first. `parts` selects parts by index; `None` takes all.
pub fn nearest_first(scene: &Scene, frame: FrameNumber, parts: Option<&[usize]>) -> Vec<usize> {
    let depth = |part: usize| scene.parts[part].depth_at(frame);
    let mut order: Vec<usize> = (0..scene.parts.len()).collect();
    order.retain(|index| scene.parts[*index].closed && parts.is_none_or(|parts| parts.contains(index)));
    order.sort_by(|&a, &b| depth(b).total_cmp(&depth(a)).then(b.cmp(&a)));
    order
}

/// The shares of each pixel of a band.
fn shares(outlines: &[Outline], band: Window, go_on: &mut dyn FnMut() -> bool) -> Option<Vec<Vec<Share>>> {
    let mut pixels = Pixels {
        band,
        shown: vec![Vec::new(); band.width() * band.height()],
        covered: Raster::new(band.width(), band.height(), 0.0f32),
    };
    for (index, outline) in outlines.iter().enumerate() {
        let Some(window) = outline.bounds.common(band) else { continue };
        let mut union = Union { outlines, of: Vec::new(), shape: Shape::new(&[]) };
        let own = Shape::new(&[vec![outline.points.clone()]]).draw(window, go_on)?;
        for (row, y) in (window.top..window.bottom).enumerate() {
            let mixed = pixels.add(index, window.left, y, own.row(row));
            pixels.mix(index, y, &mixed, &mut union);
            if !go_on() {
                return None;
            }
        }
    }
    let of_scene = |share: Share| Share { part: outlines[share.part].part, ..share };
    Some(pixels.shown.into_iter().map(|pixel| pixel.into_iter().map(of_scene).collect()).collect())
}

/// The pixels of a band. Parts are added from the nearest to the farthest.
struct Pixels {
    band: Window,
    /// The shares of each pixel. Their parts are indices of outlines.
    shown: Vec<Vec<Share>>,
    /// The coverage of the union of all added parts.
    covered: Raster<f32>,
}

impl Pixels {
    fn at(&self, x: i64, y: i64) -> usize {
        (y - self.band.top) as usize * self.band.width() + (x - self.band.left) as usize
    }

    /// Adds an outline's own coverage of a row from column `left` on. Returns the columns that need a union.
    fn add(&mut self, index: usize, left: i64, y: i64, row: &[f32]) -> Vec<i64> {
        let first = self.at(left, y);
        let mut mixed = Vec::new();
        for (x, &own) in row.iter().enumerate().filter(|(_, own)| **own > 0.0) {
            let before = self.covered.data()[first + x];
            if before == 0.0 || own == 1.0 {
                self.show(first + x, index, own);
            } else if before < 1.0 {
                mixed.push(left + x as i64);
            }
        }
        mixed
    }

    /// Adds an outline in columns of a row in which its border meets those of nearer parts.
    fn mix(&mut self, index: usize, y: i64, mixed: &[i64], union: &mut Union) {
        let (Some(&left), Some(&last)) = (mixed.first(), mixed.last()) else { return };
        let mut met: Vec<usize> =
            mixed.iter().flat_map(|&x| self.shown[self.at(x, y)].iter().map(|share| share.part)).collect();
        met.push(index);
        met.sort_unstable();
        met.dedup();
        let window = Window { left, top: y, right: last + 1, bottom: y + 1 };
        let Some(union) = union.of(met).draw(window, &mut || true) else { return };
        for &x in mixed {
            self.show(self.at(x, y), index, union.get((x - left) as usize, 0));
        }
    }

    /// Adds an outline to a pixel. `now` is the coverage of the union with it.
    fn show(&mut self, at: usize, index: usize, now: f32) {
        let before = &mut self.covered.data_mut()[at];
        let coverage = now - *before;
        if coverage >= LEAST {
            self.shown[at].push(Share { part: index, coverage });
            *before = now;
        }
    }
}

/// The union of some outlines. It is kept, since neighbouring rows mostly need the same one.
struct Union<'a> {
    outlines: &'a [Outline],
    of: Vec<usize>,
    shape: Shape,
}

impl Union<'_> {
    fn of(&mut self, outlines: Vec<usize>) -> &Shape {
        if self.of != outlines {
            let polygons = outlines.iter().map(|&index| self.outlines[index].points.clone()).collect();
            self.shape = Shape::new(&[polygons]);
            self.of = outlines;
        }
        &self.shape
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::matte;
    use proptest::prelude::*;
    use rototoon_base::scene::{Footage, Part};
    use std::collections::BTreeMap;

    fn scene(parts: Vec<(f64, Vec<Point>)>) -> Scene {
        let footage = Footage { pattern: "%d".into(), first: 0, last: 0, fps: 1.0, width: 20, height: 70, held: false };
        let part = |(index, (depth, points)): (usize, (f64, Vec<Point>))| Part {
            name: format!("part {index}"),
            closed: true,
            depth,
            keys: BTreeMap::from([(0, points)]),
            ..Part::default()
        };
        Scene { footage, parts: parts.into_iter().enumerate().map(part).collect() }
    }

    fn rectangle(x0: f64, y0: f64, x1: f64, y1: f64) -> Vec<Point> {
        vec![Point::new(x0, y0), Point::new(x1, y0), Point::new(x1, y1), Point::new(x0, y1)]
    }

    fn share(visible: &Visible, part: usize, x: usize, y: usize) -> f32 {
        let pixel = visible.pixels().nth(y * visible.width() + x).unwrap();
        pixel.iter().filter(|share| share.part == part).map(|share| share.coverage).sum()
    }

    #[test]
    fn nearer_parts_hide_and_borders_share_their_pixels() {
        // The second is nearest. The third is behind both and ends where the second begins.
        let parts = vec![
            (1.0, rectangle(0.0, 0.0, 10.0, 5.0)),
            (2.0, rectangle(4.25, 0.0, 8.0, 5.0)),
            (0.0, rectangle(2.0, 1.0, 4.25, 6.0)),
        ];
        let visible = visible(&scene(parts), 0, None);
        for (x, expected) in [(3, [1.0, 0.0, 0.0]), (4, [0.25, 0.75, 0.0]), (6, [0.0, 1.0, 0.0]), (9, [1.0, 0.0, 0.0])]
        {
            for (part, expected) in expected.into_iter().enumerate() {
                assert!((share(&visible, part, x, 2) - expected).abs() < 1e-6, "{x} {part}");
            }
        }
        assert!((share(&visible, 2, 4, 5) - 0.25).abs() < 1e-6);
        assert_eq!(visible.most(), 2);
    }

    #[test]
    fn equal_depths_lie_as_in_the_document_and_open_parts_show_nothing() {
        let mut scene = scene(vec![(0.0, rectangle(0.0, 0.0, 4.0, 4.0)), (0.0, rectangle(0.0, 0.0, 4.0, 4.0))]);
        assert_eq!(share(&visible(&scene, 0, None), 1, 1, 1), 1.0);
        assert_eq!(share(&visible(&scene, 0, Some(&[0])), 0, 1, 1), 1.0);
        scene.parts[1].closed = false;
        assert_eq!(share(&visible(&scene, 0, None), 0, 1, 1), 1.0);
        assert_eq!(visible(&scene, 3, None).most(), 0);
    }

    #[test]
    fn a_part_with_a_depth_of_its_own_on_a_frame_lies_there() {
        let mut scene = scene(vec![(2.0, rectangle(0.0, 0.0, 4.0, 4.0)), (1.0, rectangle(0.0, 0.0, 8.0, 8.0))]);
        for part in &mut scene.parts {
            part.keys.insert(1, part.keys[&0].clone());
        }
        scene.parts[0].depths = [(1, 0.5)].into();
        assert_eq!([0, 1].map(|frame| share(&visible(&scene, frame, None), 0, 1, 1)), [1.0, 0.0]);
        assert_eq!([0, 1].map(|frame| nearest_first(&scene, frame, None)[0]), [0, 1]);
    }

    proptest! {
        #[test]
        fn shares_are_what_unions_leave(corners in prop::collection::vec(prop::array::uniform6(-4.0f64..74.0), 1..9)) {
            let triangle = |c: &[f64; 6]| c.chunks(2).map(|p| Point::new(0.3 * p[0], p[1])).collect::<Vec<_>>();
            let parts: Vec<_> = corners.iter().enumerate().map(|(k, c)| (-(k as f64), triangle(c))).collect();
            let polygons: Vec<_> = parts.iter().map(|(_, points)| points.clone()).collect();
            let scene = scene(parts);
            let visible = visible(&scene, 0, None);
            let unions: Vec<_> = (0..=polygons.len()).map(|n| matte::coverage(&polygons[..n], 20, 70)).collect();
            for (at, pixel) in visible.pixels().enumerate() {
                for part in 0..polygons.len() {
                    let expected = unions[part + 1].data()[at] - unions[part].data()[at];
                    let found: f32 = pixel.iter().filter(|s| s.part == part).map(|s| s.coverage).sum();
                    prop_assert!((found - expected).abs() < 1e-5, "{at} {part}: {found} {expected}");
                }
            }
        }
    }
}
