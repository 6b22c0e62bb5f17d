//! Pegs: a tree of pivots that shift, turn and scale over time, on which strokes hang (Yang et al. 1986, section 4).
//!
//! A peg's pivot is given on the screen with everything at rest. At time t it takes a point p of what hangs on it to
//!
//! ```text
//! p ↦ α(t) A(t) (p − O) + O + S(t)
//! ```
//!
//! with the pivot O, shift S, turn A and scale α, and the pegs above it then move the result on. Under a parent that
//! does not turn, the point relative to its centre is α₀ (α A P + S), equation (11). The paper leaves the turn of a
//! parent out; here a peg turns all that hangs on it.
//!
//! Between keys a [`Timing`] says how far a movement has come.
//!
//! - *Theorem 1* says that with scaling and shifts of constant speed a point moves along a straight line at constant
//!   speed. As printed it holds where nothing hangs on a peg that scales; scalings that are multiplied bend the speed.
//!   (Equation (12) is printed with x₂ − x₁ in place of x₂.)
//! - *Theorem 2*: moving the guiding points of a B-spline moves its curve, as for every affine map.
//!
//! [`propose`] finds pegs from strokes that moved.

pub mod propose;
mod timing;

pub use timing::{Timing, TimingError};
pub(crate) use timing::{hermite, monotone_slope};

use rototoon_base::geometry::Point;
use rototoon_base::geometry::polyline::FARTHEST;
use rototoon_base::geometry::similarity::Similarity;

/// Scales nearer to zero than this are refused: nothing that hangs on such a peg could be seen.
pub const LEAST_SCALE: f64 = 1e-6;

/// Where a peg is on a key frame, against its rest.
#[derive(Clone, Debug, PartialEq)]
pub struct PegKey {
    /// The frame.
    pub frame: i32,
    /// S: shift in pixels of the rest.
    pub shift: Point,
    /// Turn in radians, from x towards y; whole turns count.
    pub turn: f64,
    /// α: scale; negative values are refused.
    pub scale: f64,
    /// How the movement to the next key runs.
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
    /// Index of the peg that it hangs on.
    pub parent: Option<usize>,
    /// O: the pivot on the screen, with everything at rest.
    pub pivot: Point,
    /// Its keys, frames rising.
    pub keys: Vec<PegKey>,
}

/// Why pegs are no tree.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum PegError {
    /// A parent is not there.
    #[error("peg {name:?}: found parent {parent}, expected less than {count}")]
    Parent {
        /// Name of the peg.
        name: String,
        /// What was found.
        parent: usize,
        /// Number of pegs.
        count: usize,
    },
    /// A peg hangs on itself.
    #[error("peg {name:?} hangs on itself, by way of its parents")]
    Loop {
        /// Name of a peg of the loop.
        name: String,
    },
    /// A pivot is no place.
    #[error("peg {name:?}: the pivot is ({x}, {y}), expected numbers between -1e9 and 1e9")]
    Pivot {
        /// Name of the peg.
        name: String,
        /// What was found.
        x: f64,
        /// What was found.
        y: f64,
    },
    /// A key's number is of no use.
    #[error("peg {name:?}, frame {frame}: {field} is {found}, expected {expected}")]
    Key {
        /// Name of the peg.
        name: String,
        /// Frame of the key.
        frame: i32,
        /// "shift", "turn" or "scale".
        field: &'static str,
        /// What was found.
        found: f64,
        /// What was expected.
        expected: &'static str,
    },
    /// Keys do not follow each other.
    #[error("peg {name:?}: found a key on frame {frame} after one on frame {before}, expected a later frame")]
    Order {
        /// Name of the peg.
        name: String,
        /// Frame of the key.
        frame: i32,
        /// Frame of the one before it.
        before: i32,
    },
    /// A movement is described wrongly.
    #[error("peg {name:?}, frame {frame}: {source}")]
    Timing {
        /// Name of the peg.
        name: String,
        /// Frame of the key.
        frame: i32,
        /// What is wrong.
        source: TimingError,
    },
}

/// Pegs that are a tree (or several).
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PegTree {
    pegs: Vec<Peg>,
    /// Indices, every parent before its children.
    order: Vec<usize>,
}

impl PegTree {
    /// The tree of these pegs.
    ///
    /// # Errors
    ///
    /// What makes them none: parents that are not there or form a loop; pivots, shifts and turns that are no finite
    /// numbers within ±1e9; scales below [`LEAST_SCALE`]; keys that do not rise; see [`PegError`].
    pub fn new(pegs: Vec<Peg>) -> Result<Self, PegError> {
        if let Some((_, error)) = problems(&pegs).into_iter().next() {
            return Err(error);
        }
        let order = ordered(&pegs).0;
        Ok(Self { pegs, order })
    }

    /// The pegs as they were given.
    pub fn pegs(&self) -> &[Peg] {
        &self.pegs
    }

    /// Where each peg takes the points that hang on it, at a time in frames.
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
    /// The peg's own movement, without its parents'. Before the first key and after the last one it rests there.
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
        // A movement that overshoots must not turn what it shrinks inside out.
        let factor = Point::from_angle(turn) * scale.max(LEAST_SCALE);
        Similarity { factor, source: self.pivot, target: self.pivot + shift }
    }
}

/// All that makes these pegs none or no tree, with the index of the peg; of a loop its first peg.
pub fn problems(pegs: &[Peg]) -> Vec<(usize, PegError)> {
    let mut found = Vec::new();
    for (k, peg) in pegs.iter().enumerate() {
        check(peg, pegs.len(), &mut |error| found.push((k, error)));
    }
    let loops = ordered(pegs).1;
    found.extend(loops.into_iter().map(|k| (k, PegError::Loop { name: pegs[k].name.clone() })));
    found
}

/// Indices, every parent before its children; and the first peg of each loop.
fn ordered(pegs: &[Peg]) -> (Vec<usize>, Vec<usize>) {
    let mut order = Vec::with_capacity(pegs.len());
    let mut loops = Vec::new();
    // By which start a peg was met.
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

/// Calls `wrong` for all that is wrong with a peg by itself, one of `count`.
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
