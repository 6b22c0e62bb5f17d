//! `bench-tween`: measures matching and in-betweens on sets with known truth. It prints tables and writes sheets to
//! `target/bench-tween`.
//!
//! Matching must find strokes that are drawn again in another order, direction and number of points. It is compared with
//! pairing by index. In-betweens are compared with the true frames, as is linear interpolation of correctly paired points.
//! An optimised program makes the measurements (`rototoon-tests`, binary `bench-tween`).

use anyhow::{Context, Result};
use clap::Args;
use rototoon_tests::sample;
use std::path::PathBuf;
use xtask_shell::shell::{cargo, command, run, target};

/// The arguments of `bench-tween`.
#[derive(Args)]
pub struct Arguments {
    /// Folders with project.json and truth.json; the sample cartoon by default.
    dirs: Vec<PathBuf>,
    /// Folders with line drawings in `frames`, for in-betweens of whole drawings.
    #[arg(long, num_args = 1..)]
    drawings: Vec<PathBuf>,
}

/// Runs the benchmark.
pub fn bench_tween(arguments: &Arguments) -> Result<()> {
    let out = target().join("bench-tween");
    std::fs::create_dir_all(&out).with_context(|| format!("cannot make {out:?}"))?;
    let mut dirs = arguments.dirs.clone();
    if dirs.is_empty() {
        dirs.push(out.join("sample"));
        sample::write(&dirs[0])?;
    }
    eprintln!("building the optimised benchmark");
    run(cargo().args(["build", "--quiet", "--release", "-p", "rototoon-tests", "--bin", "bench-tween"]))?;
    let own = target().join("release").join(format!("bench-tween{}", std::env::consts::EXE_SUFFIX));
    let mut bench = command(&own);
    bench.arg(&out).args(&dirs);
    if !arguments.drawings.is_empty() {
        bench.arg("--drawings").args(&arguments.drawings);
    }
    run(&mut bench)
}
