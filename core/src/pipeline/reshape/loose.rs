//! What a part follows that no limb carries.
//!
//! The document may say it (`follows`): another part, the way of the pelvis, the contact with the ground, or nothing.
//! Otherwise it is found in the drawing, and told:
//!
//! 1. A part that lies at least half on a carried part follows what carries that: a button, a patch, an eye. Of several
//!    the nearest to the viewer counts.
//! 2. A flat part under the feet, at the height of the ground, is a cast shadow. It goes with the contact: along the
//!    ground with the pelvis, never up or down.
//! 3. A part that touches a carried part, or nearly does, follows that part, unless it belongs to an arm or a leg: a hat
//!    above a head goes with it, but a ball beside a shin does not swing with the shin.
//! 4. A part larger than the figure, and one away from it, is background: it stays.
//! 5. Anything else goes with the pelvis.

use super::motion::Motion;
use crate::geometry::{Point, polygon, polyline};
use crate::scene::limbs::{Follow, LimbSet};

/// A shadow is at least this many times as wide as high.
const FLAT: f64 = 4.0;
/// Parts touch if the way between them is at most this share of the torso.
const NEAR: f64 = 0.1;
/// A part is away from the figure beyond this share of the torso.
const AWAY: f64 = 1.0;

/// What a part follows.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Given {
    /// Another part, by name.
    Part(String),
    /// The way of the pelvis.
    Root,
    /// The contact with the ground.
    Contact,
    /// Nothing: it stays where it is drawn.
    Nothing,
}

impl std::fmt::Display for Given {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Part(name) => write!(f, "it follows the part {name:?}"),
            Self::Root => f.write_str("it goes with the pelvis"),
            Self::Contact => f.write_str("it is taken for a shadow and stays on the ground below the figure"),
            Self::Nothing => f.write_str("it stays where it is drawn"),
        }
    }
}

/// A part that limbs carry, at rest.
pub(super) struct Carried<'a> {
    /// Its name.
    pub name: &'a str,
    /// Its outline.
    pub outline: &'a [Point],
    /// Its depth.
    pub depth: f64,
}

/// What a document says that a part follows.
pub(super) fn asked(set: &LimbSet, name: &str) -> Option<Given> {
    set.follows.iter().find(|(part, _)| part == name).map(|(_, follow)| match follow {
        Follow::Part(other) => Given::Part(other.clone()),
        Follow::Root => Given::Root,
        Follow::Contact => Given::Contact,
        Follow::Nothing => Given::Nothing,
    })
}

/// What a part follows by the drawing. `carried` are the parts that limbs carry.
pub(super) fn found(outline: &[Point], carried: &[Carried], set: &LimbSet, motion: &Motion) -> Given {
    let inside = |other: &Carried| outline.iter().filter(|p| polygon::contains(other.outline, **p)).count();
    let on = carried.iter().filter(|other| 2 * inside(other) >= outline.len());
    if let Some(other) = on.max_by(|a, b| a.depth.total_cmp(&b.depth)) {
        return Given::Part(other.name.to_owned());
    }
    let whole: Vec<Point> = carried.iter().flat_map(|body| body.outline.iter().copied()).collect();
    let (Some(own), Some(figure)) = (polygon::bounds(outline), polygon::bounds(&whole)) else { return Given::Root };
    let (size, all) = (own.1 - own.0, figure.1 - figure.0);
    if is_shadow(own, motion) {
        return Given::Contact;
    }
    if size.x * size.y > all.x * all.y {
        return Given::Nothing;
    }
    let away = |other: &Carried| {
        let from =
            |a: &[Point], b: &[Point]| a.iter().map(|p| polyline::distance(*p, b, true)).fold(f64::INFINITY, f64::min);
        from(outline, other.outline).min(from(other.outline, outline))
    };
    let distances: Vec<f64> = carried.iter().map(away).collect();
    let bodily = (0..carried.len()).filter(|&k| distances[k] <= NEAR * motion.size && !is_limb(set, carried[k].name));
    if let Some(k) = bodily.min_by(|&a, &b| distances[a].total_cmp(&distances[b])) {
        return Given::Part(carried[k].name.to_owned());
    }
    match distances.iter().any(|distance| *distance <= AWAY * motion.size) {
        true => Given::Root,
        false => Given::Nothing,
    }
}

/// Whether a part with these bounds lies flat on the ground below the figure.
fn is_shadow((low, high): (Point, Point), motion: &Motion) -> bool {
    let (size, middle) = (high - low, low.midpoint(high));
    let below = (middle.x - motion.root.x).abs() < size.x;
    let level = (middle.y - motion.ground).abs() < (0.5 * size.y).max(NEAR * motion.size);
    !motion.feet.is_empty() && size.x >= FLAT * size.y && below && level
}

/// Whether a limb of an arm or a leg carries a part.
fn is_limb(set: &LimbSet, name: &str) -> bool {
    let limb = |to: usize| set.template.on_limb(to);
    set.limbs.iter().any(|l| limb(l.to) && l.carries.iter().any(|carried| carried.part == name))
}
