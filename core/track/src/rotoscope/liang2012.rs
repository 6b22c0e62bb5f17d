//! The preset `liang2012`: rotoscoping with a two-sided ribbon and a colour penalty.
//!
//! D. Liang et al.: "Style factorization and character reshaping for 2D cartoons", Journal of Zhejiang University – Science C
//! 13 (3), 2012, section 3. The [energy](super) of [`agarwala2004`](super::agarwala2004) with two changes: the image
//! term runs over a [ribbon](super::ribbon) on both sides of the curve (1), and a
//! [colour penalty](super::colours) holds every frame to the colours of the keys.
//!
//! The paper gives neither the ribbon's width nor the penalty's form and weight; what is chosen here is said there, and the
//! weight is that of the image term. Limits as for `agarwala2004`, less the drift.

use super::energy::{Method, Weights};
use super::ribbon::{WIDTH, offsets};
use super::solve::solve;
use super::views::Views;
use crate::contract::error::TrackError;
use crate::contract::job::{Job, SpanSolver, SpanTrack};
use rototoon_base::scene::{FrameSource, Progress};

/// Weight of the colour penalty: that of the image term.
const COLOURS: f64 = 1.0;

/// Solves jobs by Liang et al. 2012; keeps the views of frames.
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
