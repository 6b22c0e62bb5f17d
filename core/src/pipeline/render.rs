//! Renders pictures of a document into files.

use super::paint::{Cels, sized};
use super::picture::{Picture, RenderJob};
use super::{PipelineError, excerpt, frames, frames_of, memory};
use crate::pictures::Sequence;
use crate::pictures::decode::Described;
use crate::project::{Document, Inputs, write_whole};
use crate::render::header::{self, BT709, Facts};
use crate::render::{self, Format};
use crate::scene::{Footage, FrameNumber, FrameSource, Progress, Scene};
use rayon::iter::{IntoParallelRefIterator, ParallelIterator};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicUsize, Ordering};

/// A render job after its check against the document.
struct Rendering {
    frames: Vec<(FrameNumber, PathBuf)>,
    parts: Option<Vec<usize>>,
    format: Format,
    /// The footage, with the size of the pictures.
    size: Footage,
    /// Width of a pixel divided by its height on frames without a file.
    aspect: f32,
    cels: Cels,
}

/// Renders frames of a document in `folder` and returns the paths of the files. Each file is written completely or not
/// at all. Where the footage has no picture for a frame that shows it, all other frames are rendered before the error. It runs on
/// the caller's rayon pool.
///
/// # Errors
///
/// [`PipelineError::Option`] if parts or frames do not fit the document; [`PipelineError::Request`] if the output does not fit
/// the job; [`PipelineError::Gaps`] if pictures of the footage are missing; errors of encoding and writing; or
/// [`PipelineError::Cancelled`].
pub fn render(
    document: &Document,
    folder: &Path,
    job: &RenderJob,
    progress: &dyn Progress,
) -> Result<Vec<PathBuf>, PipelineError> {
    let sequence = frames(document, folder)?;
    let plan = plan(document, &sequence, job)?;
    let (mut done, mut gaps, whole) = (0, Vec::new(), AtomicUsize::new(0));
    progress.report("Rendering", 0.0)?;
    progress.written(0, plan.frames.len());
    let footage = &plan.size;
    let parts = plan.parts.as_ref().map_or(document.scene.parts.len(), Vec::len);
    let at_once = memory::frames_at_once(footage, &job.picture, parts, rayon::current_num_threads().max(1))?;
    for batch in plan.frames.chunks(at_once) {
        let results: Vec<Result<(), PipelineError>> = batch
            .par_iter()
            .map(|(frame, path)| {
                write_whole(path, &picture(document, &sequence, job, &plan, *frame)?)?;
                progress.written(whole.fetch_add(1, Ordering::Relaxed) + 1, plan.frames.len());
                Ok(())
            })
            .collect();
        for ((frame, _), result) in batch.iter().zip(results) {
            match result {
                Err(PipelineError::Frame(error)) => gaps.push((*frame, error)),
                other => other?,
            }
        }
        done += batch.len();
        progress.report("Rendering", done as f64 / plan.frames.len() as f64)?;
    }
    if !gaps.is_empty() {
        let drawn = Some([plan.frames.len() - gaps.len(), plan.frames.len()]);
        return Err(PipelineError::Gaps { gaps, drawn });
    }
    Ok(plan.frames.into_iter().map(|(_, path)| path).collect())
}

fn picture(
    document: &Document,
    sequence: &Sequence,
    job: &RenderJob,
    plan: &Rendering,
    frame: FrameNumber,
) -> Result<Vec<u8>, PipelineError> {
    let parts = plan.parts.as_deref();
    let bytes = match &job.picture {
        Picture::Matte => render::encode::matte(&render::matte(&document.scene, frame, parts), plan.format),
        Picture::Cutout => {
            let pixels = sequence.layer(frame)?;
            render::encode::layer(&render::cutout(&document.scene, frame, &pixels, parts), plan.format)
        }
        Picture::Layers => render::matte_layers(&document.scene, frame, parts, job.form),
        Picture::Parts => render::matte_parts(&document.scene, frame, parts, job.form),
        Picture::Ids => render::id_picture(&document.scene, frame, parts, plan.format),
        Picture::Paint | Picture::Lines | Picture::Cel => {
            let shown = plan.cels.on(frame, job.scale);
            render::paint_picture(&shown, plan.size.width, plan.size.height, plan.format)
        }
        Picture::Painted => {
            let drawing = sequence.layer(frame)?;
            render::encode::layer(&plan.cels.under(frame, &drawing), plan.format)
        }
        Picture::Overlay(options) => {
            let below = sequence.picture(frame)?;
            render::encode::colours(&render::overlay(&document.scene, frame, &below, parts, options), plan.format)
        }
    };
    let bytes = bytes.map_err(|source| PipelineError::Encode { frame, source })?;
    Ok(if matches!(plan.format, Format::Exr(_)) { described(bytes, sequence, job, plan, frame) } else { bytes })
}

/// An OpenEXR file with what is known of its pixels. What shows the footage has the footage's colours.
fn described(bytes: Vec<u8>, sequence: &Sequence, job: &RenderJob, plan: &Rendering, frame: FrameNumber) -> Vec<u8> {
    let own = sequence.described(frame).unwrap_or(Described { pixel_aspect: plan.aspect, ..Described::default() });
    let shows_footage = matches!(job.picture, Picture::Overlay(_) | Picture::Cutout | Picture::Painted);
    let facts = Facts {
        pixel_aspect: own.pixel_aspect,
        chromaticities: own.chromaticities.filter(|_| shows_footage).unwrap_or(BT709),
        fps: plan.size.fps,
        // The code of a file that a frame holds is that of an earlier frame.
        time_code: own.time_code.filter(|_| sequence.shown(frame) == frame),
    };
    header::describe(bytes, &facts)
}

fn plan(document: &Document, sequence: &Sequence, job: &RenderJob) -> Result<Rendering, PipelineError> {
    let footage = &document.scene.footage;
    let format = job.format()?;
    let range = frames_of(footage, job.frames.clone())?;
    excerpt::shifted(footage, job.offset)?;
    let first = *range.start();
    let frames: Vec<(FrameNumber, PathBuf)> = match job.pattern(first == *range.end())? {
        Some(pattern) => range.map(|frame| (frame, pattern.path(frame.saturating_add(job.offset)))).collect(),
        None => vec![(first, PathBuf::from(&job.output))],
    };
    let inputs = Inputs::default().footage(footage, sequence.folder());
    for (frame, path) in &frames {
        inputs.check(path).map_err(|error| PipelineError::Request(format!("frame {frame}: {error}")))?;
    }
    // First, because regions and strokes have no parts to be chosen.
    let cels = Cels::of(document, job)?;
    Ok(Rendering {
        frames,
        parts: job.parts.as_ref().map(|names| indices(&document.scene, names)).transpose()?,
        format,
        size: sized(footage, job)?,
        aspect: if matches!(format, Format::Exr(_)) { sequence.pixel_aspect() } else { 1.0 },
        cels,
    })
}

pub(super) fn indices(scene: &Scene, names: &[String]) -> Result<Vec<usize>, PipelineError> {
    let index = |name: &String| scene.part_index(name).map_err(|error| PipelineError::option("parts", error));
    names.iter().map(index).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Point;
    use crate::pictures::decode::described;
    use crate::render::form::Form;
    use crate::scene::{Part, Raster, Silent};

    /// Writes an OpenEXR frame with this time code.
    fn plate(path: &Path, code: u32) {
        let picture = Raster::new(16, 12, [0.5; 3]);
        let bytes = render::encode::colours(&picture, Format::of(path).unwrap()).unwrap();
        let facts = Facts { pixel_aspect: 1.0, chromaticities: BT709, fps: 24.0, time_code: Some([code, 0]) };
        std::fs::write(path, header::describe(bytes, &facts)).unwrap();
    }

    #[test]
    fn a_frame_that_holds_an_earlier_file_has_not_its_time_code() {
        let folder = tempfile::tempdir().unwrap();
        let at = |name: &str, frame: FrameNumber| folder.path().join(format!("{name}_{frame}.exr"));
        plate(&at("a", 1), 0x0100_0001);
        plate(&at("a", 3), 0x0100_0003);
        let footage =
            Footage { pattern: "a_%d.exr".into(), first: 1, last: 4, fps: 24.0, width: 16, height: 12, held: true };
        let keys = [1, 4].map(|frame| (frame, vec![Point::ZERO, Point::X, Point::Y])).into();
        let part = Part { name: "arm".into(), closed: true, keys, ..Part::default() };
        let job = RenderJob {
            picture: Picture::Matte,
            frames: None,
            offset: 0,
            parts: None,
            scale: 1.0,
            form: Form::default(),
            output: at("m", 0).to_string_lossy().replace("m_0", "m_%d"),
        };
        render(&Document::new(Scene { footage, parts: vec![part] }), folder.path(), &job, &Silent).unwrap();
        let codes = [1, 2, 3, 4].map(|frame| described(&at("m", frame)).unwrap().time_code);
        assert_eq!(codes, [Some([0x0100_0001, 0]), None, Some([0x0100_0003, 0]), None]);
    }
}
