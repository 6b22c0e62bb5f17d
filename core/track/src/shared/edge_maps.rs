//! Edge maps of frames and their distance transforms, kept within a budget of bytes.
//!
//! A frame's edges need a mean-shift filter and a Canny detector. That takes far more time than all other work on a
//! frame. Stored as one bit per pixel, the edges of a 1920 × 1080 picture take a quarter of a megabyte. Distances take
//! 16 bits per pixel but are computed from the edges in milliseconds. So edges are kept for long and distances for a
//! while. Each kind has its own store, which drops the least recently used frame. The content of the stores never
//! changes a result.
//!
//! Several threads may work on parts over the same frames. A thread first takes frames that no other thread works on
//! ([`EdgeMaps::prepare`]), and then computes what is still missing itself. It never waits for another thread. The
//! filters hand pieces of their work to the thread pool, and a thread that waits there while it holds a lock may be
//! given the very job that waits for that lock.

use rototoon_base::scene::{Colour, FrameError, FrameNumber, FrameSource, Raster};
use rototoon_image::canny::{CannyOptions, canny};
use rototoon_image::distance_transform::manhattan;
use rototoon_image::mean_shift::{MeanShiftOptions, mean_shift};
use std::collections::{BTreeMap, BTreeSet};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

/// Byte budget of the edges of all frames together.
const EDGE_BUDGET: usize = 64 << 20;
/// Byte budget of the distances of all frames together.
const DISTANCE_BUDGET: usize = 128 << 20;

/// How edges are detected.
#[derive(Clone, Copy, Debug)]
pub struct EdgeOptions {
    /// The filter before the detector.
    pub mean_shift: MeanShiftOptions,
    /// The edge detector.
    pub canny: CannyOptions,
}

impl Default for EdgeOptions {
    /// Radius 5, colour range 20, thresholds 50 and 120 without a further blur.
    fn default() -> Self {
        Self {
            mean_shift: MeanShiftOptions { radius: 5, range: 20, ..MeanShiftOptions::default() },
            canny: CannyOptions { sigma: 0.0, low: 50.0, high: 120.0, ..CannyOptions::default() },
        }
    }
}

/// Edge maps by frame. Threads share one object.
#[derive(Debug, Default)]
pub struct EdgeMaps {
    options: EdgeOptions,
    stores: Mutex<Stores>,
}

#[derive(Debug, Default)]
struct Stores {
    edges: Store<BitRaster>,
    distances: Store<Raster<u16>>,
    in_work: BTreeSet<FrameNumber>,
}

impl EdgeMaps {
    /// Edge maps without any frames yet.
    pub fn new(options: EdgeOptions) -> Self {
        Self { options, stores: Mutex::default() }
    }

    /// Finds the edges of a frame unless they are known or another thread is computing them. Returns whether they are
    /// known now.
    ///
    /// # Errors
    ///
    /// The error of the picture, if it cannot be read.
    pub fn prepare(&self, frames: &dyn FrameSource, frame: FrameNumber) -> Result<bool, FrameError> {
        {
            let mut stores = self.lock();
            if stores.edges.get(frame).is_some() {
                return Ok(true);
            }
            if !stores.in_work.insert(frame) {
                return Ok(false);
            }
        }
        let edges = self.find_edges(frames, frame);
        let mut stores = self.lock();
        stores.in_work.remove(&frame);
        let edges = edges?;
        let bytes = edges.bytes();
        stores.edges.put(frame, Arc::new(edges), bytes, EDGE_BUDGET);
        Ok(true)
    }

    /// Manhattan distances in pixels to the nearest edge of a frame; width + height where the frame has no edge (at
    /// most 65535).
    ///
    /// # Errors
    ///
    /// The error of the picture, if it cannot be read.
    pub fn distances(&self, frames: &dyn FrameSource, frame: FrameNumber) -> Result<Arc<Raster<u16>>, FrameError> {
        let known = {
            let mut stores = self.lock();
            if let Some(distances) = stores.distances.get(frame) {
                return Ok(distances);
            }
            stores.edges.get(frame)
        };
        let edges = match known {
            Some(edges) => edges,
            None => {
                let edges = Arc::new(self.find_edges(frames, frame)?);
                self.lock().edges.put(frame, edges.clone(), edges.bytes(), EDGE_BUDGET);
                edges
            }
        };
        let distances = Arc::new(manhattan(&edges.unpack()).map(|distance| distance as u16));
        let bytes = 2 * distances.data().len();
        self.lock().distances.put(frame, distances.clone(), bytes, DISTANCE_BUDGET);
        Ok(distances)
    }

    /// Forgets every frame.
    pub fn clear(&self) {
        let mut stores = self.lock();
        stores.edges = Store::default();
        stores.distances = Store::default();
    }

    fn find_edges(&self, frames: &dyn FrameSource, frame: FrameNumber) -> Result<BitRaster, FrameError> {
        let picture = frames.picture(frame)?;
        Ok(BitRaster::pack(&self.edges_of(&picture)))
    }

    fn edges_of(&self, picture: &Raster<Colour>) -> Raster<bool> {
        canny(&mean_shift(picture, &self.options.mean_shift), &self.options.canny)
    }

    /// The stores only ever contain complete values, so they are valid even after a thread panicked.
    fn lock(&self) -> MutexGuard<'_, Stores> {
        self.stores.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// A boolean per pixel, one bit each.
#[derive(Debug)]
struct BitRaster {
    width: usize,
    height: usize,
    words: Vec<u64>,
}

impl BitRaster {
    fn pack(raster: &Raster<bool>) -> Self {
        let words = raster
            .data()
            .chunks(64)
            .map(|bits| bits.iter().enumerate().fold(0u64, |word, (k, &bit)| word | u64::from(bit) << k));
        Self { width: raster.width(), height: raster.height(), words: words.collect() }
    }

    fn unpack(&self) -> Raster<bool> {
        let mut raster = Raster::new(self.width, self.height, false);
        for (bits, &word) in raster.data_mut().chunks_mut(64).zip(&self.words) {
            for (k, bit) in bits.iter_mut().enumerate() {
                *bit = word >> k & 1 == 1;
            }
        }
        raster
    }

    fn bytes(&self) -> usize {
        8 * self.words.len()
    }
}

/// Values by frame. If they exceed a budget, the least recently used ones are dropped.
#[derive(Debug)]
struct Store<T> {
    entries: BTreeMap<FrameNumber, Entry<T>>,
    bytes: usize,
    clock: u64,
}

#[derive(Debug)]
struct Entry<T> {
    value: Arc<T>,
    bytes: usize,
    used: u64,
}

impl<T> Default for Store<T> {
    fn default() -> Self {
        Self { entries: BTreeMap::new(), bytes: 0, clock: 0 }
    }
}

impl<T> Store<T> {
    fn get(&mut self, frame: FrameNumber) -> Option<Arc<T>> {
        self.clock += 1;
        let entry = self.entries.get_mut(&frame)?;
        entry.used = self.clock;
        Some(entry.value.clone())
    }

    fn put(&mut self, frame: FrameNumber, value: Arc<T>, bytes: usize, budget: usize) {
        self.clock += 1;
        self.bytes += bytes;
        if let Some(old) = self.entries.insert(frame, Entry { value, bytes, used: self.clock }) {
            self.bytes -= old.bytes;
        }
        while self.bytes > budget && self.entries.len() > 1 {
            let oldest = self.entries.iter().min_by_key(|(_, entry)| entry.used).map(|(&frame, _)| frame);
            let dropped = oldest.and_then(|frame| self.entries.remove(&frame));
            self.bytes -= dropped.map_or(0, |entry| entry.bytes);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use std::sync::atomic::{AtomicUsize, Ordering};

    #[test]
    fn a_store_drops_the_least_recently_used_frame() {
        let mut store = Store::default();
        for frame in 0..3 {
            store.put(frame, Arc::new(frame), 10, 30);
        }
        assert_eq!(store.get(0).as_deref(), Some(&0));
        store.put(3, Arc::new(3), 10, 30);
        assert_eq!(store.entries.keys().copied().collect::<Vec<_>>(), [0, 2, 3]);
        store.put(2, Arc::new(5), 25, 30);
        assert_eq!((store.entries.keys().copied().collect::<Vec<_>>(), store.bytes), (vec![2], 25));
        store.put(9, Arc::new(9), 99, 30);
        assert_eq!(store.entries.keys().copied().collect::<Vec<_>>(), [9], "the newest stays, even if it is too large");
    }

    proptest! {
        #[test]
        fn packing_keeps_every_bit(width in 1usize..20, bits in prop::collection::vec(any::<bool>(), 0..400)) {
            let height = bits.len() / width;
            let raster = Raster::from_vec(width, height, bits[..width * height].to_vec()).unwrap();
            prop_assert_eq!(BitRaster::pack(&raster).unpack(), raster);
        }
    }

    /// A dark left half that widens by a column per frame. It counts the requests.
    struct Curtain(AtomicUsize);

    impl FrameSource for Curtain {
        fn picture(&self, frame: FrameNumber) -> Result<Arc<Raster<Colour>>, FrameError> {
            self.0.fetch_add(1, Ordering::Relaxed);
            if frame > 3 {
                return Err(FrameError::Outside { frame, first: 0, last: 3 });
            }
            let border = 16 + frame as usize;
            Ok(Arc::new(Raster::from_fn(32, 16, |x, _| if x < border { [0.1; 3] } else { [0.9; 3] })))
        }
    }

    #[test]
    fn distances_lead_to_the_border_and_pictures_are_read_once() {
        let (maps, frames) = (EdgeMaps::default(), Curtain(AtomicUsize::new(0)));
        assert_eq!(maps.prepare(&frames, 2), Ok(true));
        for _ in 0..2 {
            let distances = maps.distances(&frames, 2).unwrap();
            let row = distances.row(8);
            let nearest = row.iter().position(|&d| d == 0).unwrap();
            assert!((17..=18).contains(&nearest), "{row:?}");
            assert_eq!(row[nearest - 6], 6);
        }
        assert_eq!(frames.0.load(Ordering::Relaxed), 1);
        maps.clear();
        maps.distances(&frames, 2).unwrap();
        assert_eq!(frames.0.load(Ordering::Relaxed), 2);
    }

    #[test]
    fn a_frame_that_fails_can_be_requested_again() {
        let (maps, frames) = (EdgeMaps::default(), Curtain(AtomicUsize::new(0)));
        assert!(maps.prepare(&frames, 7).is_err());
        assert!(maps.prepare(&frames, 7).is_err(), "a failed frame is not in work any more");
        assert!(maps.distances(&frames, 7).is_err());
    }
}
