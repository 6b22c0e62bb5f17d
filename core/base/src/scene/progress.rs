//! Progress reports of long work, and the way to cancel it.
//!
//! Long work calls [`Progress::report`] repeatedly. If the call returns [`Cancelled`], the work stops and returns that
//! error.

/// The caller cancelled the work. Nothing has been changed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("cancelled")]
pub struct Cancelled;

/// Receives the progress of long work and can stop it. It is called from several threads.
pub trait Progress: Sync {
    /// `done` is the finished share of the work, from 0 to 1; it never falls. `step` names the present step.
    ///
    /// # Errors
    ///
    /// [`Cancelled`] stops the work.
    fn report(&self, step: &str, done: f64) -> Result<(), Cancelled>;

    /// So many of the files that the work writes are whole, of so many. Files of work that is cancelled stay, so whoever cancels it can say how far it came.
    /// Calls of several threads may come in another order than that of the numbers.
    fn written(&self, _files: usize, _of: usize) {}
}

/// Ignores reports and never cancels.
#[derive(Clone, Copy, Debug, Default)]
pub struct Silent;

impl Progress for Silent {
    fn report(&self, _step: &str, _done: f64) -> Result<(), Cancelled> {
        Ok(())
    }
}
