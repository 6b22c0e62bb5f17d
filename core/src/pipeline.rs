//! The pipeline joins the stages: it turns a document and the folder of its footage into a fuller document, pictures or
//! text.
//!
//! This is the only module that knows all stages. The result of a stage enters the document completely. After an error,
//! or when cancelled, the document is unchanged.

mod bare;
mod beyond;
mod breakdown;
pub mod cache;
mod check;
mod conform;
mod contradicted;
mod contrast;
mod doubts;
mod error;
mod excerpt;
mod fill;
mod gaps;
mod guesses;
mod holds;
mod imported;
mod keeping;
mod left_out;
pub mod memory;
mod order;
mod outdated;
mod outside;
mod paint;
mod picture;
mod recolour;
mod render;
mod report;
mod reshape;
mod seen;
mod shapeless;
mod shapes;
mod sheet;
mod sheet_drawn;
mod sheet_marks;
pub mod spans;
mod strokes;
mod style;
mod trace;
mod tween;
pub mod unchanged;
mod unseen;
mod untracked;

pub use beyond::{beyond, empty};
pub use breakdown::{Suggestion, suggest_breakdown};
pub use check::{check, drawing_problems};
pub use conform::{Conformed, NewFootage, conform};
pub use contradicted::{Contradiction, contradicted};
pub use doubts::{Doubt, doubts, traced_lines};
pub use error::PipelineError;
pub use excerpt::{Excerpt, excerpt};
pub use fill::{
    DOUBT, FillOptions, FillReport, FilledFrame, LeakingClick, MissedClick, Recoloured, VanishedColour, fill,
};
pub use gaps::held_gaps;
pub use guesses::{guessed_translation, guesses};
pub use imported::Imported;
pub use keeping::Earlier;
pub use left_out::{left_out_of_shapes, squeezed};
pub use outdated::outdated;
pub use outside::outside;
pub use paint::{Cels, undrawn};
pub use picture::{Picture, RenderJob};
pub use recolour::{colours, named as named_colours, recolour};
pub use render::render;
pub use report::{Counts, PartReport, Report, Together, Weakest};
pub use reshape::{Given, Mirror, ReshapeJob, Reshaped, Side, Sides, at_rate_of, reshape};
pub use seen::{Noted, changed};
pub use shapeless::nothing_for;
pub use shapes::{ShapeFormat, import_shifted};
pub use sheet::{Sheet, sheet};
pub use sheet_marks::no_picture;
pub use style::{CapturedClip, ClipJob, clip, translate, translate_and_judge};
pub use trace::{Kept, TraceMemory, TraceOptions, trace, trace_drawings};
pub use tween::{Tweened, captured, pegs_of, spacing_of, tween};
pub use unseen::unseen;
pub use untracked::untracked;

use crate::export::{self, Detail, ShapeOptions, SvgOptions, svg_with_drawn};
use crate::fit;
use crate::geometry::Point;
use crate::pictures::Sequence;
use crate::project::curves::{CurveGuides, Curves};
use crate::project::save::DECIMALS;
use crate::project::seen::{Made, Seen};
use crate::project::{Document, output, validate};
use crate::scene::{Footage, FrameNumber, Progress, Scene};
use crate::snap::{SnapOptions, snap_scene};
use crate::track::{TrackOptions, Tracker, Tracking};
use cache::FileCache;
use rayon::iter::{IndexedParallelIterator, IntoParallelRefIterator, ParallelIterator};
use std::collections::BTreeMap;
use std::io;
use std::ops::RangeInclusive;
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

/// The pictures of a document in `folder`.
///
/// # Errors
///
/// [`PipelineError::Pattern`].
pub fn frames(document: &Document, folder: &Path) -> Result<Sequence, PipelineError> {
    Ok(Sequence::new(&document.scene.footage, folder)?)
}

/// Fits a spline to each curve of a file, independently of the others. Returns the text of the file with guides in
/// place of the points. It runs on the caller's rayon pool, and the result does not depend on the pool.
///
/// # Errors
///
/// [`PipelineError::Fit`] for the first curve that cannot be fitted, or [`PipelineError::Cancelled`].
pub fn fit_curves(curves: &Curves, options: &fit::Options, progress: &dyn Progress) -> Result<String, PipelineError> {
    let (all, done) = (curves.curves.len(), AtomicUsize::new(0));
    let fitted = curves.curves.par_iter().enumerate().map(|(curve, line)| {
        let fitted =
            fit::fit(&line.points, line.closed, options).map_err(|source| PipelineError::Fit { curve, source })?;
        let finished = done.fetch_add(1, Ordering::Relaxed) + 1;
        progress.report("Fitting", finished as f64 / all as f64)?;
        let (spline, max_error) = (fitted.spline, fitted.max_error);
        Ok(CurveGuides { corners: spline.corners(), guides: spline.guides().to_vec(), max_error })
    });
    // Of several errors the one of the first curve is reported, whichever occurred first.
    let fitted: Vec<Result<CurveGuides, PipelineError>> = fitted.collect();
    let guides = fitted.into_iter().collect::<Result<Vec<_>, _>>()?;
    Ok(curves.with_guides(&guides))
}

/// Tracks every part of a document in `folder`. It runs on the caller's rayon pool.
///
/// # Errors
///
/// An invalid pattern, an unreadable frame, a failure of the tracker, or [`PipelineError::Cancelled`].
pub fn track(
    document: &mut Document,
    folder: &Path,
    options: &TrackOptions,
    progress: &dyn Progress,
) -> Result<Tracking, PipelineError> {
    track_by(document, folder, Tracker::new(*options), progress)
}

/// As [`track`]. What a cache knows is not computed again: spans whose keys, corrections and pictures are as they were. The result is the same.
///
/// # Errors
///
/// As for [`track`].
pub fn track_with_cache(
    document: &mut Document,
    folder: &Path,
    options: &TrackOptions,
    cache: &Arc<FileCache>,
    progress: &dyn Progress,
) -> Result<Tracking, PipelineError> {
    track_by(document, folder, Tracker::with_cache(*options, cache.clone()), progress)
}

fn track_by(
    document: &mut Document,
    folder: &Path,
    mut tracker: Tracker,
    progress: &dyn Progress,
) -> Result<Tracking, PipelineError> {
    let frames = frames(document, folder)?;
    memory::to_follow(&document.scene.footage)?;
    gaps::none(&frames, gaps::between_keys(&document.scene))?;
    let noted = Noted::new(&frames);
    let tracking = tracker.track(&in_effect(&document.scene), &noted, progress)?;
    store_seen(document, &tracking, noted.seen())?;
    Ok(tracking)
}

/// Puts tracks into the document, and the marks of the pictures that were read for them.
///
/// # Errors
///
/// [`PipelineError::Field`] for an invalid field `seen`; the document is then unchanged.
pub fn store_seen(
    document: &mut Document,
    tracking: &Tracking,
    mut seen: BTreeMap<FrameNumber, Seen>,
) -> Result<(), PipelineError> {
    seen.retain(|frame, _| tracking.parts.iter().any(|part| part.tracks.contains_key(frame)));
    document.set_seen(Made::Tracks, FrameNumber::MIN..=FrameNumber::MAX, &seen).map_err(|e| fill::field(&e))?;
    store(&mut document.scene, tracking);
    Ok(())
}

/// The drawings of the footage of a document in `folder`: the first and the last frame of each. Frames that differ by noise
/// alone show the same drawing.
///
/// # Errors
///
/// An invalid pattern, an unreadable frame, or [`PipelineError::Cancelled`].
pub fn held(
    document: &Document,
    folder: &Path,
    progress: &dyn Progress,
) -> Result<Vec<[FrameNumber; 2]>, PipelineError> {
    let footage = &document.scene.footage;
    let frames = Sequence::keeping(footage, folder, 0)?;
    memory::to_follow(footage)?;
    gaps::none(&frames, footage.first..=footage.last)?;
    Ok(crate::track::drawings(&frames, footage.first..=footage.last, None, progress)?)
}

/// The scene with only those corrections that have an effect. The document keeps the others, but no stage needs them.
pub fn in_effect(scene: &Scene) -> Scene {
    let mut scene = scene.clone();
    for part in &mut scene.parts {
        let (mut pins, mut centers) = (std::mem::take(&mut part.pins), std::mem::take(&mut part.centers));
        pins.retain(|frame, _| validate::acts(part, *frame));
        centers.retain(|frame, _| validate::acts(part, *frame));
        (part.pins, part.centers) = (pins, centers);
    }
    scene
}

/// Puts tracks into the scene. Snapped paths stay on frames whose contour is unchanged.
pub fn store(scene: &mut Scene, tracking: &Tracking) {
    for (part, found) in scene.parts.iter_mut().zip(&tracking.parts) {
        let before = std::mem::replace(&mut part.tracks, found.tracks.clone());
        let now = &part.tracks;
        part.curves.retain(|frame, _| match (now.get(frame), before.get(frame)) {
            (Some(now), Some(before)) => same_contour(now, before),
            // The path was snapped from a key that had no track.
            (Some(now), None) => part.keys.get(frame).is_some_and(|key| same_contour(now, key)),
            _ => false,
        });
        part.confidence = found.confidence.clone();
        part.wants_key = found.wants_key();
    }
}

/// Whether contours differ by no more than the rounding of a document.
fn same_contour(a: &[Point], b: &[Point]) -> bool {
    let tolerance = 10f64.powi(-DECIMALS);
    a.len() == b.len() && a.iter().zip(b).all(|(a, b)| (*a - *b).abs().max_element() <= tolerance)
}

/// Snaps every contour of a document in `folder` to the ink. It runs on the caller's rayon pool.
///
/// # Errors
///
/// An invalid pattern, an unreadable frame, a failure of snapping, or [`PipelineError::Cancelled`].
pub fn snap(
    document: &mut Document,
    folder: &Path,
    options: &SnapOptions,
    progress: &dyn Progress,
) -> Result<(), PipelineError> {
    let frames = frames(document, folder)?;
    memory::to_follow(&document.scene.footage)?;
    gaps::none(&frames, gaps::with_contours(&document.scene))?;
    let curves = snap_scene(&document.scene, &frames, options, progress)?;
    for (part, curves) in document.scene.parts.iter_mut().zip(curves) {
        part.curves = curves;
    }
    Ok(())
}

/// The frames that an option asks for, or all of the footage.
fn frames_of(
    footage: &Footage,
    asked: Option<RangeInclusive<FrameNumber>>,
) -> Result<RangeInclusive<FrameNumber>, PipelineError> {
    let own = footage.first..=footage.last;
    let Some(asked) = asked else { return Ok(own) };
    if asked.is_empty() || !own.contains(asked.start()) || !own.contains(asked.end()) {
        let ([first, last], [a, b]) = ([asked.start(), asked.end()], [own.start(), own.end()]);
        let reason = format!("found {first} to {last}, expected frames of the footage, {a} to {b}");
        return Err(PipelineError::option("frames", reason));
    }
    Ok(asked)
}

/// Exports the document as an animated SVG: its painted regions, its parts, and its strokes over them:
/// traced ones, in-betweens and drawings.
///
/// # Errors
///
/// [`PipelineError::Field`] if the fields `filled`, `traced`, `in_betweens` or `drawings` cannot be read.
pub fn export_svg(document: &Document, options: &SvgOptions) -> Result<String, PipelineError> {
    let (fills, strokes) = (fill::fills_to_export(document)?, strokes::to_export(document)?);
    Ok(svg_with_drawn(&document.scene, &fills, &strokes, options))
}

/// Exports the document as a RotoPaint node for Nuke. `options` say how it follows snapped paths, and how wide the pixels are.
pub fn export_nuke(document: &Document, options: impl Into<ShapeOptions>) -> String {
    export::nuke(&document.scene, options)
}

/// Exports the document as a script that makes a Roto node in Natron. `detail` says how it follows snapped paths.
pub fn export_natron(document: &Document, detail: impl Into<Detail>) -> String {
    export::natron(&document.scene, detail)
}

/// Exports the document as a project of Natron with a Roto node. `detail` says how it follows snapped paths.
pub fn export_natron_project(document: &Document, detail: impl Into<Detail>) -> String {
    export::natron_project(&document.scene, detail)
}

/// Exports the document as a script that makes masks in After Effects. `options` say how it follows snapped paths, and how wide the pixels are.
pub fn export_after_effects(document: &Document, options: impl Into<ShapeOptions>) -> String {
    export::after_effects(&document.scene, options)
}

/// Exports the document as Silhouette shapes. `options` say how it follows snapped paths, and how wide the pixels are.
pub fn export_silhouette(document: &Document, options: impl Into<ShapeOptions>) -> String {
    export::silhouette(&document.scene, options)
}

/// Exports the document as Polygon masks for Fusion. `options` say how it follows snapped paths, and how wide the pixels are.
pub fn export_fusion(document: &Document, options: impl Into<ShapeOptions>) -> String {
    export::fusion(&document.scene, options)
}

/// Width of a pixel of the footage in `folder` divided by its height: that of the first frame with a file that can be read, and 1 if no file says it.
pub fn pixel_aspect(document: &Document, folder: &Path) -> f64 {
    let Ok(sequence) = frames(document, folder) else { return 1.0 };
    f64::from(sequence.pixel_aspect())
}

/// Rewrites the relative footage pattern of a document that moves from folder `from` to folder `to`, so it still names
/// the same files. The new pattern is relative if a relative path exists, otherwise absolute.
///
/// # Errors
///
/// A folder on the way to the footage has a name that is no text. The document stays as it is.
pub fn relocate(document: &mut Document, from: &Path, to: &Path) -> io::Result<()> {
    if let Some(pattern) = relative_pattern(document) {
        *pattern = output::moved_pattern(pattern, from, to)?;
    }
    Ok(())
}

/// Makes the footage pattern of a document absolute that was in `folder` and goes where it has no folder: into a pipe.
///
/// # Errors
///
/// As for [`relocate`].
pub fn unfold(document: &mut Document, folder: &Path) -> io::Result<()> {
    if let Some(pattern) = relative_pattern(document) {
        *pattern = output::absolute_pattern(pattern, folder)?;
    }
    Ok(())
}

fn relative_pattern(document: &mut Document) -> Option<&mut String> {
    let pattern = &mut document.scene.footage.pattern;
    // On Windows a path without a drive may still begin at a root.
    let is_relative = Path::new(pattern).is_relative() && !Path::new(pattern).has_root();
    is_relative.then_some(pattern)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::export::Motion;
    use crate::render::form::{Bits, Packing};
    use crate::scene::parameters::{Kind, find};
    use crate::snap::CorridorWidth;
    use crate::track::Preset;

    fn choices(id: &str) -> Vec<&'static str> {
        let Kind::Choice { choices, .. } = find(id).unwrap().kind else { panic!("{id} is no choice") };
        choices.iter().map(|choice| choice.id).collect()
    }

    fn default(id: &str) -> f64 {
        let Kind::Number { default, .. } = find(id).unwrap().kind else { panic!("{id} is no number") };
        default
    }

    #[test]
    fn the_parameters_describe_the_stages() {
        assert_eq!(choices("preset"), Preset::ALL.map(|(_, id)| id));
        assert_eq!(choices("motion"), Motion::ALL.map(|(_, id)| id));
        let CorridorWidth { share, least, most } = CorridorWidth::default();
        assert_eq!([share, least, most], ["corridor_share", "corridor_least", "corridor_most"].map(default));
        assert_eq!(crate::render::OverlayOptions::default().line_width, default("line_width"));
        assert_eq!(SvgOptions::default().spacing, default("spacing"));
        assert_eq!(choices("exr"), Bits::ALL.map(|(_, id)| id));
        assert_eq!(choices("compression"), Packing::ALL.map(|(_, id)| id));
    }

    #[test]
    fn corrections_without_effect_reach_no_stage() {
        let json = r#"{"rototoon": 1, "footage": {"pattern": "%d", "first": 0, "last": 9, "fps": 1, "width": 9, "height": 9},
            "parts": [{"name": "a", "keys": {"2": [[1, 1]], "6": [[2, 2]]},
            "pins": {"2": {"0": [0, 0]}, "3": {"0": [0, 0]}, "8": {"0": [0, 0]}}, "centers": {"1": [0, 0], "4": [0, 0]}}]}"#;
        let document = Document::parse(json, "p").unwrap();
        let scene = in_effect(&document.scene);
        assert_eq!(scene.parts[0].pins.keys().collect::<Vec<_>>(), [&3]);
        assert_eq!(scene.parts[0].centers.keys().collect::<Vec<_>>(), [&4]);
    }
}
