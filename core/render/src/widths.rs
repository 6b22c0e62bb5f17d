//! The feather at any place of a picture, from widths along contours.
//!
//! A contour has a width at each of its control points, and between them the width changes evenly along the contour. Pixels
//! beside the contour need a width too. It is the mean of the widths along the contour. Nearer pieces of the contour count
//! more: by the inverse fourth power of their distance. So a pixel at a border has the width of its border, also where the
//! other side of a limb has another one, and between the two borders the width changes smoothly. Taking the width of the
//! nearest piece alone would leave a crease half way.
//!
//! Means are computed at the corners of square cells and are bilinear within them. The cells lie at whole multiples of their
//! side, so a pixel does not depend on the window. The side grows with the size of the mask: this bounds the cost of a mask
//! in a picture of any size. It stays below the length of the pieces, since means change over that length: cells that are
//! wider than pieces would make the border of a small mask boil as it moves over them. A cell of a pixel moves with a mask that moves by whole pixels.
//!
//! Limits: at most [`MOST_PIECES`] pieces and one for each segment; the width is even within a piece. A sharp side of a limb
//! gets a small width from a soft side a few cells away: about a hundredth of it.
//!
//! Source: D. Shepard: A two-dimensional interpolation function for irregularly-spaced data. ACM National Conference, 1968.

use super::coverage::Window;
use super::mask::Bounds;
use rototoon_base::geometry::{Point, polyline};
use rototoon_base::numeric::vector::vectorised;
use rototoon_base::scene::Raster;

/// Number of pieces that a contour is divided into, beside one for each segment.
pub const MOST_PIECES: usize = 256;
/// Least side of a cell in pixels.
const LEAST_CELL: i64 = 1;
/// Greatest side of a cell in pixels.
const MOST_CELL: i64 = 1 << 16;
/// Most products of cells and pieces of a mask.
const MOST_WORK: f64 = (1u64 << 23) as f64;
/// Pieces whose weights are computed together.
const LANES: usize = 8;

/// A piece of a contour.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Piece {
    /// Its middle, in pixels of the picture.
    pub at: Point,
    /// Its length in pixels.
    pub length: f64,
    /// The width in pixels in its middle.
    pub width: f64,
}

/// Divides a contour into pieces. `segments` are the paths between neighbouring control points, and `widths` belong to the
/// control points: a segment leads from its own one to the next, and the last segment of a closed contour to the first.
pub fn pieces(segments: &[Vec<Point>], widths: &[f64]) -> Vec<Piece> {
    let whole: f64 = segments.iter().map(|path| polyline::length(path, false)).sum();
    if !(whole.is_finite() && whole > 0.0) || widths.is_empty() {
        return Vec::new();
    }
    let mut pieces = Vec::new();
    for (k, path) in segments.iter().enumerate().filter(|(_, path)| path.len() > 1) {
        let length = polyline::length(path, false);
        let count = ((length / whole * MOST_PIECES as f64).ceil() as usize).max(1);
        let ends = [widths[k % widths.len()], widths[(k + 1) % widths.len()]];
        // Every second point is the middle of a piece.
        let points = polyline::resample(path, false, 2 * count + 1);
        for (n, &at) in points.iter().skip(1).step_by(2).enumerate() {
            let share = (n as f64 + 0.5) / count as f64;
            let width = ends[0] + share * (ends[1] - ends[0]);
            pieces.push(Piece { at, length: length / count as f64, width });
        }
    }
    pieces
}

/// Widths at all places of a picture.
#[derive(Clone, Debug)]
pub struct Widths {
    x: Vec<[f64; LANES]>,
    y: Vec<[f64; LANES]>,
    length: Vec<[f64; LANES]>,
    width: Vec<[f64; LANES]>,
    /// Square of the distance below which nearness counts no more: that of neighbouring pieces.
    near: f64,
    count: usize,
    /// The least and the greatest width.
    pub range: [f64; 2],
}

impl Widths {
    /// Widths from the pieces of contours; `None` without a piece of a length.
    pub fn new(pieces: &[Piece]) -> Option<Self> {
        let usable = |piece: &&Piece| piece.at.is_finite() && piece.length > 0.0 && piece.width.is_finite();
        let pieces: Vec<Piece> = pieces.iter().filter(usable).copied().collect();
        let range = pieces.iter().map(|piece| [piece.width; 2]).reduce(|a, b| [a[0].min(b[0]), a[1].max(b[1])])?;
        let lanes = |value: fn(&Piece) -> f64| {
            let chunk = |some: &[Piece]| {
                let mut lanes = [0.0; LANES];
                lanes.iter_mut().zip(some).for_each(|(lane, piece)| *lane = value(piece));
                lanes
            };
            pieces.chunks(LANES).map(chunk).collect::<Vec<_>>()
        };
        let longest = pieces.iter().map(|piece| piece.length).fold(0.0, f64::max);
        Some(Self {
            x: lanes(|piece| piece.at.x),
            y: lanes(|piece| piece.at.y),
            // Lanes beyond the last piece have no length and count nothing.
            length: lanes(|piece| piece.length),
            width: lanes(|piece| piece.width),
            near: longest * longest,
            count: pieces.len(),
            range,
        })
    }

    /// The width at a point.
    #[inline(always)]
    fn at(&self, p: Point) -> f64 {
        let (mut sums, mut weights) = ([0.0; LANES], [0.0; LANES]);
        for (((x, y), length), width) in self.x.iter().zip(&self.y).zip(&self.length).zip(&self.width) {
            for k in 0..LANES {
                let (dx, dy) = (x[k] - p.x, y[k] - p.y);
                let squared = dx * dx + dy * dy + self.near;
                let weight = length[k] / (squared * squared);
                weights[k] += weight;
                sums[k] += weight * width[k];
            }
        }
        let (sum, weight) = (sums.iter().sum::<f64>(), weights.iter().sum::<f64>());
        // Far away all weights vanish.
        if weight > 0.0 { (sum / weight).clamp(self.range[0], self.range[1]) } else { self.range[0] }
    }

    /// The side of the cells for a mask with these bounds.
    fn cell(&self, bounds: Bounds) -> i64 {
        let size = bounds.most - bounds.least;
        let mut cell = LEAST_CELL;
        while cell < MOST_CELL && size.x * size.y / (cell * cell) as f64 * self.count as f64 > MOST_WORK {
            cell *= 2;
        }
        cell
    }

    /// The width in the middle of each pixel of a window. `bounds` are those of the whole mask. `None` if `go_on`, called for
    /// each row of cells, returns false.
    pub fn raster(&self, window: Window, bounds: Bounds, go_on: &mut dyn FnMut() -> bool) -> Option<Raster<f32>> {
        let cell = self.cell(bounds);
        let (left, top) = (window.left.div_euclid(cell), window.top.div_euclid(cell));
        let (columns, rows) = (window.right.div_euclid(cell) - left + 2, window.bottom.div_euclid(cell) - top + 2);
        let mut corners = Raster::new(columns as usize, rows as usize, 0.0f64);
        for y in 0..rows {
            if !go_on() {
                return None;
            }
            let row = corners.row_mut(y as usize);
            vectorised(
                #[inline(always)]
                || {
                    for (x, corner) in row.iter_mut().enumerate() {
                        *corner = self.at(Point::new(((left + x as i64) * cell) as f64, ((top + y) * cell) as f64));
                    }
                },
            );
        }
        let place = |pixel: i64, first: i64| {
            let share = (pixel.rem_euclid(cell) as f64 + 0.5) / cell as f64;
            ((pixel.div_euclid(cell) - first) as usize, share)
        };
        Some(Raster::from_fn(window.width(), window.height(), |x, y| {
            let ((i, s), (j, t)) = (place(window.left + x as i64, left), place(window.top + y as i64, top));
            let mixed = |a: f64, b: f64, share: f64| a + share * (b - a);
            let across = |row: usize| mixed(corners.get(i, row), corners.get(i + 1, row), s);
            mixed(across(j), across(j + 1), t) as f32
        }))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn p(x: f64, y: f64) -> Point {
        Point::new(x, y)
    }

    fn square() -> Vec<Vec<Point>> {
        let corners = [p(0.0, 0.0), p(80.0, 0.0), p(80.0, 60.0), p(0.0, 60.0)];
        (0..4).map(|k| vec![corners[k], corners[(k + 1) % 4]]).collect()
    }

    const BOUNDS: Bounds = Bounds { least: Point::new(-40.0, -40.0), most: Point::new(120.0, 100.0) };

    #[test]
    fn pieces_change_evenly_and_have_the_contours_length() {
        let pieces = pieces(&square(), &[2.0, 10.0, 10.0, 4.0]);
        assert!((pieces.iter().map(|piece| piece.length).sum::<f64>() - 280.0).abs() < 1e-9);
        let upper: Vec<&Piece> = pieces.iter().filter(|piece| piece.at.y == 0.0).collect();
        assert!(upper.len() > 50);
        for piece in upper {
            assert!((piece.width - (2.0 + 0.1 * piece.at.x)).abs() < 1e-9, "{piece:?}");
        }
        assert!(super::pieces(&[vec![p(1.0, 1.0); 2]], &[3.0]).is_empty());
    }

    #[test]
    fn a_border_has_its_own_width_and_far_ones_hardly_count() {
        let widths = Widths::new(&pieces(&square(), &[0.0, 30.0, 30.0, 0.0])).unwrap();
        assert_eq!(widths.range[0].round(), 0.0);
        let window = Window { left: -8, top: -8, right: 88, bottom: 68 };
        let raster = widths.raster(window, BOUNDS, &mut || true).unwrap();
        let at = |x: i64, y: i64| raster.get((x + 8) as usize, (y + 8) as usize);
        // The sides left and right have 0 and 30. The upper one rises evenly.
        assert!(at(0, 30) < 0.1 && at(3, 30) < 0.1 && at(79, 30) > 29.9, "{} {} {}", at(0, 30), at(3, 30), at(79, 30));
        for x in [24, 40, 56] {
            let wanted = 30.0 * (x as f32 + 0.5) / 80.0;
            assert!((at(x, 0) - wanted).abs() < 0.15, "{x} {} {wanted}", at(x, 0));
        }
        // Between the sides it rises without a jump.
        let row = raster.row(38);
        assert!(row.windows(2).all(|pair| (pair[1] - pair[0]).abs() < 2.0), "{row:?}");
        assert_eq!(widths.raster(window, BOUNDS, &mut || false), None);
    }

    #[test]
    fn the_widths_of_a_small_mask_move_with_it() {
        // A star, whose tips have borders close to each other.
        let tips: Vec<Point> = (0..5)
            .map(|k| p(60.0, 50.0) + 35.0 * Point::from_angle(0.8 * f64::from(k) * std::f64::consts::PI))
            .collect();
        let moved = |by: (i64, i64)| {
            let at = |k: usize| tips[k % 5] + p(by.0 as f64, by.1 as f64);
            let segments: Vec<Vec<Point>> = (0..5).map(|k| vec![at(k), at(k + 1)]).collect();
            let widths = Widths::new(&pieces(&segments, &[0.0, 4.0, 9.0, 3.0, 0.0])).unwrap();
            let window = Window { left: by.0, top: by.1, right: 120 + by.0, bottom: 100 + by.1 };
            let [least, most] = [p(15.0, 5.0), p(105.0, 95.0)].map(|corner| corner + p(by.0 as f64, by.1 as f64));
            widths.raster(window, Bounds { least, most }, &mut || true).unwrap()
        };
        let own = moved((0, 0));
        for by in [(1, 0), (2, 1), (-3, 7)] {
            let other = moved(by);
            let most = own.data().iter().zip(other.data()).map(|(a, b)| (a - b).abs()).fold(0.0, f32::max);
            assert!(most < 1e-4, "{by:?}: {most} px");
        }
    }

    #[test]
    fn a_window_shows_a_piece_of_the_whole_and_equal_widths_stay() {
        let whole = Window { left: -13, top: -9, right: 90, bottom: 77 };
        let part = Window { left: 5, top: -3, right: 43, bottom: 30 };
        let widths = Widths::new(&pieces(&square(), &[3.0, 0.0, 8.0])).unwrap();
        let [all, piece] = [whole, part].map(|window| widths.raster(window, BOUNDS, &mut || true).unwrap());
        for y in 0..part.height() {
            for x in 0..part.width() {
                assert_eq!(piece.get(x, y), all.get(x + 18, y + 6));
            }
        }
        let even = Widths::new(&pieces(&square(), &[3.0; 4])).unwrap().raster(whole, BOUNDS, &mut || true).unwrap();
        assert!(even.data().iter().all(|width| *width == 3.0));
        let huge = Bounds { least: p(0.0, 0.0), most: p(1e5, 1e5) };
        assert!(widths.cell(huge) >= 256 && widths.cell(BOUNDS) == LEAST_CELL);
    }
}
