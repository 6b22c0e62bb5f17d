//! `demo`: runs the main workflow in real Blender, on the sample cartoon or on any project document.

use crate::bundle::{Bundle, Packager, bundle};
use crate::shell::{command, empty_folder, root, run, target};
use anyhow::{Context, Result, ensure};
use rototoon_tests::measure::{Figures, Row, figures, measure};
use rototoon_tests::{sample, sheet};
use serde_json::Value;
use std::fmt::Write;
use std::path::{Path, PathBuf};
use std::process::Command;

/// Number of pictures on the contact sheet.
const PICTURES: usize = 12;

/// Builds and installs the extension, tracks and snaps with it, and writes the results to `target/demo`.
pub fn demo(project: Option<PathBuf>, blender: Option<PathBuf>) -> Result<()> {
    let blender =
        blender.map(|path| path.canonicalize().with_context(|| format!("no Blender at {path:?}"))).transpose()?;
    let project =
        project.map(|path| path.canonicalize().with_context(|| format!("no project at {path:?}"))).transpose()?;
    let packager = match blender {
        Some(binary) => Packager::Blender(binary),
        None => Packager::from_wheel()?,
    };
    let bundle = bundle(&packager)?;
    let out = target().join("demo");
    empty_folder(&out)?;
    let project = match project {
        Some(path) => path,
        None => {
            sample::write(&out.join("sample"))?;
            out.join("sample/project.json")
        }
    };
    println!("demo: {} in Blender", project.display());
    run(script(&packager)
        .args(["--pictures", &PICTURES.to_string(), "--zip"])
        .arg(&bundle.zip)
        .arg("--project")
        .arg(&project)
        .arg("--out")
        .arg(&out))?;
    let tracked = out.join("tracked.json");
    export(&bundle, &tracked, &out.join("tracks.svg"))?;
    let report = document(&out.join("report.json"))?;
    contact_sheet(&report, &document(&tracked)?, &out)?;
    let table = table(&project, &document(&tracked)?, &report)?;
    std::fs::write(out.join("table.md"), &table)?;
    println!("\n{table}");
    for (file, what) in [
        ("demo.blend", "the Blender file"),
        ("contact.png", "rendered strokes over the footage"),
        ("tracks.svg", "the parts as animated paths"),
        ("tracked.json", "the tracked project document"),
        ("table.md", "this table"),
    ] {
        let path = out.join(file);
        ensure!(path.exists(), "{path:?} was not written");
        println!("{:<32} {what}", path.strip_prefix(root()).unwrap_or(&path).display());
    }
    Ok(())
}

/// The command that runs the script inside Blender, with a Blender configuration of its own.
fn script(packager: &Packager) -> Command {
    let script = root().join("tests/blender/demo.py");
    let mut start = match packager {
        Packager::Wheel(interpreter) => {
            let mut start = command(interpreter);
            start.arg(script);
            start
        }
        Packager::Blender(binary) => {
            let mut start = command(binary);
            start
                .args(["--background", "--factory-startup", "--python-exit-code", "1", "--python"])
                .arg(script)
                .arg("--");
            start
        }
    };
    start.env("BLENDER_USER_RESOURCES", target().join("demo/blender-user")).env_remove("ROTOTOON_LIBRARY");
    start
}

fn export(bundle: &Bundle, tracked: &Path, svg: &Path) -> Result<()> {
    run(command(&bundle.cli).arg("export").arg(tracked).arg("-o").arg(svg))
}

fn document(path: &Path) -> Result<Value> {
    let text = std::fs::read_to_string(path).with_context(|| format!("cannot read {path:?}"))?;
    serde_json::from_str(&text).with_context(|| format!("cannot read {path:?}"))
}

/// Makes the contact sheet: the rendered strokes over their frames.
fn contact_sheet(report: &Value, tracked: &Value, out: &Path) -> Result<()> {
    let pattern = tracked["footage"]["pattern"].as_str().context("footage.pattern is not a text")?;
    let renders = report["renders"].as_object().context("report.json: no renders")?;
    let mut pictures = renders
        .iter()
        .map(|(frame, path)| {
            let number: i32 = frame.parse()?;
            let footage = out.join(rototoon_tests::sheet::frame_path(pattern, number));
            Ok(sheet::Picture { frame: number, footage, strokes: out.join(path.as_str().context("a path is a text")?) })
        })
        .collect::<Result<Vec<_>>>()?;
    pictures.sort_by_key(|picture| picture.frame);
    sheet::write(&pictures, &out.join("contact.png"))
}

/// A table of times, and of accuracy if a truth document is next to the project.
fn table(project: &Path, tracked: &Value, report: &Value) -> Result<String> {
    let mut text =
        format!("Blender {}\n\n| step | seconds |\n| --- | ---: |\n", report["blender"].as_str().unwrap_or("?"));
    for (step, seconds) in report["seconds"].as_object().context("report.json: no seconds")? {
        writeln!(text, "| {step} | {:.2} |", seconds.as_f64().unwrap_or(f64::NAN))?;
    }
    let truth = project.with_file_name("truth.json");
    if !truth.exists() {
        writeln!(text, "\nThere is no truth.json next to the project, so the accuracy is not known.")?;
        return Ok(text);
    }
    let rows = measure(tracked, &document(&truth)?)?;
    let height = tracked["footage"]["height"].as_f64().context("footage.height is not a number")?;
    writeln!(text, "\n| part | points | good | contour px, mean / 95 % | point px, mean / 95 % |")?;
    writeln!(text, "| --- | ---: | ---: | ---: | ---: |")?;
    for (k, part) in tracked["parts"].as_array().into_iter().flatten().enumerate() {
        let own: Vec<&Row> = rows.iter().filter(|row| row.part == k).collect();
        writeln!(text, "{}", line(part["name"].as_str().unwrap_or("?"), &figures(own, height)))?;
    }
    writeln!(text, "{}", line("**all**", &figures(&rows, height)))?;
    Ok(text)
}

fn line(name: &str, f: &Figures) -> String {
    if f.points == 0 {
        return format!("| {name} | 0 | | | |");
    }
    format!(
        "| {name} | {} | {:.1} % | {:.2} / {:.1} | {:.2} / {:.1} |",
        f.points,
        100.0 * f.good,
        f.contour_mean,
        f.contour_p95,
        f.point_mean,
        f.point_p95
    )
}
