//! Edges and ink lines of a picture: the features that a live wire follows.
//!
//! Each pixel has one [`Feature`] of each [`Kind`]:
//!
//! - **Edge** (Mortensen & Barrett 1995, §3): the gradient of the colour channel where it is largest, and whether the
//!   channel's Laplacian crosses zero at the pixel. It crosses zero where it differs in sign from one of the four
//!   neighbours and is the nearer to zero of the two.
//! - **Line**: dark ink of a few pixels' width has two edges, but an artist draws down its middle. The centre of a line
//!   is the valley of the luma (Steger 1998). The strength is the larger eigenvalue of the Hessian. The pixel is on the
//!   line where the slope across the valley is zero within the pixel. A step between two flat colours has a second
//!   derivative too, but its slope is nowhere zero.
//!
//! Both kinds also store where in the pixel the feature is, as an offset across the feature's own direction.
//!
//! The picture is cut into square tiles. A tile is filtered when a wire first comes near it. So the time depends on the
//! length of the contours, not on the size of the picture, and the contours of one picture share the work.
//!
//! Limits: light lines on a dark background are followed as edges, and so are lines much wider than the scale of the
//! line filter.

use super::derivatives::{Derivatives, Kernels, Window};
use rototoon_base::geometry::Point;
use rototoon_base::scene::{Colour, Raster};
use std::sync::OnceLock;

/// Side of a tile in pixels. The filter's border adds a quarter to its area.
const TILE: usize = 64;

/// Standard deviation in pixels of the edge filter. It keeps the two sides of a 2 px line apart and still smooths the
/// steps of aliased drawings.
const EDGE_SIGMA: f64 = 0.8;

/// Standard deviation in pixels, at [`REFERENCE_LINES`] lines, of the line filter. It finds lines of 1 to 5 px.
const LINE_SIGMA: f64 = 1.0;

/// Picture height in lines at which the pixel measures of this module are given. They grow with taller pictures.
pub(super) const REFERENCE_LINES: f64 = 540.0;

/// Gradient (colour per pixel, colours 0 to 1) below which there is no edge: two of 255 levels over a pixel.
const EDGE_FLOOR: f32 = 0.008;

/// Second derivative (luma per px²) below which there is no line.
const LINE_FLOOR: f32 = 0.006;

/// Least slope (luma per pixel) on each side of a valley, one pixel from its middle.
const SLOPE_FLOOR: f32 = 0.01;

/// Largest offset of a feature from its pixel's centre, in pixels. A larger one is not trusted.
const MAX_OFFSET: f32 = 1.0;

/// A valley's bottom belongs to the pixel whose centre is at most this far away, in pixels. It is a little more than
/// half a pixel because diagonals need 0.71.
const LINE_REACH: f32 = 0.71;

/// Luma weights of ITU-R BT.601, for encoded red, green and blue.
const LUMA: [f32; 3] = [0.299, 0.587, 0.114];

/// The kind of feature that a path follows.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Follow {
    /// The line's centre where the control points are, on average, nearer to ink centres than to edges; otherwise the
    /// edge.
    #[default]
    Auto,
    /// The border between two colours, which is one side of an ink line.
    Edge,
    /// The centre of dark ink.
    Line,
}

/// The two kinds of features.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    Edge,
    Line,
}

/// The edge or line at one pixel.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Feature {
    /// Gradient or second derivative; 0 below the floor.
    pub strength: f32,
    /// Place along the normal from the pixel's centre, in pixels. NaN where there is none in reach.
    pub offset: f32,
    /// Angle of the tangent from the x axis towards the y axis. A full turn is 2¹⁶. An edge has its darker side always
    /// on the same hand; a line has no sense of direction.
    pub direction: i16,
    /// Whether the edge or line passes through this pixel.
    pub present: bool,
}

impl Feature {
    /// Unit vector across the tangent. For an edge it is the direction of the gradient.
    pub fn normal(&self) -> Point {
        Point::from_angle(f64::from(self.direction) * (std::f64::consts::TAU / 65536.0)).perp()
    }

    /// Sub-pixel place, in pixels of the picture, of the feature in the pixel (`x`, `y`), if it has one.
    pub fn place(&self, x: usize, y: usize) -> Option<Point> {
        let centre = Point::new(x as f64 + 0.5, y as f64 + 0.5);
        self.offset.is_finite().then(|| centre + self.normal() * f64::from(self.offset))
    }
}

/// An angle in radians in units of 2⁻¹⁶ turn.
fn to_turn(radians: f32) -> i16 {
    ((radians * (32768.0 / std::f32::consts::PI)).round() as i32) as i16
}

/// The features of one picture.
pub(super) struct Features<'a> {
    picture: &'a Raster<Colour>,
    columns: usize,
    scale: f64,
    tiles: [Vec<OnceLock<Box<[Feature]>>>; 2],
    kernels: [Kernels; 2],
}

impl<'a> Features<'a> {
    /// Prepares the features of a picture. Nothing is computed yet.
    pub fn new(picture: &'a Raster<Colour>) -> Self {
        let columns = picture.width().div_ceil(TILE);
        let count = columns * picture.height().div_ceil(TILE);
        let scale = (picture.height() as f64 / REFERENCE_LINES).max(1.0);
        let empty = || (0..count).map(|_| OnceLock::new()).collect();
        // Beyond twice the reference height, the filter would merge lines that are close together.
        let line_sigma = LINE_SIGMA * scale.min(2.0);
        Self {
            picture,
            columns,
            scale,
            tiles: [empty(), empty()],
            kernels: [Kernels::new(EDGE_SIGMA), Kernels::new(line_sigma)],
        }
    }

    /// Width and height of the picture.
    pub fn size(&self) -> (usize, usize) {
        (self.picture.width(), self.picture.height())
    }

    /// Pixels of this picture in a pixel at the reference height, at least 1.
    pub fn scale(&self) -> f64 {
        self.scale
    }

    /// The feature of a pixel of the picture.
    pub fn get(&self, kind: Kind, x: usize, y: usize) -> Feature {
        let slot = &self.tiles[kind as usize][y / TILE * self.columns + x / TILE];
        slot.get_or_init(|| self.tile(kind, x / TILE * TILE, y / TILE * TILE))[y % TILE * TILE + x % TILE]
    }

    fn tile(&self, kind: Kind, x: usize, y: usize) -> Box<[Feature]> {
        // One pixel more on each side: the features need their neighbours.
        let window = Window { x: x as isize - 1, y: y as isize - 1, width: TILE + 2, height: TILE + 2 };
        let kernels = &self.kernels[kind as usize];
        match kind {
            Kind::Edge => {
                let channels =
                    [0, 1, 2].map(|c| Channel::new(kernels.derivatives(window, |x, y| self.picture.clamped(x, y)[c])));
                inner_pixels().map(|at| edge_at(&channels, at)).collect()
            }
            Kind::Line => {
                let luma = |c: Colour| c[0] * LUMA[0] + c[1] * LUMA[1] + c[2] * LUMA[2];
                let derivatives = kernels.derivatives(window, |x, y| luma(self.picture.clamped(x, y)));
                inner_pixels().map(|at| line_at(&derivatives, at)).collect()
            }
        }
    }
}

/// Pixels in a row of a tile's window.
const STRIDE: usize = TILE + 2;

/// Indices in a tile's window of the tile's own pixels.
fn inner_pixels() -> impl Iterator<Item = usize> {
    (1..=TILE).flat_map(|y| (1..=TILE).map(move |x| y * STRIDE + x))
}

/// The derivatives of one colour channel that the edge feature needs.
struct Channel {
    x: Vec<f32>,
    y: Vec<f32>,
    magnitude: Vec<f32>,
    laplacian: Vec<f32>,
}

impl Channel {
    fn new(d: Derivatives) -> Self {
        let magnitude = d.x.iter().zip(&d.y).map(|(x, y)| x.hypot(*y)).collect();
        let laplacian = d.xx.iter().zip(&d.yy).map(|(xx, yy)| xx + yy).collect();
        Self { x: d.x, y: d.y, magnitude, laplacian }
    }

    fn crosses_zero(&self, at: usize) -> bool {
        let here = self.laplacian[at];
        let wins = |other: usize, first: bool| {
            let there = self.laplacian[other];
            // Of two values equally near to zero the left or upper one wins. An exact zero wins over both signs.
            here * there < 0.0 && (here.abs() < there.abs() || (first && here.abs() == there.abs()))
        };
        let opposite = |a: usize, b: usize| here == 0.0 && self.laplacian[a] * self.laplacian[b] < 0.0;
        wins(at + 1, true)
            || wins(at + STRIDE, true)
            || wins(at - 1, false)
            || wins(at - STRIDE, false)
            || opposite(at - 1, at + 1)
            || opposite(at - STRIDE, at + STRIDE)
    }
}

/// The value at a shift of at most a pixel from index `at` of a tile's window, read bilinearly.
fn near(values: &[f32], at: usize, x: f32, y: f32) -> f32 {
    let (left, top) = (x.floor(), y.floor());
    let (u, v) = (x - left, y - top);
    let read = |dx: f32, dy: f32| {
        let (dx, dy) = ((left + dx).clamp(-1.0, 1.0), (top + dy).clamp(-1.0, 1.0));
        values[(at as isize + dy as isize * STRIDE as isize + dx as isize) as usize]
    };
    (1.0 - v) * ((1.0 - u) * read(0.0, 0.0) + u * read(1.0, 0.0))
        + v * ((1.0 - u) * read(0.0, 1.0) + u * read(1.0, 1.0))
}

fn edge_at(channels: &[Channel; 3], at: usize) -> Feature {
    let mut channel = &channels[0];
    for other in &channels[1..] {
        if other.magnitude[at] > channel.magnitude[at] {
            channel = other;
        }
    }
    let here = channel.magnitude[at];
    if !here.is_finite() || here < EDGE_FLOOR {
        return Feature { offset: f32::NAN, ..Feature::default() };
    }
    let (nx, ny) = (channel.x[at] / here, channel.y[at] / here);
    let before = near(&channel.magnitude, at, -nx, -ny);
    let after = near(&channel.magnitude, at, nx, ny);
    // Vertex of the parabola through the magnitudes at −1, 0 and 1 along the gradient.
    let bend = before - 2.0 * here + after;
    let vertex = if bend < 0.0 { 0.5 * (before - after) / bend } else { f32::NAN };
    let offset = if vertex.abs() <= MAX_OFFSET { vertex } else { f32::NAN };
    // The gradient is the tangent turned by a right angle from x towards y, so the offset is measured along the normal.
    Feature { strength: here, offset, direction: to_turn((-nx).atan2(ny)), present: channel.crosses_zero(at) }
}

fn line_at(d: &Derivatives, at: usize) -> Feature {
    let (xx, xy, yy) = (d.xx[at], d.xy[at], d.yy[at]);
    let half_trace = 0.5 * (xx + yy);
    let root = (0.5 * (xx - yy)).hypot(xy);
    let bend = half_trace + root;
    if !bend.is_finite() || bend < LINE_FLOOR {
        return Feature { offset: f32::NAN, ..Feature::default() };
    }
    // The principal direction of the larger eigenvalue points across the valley.
    let across = 0.5 * (2.0 * xy).atan2(xx - yy);
    let (ny, nx) = across.sin_cos();
    let shift = -(d.x[at] * nx + d.y[at] * ny) / bend;
    let offset = if shift.abs() <= MAX_OFFSET { shift } else { f32::NAN };
    let direction = to_turn(across - std::f32::consts::FRAC_PI_2);
    // Beside a step the slope falls off so fast that its linear extrapolation reaches zero, but it keeps its sign.
    let slope = |side: f32| near(&d.x, at, side * nx, side * ny) * nx + near(&d.y, at, side * nx, side * ny) * ny;
    let valley = slope(-1.0) < -SLOPE_FLOOR && slope(1.0) > SLOPE_FLOOR;
    Feature { strength: bend, offset, direction, present: valley && shift.abs() <= LINE_REACH }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Share of the pixel (`x`, `y`) that is inside, by 8 × 8 samples.
    fn coverage(x: usize, y: usize, inside: impl Fn(Point) -> bool) -> f32 {
        let count = (0..64).filter(|i| {
            let shift = Point::new((i % 8) as f64 + 0.5, (i / 8) as f64 + 0.5) / 8.0;
            inside(Point::new(x as f64, y as f64) + shift)
        });
        count.count() as f32 / 64.0
    }

    #[test]
    fn a_slanted_step_is_an_edge_at_its_place_and_no_line() {
        let normal = Point::from_angle(0.4);
        let picture = Raster::from_fn(40, 30, |x, y| [1.0 - coverage(x, y, |p| p.dot(normal) < 21.3); 3]);
        let features = Features::new(&picture);
        let mut found = 0;
        for y in 5..25 {
            for x in 5..35 {
                let edge = features.get(Kind::Edge, x, y);
                if edge.present {
                    found += 1;
                    let place = edge.place(x, y).expect("an edge pixel has a place");
                    assert!((place.dot(normal) - 21.3).abs() < 0.15, "{x} {y}: {}", place.dot(normal) - 21.3);
                }
                assert!(!features.get(Kind::Line, x, y).present, "{x} {y}");
            }
        }
        assert!(found >= 20, "{found}");
    }

    #[test]
    fn the_centre_of_a_slanted_line_is_found() {
        let normal = Point::from_angle(-1.1);
        for width in [1.0, 2.0, 4.0] {
            let ink = |p: Point| (p.dot(normal) - -4.7).abs() < 0.5 * width;
            let picture = Raster::from_fn(40, 40, |x, y| [1.0 - coverage(x, y, ink); 3]);
            let features = Features::new(&picture);
            let mut found = 0;
            for y in 6..34 {
                for x in 6..34 {
                    let line = features.get(Kind::Line, x, y);
                    if line.present {
                        found += 1;
                        let away = line.place(x, y).expect("a line pixel has a place").dot(normal) + 4.7;
                        assert!(away.abs() < 0.2, "width {width}: {x} {y}: {away}");
                    }
                }
            }
            assert!(found >= 20, "width {width}: {found}");
        }
    }

    #[test]
    fn a_flat_picture_has_no_features() {
        let picture = Raster::new(70, 3, [0.3, 0.6, 0.9]);
        let features = Features::new(&picture);
        for kind in [Kind::Edge, Kind::Line] {
            assert!((0..210).all(|i| features.get(kind, i % 70, i / 70).strength == 0.0));
        }
    }

    #[test]
    fn tiles_meet_without_a_seam() {
        let picture = Raster::from_fn(140, 140, |x, y| [((x * x + y * 31) % 97) as f32 / 97.0; 3]);
        let shifted = Raster::from_fn(140, 140, |x, y| picture.clamped(x as isize + 20, y as isize + 20));
        let (a, b) = (Features::new(&picture), Features::new(&shifted));
        for (x, y) in [(63, 70), (64, 70), (70, 63), (70, 64), (100, 100)] {
            for kind in [Kind::Edge, Kind::Line] {
                let (here, there) = (a.get(kind, x, y), b.get(kind, x - 20, y - 20));
                assert_eq!(here.strength, there.strength);
                assert_eq!(here.present, there.present);
            }
        }
    }
}
