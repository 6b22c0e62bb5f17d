//! What was computed from pictures, kept for the next job within a budget of bytes.
//!
//! Features and flows are pure functions of the pictures, so it is no matter for the result whether they are kept or
//! made again. Values are made without holding a lock: two threads may make the same one, and the first is kept.

use super::TrackError;
use super::features::Features;
use crate::image::flow::{Flow, dense_flow};
use crate::scene::{FrameNumber, FrameSource};
use std::collections::BTreeMap;
use std::sync::{Arc, Mutex, MutexGuard};

/// Bytes of features and flows kept at the most: a hundred frames of 16:9.
const BUDGET: usize = 400 << 20;

/// Index in `LEVELS` of the level whose luma the flow is computed on, and with it the flow's resolution.
pub const FLOW_LEVEL: usize = 1;

/// Features by frame, flows by pair of frames.
#[derive(Default)]
pub struct Store {
    kept: Mutex<Kept>,
}

#[derive(Default)]
struct Kept {
    clock: u64,
    bytes: usize,
    entries: BTreeMap<Key, Entry>,
}

#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Key {
    Features(FrameNumber),
    Flow(FrameNumber, FrameNumber),
}

#[derive(Clone)]
enum Value {
    Features(Arc<Features>),
    Flow(Arc<Flow>),
}

struct Entry {
    used: u64,
    bytes: usize,
    value: Value,
}

impl Store {
    /// The features of a frame.
    pub fn features(&self, frames: &dyn FrameSource, frame: FrameNumber) -> Result<Arc<Features>, TrackError> {
        let key = Key::Features(frame);
        if let Some(Value::Features(known)) = self.get(key) {
            return Ok(known);
        }
        let made = Arc::new(Features::new(&*frames.picture(frame)?));
        self.put(key, made.bytes(), Value::Features(made.clone()));
        Ok(made)
    }

    /// The flow from the drawing of one frame to that of another, in pixels of the level [`FLOW_LEVEL`].
    pub fn flow(&self, frames: &dyn FrameSource, from: FrameNumber, to: FrameNumber) -> Result<Arc<Flow>, TrackError> {
        let key = Key::Flow(from, to);
        if let Some(Value::Flow(known)) = self.get(key) {
            return Ok(known);
        }
        let luma = |frame| Ok::<_, TrackError>(self.features(frames, frame)?.level(FLOW_LEVEL).luma());
        let made = Arc::new(dense_flow(&luma(from)?, &luma(to)?));
        self.put(key, size_of_val(made.data()), Value::Flow(made.clone()));
        Ok(made)
    }

    /// Forgets everything.
    pub fn clear(&self) {
        *self.lock() = Kept::default();
    }

    fn lock(&self) -> MutexGuard<'_, Kept> {
        // The map is only touched between complete states, so a panic elsewhere cannot have left it half changed.
        self.kept.lock().unwrap_or_else(|poisoned| poisoned.into_inner())
    }

    fn get(&self, key: Key) -> Option<Value> {
        let mut kept = self.lock();
        kept.clock += 1;
        let now = kept.clock;
        let entry = kept.entries.get_mut(&key)?;
        entry.used = now;
        Some(entry.value.clone())
    }

    fn put(&self, key: Key, bytes: usize, value: Value) {
        let mut kept = self.lock();
        kept.clock += 1;
        let entry = Entry { used: kept.clock, bytes, value };
        kept.bytes += bytes;
        if let Some(old) = kept.entries.insert(key, entry) {
            kept.bytes -= old.bytes;
        }
        while kept.bytes > BUDGET {
            let Some((&oldest, _)) = kept.entries.iter().min_by_key(|(_, entry)| entry.used) else { break };
            if let Some(entry) = kept.entries.remove(&oldest) {
                kept.bytes -= entry.bytes;
            }
        }
    }
}
