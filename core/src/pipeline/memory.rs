//! Memory for work on whole pictures, asked before the work.
//!
//! The size of the pictures is a number in a document, and nobody has checked it against a picture yet. Work that would
//! need more memory than there is ends with an error here; without it the process would be aborted. The needs below
//! were measured as the growth of peak memory from 500 to 4000 pixels square, and rounded up.

use super::PipelineError;
use super::picture::Picture;
use crate::memory;
use crate::scene::Footage;

/// Bytes for each pixel of a picture that is rendered.
const RENDER: u64 = 70;
/// More bytes for each pixel and part, for the mattes of single parts: what their blocks of lines and the compressed file take.
const RENDER_PART: u64 = 1;
/// Bytes for each pixel of the pictures that tracking or snapping holds at once.
const FOLLOW: u64 = 45;
/// Bytes for each pixel of the two pictures that tracing holds at once.
const TRACE: u64 = 120;
/// Bytes for each pixel of the four pictures that filling holds at once.
const FILL: u64 = 320;

/// Number of frames, at most `threads`, that can be rendered at the same time.
///
/// # Errors
///
/// [`PipelineError::Memory`] if there is no memory for one.
pub fn frames_at_once(
    footage: &Footage,
    picture: &Picture,
    parts: usize,
    threads: usize,
) -> Result<usize, PipelineError> {
    let layers = if matches!(picture, Picture::Layers | Picture::Parts) { parts as u64 } else { 0 };
    let one = pixels(footage).saturating_mul(RENDER + RENDER_PART * layers);
    let fits = |count: &usize| memory::ask(one.saturating_mul(*count as u64)).is_ok();
    (2..=threads).rev().find(fits).map_or_else(|| ask(footage, one).map(|()| 1), Ok)
}

/// Checks that there is memory to track or snap the pictures of a footage.
///
/// # Errors
///
/// [`PipelineError::Memory`].
pub fn to_follow(footage: &Footage) -> Result<(), PipelineError> {
    ask(footage, pixels(footage).saturating_mul(FOLLOW))
}

/// Checks that there is memory to trace the pictures of a footage.
///
/// # Errors
///
/// [`PipelineError::Memory`].
pub fn to_trace(footage: &Footage) -> Result<(), PipelineError> {
    ask(footage, pixels(footage).saturating_mul(TRACE))
}

/// Checks that there is memory to fill the drawings of a footage.
///
/// # Errors
///
/// [`PipelineError::Memory`].
pub fn to_fill(footage: &Footage) -> Result<(), PipelineError> {
    ask(footage, pixels(footage).saturating_mul(FILL))
}

fn pixels(footage: &Footage) -> u64 {
    (footage.width as u64).saturating_mul(footage.height as u64)
}

fn ask(footage: &Footage, bytes: u64) -> Result<(), PipelineError> {
    let Footage { width, height, .. } = *footage;
    memory::ask(bytes).map_err(|source| PipelineError::Memory { width, height, source })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn footage(side: usize) -> Footage {
        Footage { pattern: "%d".into(), first: 0, last: 9, fps: 12.0, width: side, height: side, held: false }
    }

    #[test]
    fn small_pictures_are_rendered_by_all_threads_and_huge_ones_refused() {
        assert_eq!(frames_at_once(&footage(64), &Picture::Matte, 3, 4).unwrap(), 4);
        assert_eq!(frames_at_once(&footage(64), &Picture::Ids, 3, 1).unwrap(), 1);
        let error = frames_at_once(&footage(1 << 28), &Picture::Matte, 3, 4).unwrap_err().to_string();
        assert!(error.starts_with("footage.width, height: found 268435456x268435456 pixels: "), "{error}");
        assert!(to_follow(&footage(1 << 28)).is_err());
    }
}
