//! `bench-fit`: compares curve fitting with SciPy's FITPACK, kurbo, paper.js, fit-curve and cu2qu on the same outlines.
//!
//! It makes a Python environment under `target/bench-fit`, and with Node.js also a folder with the two JavaScript libraries.
//! Then it builds the optimised program and runs `tests/bench_fit.py`, which says what it measures and how.

use anyhow::{Context, Result};
use clap::Args;
use std::path::PathBuf;
use xtask_shell::python;
use xtask_shell::shell::{capture, cargo, command, root, run, target};

/// NumPy and the Python libraries to compare with.
const PYTHON: [&str; 3] = ["numpy", "scipy==1.17.1", "cu2qu==1.6.7.post2"];
/// The JavaScript libraries to compare with.
const NODE: [&str; 2] = ["fit-curve@0.2.0", "paper@0.12.18"];

/// The arguments of `bench-fit`.
#[derive(Args)]
pub struct Arguments {
    /// Largest distance between line and curve, in pixels.
    #[arg(long, value_name = "PX", default_value_t = 1.0)]
    tolerance: f64,
    /// Sweep the tolerance from 0.25 to 5 px on other outlines instead.
    #[arg(long)]
    sweep: bool,
}

/// Runs the benchmark.
pub fn bench_fit(arguments: &Arguments) -> Result<()> {
    let folder = target().join("bench-fit");
    std::fs::create_dir_all(&folder).with_context(|| format!("cannot make {folder:?}"))?;
    eprintln!("building the optimised benchmark");
    run(cargo().args(["build", "--quiet", "--release", "-p", "rototoon-tests", "--bin", "bench-fit"]))?;
    let own = target().join("release").join(format!("bench-fit{}", std::env::consts::EXE_SUFFIX));
    let interpreter = python::venv("bench-fit/venv", &python::find_any()?, &PYTHON)?;
    let picture = folder.join("fitted.svg");
    let mut measure = command(&interpreter);
    measure.arg(root().join("tests/bench_fit.py")).arg("--own").arg(own).arg("--svg").arg(&picture);
    measure.arg("--tolerance").arg(arguments.tolerance.to_string());
    if arguments.sweep {
        measure.arg("--sweep");
    }
    match peers(folder.join("node")) {
        Ok(node) => {
            measure.arg("--node").arg(node);
        }
        Err(reason) => println!("paper.js, fit-curve and cu2qu are left out: {reason:#}"),
    }
    run(&mut measure)?;
    if arguments.sweep {
        return Ok(());
    }
    println!(
        "\n{} shows Rototoon's curves over the points",
        picture.strip_prefix(root()).unwrap_or(&picture).display()
    );
    Ok(())
}

/// Installs the JavaScript libraries into a folder and returns the folder.
fn peers(folder: PathBuf) -> Result<PathBuf> {
    capture(command("node").arg("--version")).context("Node.js is not installed")?;
    if NODE.iter().all(|peer| folder.join("node_modules").join(peer.split('@').next().unwrap_or("")).is_dir()) {
        return Ok(folder);
    }
    std::fs::create_dir_all(&folder).with_context(|| format!("cannot make {folder:?}"))?;
    let mut install = command("npm");
    install.args(["install", "--no-save", "--no-audit", "--no-fund", "--prefix"]).arg(&folder).args(NODE);
    capture(&mut install).context("npm could not install the JavaScript libraries")?;
    Ok(folder)
}
