//! `demo`: runs the main workflow in real Blender, on the sample cartoon or on any project document.

use crate::bundle::{Build, Bundle, Packager, bundle};
use anyhow::{Context, Result, ensure};
use std::path::{Path, PathBuf};
use std::process::Command;
use xtask_shell::shell::{command, empty_folder, root, run, target};

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
    let bundle = bundle(&packager, Build::WithMeasure)?;
    let out = target().join("demo");
    empty_folder(&out)?;
    let project = match project {
        Some(path) => path,
        None => {
            run(command(&bundle.measure).arg("sample").arg(&out))?;
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
    run(command(&bundle.measure).arg("report").arg(&project).arg(&out))?;
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
