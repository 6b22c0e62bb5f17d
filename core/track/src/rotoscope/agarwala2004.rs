//! The preset `agarwala2004`: key-frame rotoscoping as a space-time optimisation.
//!
//! A. Agarwala, A. Hertzmann, D. H. Salesin, S. M. Seitz: "Keyframe-based tracking for rotoscoping and animation", ACM
//! Transactions on Graphics 23 (3), 2004.
//!
//! The preset minimises the [energy](super) of shape, image and edges over all frames between two keys, from
//! coarse to fine ([`solve`]). The weights, the window, the sample spacing, the cost of hidden places and the trust
//! region are those of the authors' published system.
//!
//! Differences: contours are Catmull–Rom curves through our control points, which also give the correspondence. The
//! paper fits Bézier curves. Every part is solved by itself; in the paper parts may share joints.
//!
//! Limits: the linear blend of the keys must be within reach of the coarsest window, which is 32 working pixels. The
//! image term compares neighbouring frames on both sides of the contour, so it follows a textured background if that
//! has more contrast than the part. Drawings that are held and then jump violate the assumption of small motion.

use super::appearance::WINDOW;
use super::energy::{Method, Weights};
use super::solve::solve;
use super::views::Views;
use crate::contract::error::TrackError;
use crate::contract::job::{Job, SpanSolver, SpanTrack};
use rototoon_base::scene::{FrameSource, Progress};

/// Solves jobs by Agarwala et al. 2004. It keeps the prepared pictures of frames (views).
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
