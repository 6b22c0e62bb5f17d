//! The kind of drawing that a footage shows, measured in the pictures at the keys.
//!
//! - **Lines.** In the box around the keyed contours, most of the picture is paper. A pixel is *solid* if everything
//!   within 4 working pixels of it differs from the paper: it is inside something broader than a line. A line drawing has
//!   next to no solid pixels.
//! - **Shaded.** A pixel inside a part, and away from all contours, is shaded if the brightness has a gentle slope there:
//!   steeper than grain, and less steep than a line. Where light moves over the figure most of them are.
//! - **Painted** is everything else.
//!
//! Pixels are counted over several key frames together, so a frame has the weight of what it shows. Only frames with at least
//! half as many contours as the fullest one are measured. A new key of one small part therefore does not decide about the film:
//! with equal weights for all frames one key of a hat's ribbon made a shaded film a painted one, for all parts.
//!
//! On six painted films 24 to 64 % of the box is solid, on seven line films at most 0.2 %. Inside the parts of flat painted
//! films at most 34 % is shaded, of airbrushed ones at least 67 %.

use crate::contract::error::TrackError;
use crate::shared::features::{Features, Level};
use crate::shared::store::Store;
use rototoon_base::geometry::{Point, polygon, polyline};
use rototoon_base::scene::{FrameNumber, FrameSource, Progress, Raster, Scene};
use std::collections::BTreeMap;

/// What the drawings are made of.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Kind {
    /// Flat colours.
    #[default]
    Painted,
    /// Colours with light and shade over them.
    Shaded,
    /// Lines on paper.
    Lines,
}

/// Largest share of solid pixels of a line drawing.
const MOST_SOLID: f64 = 0.03;
/// Least share of shaded pixels of a shaded drawing.
const LEAST_SHADED: f64 = 0.5;
/// Difference of a channel from which on a pixel is not paper.
const DIFFERS: f32 = 0.12;
/// A solid pixel differs from the paper together with all pixels within this many pixels of the fine level.
const SOLID_REACH: usize = 2;
/// Slopes of the brightness, per working pixel, between which a pixel is shaded.
const GENTLE: (f32, f32) = (0.0015, 0.02);
/// Pixels nearer than this to a contour are not counted as shaded, in working pixels. In small pictures it is two of their
/// pixels: edges are enlarged with them.
const AWAY: f64 = 6.0;
/// Largest number of drawings that are measured.
const MEASURED: usize = 5;

/// The contours on a key frame, in pixels of the picture, and whether each is closed.
type Keyed = (FrameNumber, Vec<(Vec<Point>, bool)>);

/// The kind of a footage, and what it was decided by.
#[derive(Default)]
pub struct Decided {
    by: Vec<Keyed>,
    kind: Kind,
}

impl Decided {
    /// The kind that was decided last.
    pub fn kind(&self) -> Kind {
        self.kind
    }

    /// Decides the kind of a scene's footage, if the keys are others than last time.
    ///
    /// # Errors
    ///
    /// The error of a picture that cannot be read, or the cancellation by the progress listener.
    pub fn decide(
        &mut self,
        scene: &Scene,
        store: &Store,
        frames: &dyn FrameSource,
        progress: &dyn Progress,
    ) -> Result<Kind, TrackError> {
        let by = keyed(scene);
        if by != self.by {
            let scale = crate::shared::features::working_scale(scene.footage.height);
            let mut sums = [Share::default(); 2];
            for (frame, contours) in &by {
                progress.report("Reading frames", 0.0)?;
                let working: Vec<(Vec<Point>, bool)> =
                    contours.iter().map(|(c, closed)| (c.iter().map(|&p| p / scale).collect(), *closed)).collect();
                let shares = shares(&*store.features(frames, *frame)?, &working, scale);
                sums = [sums[0].plus(shares[0]), sums[1].plus(shares[1])];
            }
            self.kind = kind_of(sums);
            self.by = by;
        }
        Ok(self.kind)
    }
}

/// The kind of drawings with these shares of solid and of shaded pixels.
fn kind_of([solid, shaded]: [Share; 2]) -> Kind {
    // A box without pixels says nothing for a line drawing.
    if solid.of > 0 && solid.value() < MOST_SOLID {
        Kind::Lines
    } else if shaded.value() > LEAST_SHADED {
        Kind::Shaded
    } else {
        Kind::Painted
    }
}

/// A number of pixels among others.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
struct Share {
    count: usize,
    of: usize,
}

impl Share {
    fn plus(self, other: Self) -> Self {
        Self { count: self.count + other.count, of: self.of + other.of }
    }

    /// 0 where there are no pixels.
    fn value(self) -> f64 {
        self.count as f64 / self.of.max(1) as f64
    }
}

/// At most [`MEASURED`] of the key frames within the footage, evenly spread over those with at least half as many contours as
/// the fullest one, with their contours.
fn keyed(scene: &Scene) -> Vec<Keyed> {
    let footage = scene.footage.first..=scene.footage.last;
    let mut numbers: BTreeMap<FrameNumber, usize> = BTreeMap::new();
    for (frame, _) in scene.parts.iter().flat_map(|part| &part.keys).filter(|(frame, _)| footage.contains(frame)) {
        *numbers.entry(*frame).or_default() += 1;
    }
    let most = numbers.values().copied().max().unwrap_or(0);
    let all: Vec<FrameNumber> = numbers.iter().filter(|(_, n)| 2 * **n >= most).map(|(frame, _)| *frame).collect();
    let count = all.len().min(MEASURED);
    let chosen = (0..count).map(|k| all[k * (all.len() - 1) / (count - 1).max(1)]);
    let contours = |frame: FrameNumber| {
        let on = scene.parts.iter().filter_map(|part| Some((part.keys.get(&frame)?.clone(), part.closed)));
        (frame, on.filter(|(contour, _)| !contour.is_empty()).collect())
    };
    chosen.map(contours).collect()
}

/// The shares of solid and of shaded pixels of a picture. Contours are in working pixels, each of which is `scale`
/// pixels of the picture wide.
fn shares(features: &Features, contours: &[(Vec<Point>, bool)], scale: f64) -> [Share; 2] {
    let all: Vec<Point> = contours.iter().flat_map(|(contour, _)| contour.iter().copied()).collect();
    match polygon::bounds(&all) {
        Some(bounds) => [solid(features.level(2), bounds), shaded(features.level(1), contours, AWAY.max(2.0 / scale))],
        None => [Share::default(); 2],
    }
}

/// The share of solid pixels in a box.
fn solid(level: &Level, (low, high): (Point, Point)) -> Share {
    let (width, height) = level.dimensions();
    let pixel = |at: f64, count: usize| (at / level.pixel()).clamp(0.0, count as f64) as usize;
    let (x0, x1) = (pixel(low.x, width), pixel(high.x, width));
    let (y0, y1) = (pixel(low.y, height), pixel(high.y, height));
    let (columns, rows) = (x1 - x0, y1 - y0);
    if columns * rows == 0 {
        return Share::default();
    }
    let center = |x: usize, y: usize| Point::new((x0 + x) as f64 + 0.5, (y0 + y) as f64 + 0.5) * level.pixel();
    let colours = Raster::from_fn(columns, rows, |x, y| level.colour(center(x, y)).to_array());
    let paper = [0, 1, 2].map(|k| {
        let mut values: Vec<f32> = colours.data().iter().map(|colour| colour[k]).collect();
        let middle = values.len() / 2;
        *values.select_nth_unstable_by(middle, f32::total_cmp).1
    });
    let differs = colours.map(|colour| (0..3).any(|k| (colour[k] - paper[k]).abs() > DIFFERS));
    let within = |at: usize, count: usize| at.saturating_sub(SOLID_REACH)..(at + SOLID_REACH + 1).min(count);
    let is_solid = |x: usize, y: usize| within(y, rows).all(|v| within(x, columns).all(|u| differs.get(u, v)));
    let count = (0..rows).map(|y| (0..columns).filter(|&x| is_solid(x, y)).count()).sum::<usize>();
    Share { count, of: columns * rows }
}

/// The share of shaded pixels of those inside the closed contours and further than `away` working pixels from all contours.
fn shaded(level: &Level, contours: &[(Vec<Point>, bool)], away: f64) -> Share {
    let (width, height) = level.dimensions();
    let mut inside = Raster::new(width, height, false);
    for (contour, _) in contours.iter().filter(|(contour, closed)| *closed && contour.len() > 2) {
        let scaled: Vec<Point> = contour.iter().map(|&p| p / level.pixel()).collect();
        polygon::for_each_span(&scaled, width, height, |y, x0, x1| inside.row_mut(y)[x0..x1].fill(true));
    }
    let reach = (away / level.pixel()).ceil() as isize;
    for (a, b) in contours.iter().flat_map(|(contour, closed)| polyline::segments(contour, *closed)) {
        let steps = (a.distance(b) / level.pixel()).ceil().max(1.0);
        for k in 0..=steps as usize {
            let at = a.lerp(b, k as f64 / steps) / level.pixel();
            clear(&mut inside, (at.x.floor() as isize, at.y.floor() as isize), reach);
        }
    }
    let (mut count, mut gentle) = (0usize, 0usize);
    for (index, _) in inside.data().iter().enumerate().filter(|(_, inside)| **inside) {
        let at = Point::new((index % width) as f64 + 0.5, (index / width) as f64 + 0.5) * level.pixel();
        let slopes = level.sample(at).slopes.map(|s| 0.3 * s.x + 0.59 * s.y + 0.11 * s.z);
        let slope = slopes[0].hypot(slopes[1]);
        count += 1;
        gentle += usize::from(slope > GENTLE.0 && slope < GENTLE.1);
    }
    Share { count: gentle, of: count }
}

/// Clears the square around a pixel.
fn clear(mask: &mut Raster<bool>, (x, y): (isize, isize), reach: isize) {
    let range = |at: isize, count: usize| {
        let bound = |v: isize| v.clamp(0, count as isize) as usize;
        bound(at - reach)..bound(at + reach + 1)
    };
    let columns = range(x, mask.width());
    for row in range(y, mask.height()) {
        mask.row_mut(row)[columns.clone()].fill(false);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rototoon_base::scene::Colour;

    const SQUARE: [(f64, f64); 4] = [(100.0, 100.0), (400.0, 100.0), (400.0, 400.0), (100.0, 400.0)];

    fn shares_of(colour: impl Fn(Point) -> Colour) -> [f64; 2] {
        let picture = Raster::from_fn(540, 540, |x, y| colour(Point::new(x as f64 + 0.5, y as f64 + 0.5)));
        let square = SQUARE.map(|(x, y)| Point::new(x, y)).to_vec();
        shares(&Features::new(&picture), &[(square, true)], 1.0).map(Share::value)
    }

    fn inside(p: Point) -> bool {
        p.min_element() > 120.0 && p.max_element() < 380.0
    }

    #[test]
    fn outlines_fills_and_shade_are_told_apart() {
        let ring = |p: Point| (p - Point::splat(250.0)).abs().max_element() - 130.0;
        let [solid, _] = shares_of(|p| if ring(p).abs() < 2.0 { [0.3; 3] } else { [0.95; 3] });
        assert!(solid < MOST_SOLID, "{solid}");
        let [solid, shaded] = shares_of(|p| if inside(p) { [0.8, 0.4, 0.2] } else { [0.95; 3] });
        assert!(solid > 0.2 && shaded < 0.4, "{solid} {shaded}");
        let light = |p: Point| 0.2 + 0.8 * ((p.x - 100.0) / 300.0) as f32;
        let [solid, shaded] = shares_of(|p| if inside(p) { [1.0, 0.9, 0.8].map(|c| c * light(p)) } else { [0.95; 3] });
        assert!(solid > 0.2 && shaded > LEAST_SHADED, "{solid} {shaded}");
    }

    #[test]
    fn a_frame_weighs_as_much_as_it_shows() {
        let share = |count, of| Share { count, of };
        let full = [share(4000, 10_000), share(670, 1000)];
        let sum = |frames: &[[Share; 2]]| {
            frames.iter().fold([Share::default(); 2], |sum, frame| [sum[0].plus(frame[0]), sum[1].plus(frame[1])])
        };
        assert_eq!(kind_of(sum(&[full, full])), Kind::Shaded);
        // A part without pixels away from its contours, and one with a few that are flat.
        for small in [[share(90, 100), Share::default()], [share(90, 100), share(0, 12)]] {
            assert_eq!(kind_of(sum(&[full, full, small])), Kind::Shaded);
        }
        let lines = [share(20, 10_000), share(10, 1000)];
        assert_eq!(kind_of(sum(&[lines, lines, [share(50, 60), Share::default()]])), Kind::Lines);
        assert_eq!(kind_of([Share::default(); 2]), Kind::Painted);
    }

    #[test]
    fn a_key_of_one_part_is_not_measured_beside_full_ones() {
        let square = SQUARE.map(|(x, y)| Point::new(x, y)).to_vec();
        let part = |frames: &[FrameNumber]| rototoon_base::scene::Part {
            keys: frames.iter().map(|frame| (*frame, square.clone())).collect(),
            closed: true,
            ..Default::default()
        };
        let footage = rototoon_base::scene::Footage {
            pattern: "%d".into(),
            first: 0,
            last: 20,
            fps: 24.0,
            width: 540,
            height: 540,
            held: false,
        };
        let scene = |extra: &[FrameNumber]| Scene {
            footage: footage.clone(),
            parts: vec![part(&[0, 20]), part(&[0, 20]), part(&[&[0, 20], extra].concat())],
        };
        let frames = |extra: &[FrameNumber]| keyed(&scene(extra)).iter().map(|keyed| keyed.0).collect::<Vec<_>>();
        assert_eq!(frames(&[]), [0, 20]);
        assert_eq!(frames(&[8, 9, 10, 11]), [0, 20]);
    }
}
