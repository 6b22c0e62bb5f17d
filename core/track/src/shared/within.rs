//! Whether two pictures show the same drawing of a part, whatever is around it.
//!
//! Cels are painted on twos and laid over a background that pans on ones. No two pictures are the same there, so
//! [`held`](super::held) finds nothing as a whole. Inside a part's contour the picture is the same for the time of a drawing. So its
//! test is made there alone, up to the contour: the line of the part must be the same, not only what is drawn within.
//!
//! **Evidence.** Flat colour looks the same wherever the part goes. So the slopes within the region must tell a movement in each
//! direction: the smaller eigenvalue of Σ∇I∇Iᵀ must be at least [`LEAST_SLOPES`]. The region as a whole must also stand still: the movement v with the
//! least ΣD + ∇I·v squared (Lucas & Kanade 1981) must be at most [`STILL`]. Its error falls with the number of samples, so noise hides
//! half a pixel in a small window, but not in a region.
//!
//! **Shift.** A part that goes with the camera is the same drawing at another place. The second picture is read at a shift then,
//! which [`Region::settled`] makes exact in [`STEPS`] steps of the same least squares.
//!
//! **Bleeding.** A contour of few points cuts corners, so there is background inside of it. [`Region::without_bleeding`] leaves out what changes and
//! hangs together with the contour through what changes, up to [`DEEPEST`]. A part that moves changes there too. But then its line has changed. So
//! from nearly all places of the contour something of the part's slopes must be left within that depth, as much in each direction as is asked of a region.
//!
//! **Limits.** A contour that was traced on the inside of its line, with nothing drawn in the part, has no slopes beyond the rim: the answer is no.

use super::features::{Features, Level, Sample, UNIT, total};
use super::held::{Difference, variance};
use rototoon_base::geometry::{Point, polygon, polyline};
use rototoon_base::scene::Raster;

/// Least of the sum of squared slopes in a region along the direction in which it is smallest.
const LEAST_SLOPES: f64 = 1.0;
/// Longest movement of a region that stands still, in working pixels.
const STILL: f64 = 0.15;
/// Least number of pixels of ink, so that a dot is judged like one in a part.
const LEAST_INK: f64 = 100.0;
/// Level (index in `LEVELS`) on which pictures are compared.
const LEVEL: usize = 2;
/// Steps in which a shift is made exact, and the longest way that they may go in working pixels.
const STEPS: usize = 5;
const FURTHEST: f64 = 1.5;
/// How deep inside a contour the background may be, in working pixels.
const DEEPEST: f64 = 9.0;
/// Least change of a colour that is none of noise, and how many times the deviation of the grain.
const CHANGED: (f32, f64) = (0.04, 5.0);
/// Distance of the places of a contour from which the part's line is looked for, in working pixels, and the share of them that must see one.
const APART: f64 = 4.0;
const SEEING: f64 = 0.85;
/// Least squared slope of a pixel of a line.
const LINE: f32 = 0.004;

/// The pixels of the finest level that are within a contour.
#[derive(Clone)]
pub struct Region {
    contour: Vec<Point>,
    corner: (usize, usize),
    inside: Raster<bool>,
    count: usize,
}

impl Region {
    /// What is inside of a closed contour (working pixels) in a picture. `None` if nothing is.
    pub fn within(contour: &[Point], picture: &Features) -> Option<Self> {
        let level = picture.level(LEVEL);
        let (columns, rows) = level.dimensions();
        let (low, high) = polygon::bounds(contour)?;
        let pixel = |at: f64, count: usize| (at / level.pixel()).floor().clamp(0.0, count as f64) as usize;
        let corner = (pixel(low.x, columns), pixel(low.y, rows));
        let (right, below) = (pixel(high.x + level.pixel(), columns), pixel(high.y + level.pixel(), rows));
        let (width, height) = (right.saturating_sub(corner.0), below.saturating_sub(corner.1));
        if contour.len() < 3 || width == 0 || height == 0 {
            return None;
        }
        let contour = contour.to_vec();
        let mut region = Self { contour, corner, inside: Raster::new(width, height, false), count: 0 };
        for y in 0..height {
            for x in 0..width {
                let p = region.place(level, x, y);
                let is = polygon::contains(&region.contour, p);
                region.inside.row_mut(y)[x] = is;
                region.count += usize::from(is);
            }
        }
        (region.count > 0).then_some(region)
    }

    /// The region without the background that its contour contains, by two pictures of one size, the second one read at a `shift`. `None` if
    /// too little of the part's line is left.
    fn without_bleeding(&self, [a, b]: [&Level; 2], shift: Point) -> Option<Self> {
        let (width, height) = (self.inside.width(), self.inside.height());
        let (mut changes, mut slopes) = (Raster::new(width, height, 0f32), Raster::new(width, height, 0f32));
        let mut sizes = Vec::with_capacity(3 * self.count);
        self.each(a, |x, y, p| {
            let ([xx, _, yy, ..], own) = products(a, b, p, shift);
            sizes.extend(own.map(|change| (change.abs() * UNIT).round() as u16));
            changes.set(x, y, own.into_iter().map(f32::abs).fold(0.0, f32::max));
            slopes.set(x, y, xx + yy);
        });
        let bound = CHANGED.0.max((CHANGED.1 * variance(&mut sizes).sqrt()) as f32);
        let mut left = self.clone();
        let is_edge = |x: usize, y: usize| {
            let (x, y) = (x as isize, y as isize);
            [(x - 1, y), (x + 1, y), (x, y - 1), (x, y + 1)].into_iter().any(|(x, y)| !self.has(x, y))
        };
        let mut next = Vec::new();
        self.each(a, |x, y, _| next.extend(is_edge(x, y).then_some((x as isize, y as isize))));
        while let Some((x, y)) = next.pop() {
            if !left.has(x, y) || changes.get(x as usize, y as usize) <= bound {
                continue;
            }
            if polyline::distance(self.place(a, x as usize, y as usize), &self.contour, true) <= DEEPEST {
                left.inside.set(x as usize, y as usize, false);
                left.count -= 1;
                next.extend([(x - 1, y), (x + 1, y), (x, y - 1), (x, y + 1)]);
            }
        }
        left.sees_line(a.pixel(), &slopes, self).then_some(left)
    }

    /// Whether a line is left near most places of the contour. Places near which there was none before do not count.
    fn sees_line(&self, pixel: f64, slopes: &Raster<f32>, before: &Self) -> bool {
        let reach = (DEEPEST / pixel).ceil() as isize;
        let count = (polyline::length(&self.contour, true) / APART).ceil() as usize;
        let sees = |region: &Self, p: Point| {
            let at = p / pixel - Point::new(region.corner.0 as f64, region.corner.1 as f64);
            let (x, y) = (at.x.floor() as isize, at.y.floor() as isize);
            let near = (-reach..=reach).flat_map(|dy| (-reach..=reach).map(move |dx| (dx, dy)));
            let near = near.filter(|(dx, dy)| dx * dx + dy * dy <= reach * reach);
            let is = |(dx, dy): (isize, isize)| {
                region.has(x + dx, y + dy) && slopes.get((x + dx) as usize, (y + dy) as usize) > LINE
            };
            near.into_iter().any(is)
        };
        let places = polyline::resample(&self.contour, true, count.max(8));
        let (mut all, mut seeing) = (0usize, 0usize);
        for place in places.into_iter().filter(|&place| sees(before, place)) {
            all += 1;
            seeing += usize::from(sees(self, place));
        }
        all > 0 && seeing as f64 >= SEEING * all as f64
    }

    fn has(&self, x: isize, y: isize) -> bool {
        let within = x >= 0 && y >= 0 && (x as usize) < self.inside.width() && (y as usize) < self.inside.height();
        within && self.inside.get(x as usize, y as usize)
    }

    /// Whether two pictures show the same within the region, the second one read at a `shift` in working pixels. No also where the
    /// region does not tell.
    pub fn same(&self, a: &Features, b: &Features, shift: Point) -> bool {
        let levels = [a.level(LEVEL), b.level(LEVEL)];
        let is_left = || self.without_bleeding(levels, shift).is_some_and(|left| left.stands(levels, shift));
        levels[0].dimensions() == levels[1].dimensions() && (self.stands(levels, shift) || is_left())
    }

    /// Whether the whole region is the same.
    fn stands(&self, [a, b]: [&Level; 2], shift: Point) -> bool {
        let still = self.movement(a, b, shift).is_some_and(|moved| moved.length() <= STILL);
        still && self.difference(a, b, shift).measure(LEAST_INK).is_noise()
    }

    /// A shift made exact. `None` if the region does not tell, or leads far from it.
    pub fn settled(&self, a: &Features, b: &Features, shift: Point) -> Option<Point> {
        let (a, b) = (a.level(LEVEL), b.level(LEVEL));
        let mut found = shift;
        for _ in 0..STEPS {
            found += self.movement(a, b, found)?;
        }
        (found.distance(shift) <= FURTHEST).then_some(found)
    }

    fn place(&self, level: &Level, x: usize, y: usize) -> Point {
        Point::new((self.corner.0 + x) as f64 + 0.5, (self.corner.1 + y) as f64 + 0.5) * level.pixel()
    }

    /// The movement of the region from one picture to the other beyond a shift, in working pixels. `None` if its slopes do not tell.
    fn movement(&self, a: &Level, b: &Level, shift: Point) -> Option<Point> {
        let [xx, xy, yy, xt, yt, _] = self.sums(a, b, shift);
        let (middle, spread) = (0.5 * (xx + yy), (0.25 * (xx - yy).powi(2) + xy * xy).sqrt());
        if middle - spread < LEAST_SLOPES {
            return None;
        }
        let determinant = xx * yy - xy * xy;
        Some(Point::new(xy * yt - yy * xt, xy * xt - xx * yt) / determinant * a.pixel())
    }

    fn sums(&self, a: &Level, b: &Level, shift: Point) -> [f64; 6] {
        let mut sums = [0.0; 6];
        self.each(a, |_, _, p| {
            let own = products(a, b, p, shift).0;
            sums.iter_mut().zip(own).for_each(|(sum, value)| *sum += f64::from(value));
        });
        sums
    }

    fn difference(&self, a: &Level, b: &Level, shift: Point) -> Difference {
        let (width, height) = (self.inside.width(), self.inside.height());
        let mut planes = [(); 6].map(|()| vec![0f32; width * height]);
        let mut sizes = Vec::with_capacity(3 * self.count);
        self.each(a, |x, y, p| {
            let (own, changes) = products(a, b, p, shift);
            planes.iter_mut().zip(own).for_each(|(plane, value)| plane[y * width + x] = value);
            sizes.extend(changes.map(|change| (change.abs() * UNIT).round() as u16));
        });
        Difference::of((width, height), planes, &mut sizes)
    }

    /// Visits the pixels of the region, with their places in working pixels.
    fn each(&self, level: &Level, mut visit: impl FnMut(usize, usize, Point)) {
        for y in 0..self.inside.height() {
            for x in (0..self.inside.width()).filter(|&x| self.inside.get(x, y)) {
                visit(x, y, self.place(level, x, y));
            }
        }
    }
}

/// The products of a [`Difference`] at a place, and the changes of the colours. Both pictures are read between their pixels in the same measure,
/// because reading between them smooths.
fn products(a: &Level, b: &Level, p: Point, shift: Point) -> ([f32; 6], [f32; 3]) {
    let between = shift - (shift / a.pixel()).round() * a.pixel();
    let p = p - between * 0.5;
    let (first, second): (Sample, Sample) = (a.sample(p), b.sample(p + shift));
    let pixel = a.pixel() as f32;
    let d = second.colour - first.colour;
    let gx = (first.slopes[0] + second.slopes[0]) * (0.5 * pixel);
    let gy = (first.slopes[1] + second.slopes[1]) * (0.5 * pixel);
    ([gx * gx, gx * gy, gy * gy, gx * d, gy * d, d * d].map(total), [d.x, d.y, d.z])
}

#[cfg(test)]
mod tests {
    use super::*;

    const MIDDLE: Point = Point::new(200.0, 270.0);

    /// An egg with a line of 3 px and an eye, turned and moved, over stripes that are moved by `pan`.
    fn picture(turn: f64, moved: Point, pan: f64) -> Features {
        let back = Point::from_angle(-turn.to_radians());
        let colour = |p: Point| -> [f64; 3] {
            let q = back.rotate(p - MIDDLE - moved) / Point::new(70.0, 50.0);
            let away = (q.length() - 1.0) * 50.0;
            let eye = (q - Point::new(0.4, -0.2)).length() * 50.0;
            let stripe = 0.5 + 0.4 * ((p.x - pan) * 0.11).sin() * (p.y * 0.07).cos();
            let ground = [stripe, 0.8 * stripe, 0.3];
            let mix = |a: [f64; 3], b: [f64; 3], share: f64| {
                [0, 1, 2].map(|k: usize| a[k] + (b[k] - a[k]) * share.clamp(0.0, 1.0))
            };
            let painted = mix(ground, [0.8, 0.6, 0.4], 0.5 - away);
            mix(painted, [0.05; 3], (0.5 + 1.5 - away.abs()).max(4.5 - eye))
        };
        let pixel = |x: usize, y: usize| colour(Point::new(x as f64 + 0.5, y as f64 + 0.5)).map(|value| value as f32);
        Features::new(&Raster::from_fn(400, 540, pixel))
    }

    /// The contour of the egg with so many points, larger by a factor.
    fn contour(count: usize, factor: f64) -> Vec<Point> {
        let place = |k: usize| Point::from_angle(k as f64 / count as f64 * std::f64::consts::TAU);
        (0..count).map(|k| MIDDLE + place(k) * Point::new(70.0, 50.0) * factor).collect()
    }

    #[test]
    fn a_drawing_is_the_same_over_a_background_that_moves() {
        let region = Region::within(&contour(40, 1.0), &picture(0.0, Point::ZERO, 0.0)).unwrap();
        let same =
            |turn, moved, pan| region.same(&picture(0.0, Point::ZERO, 0.0), &picture(turn, moved, pan), Point::ZERO);
        assert!(same(0.0, Point::ZERO, 17.0));
        for moved in [Point::new(0.5, 0.0), Point::new(0.0, 0.5), Point::new(-0.3, 0.3)] {
            assert!(!same(0.0, moved, 0.0), "{moved}");
            assert!(!same(0.0, moved, 17.0), "{moved} over a background that moves");
        }
        assert!(!same(1.0, Point::ZERO, 0.0), "turned");
    }

    #[test]
    fn what_a_loose_contour_has_of_the_background_is_left_out() {
        let (first, loose) = (picture(0.0, Point::ZERO, 0.0), contour(9, 1.1));
        let region = Region::within(&loose, &first).unwrap();
        let same = |turn, moved, pan| {
            let second = picture(turn, moved, pan);
            let levels = [first.level(LEVEL), second.level(LEVEL)];
            assert!(!region.stands(levels, Point::ZERO), "the background is in the region");
            region.same(&first, &second, Point::ZERO)
        };
        assert!(same(0.0, Point::ZERO, 17.0));
        for moved in [Point::new(0.5, 0.0), Point::new(0.0, 0.5), Point::new(4.0, 0.0)] {
            assert!(!same(0.0, moved, 17.0), "{moved}");
        }
        assert!(!same(2.0, Point::ZERO, 17.0), "turned");
    }

    #[test]
    fn a_shift_is_made_exact() {
        let (first, second) = (picture(0.0, Point::ZERO, 0.0), picture(0.0, Point::new(6.7, -2.2), 6.7));
        let region = Region::within(&contour(40, 1.0), &first).unwrap();
        let shift = region.settled(&first, &second, Point::new(6.0, -2.0)).unwrap();
        assert!(shift.distance(Point::new(6.7, -2.2)) < 0.1, "{shift}");
        assert!(region.same(&first, &second, shift));
        assert_eq!(region.settled(&first, &second, Point::ZERO), None, "too far");
    }

    #[test]
    fn flat_colour_does_not_tell() {
        let flat = Features::new(&Raster::new(400, 540, [0.5; 3]));
        assert!(!Region::within(&contour(20, 1.0), &flat).unwrap().same(&flat, &flat, Point::ZERO));
        assert!(Region::within(&contour(20, 0.001), &flat).is_none(), "it contains no pixel");
    }
}
