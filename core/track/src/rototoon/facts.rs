//! What was found out about the pictures of a stretch after it was tracked, kept in the [cache](super::cached).
//!
//! Parts that stand still are looked for when all parts are tracked ([`holds`](super::holds)): which frames show the same drawing, where the picture goes around
//! the parts, and whether it is the same inside a contour. All that needs the pictures, and would be the most work where the tracks come from the cache. Each answer
//! is true of these pictures, whatever the tracks are: it has its contour with it. So the answers of a stretch are kept by the marks of its pictures and by how they are looked at, which
//! the kind of drawing decides: where a picture goes is not the same in colours and in tones. Answers for contours that are others now are not found.

use super::cached::{Stretch, Stretches};
use super::holds::{Pan, Said};
use super::{Looks, Rototoon};
use rototoon_base::scene::FrameNumber;
use serde::{Deserialize, Serialize};

/// Two frames.
pub(super) type Pair = (FrameNumber, FrameNumber);

/// The facts of a stretch.
#[derive(Debug, Default, Serialize, Deserialize)]
struct Facts {
    /// Whether two frames show the same drawing.
    same: Vec<(Pair, bool)>,
    asked: Vec<Said>,
    pans: Vec<(FrameNumber, Pan)>,
}

impl Rototoon {
    /// Takes what the cache knows of the pictures of a run's stretches, if there was none before. Returns of which stretches it knows nothing.
    pub(super) fn recall(&mut self, stretches: &Stretches) -> Vec<bool> {
        if !self.holds.is_empty() {
            return vec![false; stretches.of.len()];
        }
        let of_stretch = |stretch: &Stretch| {
            let Some(Facts { same, asked, pans }) = stretches.facts(stretch) else { return true };
            self.store.know_same(same);
            self.holds.add(asked, pans);
            false
        };
        stretches.of.iter().map(of_stretch).collect()
    }

    /// Keeps what is known of the pictures of stretches with new tracks, and of those of which the cache knew nothing.
    pub(super) fn note(&self, stretches: &Stretches, unknown: &[bool], frames: &Looks) {
        for (stretch, _) in stretches.of.iter().zip(unknown).filter(|(stretch, unknown)| stretch.is_new || **unknown) {
            let (asked, pans) = self.holds.within(stretch.range);
            let facts = Facts { same: self.store.known_same(stretch.range), asked, pans };
            stretches.keep_facts(stretch, &facts, frames);
        }
    }
}
