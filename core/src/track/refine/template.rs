//! The colours around each sample at a key, in the frame of the contour there.

use super::Key;
use super::samples::Samples;
use crate::geometry::{Point, polygon, polyline};
use crate::scene::Colour;

/// Half sizes along tangent and normal, in working pixels.
pub const HALF: [i32; 2] = [4, 6];
/// Steps along either.
const STEP: [i32; 2] = [2, 1];
/// Weight of what lies outside the part: it may be another thing on other frames.
const OUTSIDE: f32 = 0.5;
/// Weight of what lies outside and under a nearer part.
const OUTSIDE_HIDDEN: f32 = 0.1;
/// The part reaches this far beyond its contour, in working pixels.
const REACH: f64 = 2.0;
/// Level (index in `LEVELS`) whose colours are taken.
pub const LEVEL: usize = 2;

/// The template of one sample at one key.
#[derive(Clone)]
pub struct Template {
    /// Colour and weight at each offset, those along the normal innermost.
    pub cells: Vec<(Colour, f32)>,
    /// Sum of the weights.
    pub weight: f32,
    /// Share of the inside that no nearer part hides.
    pub shown: f64,
}

/// The templates of both keys.
pub struct Templates {
    of_key: [Vec<Template>; 2],
}

/// Offsets of a template along one axis.
pub fn offsets(axis: usize) -> impl Iterator<Item = i32> + Clone {
    (-HALF[axis]..=HALF[axis]).step_by(STEP[axis] as usize)
}

impl Templates {
    /// Cuts the templates of all samples.
    pub fn new(keys: &[Key; 2], samples: &Samples, closed: bool) -> Self {
        Self { of_key: [0, 1].map(|k: usize| of_key(&keys[k], samples, closed)) }
    }

    /// The templates of a sample.
    pub fn of(&self, s: usize) -> [&Template; 2] {
        [&self.of_key[0][s], &self.of_key[1][s]]
    }
}

fn of_key(key: &Key, samples: &Samples, closed: bool) -> Vec<Template> {
    let (places, tangents) = samples.frames(key.points);
    let level = key.picture.level(LEVEL);
    let inside =
        |p: Point| !closed || polygon::contains(key.points, p) || polyline::distance(p, key.points, true) <= REACH;
    let cut = |(place, tangent): (&Point, &Point)| {
        let mut template = Template { cells: Vec::new(), weight: 0.0, shown: 0.0 };
        let (mut within, mut seen) = (0.0, 0.0);
        for u in offsets(0) {
            for v in offsets(1) {
                let p = *place + tangent.rotate(Point::new(f64::from(u), f64::from(v)));
                let (inside, hidden) = (inside(p), key.cover.hides(p));
                let weight = match (inside, hidden) {
                    (true, false) => 1.0,
                    (true, true) => 0.0,
                    (false, false) => OUTSIDE,
                    (false, true) => OUTSIDE_HIDDEN,
                };
                within += f64::from(u8::from(inside));
                seen += f64::from(u8::from(inside && !hidden));
                template.weight += weight;
                template.cells.push((level.colour(p), weight));
            }
        }
        template.shown = seen / f64::max(within, 1.0);
        template
    };
    places.iter().zip(&tangents).map(cut).collect()
}
