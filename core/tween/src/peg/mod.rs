//! Pegs: a tree of pivots that shift, turn and scale over time. Strokes hang on them (Yang et al. 1986, section 4).
//!
//! The pivot of a peg is given in screen coordinates (pixels) with everything at rest. At time t the peg moves a point
//! p of its strokes by
//!
//! ```text
//! p ↦ α(t) A(t) (p − O) + O + S(t)
//! ```
//!
//! with the pivot O, the shift S, the turn A and the scale α. The pegs above it then move the result. Under a parent
//! that does not turn, the point relative to the parent's centre is α₀ (α A P + S), equation (11). The paper omits the
//! turn of a parent; here a peg turns everything that hangs on it.
//!
//! Between keys a [`Timing`] gives the progress of the movement.
//!
//! - *Theorem 1* says that scaling and shifts of constant speed move a point along a straight line at constant speed.
//!   As printed it is only true where nothing hangs on a peg that scales: the product of two scalings does not have
//!   constant speed. (Equation (12) is printed with x₂ − x₁ in place of x₂.)
//! - *Theorem 2*: moving the guiding points of a B-spline moves its curve. This is true for every affine map.
//!
//! [`propose`] finds pegs from strokes that moved.

pub mod propose;
mod timing;
mod tree;

pub use timing::{Timing, TimingError};
pub(crate) use timing::{hermite, monotone_slope};

use rototoon_base::geometry::Point;
use rototoon_base::geometry::polyline::FARTHEST;
use rototoon_base::geometry::similarity::Similarity;

/// Smallest scale that is accepted. Strokes on a peg with a smaller scale would be invisible.
pub const LEAST_SCALE: f64 = 1e-6;

/// Position of a peg on a key frame, relative to its rest.
#[derive(Clone, Debug, PartialEq)]
pub struct PegKey {
    /// The frame.
    pub frame: i32,
    /// S: shift in pixels, in the coordinates of the rest.
    pub shift: Point,
    /// Turn in radians, from x towards y. Full turns count.
    pub turn: f64,
    /// α: scale, from [`LEAST_SCALE`] to 1e9.
    pub scale: f64,
    /// Timing of the movement to the next key.
    pub timing: Timing,
}

impl PegKey {
    /// A key at rest.
    pub fn rest(frame: i32) -> Self {
        Self { frame, shift: Point::ZERO, turn: 0.0, scale: 1.0, timing: Timing::Linear }
    }
}

/// A pivot and its movement.
#[derive(Clone, Debug, PartialEq)]
pub struct Peg {
    /// Unique name.
    pub name: String,
    /// Index of the peg on which it hangs.
    pub parent: Option<usize>,
    /// O: the pivot in screen coordinates (pixels), with everything at rest.
    pub pivot: Point,
    /// Keys, with rising frames.
    pub keys: Vec<PegKey>,
}

/// The reason why pegs do not form a tree.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum PegError {
    /// A parent does not exist.
    #[error("peg {name:?}: found parent {parent}, expected a number below {count}")]
    Parent {
        /// Name of the peg.
        name: String,
        /// Index of the parent found.
        parent: usize,
        /// Number of pegs.
        count: usize,
    },
    /// A peg is its own ancestor.
    #[error("peg {name:?} is its own ancestor, expected parents without a loop")]
    Loop {
        /// Name of a peg of the loop.
        name: String,
    },
    /// A coordinate of a pivot is not a number or too large.
    #[error("peg {name:?}: the pivot is ({x}, {y}), expected numbers between -1e9 and 1e9")]
    Pivot {
        /// Name of the peg.
        name: String,
        /// The x found.
        x: f64,
        /// The y found.
        y: f64,
    },
    /// A number of a key is not usable.
    #[error("peg {name:?}, frame {frame}: {field} is {found}, expected {expected}")]
    Key {
        /// Name of the peg.
        name: String,
        /// Frame of the key.
        frame: i32,
        /// "shift", "turn" or "scale".
        field: &'static str,
        /// The value found.
        found: f64,
        /// The values accepted.
        expected: &'static str,
    },
    /// The frames of keys do not rise.
    #[error("peg {name:?}: found a key on frame {frame} after one on frame {before}, expected a later frame")]
    Order {
        /// Name of the peg.
        name: String,
        /// Frame of the key.
        frame: i32,
        /// Frame of the key before it.
        before: i32,
    },
    /// The timing of a key is not valid.
    #[error("peg {name:?}, frame {frame}: {source}")]
    Timing {
        /// Name of the peg.
        name: String,
        /// Frame of the key.
        frame: i32,
        /// The reason.
        source: TimingError,
    },
}

/// Pegs that form one or several trees.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PegTree {
    pegs: Vec<Peg>,
    /// Indices of the pegs, every parent before its children.
    order: Vec<usize>,
}

impl PegTree {
    /// Makes a tree of these pegs.
    ///
    /// # Errors
    ///
    /// The first of the [`problems`]: a parent that does not exist; parents that form a loop; a pivot, shift or turn
    /// that is not a number within ±1e9; a scale outside [`LEAST_SCALE`] to 1e9; frames that do not rise; a timing that
    /// is not valid. See [`PegError`].
    pub fn new(pegs: Vec<Peg>) -> Result<Self, PegError> {
        if let Some((_, error)) = problems(&pegs).into_iter().next() {
            return Err(error);
        }
        let order = ordered(&pegs).0;
        Ok(Self { pegs, order })
    }

    /// The pegs in the order in which they were given.
    pub fn pegs(&self) -> &[Peg] {
        &self.pegs
    }

    /// The map of each peg from rest to screen coordinates, its parents included. `time` is in frames.
    pub fn at(&self, time: f64) -> Vec<Similarity> {
        let mut maps = vec![Similarity::IDENTITY; self.pegs.len()];
        for &i in &self.order {
            let own = self.pegs[i].local(time);
            maps[i] = self.pegs[i].parent.map_or(own, |parent| maps[parent].after(&own));
        }
        maps
    }
}

impl Peg {
    /// The peg's own map, without its parents'. Before the first key and after the last one the peg rests at that key.
    pub fn local(&self, time: f64) -> Similarity {
        let next = self.keys.partition_point(|key| f64::from(key.frame) <= time);
        let (shift, turn, scale) = match (next.checked_sub(1).map(|k| &self.keys[k]), self.keys.get(next)) {
            (None, None) => (Point::ZERO, 0.0, 1.0),
            (Some(a), Some(b)) => {
                let u = (time - f64::from(a.frame)) / (f64::from(b.frame) - f64::from(a.frame));
                let s = a.timing.at(u);
                (a.shift.lerp(b.shift, s), a.turn + s * (b.turn - a.turn), a.scale + s * (b.scale - a.scale))
            }
            (Some(key), None) | (None, Some(key)) => (key.shift, key.turn, key.scale),
        };
        // A timing that overshoots must not make the scale negative.
        let factor = Point::from_angle(turn) * scale.max(LEAST_SCALE);
        Similarity { factor, source: self.pivot, target: self.pivot + shift }
    }
}

/// All reasons why these pegs do not form a tree, each with the index of its peg. A loop is reported once, for the peg
/// with the smallest index.
pub fn problems(pegs: &[Peg]) -> Vec<(usize, PegError)> {
    let mut found = Vec::new();
    for (k, peg) in pegs.iter().enumerate() {
        check(peg, pegs.len(), &mut |error| found.push((k, error)));
    }
    let loops = ordered(pegs).1;
    found.extend(loops.into_iter().map(|k| (k, PegError::Loop { name: pegs[k].name.clone() })));
    found
}

/// Indices of the pegs, every parent before its children; and for each loop the peg with the smallest index.
fn ordered(pegs: &[Peg]) -> (Vec<usize>, Vec<usize>) {
    let mut order = Vec::with_capacity(pegs.len());
    let mut loops = Vec::new();
    // The start from which each peg was reached.
    let mut met = vec![usize::MAX; pegs.len()];
    for start in 0..pegs.len() {
        let mut chain = Vec::new();
        let mut next = Some(start);
        while let Some(i) = next.filter(|&i| i < pegs.len() && met[i] == usize::MAX) {
            met[i] = start;
            chain.push(i);
            next = pegs[i].parent;
        }
        if let Some(again) = next.filter(|&i| i < pegs.len() && met[i] == start) {
            let entered = chain.iter().position(|&i| i == again).unwrap_or_default();
            loops.extend(chain[entered..].iter().min());
        }
        order.extend(chain.into_iter().rev());
    }
    (order, loops)
}

/// Calls `wrong` for each problem of one peg by itself. `count` is the number of pegs.
fn check(peg: &Peg, count: usize, wrong: &mut impl FnMut(PegError)) {
    let name = || peg.name.clone();
    if let Some(parent) = peg.parent.filter(|&parent| parent >= count) {
        wrong(PegError::Parent { name: name(), parent, count });
    }
    let within = |value: f64| (-FARTHEST..=FARTHEST).contains(&value);
    if !(within(peg.pivot.x) && within(peg.pivot.y)) {
        wrong(PegError::Pivot { name: name(), x: peg.pivot.x, y: peg.pivot.y });
    }
    let near = "a number between -1e9 and 1e9";
    for (k, key) in peg.keys.iter().enumerate() {
        if let Some(before) = k.checked_sub(1).map(|k| peg.keys[k].frame).filter(|&before| before >= key.frame) {
            wrong(PegError::Order { name: name(), frame: key.frame, before });
        }
        let shift = [key.shift.x, key.shift.y].into_iter().find(|&value| !within(value));
        let turn = Some(key.turn).filter(|&value| !within(value));
        let scale = Some(key.scale).filter(|value| !(LEAST_SCALE..=FARTHEST).contains(value));
        let fields = [("shift", shift, near), ("turn", turn, near), ("scale", scale, "a number from 1e-6 to 1e9")];
        for (field, found, expected) in fields {
            if let Some(found) = found {
                wrong(PegError::Key { name: name(), frame: key.frame, field, found, expected });
            }
        }
        if let Err(source) = key.timing.check() {
            wrong(PegError::Timing { name: name(), frame: key.frame, source });
        }
    }
}

#[cfg(test)]
mod tests;
