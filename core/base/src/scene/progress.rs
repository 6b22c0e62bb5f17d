//! How long work reports what it does and learns that it is no longer wanted.

/// The caller asked to stop; nothing has been changed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("cancelled")]
pub struct Cancelled;

/// Told how far long work has come; may stop it. Called from several threads.
pub trait Progress: Sync {
    /// `done` is the finished share of the whole, 0 to 1, never falling; `step` names what is being done.
    fn report(&self, step: &str, done: f64) -> Result<(), Cancelled>;
}

/// Listens to nothing and never stops.
#[derive(Clone, Copy, Debug, Default)]
pub struct Silent;

impl Progress for Silent {
    fn report(&self, _step: &str, _done: f64) -> Result<(), Cancelled> {
        Ok(())
    }
}
