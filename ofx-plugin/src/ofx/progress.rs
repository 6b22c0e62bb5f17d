//! The host's progress display, in which the user may cancel the work.

use super::effect::Effect;
use super::host::ProgressSuite;
use super::property::{call, terminated};
use openfx::sys::generic::core::kOfxStatReplyNo;

/// A progress display. Dropping it closes it. A host without a progress suite shows none, and cannot cancel.
pub struct Bar<'a> {
    effect: Effect<'a>,
    started: bool,
}

impl<'a> Bar<'a> {
    /// Whether the host has progress displays.
    pub fn exists(effect: &Effect) -> bool {
        effect.suites.progress.is_some()
    }

    /// Opens a display with a label.
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

    /// Shows the finished share, 0 to 1. Returns whether to go on.
    pub fn update(&self, done: f64) -> bool {
        let update = match self.effect.suites.progress {
            Some(ProgressSuite::V1(suite)) => suite.progressUpdate,
            Some(ProgressSuite::V2(suite)) => suite.progressUpdate,
            None => None,
        };
        let Some(update) = update.filter(|_| self.started) else { return true };
        // SAFETY: the effect's own handle. Only an explicit no cancels, because some hosts return arbitrary statuses.
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
