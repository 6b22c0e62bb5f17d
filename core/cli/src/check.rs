//! `rototoon check`: lists every problem of a document and its frames.

use crate::failure::{Failure, line};
use crate::progress::{self, Part};
use crate::{arguments, project};
use clap::{ArgMatches, Command};
use rototoon::pipeline;
use rototoon::project::{Document, Problems, Severity};
use rototoon::scene::FrameNumber;
use std::path::{Component, Path};

/// The subcommand.
pub fn command() -> Command {
    Command::new("check")
        .about("Lists every problem of a document and its frames; the exit status is 0 if there are no errors")
        .arg(arguments::project())
        .arg(arguments::switch(
            "drawings",
            "Also lists the drawings: frames that are held, with noise or without it, are one drawing",
        ))
        .args(arguments::of_run())
}

/// Runs the subcommand.
pub fn run(given: &ArgMatches) -> Result<(), Failure> {
    let path = arguments::path(given, "project");
    let document = Document::load(path)?;
    let home = project::home(&document, path);
    let failed = |error| Failure::of(error, path);
    let is_asked = arguments::is_on(given, "drawings");
    let (problems, drawings) = progress::run(given, path, |bar| {
        let problems = pipeline::check(&document, &home, &Part::first(bar, is_asked)).map_err(failed)?;
        if !is_asked || problems.error_count() > 0 {
            return Ok((problems, None));
        }
        // What was found is told, whatever comes after it.
        let drawings = pipeline::held(&document, &home, &Part::second(bar)).map_err(failed);
        let drawings = drawings.inspect_err(|_| drop(say(&document, &problems, path)))?;
        Ok((problems, Some(drawings)))
    })?;
    say(&document, &problems, path)?;
    if problems.error_count() > 0 {
        return Err(Failure::Reported);
    }
    if let Some(beyond) = pipeline::beyond(&document.scene) {
        line("note", &format!("{}: {beyond}", path.display()));
    }
    if let Some(drawings) = drawings {
        line("note", &format!("{}: {}", path.display(), listed(&drawings)));
    }
    line("note", &format!("{}: usable{}", path.display(), with(problems.warning_count())));
    Ok(())
}

/// Says what was found.
fn say(document: &Document, problems: &Problems, path: &Path) -> Result<(), Failure> {
    if let Some(outside) = outside(&document.scene.footage.pattern) {
        line("note", &format!("{}: footage.pattern: {outside}", path.display()));
    }
    project::say_gaps(document, path)?;
    for problem in problems.iter() {
        let kind = if problem.severity == Severity::Error { "error" } else { "warning" };
        line(kind, &format!("{}: {problem}", path.display()));
    }
    for (count, kind) in [(problems.left_off().0, "error"), (problems.left_off().1, "warning")] {
        if count > 0 {
            line(kind, &format!("{}: and {count} more {kind}s", path.display()));
        }
    }
    Ok(())
}

/// The drawings in words: "5 frames show 3 drawings: 0-1, 2, 3-4", "1 frame shows 1 drawing: 7".
fn listed(drawings: &[[FrameNumber; 2]]) -> String {
    let frames: i64 = drawings.iter().map(|[first, last]| i64::from(*last) - i64::from(*first) + 1).sum();
    let range = |&[first, last]: &[FrameNumber; 2]| {
        if first == last { first.to_string() } else { format!("{first}-{last}") }
    };
    let ranges: Vec<String> = drawings.iter().map(range).collect();
    let shows = if frames == 1 { "frame shows" } else { "frames show" };
    let noun = if drawings.len() == 1 { "drawing" } else { "drawings" };
    format!("{frames} {shows} {} {noun}: {}", drawings.len(), ranges.join(", "))
}

/// How many warnings there are, if any.
fn with(warnings: usize) -> String {
    match warnings {
        0 => String::new(),
        1 => ", with 1 warning".to_owned(),
        more => format!(", with {more} warnings"),
    }
}

/// Says that the frames are not below the document's folder. Every command then reads files from elsewhere.
fn outside(pattern: &str) -> Option<String> {
    let path = Path::new(pattern);
    let mut depth = 0i64;
    let leaves = path.components().any(|component| {
        depth += match component {
            Component::ParentDir => -1,
            Component::Normal(_) => 1,
            Component::CurDir | Component::RootDir | Component::Prefix(_) => 0,
        };
        depth < 0
    });
    // On Windows a path with only a root or only a drive is not absolute, and leaves the folder all the same.
    let elsewhere = path.has_root() || matches!(path.components().next(), Some(Component::Prefix(_)));
    (elsewhere || leaves).then(|| format!("the frames {pattern:?} are read from outside the document's folder"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn patterns_that_leave_the_folder_are_named() {
        for (pattern, leaves) in [
            ("f_%03d.png", false),
            ("frames/../frames/f_%03d.png", false),
            ("./a/b_%d.png", false),
            ("../f_%03d.png", true),
            ("a/../../f_%d.png", true),
            ("/tmp/f_%d.png", true),
        ] {
            assert_eq!(outside(pattern).is_some(), leaves, "{pattern}");
        }
    }
}
