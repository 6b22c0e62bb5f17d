//! Measures fills on a film with known colours, for `cargo xtask bench-fill`, and writes what the confidence is fitted from.

use anyhow::{Context, Result};
use clap::{Parser, Subcommand};
use rayon::prelude::{IntoParallelRefIterator, ParallelIterator};
use rototoon::project::write_whole;
use rototoon_tests::filling::run::measure;
use rototoon_tests::filling::set::Set;
use rototoon_tests::filling::{evidence, films, parts, shapes};
use std::path::{Path, PathBuf};

#[derive(Parser)]
#[command(about = "Measures fills on films with known colours")]
struct Arguments {
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    /// Measure a film. The results are written to OUT.json, and a sheet of the worst drawings to OUT.png. The film is named after OUT.
    Run {
        /// The folder with frames/*.png and colour/*.png.
        folder: PathBuf,
        /// The path of the results without its extension.
        out: PathBuf,
    },
    /// Draw all films of this package, each into a folder of its name, and films of the parts of tracked characters.
    Draw {
        /// The folder to write to.
        out: PathBuf,
        /// Folders with project.json and truth.json. Their films are named after them, with `.parts` behind.
        characters: Vec<PathBuf>,
    },
    /// Write tables with the evidence about every region beside the truth, from which `tests/fill_confidence.py` fits the confidence. A table
    /// is named after its film's folder.
    Evidence {
        /// The folder to write to.
        out: PathBuf,
        /// Folders with frames/*.png and colour/*.png.
        folders: Vec<PathBuf>,
    },
}

fn main() -> Result<()> {
    match Arguments::parse().command {
        Command::Run { folder, out } => run(&folder, &out),
        Command::Draw { out, characters } => draw(&out, &characters),
        Command::Evidence { out, folders } => folders.iter().try_for_each(|folder| write_evidence(&out, folder)),
    }
}

fn draw(out: &Path, characters: &[PathBuf]) -> Result<()> {
    let mut films = films::all();
    for folder in characters {
        films.push((format!("{}.parts", name(folder)?), parts::drawings(folder)?));
    }
    films.iter().try_for_each(|(name, drawings)| shapes::write(&out.join(name), shapes::LINES, drawings))
}

fn run(folder: &Path, out: &Path) -> Result<()> {
    let name = out.file_name().context("OUT has no name")?.to_string_lossy().into_owned();
    let with = |extension: &str| out.with_file_name(format!("{name}.{extension}"));
    let outcome = measure(folder, &name, &with("png"))?;
    let path = with("json");
    std::fs::write(&path, serde_json::to_vec_pretty(&outcome)?).with_context(|| format!("cannot write {path:?}"))
}

fn name(folder: &Path) -> Result<String> {
    Ok(folder.file_name().with_context(|| format!("{folder:?} has no name"))?.to_string_lossy().into_owned())
}

fn write_evidence(out: &Path, folder: &Path) -> Result<()> {
    std::fs::create_dir_all(out).with_context(|| format!("cannot make the folder {out:?}"))?;
    let name = name(folder)?;
    let set = Set::find(folder)?;
    evidence::variants(&set).par_iter().try_for_each(|variant| {
        let path = out.join(format!("{name}{}.csv", variant.name));
        Ok(write_whole(&path, evidence::table(variant)?.as_bytes())?)
    })
}
