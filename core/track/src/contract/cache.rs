//! A cache: results that are kept beyond the program that found them.
//!
//! An entry is found by the hash of everything that it was made from: the pictures, the artist's input, the tracker itself. So an entry never has
//! to be thrown away because something has changed, and one that is lost costs time alone.

pub use rototoon_base::scene::Mark;

/// Keeps results by their marks. A tracker asks it from several threads.
pub trait Cache: Send + Sync {
    /// What was put under this mark, byte for byte. `None` if it is not there any more, or damaged.
    fn get(&self, mark: &Mark) -> Option<Vec<u8>>;

    /// Keeps bytes. If that is not possible they are not kept: this is no error.
    fn put(&self, mark: &Mark, bytes: &[u8]);
}
