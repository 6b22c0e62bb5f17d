//! `bench-tween`: matching and in-betweens on sets with known truth; tables, and sheets in `target/bench-tween`.
//!
//! Strokes are drawn anew in another order, direction and number of points and found again, beside pairing by index; and
//! in-betweens are held against the true frames, beside linear interpolation of rightly paired points. The measurements are
//! made by an optimised program (`rototoon-tests`, binary `bench-tween`).

use anyhow::{Context, Result};
use clap::Args;
use rototoon_tests::sample;
use std::path::PathBuf;
use xtask_shell::shell::{cargo, command, run, target};

/// What to measure.
#[derive(Args)]
pub struct Arguments {
    /// Folders with project.json and truth.json; the sample cartoon where none is given.
    dirs: Vec<PathBuf>,
}

/// Measures.
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
    run(command(&own).arg(&out).args(&dirs))
}
