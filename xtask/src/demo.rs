//! `demo`: runs the main workflow in real Blender, on the sample cartoon or on any project document.
//!
//! It says what it will do before it begins, shows the progress of downloads and of the build, and names each result as soon as it
//! exists. It builds for this machine only, which needs neither the tools for an old glibc nor the OpenFX plugin.

use crate::bundle::{Build, Bundle, Packager, bundle};
use anyhow::{Context, Result, ensure};
use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::Instant;
use xtask_shell::shell::{command, empty_folder, root, run, target};

/// How long the first run takes: most of it is the compiler's.
const FIRST_TIME: &str = "5 to 15 minutes on two free cores, more on a busy machine,";
/// What the first run needs on disk: the package with Blender, and what the compiler leaves.
const DISK: &str = "2 GB";
/// Number of pictures on the contact sheet.
const PICTURES: usize = 12;

/// Builds and installs the extension, tracks and snaps with it, and writes the results to `target/demo`.
pub fn demo(project: Option<PathBuf>, blender: Option<PathBuf>) -> Result<()> {
    let blender =
        blender.map(|path| path.canonicalize().with_context(|| format!("no Blender at {path:?}"))).transpose()?;
    let project =
        project.map(|path| path.canonicalize().with_context(|| format!("no project at {path:?}"))).transpose()?;
    let mut steps = Steps::new(blender.is_none());
    let packager = match blender {
        Some(binary) => Packager::Blender(binary),
        None => {
            steps.begin("Blender as a Python package");
            Packager::from_wheel()?
        }
    };
    steps.begin("the extension");
    let bundle = bundle(&packager, Build::Here)?;
    let out = target().join("demo");
    empty_folder(&out)?;
    let project = match project {
        Some(path) => path,
        None => {
            steps.begin("the sample cartoon");
            run(command(&bundle.measure).arg("sample").arg(&out))?;
            println!("demo: its pictures are in {}", shown(&out.join("sample/frames")));
            out.join("sample/project.json")
        }
    };
    steps.begin(&format!("{} in Blender: import, track, snap, save, render", shown(&project)));
    run(script(&packager)
        .args(["--pictures", &PICTURES.to_string(), "--zip"])
        .arg(&bundle.zip)
        .arg("--project")
        .arg(&project)
        .arg("--out")
        .arg(&out))?;
    steps.begin("the report");
    export(&bundle, &out.join("tracked.json"), &out.join("tracks.svg"))?;
    run(command(&bundle.measure).arg("report").arg(&project).arg(&out))?;
    list(&out)?;
    steps.end();
    Ok(())
}

/// Names the results in a folder. It is an error if one is missing.
fn list(out: &Path) -> Result<()> {
    for (file, what) in [
        ("demo.blend", "the Blender file"),
        ("contact.png", "rendered strokes over the footage"),
        ("tracks.svg", "the parts as animated paths"),
        ("tracked.json", "the tracked project document"),
        ("table.md", "this table"),
    ] {
        let path = out.join(file);
        ensure!(path.exists(), "{path:?} was not written");
        println!("{:<32} {what}", shown(&path));
    }
    Ok(())
}

/// A path below the workspace's folder without that folder.
fn shown(path: &Path) -> String {
    path.strip_prefix(root()).unwrap_or(path).display().to_string()
}

/// Says what the demo does, and how long each of its steps took.
struct Steps {
    started: Instant,
    step: Option<Instant>,
}

impl Steps {
    fn new(with_wheel: bool) -> Self {
        println!("demo: builds the extension, installs it in a Blender of its own, and captures a cartoon there.");
        println!("demo: the first time this takes {FIRST_TIME} and {DISK} below {}.", shown(&target()));
        if with_wheel {
            println!("demo: Blender is downloaded as a package of about 0.4 GB, if it is not there yet.");
        }
        println!("demo: your own Blender, its settings and its files are not touched. Ctrl-C stops; nothing is lost.");
        Self { started: Instant::now(), step: None }
    }

    fn begin(&mut self, name: &str) {
        self.finish();
        println!("\ndemo: {name}");
        self.step = Some(Instant::now());
    }

    fn finish(&mut self) {
        if let Some(started) = self.step.take() {
            println!("demo: done in {:.0} s", started.elapsed().as_secs_f64());
        }
    }

    fn end(&mut self) {
        self.finish();
        println!("\ndemo: all of it took {:.0} s", self.started.elapsed().as_secs_f64());
    }
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
