//! Frames that a program keeps for all that it does, so that each is decoded once.
//!
//! A program that takes several steps on the same footage calls [`keep`] at its start. From then on every
//! [`Sequence`](super::Sequence) of the process puts the pictures that it decodes here, as their files have them
//! ([`Stored`]), and takes them from here. What is made of them is the same bit by bit.
//!
//! Nothing makes room for what comes later: steps read a footage from its first frame to its last, one after the other, and
//! of such a round the last used pictures are those that are needed latest. What does not fit is decoded again.
//!
//! Limits: a file that changes while the program runs is not read again. Without [`keep`] nothing is kept.

use super::stored::Stored;
use std::collections::HashMap;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, MutexGuard, OnceLock, PoisonError};

static STORE: OnceLock<Store> = OnceLock::new();

/// Keeps decoded pictures of at most `bytes` bytes until the process ends. Only the first call has an effect.
pub fn keep(bytes: u64) {
    STORE.get_or_init(|| Store::new(bytes));
}

/// Bytes of the pictures that are kept.
pub fn kept_bytes() -> u64 {
    STORE.get().map_or(0, |store| store.bytes())
}

/// The store of the process, if it has one.
pub(super) fn of_process() -> Option<&'static Store> {
    STORE.get()
}

/// A picture's file, width and height.
type Key = (PathBuf, (usize, usize));

/// Pictures by their files.
#[derive(Debug)]
pub(super) struct Store {
    most: u64,
    kept: Mutex<Kept>,
}

#[derive(Debug, Default)]
struct Kept {
    pictures: HashMap<Key, Arc<Stored>>,
    bytes: u64,
}

impl Store {
    fn new(most: u64) -> Self {
        Self { most, kept: Mutex::default() }
    }

    /// The picture of a file, if it is kept with this size.
    pub(super) fn get(&self, path: &Path, size: (usize, usize)) -> Option<Arc<Stored>> {
        self.locked().pictures.get(&(path.to_owned(), size)).cloned()
    }

    /// Keeps a picture if there is room for it, and returns it.
    pub(super) fn put(&self, path: &Path, size: (usize, usize), picture: Stored) -> Arc<Stored> {
        // Making it compact takes time, and is of no use for a picture that is not kept.
        if self.bytes() >= self.most {
            return Arc::new(picture);
        }
        let picture = Arc::new(picture.compact());
        let (own, mut kept) = (picture.bytes() as u64, self.locked());
        let key = (path.to_owned(), size);
        if kept.bytes + own <= self.most && !kept.pictures.contains_key(&key) {
            kept.pictures.insert(key, picture.clone());
            kept.bytes += own;
        }
        picture
    }

    fn bytes(&self) -> u64 {
        self.locked().bytes
    }

    /// A thread that panicked cannot leave the store inconsistent, because nothing panics between two changes of it.
    fn locked(&self) -> MutexGuard<'_, Kept> {
        self.kept.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use image::{DynamicImage, ImageBuffer, Luma};

    #[test]
    fn pictures_are_kept_while_there_is_room() {
        let store = Store::new(25);
        let size = (5, 2);
        let picture = |grey| Stored::new(DynamicImage::ImageLuma8(ImageBuffer::from_pixel(5, 2, Luma([grey]))), false);
        for (name, grey) in [("a", 1), ("b", 2), ("c", 3), ("a", 4)] {
            assert_eq!(store.put(Path::new(name), size, picture(grey)).bytes(), 10);
        }
        let grey =
            |name: &str| store.get(Path::new(name), size).map(|stored| (stored.colours(0.5)[0][0] * 255.0).round());
        assert!(store.get(Path::new("a"), (2, 5)).is_none());
        assert_eq!((grey("a"), grey("b"), grey("c")), (Some(1.0), Some(2.0), None));
        assert_eq!(store.bytes(), 20);
    }
}
