//! Templates: the colours around each sample at a key, in the frame of the contour there.
//!
//! A cell outside the part shows the background, which may be different on other frames. So it has less weight, and it
//! also stores the part's own colour at the mirror place inside, which shows a contour that slipped inwards.
//!
//! A template has a [`Grain`]. A coarse one is the same on a reduced picture, so it looks twice as far.

use super::samples::Samples;
use super::view::Key;
use crate::rototoon::lattice::texture::CONTRAST;
use crate::shared::features::{Padded, difference};
use rototoon_base::geometry::{Point, polygon, polyline};
use rototoon_base::scene::Colour;

/// Half sizes along tangent and normal, in working pixels.
pub const HALF: [i32; 2] = [4, 6];
/// Steps along tangent and normal, in working pixels.
const STEP: [i32; 2] = [2, 1];
/// Weight of an offset outside the part: it may show something else on other frames.
const OUTSIDE: f32 = 0.5;
/// Weight of an offset that is outside and under a nearer part.
const OUTSIDE_HIDDEN: f32 = 0.1;
/// An offset this near to the contour still counts as inside, in working pixels.
const REACH: f64 = 2.0;

/// How large a template is. All lengths of this module are multiplied by its step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Grain {
    /// Level (index in `LEVELS`) from which the colours are read.
    pub level: usize,
    /// Working pixels per step.
    pub step: f64,
}

/// Templates on the finest level.
pub const FINE: Grain = Grain { level: 2, step: 1.0 };
/// Templates on the next level, twice as large.
pub const COARSE: Grain = Grain { level: 1, step: 2.0 };

/// One offset of a template.
#[derive(Clone)]
pub struct Cell {
    /// Colour at the key.
    pub colour: Colour,
    /// Weight of the offset.
    pub weight: f32,
    /// The part's colour at the mirror place inside the contour, for an offset outside. None if the two colours are
    /// alike.
    pub own: Option<Colour>,
}

/// The template of one sample at one key.
#[derive(Clone)]
pub struct Template {
    /// Its cells. The offset along the normal is the inner index.
    pub cells: Vec<Cell>,
    /// Sum of the weights.
    pub weight: f32,
    /// Share of the inside offsets that no nearer part hides.
    pub shown: f64,
}

/// The templates of both keys.
pub struct Templates {
    of_key: [Vec<Template>; 2],
    /// How large they are.
    pub grain: Grain,
}

/// Offsets of a template along one axis.
pub fn offsets(axis: usize) -> impl Iterator<Item = i32> + Clone {
    (-HALF[axis]..=HALF[axis]).step_by(STEP[axis] as usize)
}

impl Templates {
    /// Reads the templates of all samples.
    pub fn new(keys: &[Key; 2], samples: &Samples, closed: bool, grain: Grain) -> Self {
        Self { of_key: [0, 1].map(|k: usize| of_key(&keys[k], samples, closed, grain)), grain }
    }

    /// Forgets the difference between part and background, for measurements without it: offsets outside have the same
    /// cost function as offsets inside.
    pub fn forget_figure(&mut self) {
        self.of_key.iter_mut().flatten().flat_map(|template| &mut template.cells).for_each(|cell| cell.own = None);
    }

    /// The templates of a sample, one per key.
    pub fn of(&self, s: usize) -> [&Template; 2] {
        [&self.of_key[0][s], &self.of_key[1][s]]
    }
}

/// A colour without its padding.
fn bare(colour: Padded) -> Colour {
    colour.truncate().to_array()
}

fn of_key(key: &Key, samples: &Samples, closed: bool, grain: Grain) -> Vec<Template> {
    let (places, tangents) = samples.frames(key.points);
    let level = key.picture.level(grain.level);
    let within = |p: Point| polygon::contains(key.points, p);
    let inside = |p: Point| !closed || within(p) || polyline::distance(p, key.points, true) <= REACH * grain.step;
    let cut = |(place, tangent): (&Point, &Point)| {
        let mut template = Template { cells: Vec::new(), weight: 0.0, shown: 0.0 };
        let (mut own_cells, mut seen) = (0.0, 0.0);
        for u in offsets(0) {
            for v in offsets(1) {
                let at = |v: i32| *place + tangent.rotate(Point::new(f64::from(u), f64::from(v)) * grain.step);
                let (p, across) = (at(v), at(-v));
                let (inside, hidden) = (inside(p), key.cover.hides(p));
                let colour = level.colour(p);
                let own = if inside || !within(across) { None } else { Some(level.colour(across)) };
                let own = own.filter(|own| difference(*own, colour) > CONTRAST).map(bare);
                let colour = bare(colour);
                let weight = match (inside, hidden) {
                    (true, false) => 1.0,
                    (true, true) => 0.0,
                    (false, false) => OUTSIDE,
                    (false, true) => OUTSIDE_HIDDEN,
                };
                own_cells += f64::from(u8::from(inside));
                seen += f64::from(u8::from(inside && !hidden));
                template.weight += weight;
                template.cells.push(Cell { colour, weight, own });
            }
        }
        template.shown = seen / f64::max(own_cells, 1.0);
        template
    };
    places.iter().zip(&tangents).map(cut).collect()
}
