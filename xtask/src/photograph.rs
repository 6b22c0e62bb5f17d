//! `photograph`: the documentation's pictures of every panel and of Match Strokes, taken in a real Blender window. `press`: every button
//! of the tab pressed there. `bench-window`: for how long Track holds that window's main thread.

use crate::bundle::{Build, Bundle};
use crate::window::{Script, in_window};
use anyhow::{Context, Result, bail};
use std::path::Path;
use xtask_shell::shell::{command, copy_folder, empty_folder, root, run, target};

/// Where the documentation's pictures are, below the workspace's folder.
const PICTURES: &str = "docs/src/pictures";

/// Writes the pictures of the documentation, or says why it can't.
pub fn photograph() -> Result<()> {
    let script = Script {
        file: "photograph.py",
        words: "rototoon.zip sample pictures ready".into(),
        options: "",
        build: Build::WithMeasure,
        // The longest panel, Bones, is this high.
        screen: (1600, 1480),
        patience: 900,
    };
    let sample = |folder: &Path| run(command(Bundle::of(Build::WithMeasure)?.measure).arg("sample").arg(folder));
    match in_window("photograph", &script, sample)? {
        Some(stage) => accept(&stage.folder.join("pictures"), &root().join(PICTURES)),
        None => Ok(()),
    }
}

/// Presses every button of the tab, or says why it can't. Fails where a button does. Pictures and tables are in `target/press`.
pub fn press(variants: &[String]) -> Result<()> {
    exit_codes()?;
    let script = Script {
        file: "press.py",
        words: format!("rototoon.zip pictures ready {}", variants.join(",")),
        options: "--enable-event-simulate",
        build: Build::TestedWithHelp,
        // At twice the size the longest panel is this high.
        screen: if variants.is_empty() || variants.iter().any(|name| name.ends_with("2x")) {
            (1100, 2300)
        } else {
            (900, 1000)
        },
        patience: 4 * 3600,
    };
    let Some(stage) = in_window("press", &script, |_| Ok(()))? else { return Ok(()) };
    let kept = target().join("press");
    empty_folder(&kept)?;
    copy_folder(&stage.folder.join("pictures"), &kept, &|_| true)?;
    println!("press: pictures and tables of every press are in {}", kept.display());
    if !stage.said.is_empty() {
        bail!("press: {} faults\n{}", stage.said.len(), stage.said.join("\n"));
    }
    Ok(())
}

/// Runs the documentation's background script in an installed Blender, with `--python-exit-code`. Fails where a status is not as the page
/// promises.
fn exit_codes() -> Result<()> {
    let script = Script {
        file: "exit_codes.py",
        words: "rototoon.zip blender.md ready".into(),
        options: "",
        build: Build::TestedWithHelp,
        screen: (300, 300),
        patience: 3600,
    };
    let page = |folder: &Path| {
        std::fs::copy(root().join("docs/src/scripts/blender.md"), folder.join("blender.md"))?;
        Ok(())
    };
    match in_window("press", &script, page)? {
        Some(stage) if !stage.said.is_empty() => bail!("press: {}", stage.said.join("\n")),
        Some(_) => println!("press: the background script ends with the statuses that its page promises"),
        None => {}
    }
    Ok(())
}

/// Prints for how long Track holds the main thread of a window, or says why it can't.
pub fn bench_window() -> Result<()> {
    let script = Script {
        file: "bench_window.py",
        words: "rototoon.zip table.md ready".into(),
        options: "",
        build: Build::WithMeasure,
        screen: (1600, 1280),
        patience: 3600,
    };
    let Some(stage) = in_window("bench-window", &script, |_| Ok(()))? else { return Ok(()) };
    let table = std::fs::read_to_string(stage.folder.join("table.md")).context("the script left no table")?;
    println!("{table}");
    Ok(())
}

/// Copies the pictures into the documentation. They are looked at before they are committed.
fn accept(taken: &Path, kept: &Path) -> Result<()> {
    std::fs::create_dir_all(kept)?;
    for entry in std::fs::read_dir(taken).with_context(|| format!("cannot read {taken:?}"))? {
        let path = entry?.path();
        if path.extension().is_none_or(|extension| extension != "png") {
            continue;
        }
        let place = kept.join(path.file_name().context("a picture has a name")?);
        std::fs::copy(&path, &place).with_context(|| format!("cannot write {place:?}"))?;
        println!("photograph: {}", place.display());
    }
    Ok(())
}
