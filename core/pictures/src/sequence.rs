//! The pictures of a footage, decoded on demand, with a cache.
//!
//! Trackers read the same few frames again and again, but a complete sequence does not fit into memory. The most
//! recently used pictures are therefore kept, up to a number of bytes. The result does not depend on what was kept.
//! Decoding happens outside the lock, so several threads decode at the same time. Two threads that need the same
//! picture at the same moment may both decode it. That costs time, but it cannot deadlock within a pool of threads.
//!
//! The footage may say that a frame without a file shows the one before it ([`super::holds`]).
//!
//! A program that takes several steps on one footage can keep it in the form of its files too: see [`super::store`].

use super::backdrop;
use super::decode::{Described, described, probe, raster, stored};
use super::error::DecodeError;
use super::holds::{Holds, is_there};
use super::store;
use super::stored::Stored;
use rayon::prelude::{IntoParallelRefIterator, ParallelIterator};
use rototoon_base::scene::{
    Colour, Footage, FrameError, FrameNumber, FramePattern, FrameSource, Mark, PatternError, Raster,
};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::SystemTime;

/// Default limit of the bytes of pictures that a sequence keeps.
pub const KEPT_BYTES: usize = 256 << 20;

/// A footage whose pictures are read from files.
#[derive(Debug)]
pub struct Sequence {
    footage: Footage,
    folder: PathBuf,
    pattern: FramePattern,
    kept: Mutex<Kept>,
    holds: Holds,
}

impl Sequence {
    /// The footage of a document in `folder`. No file is read.
    ///
    /// # Errors
    ///
    /// A file name pattern that is not valid.
    pub fn new(footage: &Footage, folder: &Path) -> Result<Self, PatternError> {
        Self::keeping(footage, folder, KEPT_BYTES)
    }

    /// As [`Sequence::new`], with at most `bytes` bytes of pictures kept; 0 keeps none.
    ///
    /// # Errors
    ///
    /// As for [`Sequence::new`].
    pub fn keeping(footage: &Footage, folder: &Path, bytes: usize) -> Result<Self, PatternError> {
        let pattern = FramePattern::parse(&footage.pattern)?;
        let kept = Mutex::new(Kept { most: bytes, ..Kept::default() });
        Ok(Self { footage: footage.clone(), folder: folder.into(), pattern, kept, holds: Holds::default() })
    }

    /// The footage.
    pub fn footage(&self) -> &Footage {
        &self.footage
    }

    /// The folder that a relative pattern starts in.
    pub fn folder(&self) -> &Path {
        &self.folder
    }

    /// The path of the file that a frame shows.
    pub fn path(&self, frame: FrameNumber) -> PathBuf {
        self.own(self.shown(frame))
    }

    /// The frame whose file a frame shows: itself, or where gaps are held an earlier one.
    pub fn shown(&self, frame: FrameNumber) -> FrameNumber {
        let Footage { first, last, held, .. } = self.footage;
        if !held || !(first..=last).contains(&frame) {
            return frame;
        }
        self.holds.shown(frame, first, |at| is_there(&self.own(at)))
    }

    /// The path that the pattern gives a frame.
    fn own(&self, frame: FrameNumber) -> PathBuf {
        self.folder.join(self.pattern.path(frame))
    }

    /// Decodes frames in parallel and returns them in the given order. All pictures are in memory at once.
    ///
    /// # Errors
    ///
    /// Of several errors, that of the first frame in the list.
    pub fn pictures(&self, frames: &[FrameNumber]) -> Result<Vec<Arc<Raster<Colour>>>, FrameError> {
        let results: Vec<_> = frames.par_iter().map(|&frame| self.picture(frame)).collect();
        results.into_iter().collect()
    }

    /// The mark of a frame, whose picture this is. It is computed once.
    pub fn mark_of(&self, frame: FrameNumber, picture: &Raster<Colour>) -> Mark {
        let shown = self.shown(frame);
        let known = self.locked().marks.get(&shown).copied();
        known.unwrap_or_else(|| {
            let mark = mark(picture);
            self.locked().marks.insert(shown, mark);
            mark
        })
    }

    /// What changes when the file of a frame does; `None` if nobody knows.
    fn stamp(&self, frame: FrameNumber) -> Stamp {
        let data = std::fs::metadata(self.path(frame)).ok()?;
        Some((data.len(), data.modified().ok()?))
    }

    /// Whether a file has changed since it was read for the first time, or a frame that was held has one now. Then what is kept here, and what others have
    /// computed of it, may be of old pictures.
    pub fn has_changed(&self) -> bool {
        let stamps = self.locked().stamps.clone();
        stamps.iter().any(|(&frame, stamp)| *stamp != self.stamp(frame))
            || self.holds.has_changed(|frame| is_there(&self.own(frame)))
    }

    /// Empties the cache, because files may have changed.
    pub fn forget(&self) {
        let mut kept = self.locked();
        *kept = Kept { most: kept.most, ..Kept::default() };
        self.holds.forget();
    }

    /// A thread that panicked cannot leave the cache inconsistent, because nothing panics between two changes of it.
    fn locked(&self) -> std::sync::MutexGuard<'_, Kept> {
        self.kept.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// A frame with its transparency, as [`super::decode::decode_layer`] returns it. It is not cached.
    ///
    /// # Errors
    ///
    /// A frame outside the footage; a file that does not exist, cannot be read or has another size.
    pub fn layer(&self, frame: FrameNumber) -> Result<Raster<[f32; 4]>, FrameError> {
        self.inside(frame)?;
        let (stored, size) = self.stored(frame, size_of::<[f32; 4]>())?;
        raster(size, stored.layer()).map_err(|error| self.named(frame, self.path(frame), error))
    }

    /// Whether a frame has a picture of the footage's size, as far as the head of its file says. Nothing is decoded.
    ///
    /// # Errors
    ///
    /// As for [`Sequence::layer`].
    pub fn probe(&self, frame: FrameNumber) -> Result<(), FrameError> {
        self.inside(frame)?;
        let path = self.path(frame);
        let size = (self.footage.width, self.footage.height);
        let found = probe(&path).and_then(|(width, height)| {
            if (width, height) == size { Ok(()) } else { Err(DecodeError::WrongSize { width, height }) }
        });
        found.map_err(|error| self.named(frame, path, error))
    }

    /// What a frame's file says of its picture ([`described`]).
    pub fn described(&self, frame: FrameNumber) -> Option<Described> {
        described(&self.path(frame))
    }

    /// Width of the footage's pixels divided by their height, as the first file says that can be read; 1 if there is none.
    pub fn pixel_aspect(&self) -> f32 {
        let Footage { first, last, .. } = self.footage;
        // A frame that holds an earlier one has no file of its own to ask.
        let mut own = (first..=last).filter(|&frame| self.shown(frame) == frame);
        own.find_map(|frame| self.described(frame)).unwrap_or_default().pixel_aspect
    }

    fn inside(&self, frame: FrameNumber) -> Result<(), FrameError> {
        let (first, last) = (self.footage.first, self.footage.last);
        if (first..=last).contains(&frame) { Ok(()) } else { Err(FrameError::Outside { frame, first, last }) }
    }

    /// A frame's picture as its file has it, with width and height. `pixel` is the number of bytes of a pixel that is made of it.
    fn stored(&self, frame: FrameNumber, pixel: usize) -> Result<(Arc<Stored>, (usize, usize)), FrameError> {
        let size = (self.footage.width, self.footage.height);
        let path = self.path(frame);
        let read = || {
            if let Some(kept) = store::of_process().and_then(|store| store.get(&path, size)) {
                return Ok((kept, size));
            }
            let (read, size) = stored(&path, Some(size), pixel)?;
            let Some(store) = store::of_process() else { return Ok((Arc::new(read), size)) };
            Ok((store.put(&path, size, read), size))
        };
        read().map_err(|error| self.named(frame, path.clone(), error))
    }

    /// The grey behind transparent pixels of all frames: that of the first frame that can be read and shows anything. `at` is a frame that can be read.
    fn backdrop(&self, at: FrameNumber, picture: &Stored) -> f32 {
        if !picture.has_alpha() {
            return backdrop::GREY;
        }
        if let Some(known) = self.locked().backdrop {
            return known;
        }
        let of = |picture: &Stored| backdrop::of(picture, self.footage.width);
        let other = |frame| of(&self.stored(frame, size_of::<Colour>()).ok()?.0);
        let before = (self.footage.first..at).find_map(other);
        let found = before.or_else(|| of(picture)).or_else(|| (at + 1..=self.footage.last).find_map(other));
        *self.locked().backdrop.get_or_insert(found.unwrap_or(backdrop::GREY))
    }

    /// Whether a frame without a file could be held, if the footage said so.
    fn may_hold(&self, frame: FrameNumber) -> bool {
        let Footage { first, held, .. } = self.footage;
        !held && frame > first && is_there(&self.own(first))
    }

    fn named(&self, frame: FrameNumber, path: PathBuf, error: DecodeError) -> FrameError {
        let (width, height) = (self.footage.width, self.footage.height);
        match error {
            DecodeError::Missing if self.may_hold(frame) => FrameError::Gap { frame, path },
            DecodeError::Missing => FrameError::Missing { frame, path },
            DecodeError::Unreadable(reason) => FrameError::Unreadable { frame, path, reason },
            DecodeError::WrongSize { width: found_width, height: found_height } => {
                FrameError::WrongSize { frame, path, found_width, found_height, width, height }
            }
        }
    }
}

/// The hash of a picture: BLAKE3 of its width and of its values.
pub fn mark(picture: &Raster<Colour>) -> Mark {
    let mut hasher = blake3::Hasher::new();
    hasher.update(&(picture.width() as u64).to_le_bytes());
    let mut bytes = Vec::new();
    for y in 0..picture.height() {
        bytes.clear();
        bytes.extend(picture.row(y).iter().flatten().flat_map(|value| value.to_le_bytes()));
        hasher.update(&bytes);
    }
    *hasher.finalize().as_bytes()
}

impl FrameSource for Sequence {
    /// `None` if the file has changed since its picture was read for the first time: some may still have the old picture.
    fn mark(&self, frame: FrameNumber) -> Result<Option<Mark>, FrameError> {
        let known = self.locked().marks.get(&self.shown(frame)).copied();
        let mark = match known {
            Some(mark) => mark,
            None => self.mark_of(frame, &*self.picture(frame)?),
        };
        let read = self.locked().stamps.get(&self.shown(frame)).copied();
        Ok((read == Some(self.stamp(frame))).then_some(mark))
    }

    fn picture(&self, frame: FrameNumber) -> Result<Arc<Raster<Colour>>, FrameError> {
        self.inside(frame)?;
        let shown = self.shown(frame);
        if let Some(picture) = self.locked().get(shown) {
            return Ok(picture);
        }
        // What others have computed may be of the picture that was read first.
        let stamp = self.stamp(frame);
        self.locked().stamps.entry(shown).or_insert(stamp);
        let (stored, size) = self.stored(frame, size_of::<Colour>())?;
        let colours = stored.colours(self.backdrop(frame, &stored));
        let picture = raster(size, colours).map_err(|error| self.named(frame, self.path(frame), error))?;
        let picture = Arc::new(picture);
        self.locked().put(shown, &picture);
        Ok(picture)
    }
}

/// Length and time of a file.
type Stamp = Option<(u64, SystemTime)>;

/// The most recently used pictures.
#[derive(Debug, Default)]
struct Kept {
    /// Each picture with the time of its last use.
    pictures: BTreeMap<FrameNumber, (Arc<Raster<Colour>>, u64)>,
    /// What the files were before they were read for the first time.
    stamps: BTreeMap<FrameNumber, Stamp>,
    /// The marks of the pictures that were asked for theirs.
    marks: BTreeMap<FrameNumber, Mark>,
    bytes: usize,
    most: usize,
    time: u64,
    /// The grey behind transparent pixels, once it is known.
    backdrop: Option<f32>,
}

impl Kept {
    fn get(&mut self, frame: FrameNumber) -> Option<Arc<Raster<Colour>>> {
        self.time += 1;
        let (picture, used) = self.pictures.get_mut(&frame)?;
        *used = self.time;
        Some(picture.clone())
    }

    /// Caches a picture. The pictures unused for the longest time make room. A picture that is too large by itself is
    /// not kept.
    fn put(&mut self, frame: FrameNumber, picture: &Arc<Raster<Colour>>) {
        let bytes = |picture: &Raster<Colour>| size_of_val(picture.data());
        let own = bytes(picture);
        if own > self.most || self.pictures.contains_key(&frame) {
            return;
        }
        while self.bytes + own > self.most {
            let oldest = self.pictures.iter().min_by_key(|(_, (_, used))| *used).map(|(&frame, _)| frame);
            let Some((dropped, _)) = oldest.and_then(|frame| self.pictures.remove(&frame)) else { break };
            self.bytes -= bytes(&dropped);
        }
        self.time += 1;
        self.bytes += own;
        self.pictures.insert(frame, (picture.clone(), self.time));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use image::{ImageBuffer, Rgb};
    use tempfile::TempDir;

    /// Frames 1 to 6 of 4 × 3 pixels, each with a different grey.
    fn footage() -> (TempDir, Footage) {
        let folder = tempfile::tempdir().unwrap();
        for frame in 1..=6u8 {
            let picture = ImageBuffer::from_pixel(4, 3, Rgb([frame * 10; 3]));
            picture.save(folder.path().join(format!("f{frame:03}.png"))).unwrap();
        }
        let footage =
            Footage { pattern: "f%03d.png".into(), first: 1, last: 6, fps: 25.0, width: 4, height: 3, held: false };
        (folder, footage)
    }

    const BYTES: usize = 4 * 3 * 12;

    fn held(sequence: &Sequence) -> Vec<FrameNumber> {
        let kept = sequence.locked();
        assert_eq!(kept.bytes, kept.pictures.len() * BYTES);
        kept.pictures.keys().copied().collect()
    }

    #[test]
    fn pictures_come_in_their_order() {
        let (folder, footage) = footage();
        for bytes in [0, BYTES, 3 * BYTES, KEPT_BYTES] {
            let sequence = Sequence::keeping(&footage, folder.path(), bytes).unwrap();
            let pictures = sequence.pictures(&[5, 1, 6, 5]).unwrap();
            let greys: Vec<_> = pictures.iter().map(|p| (p.get(3, 2)[1] * 255.0).round()).collect();
            assert_eq!(greys, [50.0, 10.0, 60.0, 50.0]);
        }
    }

    #[test]
    fn a_mark_is_that_of_the_pixels_and_goes_when_the_file_changes() {
        let (folder, footage) = footage();
        let sequence = Sequence::new(&footage, folder.path()).unwrap();
        let mark = |frame| sequence.mark(frame).unwrap();
        let path = |frame| folder.path().join(format!("f{frame:03}.png"));
        assert!(mark(1).is_some() && mark(1) == mark(1) && mark(1) != mark(2));
        assert!(!sequence.has_changed());
        assert_eq!(mark(1), Some(super::mark(&sequence.picture(1).unwrap())));
        // The picture that was read may still be in use.
        std::fs::copy(path(3), path(1)).unwrap();
        assert_eq!(mark(1), None);
        assert!(sequence.has_changed());
        sequence.forget();
        assert!(!sequence.has_changed(), "nothing is kept");
        assert_eq!((mark(1), mark(2).is_some()), (mark(3), true));
        // So may one that was read before anybody asked for its mark.
        sequence.picture(6).unwrap();
        std::fs::write(path(6), "another file").unwrap();
        assert_eq!(mark(6), None);
        let held = Sequence::new(&Footage { held: true, ..footage }, folder.path()).unwrap();
        std::fs::remove_file(path(5)).unwrap();
        assert_eq!(held.mark(5).unwrap(), held.mark(4).unwrap(), "a frame without a file shows the one before");
        assert!(sequence.mark(5).is_err());
    }

    #[test]
    fn pictures_used_last_are_kept() {
        let (folder, footage) = footage();
        let sequence = Sequence::keeping(&footage, folder.path(), 3 * BYTES + 1).unwrap();
        for frame in [1, 2, 3, 1, 4] {
            sequence.picture(frame).unwrap();
        }
        assert_eq!(held(&sequence), [1, 3, 4]);
        let again = sequence.picture(3).unwrap();
        std::fs::remove_file(folder.path().join("f003.png")).unwrap();
        assert!(Arc::ptr_eq(&again, &sequence.picture(3).unwrap()));
        sequence.forget();
        assert_eq!(held(&sequence), [0; 0]);
        assert!(matches!(sequence.picture(3), Err(FrameError::Gap { frame: 3, .. })));
    }

    #[test]
    fn errors_name_frame_and_file() {
        let (folder, footage) = footage();
        let at = |name: &str| folder.path().join(name);
        std::fs::remove_file(at("f002.png")).unwrap();
        std::fs::write(at("f003.png"), "text").unwrap();
        ImageBuffer::from_pixel(9, 3, Rgb([0u8; 3])).save(at("f004.png")).unwrap();
        let sequence = Sequence::new(&footage, folder.path()).unwrap();
        for frame in 1..=7 {
            assert_eq!(sequence.probe(frame).err(), sequence.picture(frame).err(), "{frame}");
        }
        assert_eq!(sequence.picture(7), Err(FrameError::Outside { frame: 7, first: 1, last: 6 }));
        assert_eq!(sequence.picture(2), Err(FrameError::Gap { frame: 2, path: at("f002.png") }));
        let unreadable = sequence.picture(3).unwrap_err();
        assert!(matches!(&unreadable, FrameError::Unreadable { frame: 3, path, .. } if *path == at("f003.png")));
        let path = at("f004.png");
        let wrong = FrameError::WrongSize { frame: 4, path, found_width: 9, found_height: 3, width: 4, height: 3 };
        assert_eq!(sequence.picture(4), Err(wrong));
        assert_eq!(sequence.pictures(&[1, 3, 2]), Err(unreadable));
        assert!(Sequence::new(&Footage { pattern: "a.png".into(), ..footage }, folder.path()).is_err());
    }

    #[test]
    fn held_gaps_show_the_nearest_earlier_file() {
        let (folder, footage) = footage();
        let at = |frame: i32| folder.path().join(format!("f{frame:03}.png"));
        [1, 3, 4, 6].iter().for_each(|&frame| std::fs::remove_file(at(frame)).unwrap());
        let sequence = Sequence::new(&Footage { held: true, ..footage.clone() }, folder.path()).unwrap();
        let picture = |frame| sequence.picture(frame).unwrap();
        assert!(Arc::ptr_eq(&picture(4), &picture(2)) && Arc::ptr_eq(&picture(3), &picture(2)));
        assert!(Arc::ptr_eq(&picture(6), &picture(5)) && !Arc::ptr_eq(&picture(5), &picture(4)));
        assert_eq!(held(&sequence), [2, 5]);
        assert_eq!((sequence.path(4), sequence.shown(4), sequence.probe(4)), (at(2), 2, Ok(())));
        assert!(sequence.layer(4).unwrap() == sequence.layer(2).unwrap());
        assert_eq!(sequence.picture(1), Err(FrameError::Missing { frame: 1, path: at(1) }));
        assert!(!sequence.has_changed());
        std::fs::write(at(4), "text").unwrap();
        assert!(Arc::ptr_eq(&picture(4), &picture(2)), "found before it came");
        assert!(sequence.has_changed());
        sequence.forget();
        assert!(matches!(sequence.picture(4), Err(FrameError::Unreadable { frame: 4, path, .. }) if path == at(4)));
        let open = Sequence::new(&footage, folder.path()).unwrap();
        assert_eq!(
            open.picture(3),
            Err(FrameError::Missing { frame: 3, path: at(3) }),
            "the first file is missing too"
        );
    }

    #[test]
    fn an_absolute_pattern_ignores_the_folder() {
        let (folder, footage) = footage();
        let pattern = folder.path().join("f%03d.png").to_str().unwrap().to_owned();
        let sequence = Sequence::new(&Footage { pattern, ..footage }, Path::new("elsewhere")).unwrap();
        assert!(sequence.picture(1).is_ok());
    }
}
