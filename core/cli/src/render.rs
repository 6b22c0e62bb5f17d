//! `rototoon render`: draws pictures of the result.

use crate::failure::{Failure, line};
use crate::{arguments, progress, project};
use clap::{ArgMatches, Command};
use rototoon::pipeline::{self, Picture, PipelineError, RenderJob};
use rototoon::project::Document;
use rototoon::project::output::check_writable;
use rototoon::project::seen::Made;
use rototoon::render::form::{Bits, Form, Packing};
use rototoon::render::{Format, OverlayOptions};
use rototoon::scene::parameters::Stage;
use rototoon::scene::{Footage, FrameNumber, FramePattern};
use std::collections::BTreeSet;
use std::ops::RangeInclusive;
use std::path::{Path, PathBuf};

/// The subcommand.
pub fn command() -> Command {
    Command::new("render")
        .about("Draws the contours over the footage, the parts' matte, the parts cut out, a picture of part ids, painted regions, or strokes")
        .arg(arguments::project())
        .arg(arguments::output(
            "PATTERN",
            "The files to write, such as out.%04d.exr or out.%04d.png; for one frame also a plain name",
        ))
        .args(arguments::of_stage(Stage::Render))
        .arg(arguments::frames())
        .arg(arguments::frame_offset(
            "What is added to a frame's number in the name of its file: with 1000, frame 1 becomes 1001",
        ))
        .arg(arguments::parts("Draws only the part of this name; may be given several times"))
        .args(arguments::of_run())
}

/// What the options ask for.
fn job(given: &ArgMatches) -> Result<RenderJob, Failure> {
    let output = arguments::path(given, "output");
    let output = output.to_str().ok_or_else(|| Failure::Use(format!("{}: expected UTF-8 text", output.display())))?;
    let (layers, parts) = (arguments::flag(given, "layers"), arguments::flag(given, "multipart"));
    if layers && parts {
        return Err(Failure::Use("found --layers on and --multipart on: expected one of them".to_owned()));
    }
    let what = arguments::choice(given, "what");
    let unused: &[&str] = match what {
        "matte" => &["line_width", "points", "confidence"],
        "overlay" => &["layers", "multipart"],
        _ => &["layers", "multipart", "line_width", "points", "confidence"],
    };
    arguments::without(given, unused, &format!("with --what {what}"))?;
    if Format::of(Path::new(output)) == Some(Format::Png) {
        arguments::without(given, &["exr", "compression"], "for a .png file")?;
    }
    Ok(RenderJob {
        picture: match what {
            "matte" if layers => Picture::Layers,
            "matte" if parts => Picture::Parts,
            "matte" => Picture::Matte,
            "cutout" => Picture::Cutout,
            "ids" => Picture::Ids,
            "paint" => Picture::Paint,
            "painted" => Picture::Painted,
            "lines" => Picture::Lines,
            "cel" => Picture::Cel,
            _ => Picture::Overlay(OverlayOptions {
                line_width: arguments::number(given, "line_width"),
                points: arguments::flag(given, "points"),
                confidence: arguments::flag(given, "confidence"),
            }),
        },
        frames: arguments::range(given),
        offset: arguments::offset(given),
        parts: arguments::names(given),
        scale: arguments::number(given, "scale"),
        form: Form {
            bits: Bits::from_id(arguments::choice(given, "exr")).unwrap_or_default(),
            packing: Packing::from_id(arguments::choice(given, "compression")).unwrap_or_default(),
        },
        output: output.to_owned(),
    })
}

/// What is wrong with the options, whatever the document.
pub fn check(given: &ArgMatches) -> Result<(), String> {
    let job = job(given).map_err(|failure| failure.to_string())?;
    job.check().map_err(|error| error.to_string())
}

/// Runs the subcommand.
pub fn run(given: &ArgMatches) -> Result<(), Failure> {
    let from = arguments::path(given, "project");
    let job = job(given)?;
    let output = job.output.as_str();
    let drawn = job.picture.shows_regions() || job.picture.shows_strokes();
    let document = if drawn { project::load_drawn(from)? } else { project::load(from)? };
    let home = project::home(&document, from);
    probed(&job, &document.scene.footage).iter().try_for_each(|file| check_writable(file))?;
    let mut has_gaps = false;
    let done = progress::run(given, from, |bar| {
        pipeline::render(&document, &home, &job, bar).map_err(|error| {
            has_gaps = matches!(error, PipelineError::Gaps { .. });
            Failure::of(error, from)
        })
    });
    // Where some pictures are missing, the others were drawn and may be wrong all the same.
    let told = if done.is_ok() || has_gaps { warnings(&document, &home, &job) } else { Ok(Vec::new()) };
    told.iter().flatten().for_each(|warning| line("warning", &format!("{output}: {warning}")));
    done?;
    told.map(drop).map_err(|error| Failure::of(error, from))
}

/// What is told of pictures that were drawn.
fn warnings(document: &Document, home: &Path, job: &RenderJob) -> Result<Vec<String>, PipelineError> {
    let drawn = job.picture.shows_regions() || job.picture.shows_strokes();
    let contours = !drawn && job.frames.is_none();
    let made: Vec<Made> = [
        (job.picture.shows_regions(), Made::Filled),
        (job.picture.shows_strokes(), Made::Traced),
        (!drawn, Made::Tracks),
    ]
    .into_iter()
    .filter_map(|(shows, made)| shows.then_some(made))
    .collect();
    let told = [
        if drawn { pipeline::undrawn(document, job) } else { pipeline::untracked(&document.scene) },
        pipeline::outdated(&document.scene),
        contours.then(|| pipeline::outside(&document.scene)).flatten(),
    ];
    let changed = pipeline::changed(document, home, &made, job.frames.as_ref())?;
    Ok(told.into_iter().flatten().chain(pipeline::empty(document, job)).chain(changed).collect())
}

/// The files that show whether the pictures of a job can be written: one in each folder. In the pattern `%%` stands for a percent sign, in the name of
/// its folder too, which may have the number of the frame.
fn probed(job: &RenderJob, footage: &Footage) -> BTreeSet<PathBuf> {
    let output = Path::new(&job.output);
    let Ok(pattern) = FramePattern::parse(&job.output) else { return [output.to_owned()].into() };
    let file = output.file_name().unwrap_or_default();
    let asked = job.frames.clone().unwrap_or(footage.first..=footage.last);
    // Of frames that the footage does not have there may be very many; rendering refuses them before it writes.
    if *asked.start() < footage.first || *asked.end() > footage.last {
        return BTreeSet::new();
    }
    asked.map(|frame| pattern.path(frame.saturating_add(job.offset)).with_file_name(file)).collect()
}

/// Reads frames in the form `A-B` or `A`. Both may be negative.
pub fn range(text: &str) -> Result<RangeInclusive<FrameNumber>, String> {
    let wrong = || "expected frames such as 3-9, or one frame such as 3".to_owned();
    // The first character is a sign or a digit, so the next dash is the separator.
    let at = text.char_indices().skip(1).find(|(_, c)| *c == '-').map(|(at, _)| at);
    let (first, last) = at.map_or((text, text), |at| (&text[..at], &text[at + 1..]));
    let (first, last) = (first.parse().map_err(|_| wrong())?, last.parse().map_err(|_| wrong())?);
    if first > last {
        Err(format!("found first frame {first} and last frame {last}, expected the first one not to be the greater"))
    } else {
        Ok(first..=last)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ranges() {
        for (text, expected) in [("3", 3..=3), ("3-9", 3..=9), ("-5--1", -5..=-1), ("-5-2", -5..=2), ("-4", -4..=-4)] {
            assert_eq!(range(text), Ok(expected), "{text}");
        }
        for text in ["", "a", "3-", "-", "9-3", "1-2-3", "é-1"] {
            assert!(range(text).is_err(), "{text}");
        }
    }
}
