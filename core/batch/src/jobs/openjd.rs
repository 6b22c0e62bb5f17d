//! A job template for Open Job Description, specification `jobtemplate-2023-09` with the extension `TASK_CHUNKING`.
//!
//! The engine divides the places of the shots into chunks and starts the program for each. The step `Page` waits for all
//! of them. The program says how far it is in lines `openjd_progress: 42.0`, a percentage, and `openjd_status: TEXT` on standard output.

use super::{OnFailure, Places, Tells, words};
use serde_json::{Value, json};

/// Greatest number of letters of a job's name.
const LONGEST_NAME: usize = 128;

/// The template for a number of shots. `chunk` is the number of shots that the program gets at a time. `manifest` and
/// `output` are the defaults of the parameters, relative to the template's folder: the specification allows no others. A
/// parameter without a default is asked for when the job is sent.
pub fn template(
    name: &str,
    (shots, chunk): (usize, usize),
    failure: OnFailure,
    manifest: Option<&str>,
    output: Option<&str>,
) -> Value {
    let places = Places { manifest: "{{Param.Manifest}}", output: "{{Param.Output}}" };
    let run = |shots: Option<&str>| json!({"onRun": {"command": "{{Param.Program}}", "args": words(places, shots, failure, Tells::Openjd)}});
    let path = |name: &str, kind: &str, flow: &str, default: Option<&str>, description: &str| {
        let mut parameter =
            json!({"name": name, "type": "PATH", "objectType": kind, "dataFlow": flow, "description": description});
        if let Some(default) = default {
            parameter["default"] = json!(default);
        }
        parameter
    };
    let chunks = json!({"defaultTaskCount": chunk.max(1), "rangeConstraint": "CONTIGUOUS"});
    json!({
        "specificationVersion": "jobtemplate-2023-09",
        "extensions": ["TASK_CHUNKING"],
        "name": job_name(name),
        "parameterDefinitions": [
            path("Manifest", "FILE", "IN", manifest, "The file that names shots and steps"),
            path("Output", "DIRECTORY", "OUT", output, "The folder of the results"),
            {"name": "Program", "type": "STRING", "default": "rototoon", "description": "The command line program"}
        ],
        "steps": [
            {
                "name": "Shots",
                "parameterSpace": {"taskParameterDefinitions": [
                    {"name": "Shot", "type": "CHUNK[INT]", "range": format!("1-{shots}"), "chunks": chunks}
                ]},
                "script": {"actions": run(Some("{{Task.Param.Shot}}"))}
            },
            {"name": "Page", "dependencies": [{"dependsOn": "Shots"}], "script": {"actions": run(None)}}
        ]
    })
}

/// A name without signs that a template does not allow, or that would be filled in.
fn job_name(name: &str) -> String {
    let plain: String = name.chars().filter(|c| !c.is_control() && !"{}".contains(*c)).take(LONGEST_NAME - 9).collect();
    format!("Rototoon {}", plain.trim()).trim().to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_shot_is_in_the_range() {
        let template = template("night {7}", (20, 3), OnFailure::GoOn, Some("m.json"), None);
        let space = &template["steps"][0]["parameterSpace"]["taskParameterDefinitions"][0];
        assert_eq!((&space["range"], &space["chunks"]["defaultTaskCount"]), (&json!("1-20"), &json!(3)));
        assert_eq!(template["name"], "Rototoon night 7");
        let default = |parameter: usize| template["parameterDefinitions"][parameter].get("default");
        assert_eq!((default(0), default(1)), (Some(&json!("m.json")), None));
        let args = |step: usize| template["steps"][step]["script"]["actions"]["onRun"]["args"].clone();
        let common = ["batch", "{{Param.Manifest}}", "-o", "{{Param.Output}}"];
        assert_eq!(
            args(0),
            json!([&common[..], &["--shots", "{{Task.Param.Shot}}", "--fine", "all", "--progress", "openjd"]].concat())
        );
        assert_eq!(args(1), json!([&common[..], &["--summary", "--fine", "keys"]].concat()));
        let strict = super::template("night", (20, 3), OnFailure::Fail, None, None);
        assert_eq!(strict["steps"][0]["script"]["actions"]["onRun"]["args"][7], "keys", "{strict}");
    }
}
