//! The preset `agarwala2004`: rotoscoping by key frames as a space-time optimisation.
//!
//! A. Agarwala, A. Hertzmann, D. H. Salesin, S. M. Seitz: "Keyframe-based tracking for rotoscoping and animation", ACM
//! Transactions on Graphics 23 (3), 2004. The [energy](super) of shape, image and edges over all frames between two
//! keys, from coarse to fine ([`solve`]). Weights, window, spacing of the samples, cost of hidden places and the trust region are
//! those of the authors' published system.
//!
//! Differences: contours are Catmull–Rom curves through our control points instead of fitted Béziers, and correspond by
//! these; every part is solved by itself, where theirs may share joints.
//!
//! Limits: the blend must come within reach of the coarsest window (32 px of the picture); the image term compares neighbouring
//! frames and both sides of the contour, so it follows a textured background where that has more contrast; drawings that
//! are held and then jump break its presumption of small motion.

use super::appearance::WINDOW;
use super::energy::{Method, Weights};
use super::solve::solve;
use super::views::Views;
use crate::contract::error::TrackError;
use crate::contract::job::{Job, SpanSolver, SpanTrack};
use rototoon_base::scene::{FrameSource, Progress};

/// Solves jobs by Agarwala et al. 2004; keeps the views of frames.
pub struct Agarwala2004 {
    method: Method,
    views: Views,
}

impl Default for Agarwala2004 {
    fn default() -> Self {
        let method = Method { weights: Weights::default(), offsets: WINDOW.to_vec(), ribbon: 0 };
        Self { method, views: Views::default() }
    }
}

impl SpanSolver for Agarwala2004 {
    fn solve(&self, job: &Job, frames: &dyn FrameSource, progress: &dyn Progress) -> Result<SpanTrack, TrackError> {
        solve(&self.method, &self.views, job, frames, progress)
    }

    fn forget_pictures(&self) {
        self.views.clear();
    }
}
