//! The space-time energy of rotoscoping by key frames (Agarwala et al. 2004) of one part over one span:
//!
//! ```text
//! E = F · ( w_L mean E_L + w_C mean E_C + w_V mean E_V + w_I mean E_I + w_P mean E_P ) + w_G mean E_G
//! ```
//!
//! A. Agarwala, A. Hertzmann, D. H. Salesin, S. M. Seitz: "Keyframe-based tracking for rotoscoping and animation", ACM
//! Transactions on Graphics 23 (3), 2004. F is the number of steps from frame to frame; a mean is over a term's samples, those
//! that are hidden included. Lengths are working pixels, colours 8-bit levels: the weights of the authors' system presume both.
//!
//! The presets are [`agarwala2004`] and [`liang2012`]. The terms:
//!
//! - [`length`]: change of the samples' distances, E_L
//! - [`curvature`]: change of the second differences, E_C
//! - [`velocity`]: way of the samples, E_V
//! - [`appearance`]: change of the colours along the normals, E_I; over which offsets is the preset's choice ([`ribbon`])
//! - [`colours`]: change of the colours from those at the keys, E_P
//! - [`edge`]: edges where both keys have edges, E_G
//!
//! and what they stand on:
//!
//! - [`curve`]: Catmull–Rom curves, samples, linear readings of the control points
//! - [`pose`]: the curves of all frames
//! - [`profile`]: places along a normal, with derivatives
//! - [`views`]: pictures on a pyramid, what hides the part
//! - [`blocks`]: JᵀJ as a block-tridiagonal matrix
//! - [`energy`]: the terms joined, as an objective for [`trust_region`](rototoon_base::numeric::trust_region)
//! - [`solve`]: from coarse to fine
//! - [`sureness`]: confidence of the points
//!
//! Every term is a sum of squares. A term is written once, as a walk over its residuals with their derivatives by what it reads
//! of the curves ([`Handle`]); costs, normal equations and the tests' Jacobian come from the same walk into different [`Sink`]s.
//! The Jacobian itself is never kept: a ribbon has millions of entries, but all rows of a sample share the same eight
//! numbers, so JᵀJ is summed in those and spread to the control points once a sample.

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

/// Handles of a group of residuals at the most.
pub const MOST_HANDLES: usize = 4;

/// What a group of residuals depends on: a reading of the control points of one of two neighbouring frames.
#[derive(Clone, Copy, Debug)]
pub struct Handle<'a> {
    /// Whether it reads the later frame.
    pub later: bool,
    /// What it reads.
    pub functional: &'a Functional,
}

impl<'a> Handle<'a> {
    /// A reading of the earlier frame.
    pub fn earlier(functional: &'a Functional) -> Self {
        Self { later: false, functional }
    }

    /// A reading of the later frame.
    pub fn later(functional: &'a Functional) -> Self {
        Self { later: true, functional }
    }
}

/// Takes the residuals of terms, group by group.
pub trait Sink {
    /// Whether derivatives are looked at; where not, a term may hand over anything.
    const SLOPES: bool;

    /// Begins a group of residuals that depend on the same handles, [`MOST_HANDLES`] at the most.
    fn open(&mut self, handles: &[Handle<'_>]);

    /// A residual of the group and its derivatives by the handles.
    fn residual(&mut self, value: f64, by: &[Point]);

    /// Ends the group.
    fn close(&mut self);

    /// A cost that depends on nothing.
    fn constant(&mut self, cost: f64);
}

/// A sum of squares over the curves.
pub trait Term {
    /// Hands over the residuals that join frame `frame` to the next; those of one frame alone belong to it.
    fn walk(&self, frame: usize, pose: &Pose, sink: &mut impl Sink);
}

/// Walks a term with residuals and derivatives scaled by the root of its weight.
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
