//! Makes one measurement for `cargo xtask bench-tracking`, in a process of its own.

use anyhow::{Context, Result, ensure};
use clap::{Parser, Subcommand};
use rototoon::pipeline;
use rototoon::project::{Document, write_whole};
use rototoon::scene::Silent;
use rototoon::track::{Mechanism, Mechanisms, Preset, TrackOptions};
use rototoon_tests::artist::Rules;
use rototoon_tests::benchmark::growth::Sample;
use rototoon_tests::benchmark::{evidence, overlay, own, pins, run};
use rototoon_tests::memory::peak_mb;
use rototoon_tests::puppet::Puppet;
use std::io::Cursor;
use std::path::{Path, PathBuf};
use std::time::Instant;

#[derive(Parser)]
#[command(about = "Makes one measurement for `cargo xtask bench-tracking`")]
struct Arguments {
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    /// Run one preset on one set, and write OUT.json and the overlay sheet OUT.png.
    Run {
        /// Folder with project.json and truth.json.
        folder: PathBuf,
        /// Name of the set in the results.
        #[arg(long)]
        set: String,
        /// Id of the preset.
        #[arg(long)]
        preset: String,
        /// Id of a mechanism to leave out of the default preset.
        #[arg(long)]
        without: Option<String>,
        /// Path of the results, without file extension.
        #[arg(long)]
        out: PathBuf,
        /// Leave out the simulated artist.
        #[arg(long)]
        no_edits: bool,
        /// Number of threads; 0 for one per core.
        #[arg(long, default_value_t = 0)]
        threads: usize,
    },
    /// Track a document with the default preset, and print seconds and peak memory as JSON.
    Time {
        /// Folder with project.json.
        folder: PathBuf,
        /// Number of threads; 0 for one per core.
        #[arg(long, default_value_t = 0)]
        threads: usize,
    },
    /// Pin a point of each part in the middle of each span, one at a time, and print how long each track takes as JSON.
    Pins {
        /// Folder with project.json and truth.json.
        folder: PathBuf,
        /// Compare each track with that of a new tracker.
        #[arg(long)]
        check: bool,
        /// Number of threads; 0 for one per core.
        #[arg(long, default_value_t = 0)]
        threads: usize,
    },
    /// Write tables with the evidence about every point beside the truth, from which `tests/confidence.py` fits the model.
    Evidence {
        /// The folder to write to.
        out: PathBuf,
        /// Folders with project.json and truth.json. The benchmark's own sets are added.
        folders: Vec<PathBuf>,
        /// Number of threads; 0 for one per core.
        #[arg(long, default_value_t = 0)]
        threads: usize,
    },
    /// Draw a scene of limbs.
    Draw {
        /// The folder to make.
        folder: PathBuf,
        /// Width, height, frames, frames from key to key, parts, points per part.
        #[arg(num_args = 6)]
        numbers: Vec<usize>,
    },
}

fn main() -> Result<()> {
    match Arguments::parse().command {
        Command::Run { folder, set, preset, without, out, no_edits, threads } => {
            let (options, id) = options(&preset, without.as_deref())?;
            pool(threads)?.install(|| run_set(&folder, &set, (options, &id), &out, no_edits))
        }
        Command::Time { folder, threads } => pool(threads)?.install(|| time(&folder)),
        Command::Pins { folder, check, threads } => {
            let found = pool(threads)?.install(|| pins::pins(&folder, TrackOptions::default(), check))?;
            println!("{}", serde_json::to_string_pretty(&found)?);
            Ok(())
        }
        Command::Evidence { out, folders, threads } => pool(threads)?.install(|| tables(&out, &folders)),
        Command::Draw { folder, numbers } => {
            let [width, height, frames, step, parts, points] = numbers[..] else { return Ok(()) };
            Puppet { width, height, frames, step, parts, points }.write(&folder)
        }
    }
}

fn pool(threads: usize) -> Result<rayon::ThreadPool> {
    rayon::ThreadPoolBuilder::new().num_threads(threads).build().context("cannot start threads")
}

/// The options of tracking, and their name in the results.
fn options(preset: &str, without: Option<&str>) -> Result<(TrackOptions, String)> {
    let known = Preset::from_id(preset).with_context(|| format!("no preset {preset:?}"))?;
    let Some(id) = without else {
        return Ok((TrackOptions { preset: known, ..TrackOptions::default() }, preset.to_owned()));
    };
    ensure!(known == Preset::default(), "nothing can be left out of the preset {preset:?}");
    let mechanism = Mechanism::from_id(id).with_context(|| format!("no mechanism {id:?}"))?;
    let options = TrackOptions { preset: known, mechanisms: Mechanisms::without(mechanism) };
    Ok((options, format!("{preset} without {id}")))
}

fn run_set(folder: &Path, set: &str, (options, id): (TrackOptions, &str), out: &Path, no_edits: bool) -> Result<()> {
    let rules = Rules::default();
    let run = run::run(set, folder, (options, id), (!no_edits).then_some(&rules), |work| {
        let (good, edits) = (100.0 * work.last.good, work.edits());
        eprintln!("{set}, {id}: round {}, {edits} edits, good {good:.1} %", work.rounds);
    })?;
    let mut png = Cursor::new(Vec::new());
    overlay::sheet(&run)?.write_to(&mut png, image::ImageFormat::Png)?;
    write_whole(&ending(out, ".png"), png.get_ref())?;
    write_whole(&ending(out, ".json"), &serde_json::to_vec_pretty(&run.outcome)?)?;
    Ok(())
}

fn tables(out: &Path, folders: &[PathBuf]) -> Result<()> {
    std::fs::create_dir_all(out).with_context(|| format!("cannot make {out:?}"))?;
    let drawn = tempfile::tempdir()?;
    let own = own::write(drawn.path())?;
    let name = |folder: &PathBuf| folder.file_name().map(|name| name.to_string_lossy().into_owned());
    let given = folders.iter().map(|folder| Ok((name(folder).context("a folder without a name")?, folder.clone())));
    for (set, folder) in given.collect::<Result<Vec<_>>>()?.into_iter().chain(own) {
        eprintln!("{set}");
        evidence::write(&set, &folder, out)?;
    }
    Ok(())
}

fn ending(path: &Path, ending: &str) -> PathBuf {
    let mut path = path.as_os_str().to_owned();
    path.push(ending);
    path.into()
}

fn time(folder: &Path) -> Result<()> {
    let start = Instant::now();
    let mut document = Document::load(&folder.join("project.json"))?;
    pipeline::track(&mut document, folder, &TrackOptions::default(), &Silent)?;
    let sample = Sample { seconds: start.elapsed().as_secs_f64(), peak_mb: peak_mb() };
    println!("{}", serde_json::to_string(&sample)?);
    Ok(())
}
