//! `rototoon check`: lists every problem of a document and its frames.

use crate::failure::{Failure, line};
use crate::{arguments, progress, project};
use clap::{ArgMatches, Command};
use rototoon::pipeline;
use rototoon::project::{Document, Severity};
use rototoon::scene::parameters::Stage;
use std::path::{Component, Path};

/// The subcommand.
pub fn command() -> Command {
    Command::new("check")
        .about("Lists every problem of a document and its frames; the exit status is 0 if there are no errors")
        .arg(arguments::project())
        .args(arguments::of_stage(Stage::Run))
}

/// Runs the subcommand.
pub fn run(given: &ArgMatches) -> Result<(), Failure> {
    let path = arguments::path(given, "project");
    let document = Document::load(path)?;
    let problems =
        progress::run(arguments::threads(given), |bar| Ok(pipeline::check(&document, project::folder(path), bar)?))?;
    if let Some(outside) = outside(&document.scene.footage.pattern) {
        line("note", &format!("{}: footage.pattern: {outside}", path.display()));
    }
    for problem in problems.iter() {
        let kind = if problem.severity == Severity::Error { "error" } else { "warning" };
        line(kind, &format!("{}: {problem}", path.display()));
    }
    for (count, kind) in [(problems.left_off().0, "error"), (problems.left_off().1, "warning")] {
        if count > 0 {
            line(kind, &format!("{}: and {count} more {kind}s", path.display()));
        }
    }
    if problems.error_count() > 0 { Err(Failure::Reported) } else { Ok(()) }
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
    (path.is_absolute() || leaves)
        .then(|| format!("the frames {pattern:?} are read from outside the document's folder"))
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
