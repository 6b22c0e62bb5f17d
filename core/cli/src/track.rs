//! `rototoon track`: tracks contours from the keys to every frame.

use crate::failure::{Failure, line};
use crate::{arguments, progress, project};
use clap::{Arg, ArgMatches, Command, value_parser};
use rototoon::pipeline::{self, Report};
use rototoon::project::write_whole;
use rototoon::scene::Scene;
use rototoon::scene::parameters::Stage;
use rototoon::track::{Ending, Preset, TrackEnd, TrackOptions, Tracking};
use std::path::PathBuf;
use std::sync::Arc;

/// The subcommand.
pub fn command() -> Command {
    Command::new("track")
        .about(
            "Tracks every part from its first key to its last. A part with a single key is tracked outward from it, as far \
             as the result is reliable",
        )
        .arg(arguments::project())
        .arg(arguments::output("OUT", "The document to write, with tracks and confidence"))
        .arg(
            Arg::new("report")
                .long("report")
                .value_name("FILE")
                .help("Also writes what became of each part as JSON: frames sure, doubtful and lost")
                .value_parser(value_parser!(PathBuf)),
        )
        .arg(arguments::cache(
            "Folder where tracks are kept. Spans with the same keys and pictures as before come from it",
        ))
        .args(arguments::of_stage(Stage::Track))
        .args(arguments::of_run())
}

/// Runs the subcommand.
pub fn run(given: &ArgMatches) -> Result<(), Failure> {
    let (from, to) = (arguments::path(given, "project"), arguments::path(given, "output"));
    let id = arguments::choice(given, "preset");
    let preset = Preset::from_id(id).ok_or_else(|| Failure::Use(format!("no preset {id:?}")))?;
    let mut document = project::load(from)?;
    let home = project::home(&document, from);
    let written = given.get_one::<PathBuf>("report");
    let inputs = project::inputs(&document, from);
    inputs.check(to)?;
    project::check_output(&document, from, to)?;
    if let Some(report) = written {
        project::check_report(report, &inputs, [from, to])?;
    }
    let options = TrackOptions { preset, ..TrackOptions::default() };
    let cache = arguments::cached(given).map(Arc::new);
    let (document, exchanges, contradicted) = progress::run(given, from, |bar| {
        let tracking = match &cache {
            Some(cache) => pipeline::track_with_cache(&mut document, &home, &options, cache, bar),
            None => pipeline::track(&mut document, &home, &options, bar),
        };
        let tracking = tracking.map_err(|error| Failure::of(error, from))?;
        say_kept(&tracking);
        say_ends(&document.scene, &tracking);
        let frames = pipeline::frames(&document, &home).map_err(|error| Failure::of(error, from))?;
        let contradicted = pipeline::contradicted(&document.scene, &frames, bar);
        let contradicted = contradicted.map_err(|error| Failure::of(error, from))?;
        Ok((document, tracking.exchanges, contradicted))
    })?;
    contradicted.iter().for_each(|found| line("note", &format!("part {:?}: {found}", found.part)));
    project::say_gaps(&document, from)?;
    let (report, beyond) = (Report::of(&document.scene, &exchanges), pipeline::beyond(&document.scene));
    project::save(document, from, to)?;
    if let Some(path) = written {
        let json = serde_json::to_vec_pretty(&report).map_err(|error| Failure::Other(error.to_string()))?;
        write_whole(path, &json)?;
    }
    report.lines().iter().chain(&beyond).for_each(|text| line("note", text));
    Ok(())
}

/// Prints how much was known before.
fn say_kept(tracking: &Tracking) {
    let (kept, all) = (tracking.jobs.iter().filter(|job| !job.solved).count(), tracking.jobs.len());
    if kept > 0 {
        let text = format!("{kept} of {all} spans have the keys and the pictures of an earlier run, and its tracks");
        line("note", &text);
    }
}

/// Prints where the tracks of parts with a single key end, and where these parts need a key.
fn say_ends(scene: &Scene, tracking: &Tracking) {
    for (part, track) in scene.parts.iter().zip(&tracking.parts) {
        for TrackEnd { frame, reason } in &track.ends {
            let what = match reason {
                Ending::Lost => format!("needs a key on frame {frame}: its track is lost there"),
                Ending::Cut => format!("ends before frame {frame}: another shot begins there"),
                Ending::Left => format!("ends before frame {frame}: it has left the picture"),
            };
            line("note", &format!("part {:?} {what}", part.name));
        }
    }
}
