//! Solid shapes on the next drawing, where tracing finds none.
//!
//! A line is laid on the ink there ([`super::follow`]). A small solid shape, such as a pupil, may have no outline to be laid on: it is
//! hardly broader than the lines, or a light crosses it, so the next drawing is traced with lines at its place. Laid on these
//! it would collapse. It is looked for as what it is, a patch of dark in light:
//!
//! 1. Its *patch* are the brightnesses within its outline and in a rim around it. The place is where the next drawing differs least
//!    from the patch: steps of two pixels around the expected place, then finer and finer ones.
//! 2. Its outline follows the edge of the dark: along each normal the place of half brightness is looked for on both drawings,
//!    and the point moves by the difference. So the same picture gives the same outline, however the artist drew it. Moves are
//!    smoothed along the outline.
//!
//! What is inside and what is around count the same. Where the patch differs by more than a third of its contrast everywhere, the
//! shape has ended: if the dark is gone, it differs by a half.

use super::confidence::Signs;
use super::{Laid, carried_along};
use crate::drawing::Drawing;
use rototoon_base::geometry::{Point, polygon};
use rototoon_base::scene::{Colour, Raster};

/// Width of the rim around a shape, in pixels at 540 lines.
const RIM: f64 = 3.0;
/// Reach of the search around the expected place, and of the edge along a normal, in the same pixels.
const REACH: f64 = 12.0;
const EDGE: f64 = 3.0;
/// Places of a patch that are compared, about.
const PLACES: usize = 1500;
/// Least difference of the brightness around and inside, of 1.
const DARKER: f64 = 0.2;
/// Largest mean difference of a patch, in contrasts.
const DIFFERS: f64 = 1.0 / 3.0;

/// The shape of a patch of the drawing `from` on the drawing `to`. `expected` are the points of its outline where they are expected. `None` if it
/// has ended.
pub fn found(patch: &Patch, from: &Drawing, outline: &[Point], expected: &[Point], to: &Drawing) -> Option<Laid> {
    let about = carried_along(outline, expected);
    let shift = patch.place(to, about);
    let off = patch.differs(to, shift) / patch.contrast;
    let far = shift.distance(about) / to.unit;
    if off > DIFFERS {
        return None;
    }
    let moves = edges(from, outline, Point::ZERO, patch).into_iter().zip(edges(to, outline, shift, patch));
    let moves = smoothed(moves.map(|(before, after)| after - before).collect());
    let normals = normals(outline);
    let points = outline.iter().zip(normals.iter().zip(moves)).map(|(p, (n, by))| *p + shift + *n * by).collect();
    Some(Laid { points, closed: true, signs: Signs { off, far, ..Signs::default() } })
}

/// A solid shape and what is around it.
pub struct Patch {
    /// Places inside and around, with their brightnesses.
    inside: Vec<(Point, f64)>,
    around: Vec<(Point, f64)>,
    /// Brightness half way between inside and around, and the difference of the two.
    half: f64,
    contrast: f64,
    unit: f64,
}

impl Patch {
    /// The patch of an outline. `None` if it is not clearly darker inside than around: then it is a line with paint in it.
    pub fn of(drawing: &Drawing, outline: &[Point]) -> Option<Self> {
        let unit = drawing.unit;
        let picture = &*drawing.picture;
        let grown = grown(outline, RIM * unit);
        let (low, high) = polygon::bounds(&grown)?;
        let area = ((high.x - low.x) * (high.y - low.y)).max(1.0);
        let every = ((area / PLACES as f64).sqrt().floor() as usize).max(1);
        let mut places = Vec::new();
        polygon::for_each_span(&grown, picture.width(), picture.height(), |y, first, behind| {
            if y % every == 0 {
                places.extend(
                    (first..behind).filter(|x| x % every == 0).map(|x| Point::new(x as f64 + 0.5, y as f64 + 0.5)),
                );
            }
        });
        let places = places.into_iter().map(|p| (p, bright(picture, p)));
        let (inside, around): (Vec<_>, Vec<_>) = places.partition(|(p, _)| polygon::contains(outline, *p));
        let mean = |of: &[(Point, f64)]| of.iter().map(|(_, value)| value).sum::<f64>() / of.len() as f64;
        let (dark, light) = (mean(&inside), mean(&around));
        (light - dark >= DARKER).then_some(Self {
            inside,
            around,
            half: 0.5 * (light + dark),
            contrast: light - dark,
            unit,
        })
    }

    /// The shift to where the drawing differs least, near an expected one.
    fn place(&self, to: &Drawing, about: Point) -> Point {
        let mut best = (f64::INFINITY, about);
        let mut step = 2.0 * self.unit;
        let mut count = (REACH / 2.0) as i32;
        while step >= 0.2 {
            let middle = if best.0.is_finite() { best.1 } else { about };
            for (v, u) in (-count..=count).flat_map(|v| (-count..=count).map(move |u| (v, u))) {
                let shift = middle + Point::new(f64::from(u), f64::from(v)) * step;
                // Of places that fit equally well the nearest is meant.
                let cost = self.differs(to, shift) + 1e-3 * self.contrast * shift.distance(about) / self.unit;
                if cost < best.0 {
                    best = (cost, shift);
                }
            }
            (step, count) = (0.5 * step, 1);
        }
        best.1
    }

    /// The mean difference of the patch and the drawing after a shift.
    fn differs(&self, to: &Drawing, shift: Point) -> f64 {
        let mean = |of: &[(Point, f64)]| {
            of.iter().map(|(p, value)| (bright(&to.picture, *p + shift) - value).abs()).sum::<f64>() / of.len() as f64
        };
        0.5 * (mean(&self.inside) + mean(&self.around))
    }
}

/// Where the edge of the dark is along each normal of a shifted outline, in pixels outwards; 0 where none is near.
fn edges(drawing: &Drawing, outline: &[Point], shift: Point, patch: &Patch) -> Vec<f64> {
    let step = 0.5 * drawing.unit;
    let count = (EDGE * drawing.unit / step).round() as i32;
    let of = |(p, normal): (&Point, &Point)| {
        let at = |k: i32| bright(&drawing.picture, *p + shift + *normal * (f64::from(k) * step));
        let crossing = |k: i32| {
            let (inner, outer) = (at(k), at(k + 1));
            let crosses = inner <= patch.half && outer > patch.half;
            crosses.then(|| (f64::from(k) + (patch.half - inner) / (outer - inner)) * step)
        };
        (-count..count).filter_map(crossing).min_by(|a, b| a.abs().total_cmp(&b.abs())).unwrap_or(0.0)
    };
    outline.iter().zip(&normals(outline)).map(of).collect()
}

/// The unit normals of a closed outline, which point outwards.
fn normals(outline: &[Point]) -> Vec<Point> {
    let n = outline.len();
    let side = if polygon::signed_area(outline) > 0.0 { 1.0 } else { -1.0 };
    let normal = |k: usize| {
        let along = (outline[(k + 1) % n] - outline[(k + n - 1) % n]).normalize_or_zero();
        Point::new(along.y, -along.x) * side
    };
    (0..n).map(normal).collect()
}

/// A closed outline that is larger by a distance all around.
fn grown(outline: &[Point], by: f64) -> Vec<Point> {
    outline.iter().zip(normals(outline)).map(|(p, normal)| *p + normal * by).collect()
}

/// Moves along an outline without outliers: the middle one of five, then means of three, twice.
fn smoothed(moves: Vec<f64>) -> Vec<f64> {
    let n = moves.len();
    let around = |values: &[f64], k: usize, by: usize| -> Vec<f64> {
        (0..=2 * by).map(|d| values[(k + n + d - by) % n]).collect()
    };
    if n < 5 {
        return vec![0.0; n];
    }
    let middle = |k: usize| {
        let mut five = around(&moves, k, 2);
        five.sort_unstable_by(f64::total_cmp);
        five[2]
    };
    let mut out: Vec<f64> = (0..n).map(middle).collect();
    for _ in 0..2 {
        out = (0..n).map(|k| around(&out, k, 1).iter().sum::<f64>() / 3.0).collect();
    }
    out
}

/// The brightness at a place, bilinear between the centres of pixels.
fn bright(picture: &Raster<Colour>, place: Point) -> f64 {
    let at = place - Point::splat(0.5);
    let (x, y) = (at.x.floor(), at.y.floor());
    let pixel = |u: f64, v: f64| {
        let [r, g, b] = picture.clamped(u as isize, v as isize);
        f64::from(r + g + b) / 3.0
    };
    let row = |v: f64| pixel(x, v) + (at.x - x) * (pixel(x + 1.0, v) - pixel(x, v));
    row(y) + (at.y - y) * (row(y + 1.0) - row(y))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::stroke::Options;
    use std::f64::consts::TAU;
    use std::sync::Arc;

    fn oval(at: Point, radii: Point) -> Vec<Point> {
        (0..32).map(|k| at + radii * Point::from_angle(TAU * f64::from(k) / 32.0)).collect()
    }

    /// A pupil in the ring of an eye, in a picture of 540 lines. The edges are soft.
    fn eye(at: Point, radii: Point) -> Drawing {
        let dark = |x: usize, y: usize| {
            let p = Point::new(x as f64 + 0.5, y as f64 + 0.5);
            let away = p - at;
            let pupil = (away / radii).length() - 1.0;
            let ring = ((away / Point::new(26.0, 30.0)).length() - 1.0).abs() * 28.0 - 1.2;
            (0.5 - (pupil * radii.min_element()).min(ring)).clamp(0.0, 1.0)
        };
        let picture = Raster::from_fn(300, 540, |x, y| [1.0 - 0.9 * dark(x, y) as f32; 3]);
        Drawing::new(Arc::new(picture), &Options::default())
    }

    fn look(from: &Drawing, outline: &[Point], expected: &[Point], to: &Drawing) -> Option<Laid> {
        found(&Patch::of(from, outline).unwrap(), from, outline, expected, to)
    }

    #[test]
    fn a_small_shape_is_found_where_it_went() {
        let (radii, from) = (Point::new(4.0, 6.0), Point::new(120.0, 200.0));
        let before = eye(from, radii);
        let outline = oval(from, radii);
        for (shift, grown) in [(Point::ZERO, 1.0), (Point::new(7.3, -4.6), 1.0), (Point::new(-5.0, 3.0), 1.25)] {
            let after = eye(from + shift, radii * grown);
            // It is expected four pixels beside.
            let expected: Vec<Point> = outline.iter().map(|p| *p + shift + Point::new(4.0, -2.0)).collect();
            let laid = look(&before, &outline, &expected, &after).unwrap();
            let away = |p: &Point| ((((*p - from - shift) / (radii * grown)).length() - 1.0) * radii.x).abs();
            let off = laid.points.iter().map(away).fold(0.0, f64::max);
            assert!(laid.closed && off < 0.75, "{off} px for {shift} and {grown}");
            assert!(laid.signs.off < 0.25, "{:?}", laid.signs);
        }
    }

    #[test]
    fn a_shape_that_is_gone_has_ended() {
        let (radii, at) = (Point::new(4.0, 6.0), Point::new(120.0, 200.0));
        let outline = oval(at, radii);
        let gone = eye(at, Point::splat(0.4));
        assert!(look(&eye(at, radii), &outline, &outline, &gone).is_none());
        assert!(Patch::of(&gone, &outline).is_none(), "nothing dark was there before");
    }

    #[test]
    fn a_line_with_paint_in_it_is_no_patch() {
        let at = Point::new(120.0, 200.0);
        assert!(Patch::of(&eye(at, Point::splat(4.0)), &oval(at, Point::new(26.0, 30.0))).is_none());
    }

    #[test]
    fn the_artists_outline_is_kept_where_nothing_changes() {
        let (radii, at) = (Point::new(5.0, 6.0), Point::new(120.0, 200.0));
        // It is drawn a little too small.
        let outline = oval(at, radii * 0.8);
        let laid = look(&eye(at, radii), &outline, &outline, &eye(at, radii)).unwrap();
        assert!(laid.points.iter().zip(&outline).all(|(p, q)| p.distance(*q) < 0.05));
    }
}
