//! The preset `liang2012`: rotoscoping with a two-sided ribbon and a colour penalty.
//!
//! D. Liang et al.: "Style factorization and character reshaping for 2D cartoons", Journal of Zhejiang University –
//! Science C 13 (3), 2012, section 3.
//!
//! The preset minimises the [energy](super) of [`agarwala2004`](super::agarwala2004) with two changes. The
//! image term samples a [ribbon](super::ribbon) on both sides of the curve (1). A [colour
//! penalty](super::colours) compares every frame with the colours of the keys.
//!
//! The paper gives neither the width of the ribbon nor the form and weight of the penalty. Our choices are documented
//! in these two modules; the weight is that of the image term.
//!
//! Limits: those of `agarwala2004`, except for the drift.

use super::energy::{Method, Weights};
use super::ribbon::{WIDTH, offsets};
use super::solve::solve;
use super::views::Views;
use crate::contract::error::TrackError;
use crate::contract::job::{Job, SpanSolver, SpanTrack};
use rototoon_base::scene::{FrameSource, Progress};

/// Weight of the colour penalty: that of the image term.
const COLOURS: f64 = 1.0;

/// Solves jobs by Liang et al. 2012. It keeps the prepared pictures of frames (views).
pub struct Liang2012 {
    method: Method,
    views: Views,
}

impl Default for Liang2012 {
    fn default() -> Self {
        let weights = Weights { colours: COLOURS, ..Weights::default() };
        Self { method: Method { weights, offsets: offsets(WIDTH), ribbon: WIDTH }, views: Views::default() }
    }
}

impl SpanSolver for Liang2012 {
    fn solve(&self, job: &Job, frames: &dyn FrameSource, progress: &dyn Progress) -> Result<SpanTrack, TrackError> {
        solve(&self.method, &self.views, job, frames, progress)
    }

    fn forget_pictures(&self) {
        self.views.clear();
    }
}
