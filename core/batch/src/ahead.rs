//! How far a batch is: the share of its steps that is done.
//!
//! Each shot counts the same, and each of its steps. Steps take different times, so the share is no measure of the time that is left; a
//! farm and a person see whether it moves. A shot that another worker has counts when its result is taken.

use std::sync::{Mutex, MutexGuard, PoisonError};

/// The share of each shot that is done.
#[derive(Debug)]
pub struct Ahead(Mutex<Vec<f64>>);

impl Ahead {
    /// So many shots, of which nothing is done.
    pub fn new(shots: usize) -> Self {
        Self(Mutex::new(vec![0.0; shots]))
    }

    /// A shot has done `before` of its `steps`, and a share of the next one. Returns the share of all. It never falls, so that what is told
    /// of it does not.
    pub fn at(&self, shot: usize, (before, steps): (usize, usize), share: f64) -> f64 {
        let now = (before as f64 + share.clamp(0.0, 1.0)) / steps.max(1) as f64;
        self.set(shot, now.min(1.0))
    }

    /// A shot ended. Returns the share of all.
    pub fn end(&self, shot: usize) -> f64 {
        self.set(shot, 1.0)
    }

    fn set(&self, shot: usize, share: f64) -> f64 {
        let mut shares = self.shares();
        if let Some(own) = shares.get_mut(shot) {
            *own = own.max(share);
        }
        shares.iter().sum::<f64>() / shares.len().max(1) as f64
    }

    fn shares(&self) -> MutexGuard<'_, Vec<f64>> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shots_and_steps_count_the_same_and_nothing_falls() {
        let ahead = Ahead::new(2);
        assert_eq!(ahead.at(0, (1, 4), 0.5), 0.1875);
        assert_eq!(ahead.at(1, (0, 1), 0.25), 0.3125);
        assert_eq!(ahead.at(0, (0, 4), 0.0), 0.3125, "a step that was found done is not told anew");
        assert_eq!((ahead.end(0), ahead.end(1), ahead.end(1)), (0.625, 1.0, 1.0));
        assert_eq!(Ahead::new(0).end(0), 0.0);
    }
}
