//! `bench-style`: compares factorisation with scikit-learn and reshaping with libigl, and repeats the experiments of Liang
//! et al. 2012.
//!
//! It makes a Python environment under `target/bench-style`, builds the optimised program, and runs `tests/bench_style.py`
//! (the comparisons) and `tests/bench_style_paper.py` (the experiments). These scripts say what they measure and how. Plots
//! are in `target/style`, as SVG and PNG, with a subfolder for each given folder. Folders with a tracking set
//! (`project.json` and `truth.json`) go to `bench-tracking`, with the presets of the two papers. It counts how many points
//! an artist corrects with each of them.

use crate::bench_tracking;
use anyhow::{Context, Result, ensure};
use clap::Args;
use rototoon_tests::chart::{Axis, Chart, INKS, Panel, Series};
use serde_json::Value;
use std::path::{Path, PathBuf};
use xtask_shell::python;
use xtask_shell::shell::{cargo, command, root, run, target};

/// NumPy and the libraries to compare with.
const PYTHON: [&str; 3] = ["numpy", "scikit-learn==1.9.1", "libigl==2.6.3"];
/// Presets of the two trackers whose number of corrections Liang et al. 2012 compare.
const TRACKERS: [&str; 2] = ["agarwala2004", "liang2012"];
/// Height of a plot's only panel, and of one of several panels.
const HEIGHTS: [f32; 2] = [320.0, 150.0];

/// The arguments of `bench-style`.
#[derive(Args)]
pub struct Arguments {
    /// Folders with a clips.json or with a tracking set (project.json and truth.json); synthetic gaits by default.
    dirs: Vec<PathBuf>,
    /// A further file of clips to measure.
    #[arg(long)]
    clips: Option<PathBuf>,
    /// Run only the comparisons with other libraries, not the paper's experiments.
    #[arg(long)]
    kernels: bool,
}

/// Runs the benchmark.
pub fn bench_style(arguments: &Arguments) -> Result<()> {
    let (clips, sets) = sorted(arguments)?;
    eprintln!("building the optimised benchmark");
    run(cargo().args(["build", "--quiet", "--release", "-p", "rototoon-tests", "--bin", "bench-style"]))?;
    let own = target().join("release").join(format!("bench-style{}", std::env::consts::EXE_SUFFIX));
    let interpreter = python::venv("bench-style/venv", &python::find_any()?, &PYTHON)?;
    let measure = |script: &str| {
        let mut command = command(&interpreter);
        command.arg(root().join("tests").join(script)).arg("--own").arg(&own);
        command
    };
    let mut kernels = measure("bench_style.py");
    if let Some(first) = clips.first() {
        kernels.arg("--clips").arg(first);
    }
    run(&mut kernels)?;
    if arguments.kernels {
        return Ok(());
    }
    if clips.is_empty() && sets.is_empty() {
        experiments(&mut measure("bench_style_paper.py"), &target().join("style"))?;
    }
    for path in &clips {
        let folder = path.parent().and_then(Path::file_name).unwrap_or_default();
        let out = target().join("style").join(folder);
        experiments(measure("bench_style_paper.py").arg("--clips").arg(path), &out)?;
    }
    if sets.is_empty() {
        println!(
            "\nUser-edit ratios are measured on folders with tracking sets, or by: cargo xtask bench-tracking --preset \
             agarwala2004 --preset liang2012"
        );
        return Ok(());
    }
    println!("\nUser-edit ratios: corrections until 95 % of the points are good");
    bench_tracking::bench_tracking(&bench_tracking::Arguments::of(&sets, &TRACKERS))
}

/// Divides the arguments into files of clips and folders of tracking sets.
fn sorted(arguments: &Arguments) -> Result<(Vec<PathBuf>, Vec<PathBuf>)> {
    let (mut clips, mut sets): (Vec<PathBuf>, Vec<PathBuf>) =
        (arguments.clips.clone().into_iter().collect(), Vec::new());
    for folder in &arguments.dirs {
        let (document, set) = (folder.join("clips.json"), folder.join("project.json"));
        ensure!(
            document.exists() || set.exists(),
            "{}: found neither a clips.json nor a project.json, expected one of them",
            folder.display()
        );
        if document.exists() {
            clips.push(document);
        }
        if set.exists() {
            sets.push(folder.clone());
        }
    }
    Ok((clips, sets))
}

/// Runs the experiments and draws their plots.
fn experiments(measure: &mut std::process::Command, out: &Path) -> Result<()> {
    run(measure.arg("--out").arg(out))?;
    for name in ["dimension", "reconstruction", "translation", "limbs", "order"] {
        let numbers = out.join(format!("{name}.plot.json"));
        let text = std::fs::read_to_string(&numbers).with_context(|| format!("cannot read {}", numbers.display()))?;
        let drawing =
            chart(&serde_json::from_str(&text)?).with_context(|| format!("{}: no plot", numbers.display()))?.draw();
        std::fs::write(out.join(format!("{name}.svg")), drawing.svg())?;
        std::fs::write(out.join(format!("{name}.png")), drawing.png()?)?;
        std::fs::remove_file(&numbers)?;
    }
    println!("\nplots: {}/*.svg and *.png", out.display());
    Ok(())
}

/// Makes a chart of a plot's numbers. `None` if they are not in the form that the script writes.
fn chart(plot: &Value) -> Option<Chart> {
    let text = |value: &Value, key: &str| value[key].as_str().map(str::to_owned);
    let axis = |value: &Value| {
        let logarithmic = value["logarithmic"].as_bool().unwrap_or(false);
        Some(Axis {
            label: text(value, "label")?,
            low: value["low"].as_f64()?,
            high: value["high"].as_f64()?,
            logarithmic,
        })
    };
    let panels = plot["panels"].as_array()?;
    let height = HEIGHTS[usize::from(panels.len() > 1)];
    let series = |(k, value): (usize, &Value)| {
        let points = value["points"].as_array()?.iter().map(|point| Some((point[0].as_f64()?, point[1].as_f64()?)));
        let runs = vec![points.collect::<Option<Vec<_>>>()?];
        Some(Series { name: text(value, "name")?, ink: INKS[k % INKS.len()], dashed: value["dashed"].as_bool()?, runs })
    };
    let panel = |value: &Value| {
        let series = value["series"].as_array()?.iter().enumerate().map(series).collect::<Option<Vec<_>>>()?;
        Some(Panel { y: axis(value)?, height, series })
    };
    Some(Chart {
        title: text(plot, "title")?,
        note: text(plot, "note")?,
        x: axis(&plot["x"])?,
        panels: panels.iter().map(panel).collect::<Option<Vec<_>>>()?,
        marked: Vec::new(),
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn plots_of_the_script_are_read() {
        let panel = json!({"label": "y", "low": 0, "high": 2, "series": [{"name": "a", "points": [[1, 2], [2, 1.5]], "dashed": false}]});
        let x = json!({"label": "x", "low": 1, "high": 9, "logarithmic": true});
        let plot = json!({"title": "t", "note": "", "x": x, "panels": [panel]});
        let found = chart(&plot).unwrap();
        assert!(found.x.logarithmic && found.panels[0].series[0].runs == [[(1.0, 2.0), (2.0, 1.5)]]);
        assert!(found.draw().svg().contains("polyline"));
        assert!(chart(&json!({"title": "t"})).is_none());
    }
}
