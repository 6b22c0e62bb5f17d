//! Which frames of a film show the same drawing: each frame compared with those before it ([`super::held`]).
//!
//! An answer depends on two pictures alone. With a cache it is kept under their marks, and where all answers about a frame are known its picture needs no
//! pyramid. Of pictures without marks, and of those that change during the run, nothing is kept.

use super::features::Features;
use super::held::same_drawing;
use crate::contract::cache::{Cache, Mark, TRACKER, keep, recall};
use crate::contract::error::TrackError;
use rayon::iter::{IntoParallelRefIterator, ParallelIterator};
use rototoon_base::scene::{FrameNumber, FrameSource, Progress};
use std::collections::BTreeMap;

/// How many pictures are looked at together.
const AT_ONCE: usize = 4;

/// The drawings of frames, which are in their order: the first and the last frame of each. They are those that the default tracker
/// works on: a frame is compared with the one before it and with the first one of its drawing. A `cache` may know the answers.
///
/// # Errors
///
/// The error of a picture that cannot be read, or the cancellation by `progress`.
pub fn drawings(
    frames: &dyn FrameSource,
    numbers: impl IntoIterator<Item = FrameNumber>,
    cache: Option<&dyn Cache>,
    progress: &dyn Progress,
) -> Result<Vec<[FrameNumber; 2]>, TrackError> {
    let numbers: Vec<FrameNumber> = numbers.into_iter().collect();
    let mut found: Vec<[FrameNumber; 2]> = Vec::new();
    let mut compared = Compared::new(frames, cache);
    for (k, batch) in numbers.chunks(AT_ONCE).enumerate() {
        progress.report("Comparing drawings", (k * AT_ONCE) as f64 / numbers.len() as f64)?;
        compared.look(found.last().map(|own| own[1]), batch)?;
        for &frame in batch {
            let goes_on = match found.last() {
                Some(&[first, last]) => {
                    compared.is_same(last, frame)? && (first == last || compared.is_same(first, frame)?)
                }
                None => false,
            };
            match found.last_mut().filter(|_| goes_on) {
                Some(own) => own[1] = frame,
                None => found.push([frame, frame]),
            }
        }
        compared.forget(found.last().copied().unwrap_or_default());
    }
    Ok(found)
}

/// The frame from which [`drawings`] must be asked for, so that the drawing of `frame` begins where it does in a look at all frames from
/// `earliest` on: the latest one up to `frame` that differs from the one before it. A picture that cannot be read ends the search.
///
/// # Errors
///
/// That of the picture of `frame`, or the cancellation by `progress`.
pub fn began(
    frames: &dyn FrameSource,
    frame: FrameNumber,
    earliest: FrameNumber,
    cache: Option<&dyn Cache>,
    progress: &dyn Progress,
) -> Result<FrameNumber, TrackError> {
    let mut first = frame;
    let mut compared = Compared::new(frames, cache);
    compared.see(frame)?;
    while first > earliest {
        progress.report("Comparing drawings", 0.0)?;
        if compared.see(first - 1).is_err() || !compared.is_same(first - 1, first)? {
            break;
        }
        first -= 1;
        compared.forget([first, first]);
    }
    Ok(first)
}

/// Frames that are compared.
struct Compared<'a> {
    frames: &'a dyn FrameSource,
    cache: Option<&'a dyn Cache>,
    /// The marks of the frames, where there is a cache.
    marks: BTreeMap<FrameNumber, Mark>,
    /// The pictures that were looked at.
    seen: BTreeMap<FrameNumber, Features>,
}

impl<'a> Compared<'a> {
    fn new(frames: &'a dyn FrameSource, cache: Option<&'a dyn Cache>) -> Self {
        Self { frames, cache, marks: BTreeMap::new(), seen: BTreeMap::new() }
    }

    /// Looks at frames together: at those about which the cache has no answer.
    fn look(&mut self, before: Option<FrameNumber>, batch: &[FrameNumber]) -> Result<(), TrackError> {
        if self.cache.is_some() {
            let mark = |&frame: &FrameNumber| Some((frame, self.frames.mark(frame).ok()??));
            let marks: Vec<_> = batch.par_iter().filter_map(mark).collect();
            self.marks.extend(marks);
        }
        let all: Vec<FrameNumber> = before.into_iter().chain(batch.iter().copied()).collect();
        let is_open: Vec<bool> = all.windows(2).map(|pair| self.known(pair[0], pair[1]).is_none()).collect();
        let is_needed = |k: usize| {
            let beside = [k.checked_sub(1), Some(k)].into_iter().flatten().filter_map(|pair| is_open.get(pair));
            !self.marks.contains_key(&all[k]) || beside.into_iter().any(|open| *open)
        };
        let needed: Vec<FrameNumber> = (0..all.len())
            .filter(|&k| is_needed(k))
            .map(|k| all[k])
            .filter(|frame| !self.seen.contains_key(frame))
            .collect();
        let looks: Vec<Result<_, TrackError>> =
            needed.par_iter().map(|&frame| Ok((frame, self.features(frame)?))).collect();
        for look in looks {
            let (frame, features) = look?;
            self.seen.insert(frame, features);
        }
        Ok(())
    }

    /// Looks at a frame, if that is not done and its picture has no mark.
    fn see(&mut self, frame: FrameNumber) -> Result<(), TrackError> {
        if self.cache.is_some()
            && let Some(mark) = self.frames.mark(frame)?
        {
            self.marks.insert(frame, mark);
        } else if !self.seen.contains_key(&frame) {
            let features = self.features(frame)?;
            self.seen.insert(frame, features);
        }
        Ok(())
    }

    fn features(&self, frame: FrameNumber) -> Result<Features, TrackError> {
        Ok(Features::new(&*self.frames.picture(frame)?))
    }

    /// Whether two frames show the same drawing, if the cache knows it.
    fn known(&self, before: FrameNumber, frame: FrameNumber) -> Option<bool> {
        recall(self.cache?, &self.made_from(before, frame)?)
    }

    fn made_from(&self, before: FrameNumber, frame: FrameNumber) -> Option<(&'static str, &'static str, [Mark; 2])> {
        Some((TRACKER, "same drawing", [*self.marks.get(&before)?, *self.marks.get(&frame)?]))
    }

    /// Whether two frames show the same drawing.
    fn is_same(&mut self, before: FrameNumber, frame: FrameNumber) -> Result<bool, TrackError> {
        if let Some(known) = self.known(before, frame) {
            return Ok(known);
        }
        for frame in [before, frame] {
            if !self.seen.contains_key(&frame) {
                let features = self.features(frame)?;
                self.seen.insert(frame, features);
            }
        }
        let same = same_drawing(&self.seen[&before], &self.seen[&frame]);
        let still = |frame: FrameNumber| self.frames.mark(frame).ok().flatten() == self.marks.get(&frame).copied();
        if let Some(cache) = self.cache
            && let Some(made_from) = self.made_from(before, frame)
            && still(before)
            && still(frame)
        {
            keep(cache, &made_from, &same);
        }
        Ok(same)
    }

    /// Forgets all frames but these.
    fn forget(&mut self, but: [FrameNumber; 2]) {
        self.seen.retain(|frame, _| but.contains(frame));
        self.marks.retain(|frame, _| but.contains(frame));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rototoon_base::scene::{Colour, FrameError, Raster, Silent};
    use std::sync::{Arc, Mutex};

    /// A square on twos; the picture of a frame may be another one's. It counts the pictures that were looked at.
    struct Film([FrameNumber; 8], Mutex<usize>);

    impl FrameSource for Film {
        fn picture(&self, frame: FrameNumber) -> Result<Arc<Raster<Colour>>, FrameError> {
            *self.1.lock().unwrap() += 1;
            let left = 20 + 30 * (self.0[frame as usize] / 2) as usize;
            let ink = |x: usize, y: usize| (left..left + 60).contains(&x) && (40..100).contains(&y);
            Ok(Arc::new(Raster::from_fn(300, 200, |x, y| if ink(x, y) { [0.0; 3] } else { [1.0; 3] })))
        }

        fn mark(&self, frame: FrameNumber) -> Result<Option<Mark>, FrameError> {
            Ok(Some([self.0[frame as usize] as u8; 32]))
        }
    }

    #[derive(Default)]
    struct Store(Mutex<BTreeMap<Mark, Vec<u8>>>);

    impl Cache for Store {
        fn get(&self, mark: &Mark) -> Option<Vec<u8>> {
            self.0.lock().unwrap().get(mark).cloned()
        }

        fn put(&self, mark: &Mark, bytes: &[u8]) {
            self.0.lock().unwrap().insert(*mark, bytes.to_vec());
        }
    }

    /// The drawings with a cache, which must be those without one, and how many pictures were looked at.
    fn found(film: [FrameNumber; 8], store: &Store) -> (Vec<[FrameNumber; 2]>, usize) {
        let film = Film(film, Mutex::default());
        let all = || 0..8;
        let found = drawings(&film, all(), Some(store), &Silent).unwrap();
        let begins: Vec<_> = all().map(|frame| began(&film, frame, 0, Some(store), &Silent).unwrap()).collect();
        let looks = std::mem::take(&mut *film.1.lock().unwrap());
        assert_eq!(found, drawings(&film, all(), None, &Silent).unwrap());
        let plain: Vec<_> = all().map(|frame| began(&film, frame, 0, None, &Silent).unwrap()).collect();
        assert_eq!(begins, plain);
        (found, looks)
    }

    #[test]
    fn answers_come_from_the_cache_and_a_new_picture_is_looked_at_with_its_neighbours() {
        let store = Store::default();
        let (first, looks) = found([0, 1, 2, 3, 4, 5, 6, 7], &store);
        assert_eq!((first, looks), (vec![[0, 1], [2, 3], [4, 5], [6, 7]], 8));
        assert_eq!(found([0, 1, 2, 3, 4, 5, 6, 7], &store).1, 0);
        let (changed, looks) = found([0, 1, 2, 3, 4, 0, 6, 7], &store);
        assert_eq!((changed, looks), (vec![[0, 1], [2, 3], [4, 4], [5, 5], [6, 7]], 3));
    }
}
