//! The order in which a worker takes shots.
//!
//! Several workers may share one folder of results. A shot that another worker has is left for later: all that are free come
//! first, in the order of the manifest. Then those that were locked are tried in turn until each is free. So workers share
//! the shots of one manifest without knowing of each other, and one that hangs keeps back only the shots that it has.
//!
//! Nothing depends on the order: each shot reads its own document and writes its own folder.

use std::collections::VecDeque;
use std::sync::{Mutex, PoisonError};

/// A shot in the queue.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Place {
    /// Its place in the list of the shots to work on.
    pub at: usize,
    /// How often it was found locked.
    pub locked: usize,
}

/// The shots that no thread of this worker has taken.
#[derive(Debug)]
pub struct Queue(Mutex<VecDeque<Place>>);

impl Queue {
    /// A queue of so many shots.
    pub fn new(shots: usize) -> Self {
        Self(Mutex::new((0..shots).map(|at| Place { at, locked: 0 }).collect()))
    }

    /// The next shot; `None` if there is none.
    pub fn take(&self) -> Option<Place> {
        self.places().pop_front()
    }

    /// Puts a shot that was locked behind all others.
    pub fn put_back(&self, place: Place) {
        self.places().push_back(Place { locked: place.locked + 1, ..place });
    }

    fn places(&self) -> std::sync::MutexGuard<'_, VecDeque<Place>> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn locked_shots_come_after_all_free_ones_and_in_turn() {
        let queue = Queue::new(4);
        let mut seen = Vec::new();
        // Shots 0 and 2 are locked; 2 is free at its third try, 0 at its fourth.
        while let Some(place) = queue.take() {
            seen.push(place.at);
            if place.locked < [3, 0, 2, 0][place.at] {
                queue.put_back(place);
            }
        }
        assert_eq!(seen, [0, 1, 2, 3, 0, 2, 0, 2, 0]);
    }
}
