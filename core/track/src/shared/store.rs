//! A store of data computed from pictures, kept for the next job within a [budget](super::budget) of bytes.
//!
//! Features and flows depend on the pictures alone, so the store never changes a result. Values are computed without
//! holding the lock. Features are computed by many threads together, so two callers may compute the same ones.
//! [`Store::read`] computes those of a complete scene before they are requested.

use super::budget::Budget;
use super::features::Features;
use super::held::same_drawing;
use super::sought::Sought;
use crate::contract::error::TrackError;
use crate::contract::tasks::Steps;
use rayon::prelude::{IndexedParallelIterator, IntoParallelIterator, IntoParallelRefIterator, ParallelIterator};
use rototoon_base::scene::{FrameNumber, FrameSource, Progress, Span};
use rototoon_image::flow::{Flow, Pyramid, dense_flow};
use std::collections::{BTreeMap, BTreeSet};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};

/// Index in `LEVELS` of the level on whose luma the flow is computed. The flow has the resolution of this level.
pub const FLOW_LEVEL: usize = 1;

/// Features by frame, flows by pair of frames, and other data of pictures.
#[derive(Default)]
pub struct Store {
    kept: Mutex<Kept>,
    made: Condvar,
}

#[derive(Default)]
struct Kept {
    clock: u64,
    bytes: usize,
    budget: Budget,
    entries: BTreeMap<Key, Entry>,
    /// Whether two frames show the same drawing. These are so small that all are kept.
    same: BTreeMap<(FrameNumber, FrameNumber), bool>,
    making: BTreeSet<Key>,
}

#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Key {
    Features(FrameNumber),
    Pyramid(FrameNumber),
    Flow(FrameNumber, FrameNumber),
    Sought(FrameNumber, usize),
}

#[derive(Clone)]
enum Value {
    Features(Arc<Features>),
    Pyramid(Arc<Pyramid>),
    Flow(Arc<Flow>),
    Sought(Arc<Sought>),
}

struct Entry {
    used: u64,
    bytes: usize,
    value: Value,
}

/// Marks a value that is being computed. When it is finished, or given up by a panic, the waiting threads look again.
struct Making<'a> {
    store: &'a Store,
    key: Key,
}

impl Drop for Making<'_> {
    fn drop(&mut self) {
        self.store.lock().making.remove(&self.key);
        self.store.made.notify_all();
    }
}

impl Kept {
    fn get(&mut self, key: Key) -> Option<Value> {
        self.clock += 1;
        let entry = self.entries.get_mut(&key)?;
        entry.used = self.clock;
        Some(entry.value.clone())
    }
}

impl Store {
    /// The features of a frame.
    pub fn features(&self, frames: &dyn FrameSource, frame: FrameNumber) -> Result<Arc<Features>, TrackError> {
        let key = Key::Features(frame);
        if let Some(Value::Features(known)) = self.get(key) {
            return Ok(known);
        }
        let made = Arc::new(Features::new(&*frames.picture(frame)?));
        let mut kept = self.lock();
        kept.budget = kept.budget.with_features(made.bytes());
        drop(kept);
        self.put(key, made.bytes(), Value::Features(made.clone()));
        Ok(made)
    }

    /// Makes room for a scene of so many frames.
    pub fn expect(&self, frames: usize) {
        let mut kept = self.lock();
        kept.budget = kept.budget.raised(frames);
    }

    /// Of how many frames the store keeps all that is computed from them, for frames such as this one.
    pub fn room(&self, frames: &dyn FrameSource, frame: FrameNumber) -> Result<usize, TrackError> {
        self.features(frames, frame)?;
        Ok(self.lock().budget.room())
    }

    /// Computes the features of several frames, each once, as far as they fit into half of the budget.
    pub fn read(
        &self,
        frames: &dyn FrameSource,
        numbers: &[FrameNumber],
        progress: &dyn Progress,
    ) -> Result<(), TrackError> {
        let Some((first, rest)) = numbers.split_first() else { return Ok(()) };
        self.expect(numbers.len());
        let one = self.features(frames, *first)?.bytes();
        let most = self.lock().budget.bytes() / 2 / one.max(1);
        let rest = &rest[..rest.len().min(most)];
        let steps = Steps::new(progress, "Reading frames", rest.len());
        rest.par_iter().with_max_len(1).try_for_each(|&frame| steps.step(|| self.features(frames, frame).map(|_| ())))
    }

    /// The flow from the drawing of one frame to that of another, in pixels of the level [`FLOW_LEVEL`].
    pub fn flow(&self, frames: &dyn FrameSource, from: FrameNumber, to: FrameNumber) -> Result<Arc<Flow>, TrackError> {
        let key = Key::Flow(from, to);
        if let Some(Value::Flow(known)) = self.get(key) {
            return Ok(known);
        }
        let (first, second) = (self.pyramid(frames, from)?, self.pyramid(frames, to)?);
        let make = || {
            let flow = dense_flow(&first, &second);
            (size_of_val(flow.data()), Value::Flow(Arc::new(flow)))
        };
        match self.once(key, make) {
            Value::Flow(flow) => Ok(flow),
            _ => unreachable!("a flow is kept under the key of a flow"),
        }
    }

    /// The luma pyramid of a frame, for the flow.
    fn pyramid(&self, frames: &dyn FrameSource, frame: FrameNumber) -> Result<Arc<Pyramid>, TrackError> {
        let key = Key::Pyramid(frame);
        if let Some(Value::Pyramid(known)) = self.get(key) {
            return Ok(known);
        }
        let features = self.features(frames, frame)?;
        let make = || {
            let pyramid = Pyramid::new(&features.level(FLOW_LEVEL).luma());
            (pyramid.bytes(), Value::Pyramid(Arc::new(pyramid)))
        };
        match self.once(key, make) {
            Value::Pyramid(pyramid) => Ok(pyramid),
            _ => unreachable!("a pyramid is kept under the key of a pyramid"),
        }
    }

    /// The picture of a frame prepared for the search on a level (index in `LEVELS`).
    pub fn sought(
        &self,
        frames: &dyn FrameSource,
        frame: FrameNumber,
        level: usize,
    ) -> Result<Arc<Sought>, TrackError> {
        let key = Key::Sought(frame, level);
        if let Some(Value::Sought(known)) = self.get(key) {
            return Ok(known);
        }
        let features = self.features(frames, frame)?;
        let make = || {
            let sought = Sought::new(features.level(level));
            (sought.bytes(), Value::Sought(Arc::new(sought)))
        };
        match self.once(key, make) {
            Value::Sought(sought) => Ok(sought),
            _ => unreachable!("a prepared picture is kept under the key of a prepared picture"),
        }
    }

    /// For each of several frames but the last: whether the next one shows the same drawing. A frame is compared with
    /// the one before it and with the first one of its drawing, so that slow movement does not add up.
    pub fn held(
        &self,
        frames: &dyn FrameSource,
        numbers: &[FrameNumber],
        progress: &(impl Fn() -> Result<(), TrackError> + Sync),
    ) -> Result<Vec<bool>, TrackError> {
        let same = |pair: &[FrameNumber]| {
            progress()?;
            self.same(frames, pair[0], pair[1])
        };
        let mut held: Vec<bool> =
            numbers.windows(2).collect::<Vec<_>>().into_par_iter().map(same).collect::<Result<_, _>>()?;
        let mut first = 0;
        for (i, held) in held.iter_mut().enumerate() {
            *held = *held && (first == i || same(&[numbers[first], numbers[i + 1]])?);
            if !*held {
                first = i + 1;
            }
        }
        Ok(held)
    }

    /// Whether two frames show the same drawing.
    fn same(&self, frames: &dyn FrameSource, a: FrameNumber, b: FrameNumber) -> Result<bool, TrackError> {
        let known = self.lock().same.get(&(a, b)).copied();
        if let Some(known) = known {
            return Ok(known);
        }
        let same = same_drawing(&*self.features(frames, a)?, &*self.features(frames, b)?);
        self.lock().same.insert((a, b), same);
        Ok(same)
    }

    /// Which pairs of frames of a span are known to show the same drawing, and which are not.
    pub fn known_same(&self, span: Span) -> Vec<((FrameNumber, FrameNumber), bool)> {
        let kept = self.lock();
        let within = kept.same.iter().filter(|((a, b), _)| span.first <= *a.min(b) && *a.max(b) <= span.last);
        within.map(|(pair, same)| (*pair, *same)).collect()
    }

    /// Adds what is known of these pictures.
    pub fn know_same(&self, pairs: Vec<((FrameNumber, FrameNumber), bool)>) {
        self.lock().same.extend(pairs);
    }

    /// Forgets everything.
    pub fn clear(&self) {
        let mut kept = self.lock();
        let making = std::mem::take(&mut kept.making);
        *kept = Kept { making, ..Kept::default() };
    }

    fn lock(&self) -> MutexGuard<'_, Kept> {
        // The map is only changed between complete states, so a panic elsewhere cannot leave it half changed.
        self.kept.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// The value of a key. If it is not kept and no other thread is computing it, it is computed now. If another thread
    /// is computing it, this thread waits.
    ///
    /// `make` must not hand work to other threads, because a waiting thread does no work.
    fn once(&self, key: Key, make: impl FnOnce() -> (usize, Value)) -> Value {
        let mut kept = self.lock();
        loop {
            if let Some(known) = kept.get(key) {
                return known;
            }
            if kept.making.insert(key) {
                break;
            }
            kept = self.made.wait(kept).unwrap_or_else(PoisonError::into_inner);
        }
        drop(kept);
        let _making = Making { store: self, key };
        let (bytes, value) = make();
        self.put(key, bytes, value.clone());
        value
    }

    fn get(&self, key: Key) -> Option<Value> {
        self.lock().get(key)
    }

    fn put(&self, key: Key, bytes: usize, value: Value) {
        let mut kept = self.lock();
        kept.clock += 1;
        let entry = Entry { used: kept.clock, bytes, value };
        kept.bytes += bytes;
        if let Some(old) = kept.entries.insert(key, entry) {
            kept.bytes -= old.bytes;
        }
        while kept.bytes > kept.budget.bytes() {
            let Some((&oldest, _)) = kept.entries.iter().min_by_key(|(_, entry)| entry.used) else { break };
            if let Some(entry) = kept.entries.remove(&oldest) {
                kept.bytes -= entry.bytes;
            }
        }
    }
}
