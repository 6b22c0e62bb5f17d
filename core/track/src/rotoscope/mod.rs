//! The space-time energy of key-frame rotoscoping (Agarwala et al. 2004) for one part over one span:
//!
//! ```text
//! E = F · ( w_L mean E_L + w_C mean E_C + w_V mean E_V + w_I mean E_I + w_P mean E_P ) + w_G mean E_G
//! ```
//!
//! A. Agarwala, A. Hertzmann, D. H. Salesin, S. M. Seitz: "Keyframe-based tracking for rotoscoping and animation", ACM
//! Transactions on Graphics 23 (3), 2004. F is the number of steps from frame to frame. A mean is over a term's
//! samples, hidden ones included. Lengths are in working pixels and colours in 8-bit levels, because the weights of the
//! authors' system assume both.
//!
//! The presets are [`agarwala2004`] and [`liang2012`]. The terms:
//!
//! - [`length`]: change of the samples' distances, E_L
//! - [`curvature`]: change of the second differences, E_C
//! - [`velocity`]: motion of the samples, E_V
//! - [`appearance`]: change of the colours along the normals, E_I; the preset chooses the offsets ([`ribbon`])
//! - [`colours`]: change of the colours from those at the keys, E_P
//! - [`edge`]: edges where both keys have edges, E_G
//!
//! The modules below them are:
//!
//! - [`curve`]: Catmull–Rom curves, samples, linear functions of the control points
//! - [`pose`]: the curves of all frames
//! - [`profile`]: places along a normal, with derivatives
//! - [`views`]: pictures on a pyramid, and the occlusion of the part
//! - [`blocks`]: JᵀJ as a block-tridiagonal matrix
//! - [`energy`]: the terms joined, as an objective for [`trust_region`](rototoon_base::numeric::trust_region)
//! - [`solve`]: minimisation from coarse to fine
//! - [`sureness`]: confidence of the points
//!
//! Every term is a sum of squares. It is written once, as a walk over its residuals with their derivatives by the
//! functionals of the curves that it reads ([`Handle`]). Costs, normal equations and the tests' Jacobian come from the
//! same walk into different [`Sink`]s. The Jacobian itself is never stored: a ribbon has millions of entries. But all
//! rows of a sample depend on the same eight numbers. So JᵀJ is summed for these eight numbers and distributed to the
//! control points once per sample.

pub mod agarwala2004;
pub mod appearance;
pub mod blocks;
pub mod colours;
pub mod curvature;
pub mod curve;
pub mod edge;
pub mod energy;
pub mod length;
pub mod liang2012;
pub mod pose;
pub mod profile;
pub mod ribbon;
pub mod solve;
pub mod sureness;
pub mod velocity;
pub mod views;

use curve::Functional;
use pose::Pose;
use rototoon_base::geometry::Point;

/// Largest number of handles of a group of residuals.
pub const MOST_HANDLES: usize = 4;

/// A dependency of a group of residuals: a functional of the control points of one of two neighbouring frames.
#[derive(Clone, Copy, Debug)]
pub struct Handle<'a> {
    /// Whether it reads the later frame.
    pub later: bool,
    /// The functional.
    pub functional: &'a Functional,
}

impl<'a> Handle<'a> {
    /// A functional of the earlier frame.
    pub fn earlier(functional: &'a Functional) -> Self {
        Self { later: false, functional }
    }

    /// A functional of the later frame.
    pub fn later(functional: &'a Functional) -> Self {
        Self { later: true, functional }
    }
}

/// Receives the residuals of terms, group by group.
pub trait Sink {
    /// Whether the sink uses derivatives. If not, a term may pass any values for them.
    const SLOPES: bool;

    /// Begins a group of residuals that depend on the same handles, at most [`MOST_HANDLES`].
    fn open(&mut self, handles: &[Handle<'_>]);

    /// A residual of the group and its derivatives by the handles.
    fn residual(&mut self, value: f64, by: &[Point]);

    /// Ends the group.
    fn close(&mut self);

    /// Adds a cost that depends on no variable.
    fn constant(&mut self, cost: f64);
}

/// A sum of squares over the curves of all frames.
pub trait Term {
    /// Passes the residuals that couple frame `frame` with the next one. Residuals of the frame `frame` alone belong to
    /// them.
    fn walk(&self, frame: usize, pose: &Pose, sink: &mut impl Sink);
}

/// Walks a term with residuals and derivatives scaled by the square root of its weight. A weight of 0 skips the term.
pub fn weighted(term: &impl Term, weight: f64, frame: usize, pose: &Pose, sink: &mut impl Sink) {
    if weight > 0.0 {
        term.walk(frame, pose, &mut Scaled { weight, root: weight.sqrt(), sink });
    }
}

struct Scaled<'a, S> {
    weight: f64,
    root: f64,
    sink: &'a mut S,
}

impl<S: Sink> Sink for Scaled<'_, S> {
    const SLOPES: bool = S::SLOPES;

    fn open(&mut self, handles: &[Handle<'_>]) {
        self.sink.open(handles);
    }

    fn residual(&mut self, value: f64, by: &[Point]) {
        let mut scaled = [Point::ZERO; MOST_HANDLES];
        if S::SLOPES {
            scaled.iter_mut().zip(by).for_each(|(scaled, by)| *scaled = *by * self.root);
        }
        self.sink.residual(self.root * value, &scaled[..by.len()]);
    }

    fn close(&mut self) {
        self.sink.close();
    }

    fn constant(&mut self, cost: f64) {
        self.sink.constant(self.weight * cost);
    }
}

#[cfg(test)]
pub(crate) mod tests;
