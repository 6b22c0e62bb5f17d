//! A job type for Flamenco, Blender's farm manager: one JavaScript file for the manager's folder `scripts`.
//!
//! The manager shows the settings to whoever sends a job, and calls `compileJob`. Each task runs the worker command `exec`
//! (Flamenco 3.0 and later).

use super::{OnFailure, Places, Tells, words};
use serde_json::json;

/// The text of the job type.
pub fn job_type(failure: OnFailure) -> String {
    // These names are replaced by expressions of the script.
    let places = Places { manifest: "$manifest", output: "$output" };
    let list = |shots: Option<&str>| list(&words(places, shots, failure, Tells::Lines));
    SCRIPT.replace("$SHOTS", &list(Some("$shots"))).replace("$PAGE", &list(None))
}

/// Words as a list in JavaScript.
fn list(words: &[String]) -> String {
    let word = |word: &String| match word.as_str() {
        "$manifest" => "settings.manifest".to_owned(),
        "$output" => "settings.output".to_owned(),
        "$shots" => "`${first}-${last}`".to_owned(),
        other => json!(other).to_string(),
    };
    format!("[{}]", words.iter().map(word).collect::<Vec<_>>().join(", "))
}

const SCRIPT: &str = r#"// Rototoon's job type for Flamenco. Written by `rototoon job --for flamenco`.

const JOB_TYPE = {
    label: "Rototoon batch",
    settings: [
        { key: "manifest", type: "string", subtype: "file_path", required: true,
          description: "The file that names shots and steps" },
        { key: "output", type: "string", subtype: "dir_path", required: true,
          description: "The folder of the results" },
        { key: "shots", type: "int32", required: true, default: 1,
          description: "Number of shots in the manifest" },
        { key: "chunk_size", type: "int32", default: 4,
          description: "Shots that a worker gets at a time" },
        { key: "program", type: "string", default: "rototoon",
          description: "The command line program" },
    ]
};

function compileJob(job) {
    const settings = job.settings;
    const size = Math.max(1, settings.chunk_size);
    const page = author.Task("page", "misc");
    for (let first = 1; first <= settings.shots; first += size) {
        const last = Math.min(first + size - 1, settings.shots);
        const task = author.Task(`shots-${first}-${last}`, "misc");
        task.addCommand(author.Command("exec", {
            exe: settings.program,
            args: $SHOTS,
        }));
        job.addTask(task);
        page.addDependency(task);
    }
    page.addCommand(author.Command("exec", {
        exe: settings.program,
        args: $PAGE,
    }));
    job.addTask(page);
}
"#;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_calls_are_those_of_the_other_engines() {
        let script = job_type(OnFailure::GoOn);
        assert!(script.contains(
            r#"args: ["batch", settings.manifest, "-o", settings.output, "--shots", `${first}-${last}`, "--fine", "all", "--progress", "lines"],"#
        ));
        assert!(
            script.contains(
                r#"args: ["batch", settings.manifest, "-o", settings.output, "--summary", "--fine", "keys"],"#
            )
        );
        assert!(!script.contains("$SHOTS") && !script.contains("$PAGE"));
        assert_eq!(job_type(OnFailure::Fail).matches(r#""--fine", "keys""#).count(), 2);
    }
}
