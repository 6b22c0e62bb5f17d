//! How far long work has come, shown by the host, which may cancel it.

use super::effect::Effect;
use super::host::ProgressSuite;
use super::property::{call, terminated};
use openfx::sys::generic::core::kOfxStatReplyNo;

/// A progress display; dropping ends it. Without the suite there is none, and nothing cancels.
pub struct Bar<'a> {
    effect: Effect<'a>,
    started: bool,
}

impl<'a> Bar<'a> {
    /// Shows a display with a label.
    pub fn new(effect: Effect<'a>, label: &str) -> Self {
        let label = terminated(label);
        let handle = effect.handle.cast();
        let started = match effect.suites.progress {
            Some(ProgressSuite::V1(suite)) => call!(suite, progressStart, handle, label.as_ptr()).is_ok(),
            Some(ProgressSuite::V2(suite)) => {
                call!(suite, progressStart, handle, label.as_ptr(), c"rototoon".as_ptr()).is_ok()
            }
            None => false,
        };
        Self { effect, started }
    }

    /// Shows a share of the whole, 0 to 1; whether to go on.
    pub fn update(&self, done: f64) -> bool {
        let update = match self.effect.suites.progress {
            Some(ProgressSuite::V1(suite)) => suite.progressUpdate,
            Some(ProgressSuite::V2(suite)) => suite.progressUpdate,
            None => None,
        };
        let Some(update) = update.filter(|_| self.started) else { return true };
        // SAFETY: the effect's own handle. Any status but a clear no goes on: some hosts return nonsense.
        unsafe { update(self.effect.handle.cast(), done) != kOfxStatReplyNo }
    }
}

impl Drop for Bar<'_> {
    fn drop(&mut self) {
        if !self.started {
            return;
        }
        let handle = self.effect.handle.cast();
        let _ = match self.effect.suites.progress {
            Some(ProgressSuite::V1(suite)) => call!(suite, progressEnd, handle),
            Some(ProgressSuite::V2(suite)) => call!(suite, progressEnd, handle),
            None => Ok(()),
        };
    }
}
