//! The clip at the document's frame rate.
//!
//! A drawing that moves stands in a shot, and the shot has a rate. A clip of another rate lasts as long as before, on
//! other frames.

use crate::scene::{Clip, Footage};

/// The clip at the rate of the footage over which its result lies, and what is to be said if that is another one than its own,
/// `fps`.
pub fn at_rate_of(footage: &Footage, clip: &Clip, fps: f64) -> (Clip, Option<String>) {
    let made = clip.clone().at_rate(fps, footage.fps);
    let (before, after) = (clip.postures.len(), made.postures.len());
    let changed = made.postures != clip.postures;
    let said = format!(
        "the clip has {fps} frames a second and the document {}, so its {before} frames become {after}",
        footage.fps
    );
    (made, changed.then_some(said))
}
