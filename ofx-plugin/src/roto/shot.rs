//! The frames of a shot, in the composition's numbers.
//!
//! They are those of the source. But by OpenFX a generator has frames without end, and so has in some hosts whatever is merged with
//! one, such as drawings over white paper. Then the timeline says what the shot is, or what else is known.

use crate::description::{OUTPUT, SOURCE};
use crate::ofx::{Clip, Effect, Failure};
use rototoon::project::schema::MAX_FRAMES;

/// Frames on each side of a time, where nothing else is known of a shot.
const AROUND: f64 = 500.0;

/// First and last frame of the source: `None` if it is not connected. The second `None` stands for frames without end.
pub fn of_source(effect: &Effect) -> Result<Option<Option<[f64; 2]>>, Failure> {
    let source = Some(effect.clip(SOURCE)?).filter(Clip::connected);
    Ok(source.and_then(|source| source.frame_range()).map(|range| Some(range).filter(is_bounded)))
}

/// First and last frame of the shot: those of the source, or, where it has no end, of the host's timeline, the output, the range that is chosen
/// for Track, or the frames around a time. `None` if no source is connected.
pub fn frames(effect: &Effect, time: f64) -> Result<Option<[f64; 2]>, Failure> {
    let Some(own) = of_source(effect)? else { return Ok(None) };
    let parameters = effect.parameters()?;
    let chosen = [parameters.int(c"firstFrame", time)?, parameters.int(c"lastFrame", time)?].map(f64::from);
    let known = [own, effect.timeline(), effect.clip(OUTPUT)?.frame_range(), Some(chosen).filter(|[a, b]| a < b)];
    let time = if time.is_finite() { time.round() } else { 0.0 };
    Ok(known.into_iter().flatten().find(is_bounded).or(Some([time - AROUND, time + AROUND])))
}

/// Whether a document may have so many frames.
fn is_bounded([first, last]: &[f64; 2]) -> bool {
    last - first < MAX_FRAMES as f64
}
