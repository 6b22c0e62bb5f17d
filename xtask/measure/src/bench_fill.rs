//! `bench-fill`: measures fills on line drawings with known colours. It prints tables and writes them and sheets of the worst drawings to
//! `target/bench-fill`.
//!
//! The first drawing of each set gets a click in each region, with its true colour. Every other drawing is compared with the same drawing in
//! colour. An optimised program makes the measurements (`rototoon-tests`, binary `bench-fill`), in a process of its own for each
//! set, so that peak memory is measured separately.

use crate::sets;
use anyhow::{Context, Result};
use clap::Args;
use rototoon_tests::filling::run::Outcome;
use rototoon_tests::filling::set::Set;
use rototoon_tests::filling::{own, shapes, table};
use std::path::{Path, PathBuf};
use xtask_shell::shell::{cargo, command, empty_folder, root, run, target};

/// The arguments of `bench-fill`.
#[derive(Args)]
pub struct Arguments {
    /// Folders with line drawings, frames/*.png, and the same drawings in colour, colour/*.png; a film that is drawn by default.
    dirs: Vec<PathBuf>,
}

/// Runs the benchmark.
pub fn bench_fill(arguments: &Arguments) -> Result<()> {
    // Bad folders are reported before anything is built or measured.
    let mut sets = sets::named(&arguments.dirs, |dir| Set::find(dir).map(|_| ()))?;
    let out = target().join("bench-fill");
    std::fs::create_dir_all(&out).with_context(|| format!("cannot make {out:?}"))?;
    if sets.is_empty() {
        sets = vec![("drawn".into(), out.join("drawn"))];
        empty_folder(&sets[0].1)?;
        shapes::write(&sets[0].1, shapes::LINES, &own::drawings(own::COUNT))?;
    }
    eprintln!("building the optimised benchmark");
    run(cargo().args(["build", "--quiet", "--release", "-p", "rototoon-tests", "--bin", "bench-fill"]))?;
    let program = target().join("release").join(format!("bench-fill{}", std::env::consts::EXE_SUFFIX));
    let mut outcomes = Vec::new();
    for (name, folder) in &sets {
        eprintln!("{name}");
        outcomes.push(measured(&program, folder, &out.join(name))?);
    }
    let text = table::markdown(&outcomes);
    let path = out.join("table.md");
    std::fs::write(&path, &text).with_context(|| format!("cannot write {path:?}"))?;
    let shown = out.strip_prefix(root()).unwrap_or(&out).display();
    println!("{text}\n{shown} contains table.md, and for each set its results (.json) and its worst drawings (.png)");
    Ok(())
}

/// Measures a set with the optimised program. `out` is the path of its results without extension.
fn measured(program: &Path, folder: &Path, out: &Path) -> Result<Outcome> {
    run(command(program).arg("run").arg(folder).arg(out))?;
    let name = out.file_name().unwrap_or_default().to_string_lossy();
    let results = out.with_file_name(format!("{name}.json"));
    let text = std::fs::read_to_string(&results).with_context(|| format!("cannot read {results:?}"))?;
    serde_json::from_str(&text).with_context(|| format!("cannot read {results:?}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bad_folders_are_reported_before_anything_is_built() {
        let base = target().join("xtask-bench-fill");
        empty_folder(&base).unwrap();
        let dirs = ["a/film", "b/film"].map(|name| base.join(name));
        let arguments = Arguments { dirs: dirs.to_vec() };
        let missing = bench_fill(&arguments).unwrap_err().to_string();
        assert!(missing.contains("film\": found no folder, expected that of a set"), "{missing}");
        dirs.iter().for_each(|dir| std::fs::create_dir_all(dir).unwrap());
        let empty = bench_fill(&arguments).unwrap_err().to_string();
        assert!(empty.contains("frames\": found no folder, expected a folder with line drawings"), "{empty}");
        std::fs::remove_dir_all(&base).unwrap();
    }
}
