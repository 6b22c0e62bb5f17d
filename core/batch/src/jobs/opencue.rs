//! A job for OpenCue: one Python script that makes an outline with the package `opencue-pyoutline` and sends it.
//!
//! An outline's layer is a list of commands, one for each chunk of shots. The layer `page` waits for all of them.

use super::{OnFailure, Places, Tells, words};
use serde_json::json;

/// The text of the script for a number of shots. `chunk` is the number of shots that a command gets.
pub fn outline(name: &str, shots: usize, chunk: usize, failure: OnFailure) -> String {
    // These names are replaced by expressions of the script.
    let places = Places { manifest: "$manifest", output: "$output" };
    SCRIPT
        .replace("$NAME", &json!(job_name(name)).to_string())
        .replace("$COUNT", &shots.to_string())
        .replace("$CHUNK", &chunk.max(1).to_string())
        .replace("$SHOTS", &list(&words(places, Some("$shots"), failure, Tells::Lines)))
        .replace("$PAGE", &list(&words(places, None, failure, Tells::Lines)))
}

/// Letters, digits, `_` and `-`: OpenCue makes folders of it.
fn job_name(name: &str) -> String {
    let plain: String =
        name.chars().map(|c| if c.is_ascii_alphanumeric() || "_-".contains(c) { c } else { '_' }).take(100).collect();
    format!("rototoon_{plain}")
}

/// Words as a list in Python.
fn list(words: &[String]) -> String {
    let word = |word: &String| match word.as_str() {
        "$manifest" => "settings.manifest".to_owned(),
        "$output" => "settings.output".to_owned(),
        "$shots" => "f\"{first}-{min(first + CHUNK - 1, SHOTS)}\"".to_owned(),
        other => json!(other).to_string(),
    };
    let words: Vec<_> = ["settings.program".to_owned()].into_iter().chain(words.iter().map(word)).collect();
    format!("[{}]", words.join(", "))
}

const SCRIPT: &str = r#"# Rototoon's job for OpenCue. Written by `rototoon job --for opencue`.
"""Sends a batch to OpenCue: python FILE MANIFEST RESULTS [--program rototoon] [--name NAME]

The paths must be the same on all machines. It needs the packages opencue-pyoutline and packaging.
"""
import argparse
import os
import sys

import outline
import outline.cuerun
from outline.modules.shell import ShellCommand, ShellSequence

NAME = $NAME
SHOTS, CHUNK = $COUNT, $CHUNK


def job(settings):
    """The outline: commands for the shots, and one for the page that waits for all of them."""
    made = outline.Outline(settings.name)
    firsts = range(1, SHOTS + 1, CHUNK)
    commands = [$SHOTS for first in firsts]
    made.add_layer(ShellSequence("shots", commands=commands))
    page = ShellCommand("page", command=$PAGE)
    made.add_layer(page)
    page.depend_all("shots")
    return made


def arguments(words):
    """The arguments of the script."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("manifest", type=os.path.abspath)
    parser.add_argument("output", type=os.path.abspath)
    parser.add_argument("--program", default="rototoon")
    parser.add_argument("--name", default=NAME)
    return parser.parse_args(words)


if __name__ == "__main__":
    outline.cuerun.launch(job(arguments(sys.argv[1:])))
"#;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_calls_are_those_of_the_other_engines() {
        let script = outline("night \"7\"", 20, 6, OnFailure::GoOn);
        for line in [
            "NAME = \"rototoon_night__7_\"\nSHOTS, CHUNK = 20, 6\n",
            r#"[settings.program, "batch", settings.manifest, "-o", settings.output, "--shots", f"{first}-{min(first + CHUNK - 1, SHOTS)}", "--fine", "all", "--progress", "lines"]"#,
            r#"command=[settings.program, "batch", settings.manifest, "-o", settings.output, "--summary", "--fine", "keys"])"#,
        ] {
            assert!(script.contains(line), "{line}\n{script}");
        }
        assert!(!script.contains('$'));
        let strict = outline("night", 20, 6, OnFailure::Fail);
        assert_eq!(strict.matches(r#""--fine", "keys""#).count(), 2, "{strict}");
    }
}
