//! A cache: results that are kept beyond the program that found them.
//!
//! An entry is found by the hash of everything that it was made from: the pictures, the artist's input, the tracker itself. So an entry never has
//! to be thrown away because something has changed, and one that is lost costs time alone.

pub use rototoon_base::scene::Mark;

use serde::Serialize;
use serde::de::DeserializeOwned;

/// The mark of the tracker's code (`build.rs`).
pub const TRACKER: &str = env!("ROTOTOON_TRACKER");

/// Keeps results by their marks. A tracker asks it from several threads.
pub trait Cache: Send + Sync {
    /// What was put under this mark, byte for byte. `None` if it is not there any more, or damaged.
    fn get(&self, mark: &Mark) -> Option<Vec<u8>>;

    /// Keeps bytes. If that is not possible they are not kept: this is no error.
    fn put(&self, mark: &Mark, bytes: &[u8]);
}

/// The value that was kept under all that it was made from.
pub fn recall<T: DeserializeOwned>(cache: &dyn Cache, made_from: &impl Serialize) -> Option<T> {
    postcard::from_bytes(&cache.get(&mark_of(made_from)?)?).ok()
}

/// Keeps a value under all that it was made from.
pub fn keep(cache: &dyn Cache, made_from: &impl Serialize, value: &impl Serialize) {
    if let (Some(mark), Ok(bytes)) = (mark_of(made_from), postcard::to_stdvec(value)) {
        cache.put(&mark, &bytes);
    }
}

/// The hash of a value.
pub fn mark_of(value: &impl Serialize) -> Option<Mark> {
    Some(*blake3::hash(&postcard::to_stdvec(value).ok()?).as_bytes())
}
