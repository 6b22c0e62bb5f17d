//! How many bytes a store keeps of what was computed from pictures.
//!
//! A tracker goes through all frames of a scene again and again. What a store drops is computed anew in each of these rounds, with its picture decoded. In a
//! scene a little larger than the store, that is everything: the frame that is needed next is always the one that was not used for the longest time. 97
//! frames of 1920 × 1080 with eleven parts took 444 s of processor time in place of 112 s. So the budget grows with the scene.
//!
//! It is bounded by a quarter of the memory that is free. Where the system does not say how much that is ([`limits`]), the bound is
//! fixed. A scene that is larger than its budget takes longer, and its result is the same.

use rototoon_base::limits;

/// Bytes kept at least, however small a scene is.
const LEAST: usize = 400 << 20;
/// Bytes kept at most, however much memory is free.
const MOST: usize = 3 << 30;
/// Bytes kept at most where nobody knows how much memory is free.
const UNKNOWN: usize = 1 << 30;
/// Share of the free memory that a store may take: there are two of them, and other programs.
const SHARE: f64 = 0.25;
/// Bytes kept for each frame, in bytes of its features. The rest is for flows, and for pictures that are prepared for the search.
const FOR_EACH: usize = 2;

/// The budget of a store.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Budget {
    frames: usize,
    features: usize,
    most: usize,
}

impl Budget {
    /// For a scene of at least so many frames.
    pub fn raised(self, frames: usize) -> Self {
        Self { frames: self.frames.max(frames), most: most(limits::free()), ..self }
    }

    /// For features of so many bytes.
    pub fn with_features(self, bytes: usize) -> Self {
        Self { features: self.features.max(bytes), ..self }
    }

    /// Number of frames that it is large enough for; at least 1.
    pub fn room(self) -> usize {
        (self.bytes() / (FOR_EACH * self.features).max(1)).max(1)
    }

    /// Number of bytes.
    pub fn bytes(self) -> usize {
        self.frames.saturating_mul(FOR_EACH).saturating_mul(self.features).min(self.most).max(LEAST)
    }
}

/// The largest budget with this much free memory.
fn most(free: Option<u64>) -> usize {
    free.map_or(UNKNOWN, |free| ((free as f64 * SHARE) as usize).min(MOST))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_grows_with_the_scene_up_to_a_share_of_what_is_free() {
        let budget = |frames, free| Budget { frames, features: 4 << 20, most: most(free) }.bytes();
        assert_eq!(budget(0, None), LEAST);
        assert_eq!(budget(100, Some(16 << 30)), 800 << 20);
        assert_eq!(budget(100, Some(2 << 30)), 512 << 20);
        assert_eq!(budget(100, Some(0)), LEAST);
        assert_eq!(budget(1000, Some(64 << 30)), MOST);
        assert_eq!(budget(1000, None), UNKNOWN);
        assert_eq!(budget(usize::MAX, None), UNKNOWN);
        let raised = Budget::default().with_features(5).raised(7).raised(3);
        assert_eq!((raised.frames, raised.features), (7, 5));
    }
}
