//! `bench-tracking`: measures every preset on sets with known truth. It writes tables and pictures to
//! `target/bench-tracking`.
//!
//! An optimised program makes the measurements (`rototoon-tests`, binary `bench-tracking`), because xtask itself is not
//! optimised. Each set and preset runs in a process of its own, so that all start with cold caches and peak memory is
//! measured separately. An interrupted run leaves the files of the finished measurements.

use crate::sets;
use anyhow::{Context, Result, bail, ensure};
use clap::Args;
use rototoon_tests::benchmark::growth::{self, Measured, Sample};
use rototoon_tests::benchmark::pins::{self, Pinned};
use rototoon_tests::benchmark::run::Outcome;
use rototoon_tests::benchmark::table::{self, Failure};
use rototoon_tests::benchmark::{mechanisms, own, presets, write_files};
use rototoon_tests::puppet::Puppet;
use std::fmt::Write;
use std::path::{Path, PathBuf};
use xtask_shell::shell::{capture, cargo, command, root, run, target};

/// How often tracking is timed for the growth. The fastest run counts.
const REPEATS: usize = 5;

/// The arguments of `bench-tracking`.
#[derive(Args)]
pub struct Arguments {
    /// Folders with project.json (key frames only) and truth.json; three synthetic sets by default.
    dirs: Vec<PathBuf>,
    /// Measure only this preset; may be given several times.
    #[arg(long = "preset", value_name = "ID")]
    presets: Vec<String>,
    /// Leave out the simulated artist, who corrects the tracks and tracks again.
    #[arg(long)]
    no_edits: bool,
    /// Number of threads; 0 for one per core.
    #[arg(long, value_name = "N", default_value_t = 0)]
    threads: usize,
    /// Measure only the default preset: complete, and without each of its mechanisms.
    #[arg(long, conflicts_with = "presets")]
    ablations: bool,
    /// Measure instead how long a track takes after a pin, with a pin on each part in the middle of each of its spans.
    #[arg(long, conflicts_with_all = ["growth", "memory", "ablations", "presets"])]
    pins: bool,
    /// With --pins: fail if a tracker that knows the film finds other tracks than a new one.
    #[arg(long, requires = "pins")]
    check: bool,
    /// Measure instead how time and memory grow with the frames, parts, points and pixels of synthetic scenes.
    #[arg(long, conflicts_with = "dirs")]
    growth: bool,
    /// Measure instead the peak memory of 100 synthetic frames of 1920x1080.
    #[arg(long, conflicts_with = "dirs")]
    memory: bool,
}

impl Arguments {
    /// Arguments that measure these presets on these folders, with the simulated artist.
    pub fn of(dirs: &[PathBuf], presets: &[&str]) -> Self {
        let presets = presets.iter().map(|id| (*id).to_owned()).collect();
        Self {
            dirs: dirs.to_vec(),
            presets,
            no_edits: false,
            threads: 0,
            ablations: false,
            pins: false,
            check: false,
            growth: false,
            memory: false,
        }
    }
}

/// Runs the benchmark.
pub fn bench_tracking(arguments: &Arguments) -> Result<()> {
    let known = presets();
    if let Some(id) = arguments.presets.iter().find(|id| !known.contains(&id.as_str())) {
        bail!("no preset {id:?}: expected one of {}", known.join(", "));
    }
    let bench = Bench { program: program()?, out: target().join("bench-tracking"), threads: arguments.threads };
    std::fs::create_dir_all(&bench.out).with_context(|| format!("cannot make {:?}", bench.out))?;
    if arguments.growth {
        bench.growth()?;
    }
    if arguments.memory {
        bench.memory()?;
    }
    if arguments.growth || arguments.memory {
        return Ok(());
    }
    if arguments.pins {
        return bench.pins(arguments);
    }
    bench.sets(arguments, &known)
}

/// A preset, complete or without one of its mechanisms.
struct Way {
    preset: &'static str,
    /// The mechanism that is left out.
    without: Option<&'static str>,
}

impl Way {
    /// Its name in the results.
    fn name(&self) -> String {
        self.without.map_or(self.preset.to_owned(), |id| format!("{} without {id}", self.preset))
    }
}

/// Builds the optimised program and returns its path.
fn program() -> Result<PathBuf> {
    eprintln!("building the optimised benchmark");
    run(cargo().args(["build", "--quiet", "--release", "-p", "rototoon-tests", "--bin", "bench-tracking"]))?;
    Ok(target().join("release").join(format!("bench-tracking{}", std::env::consts::EXE_SUFFIX)))
}

/// The program, the folder of its results, and the number of threads.
struct Bench {
    program: PathBuf,
    out: PathBuf,
    threads: usize,
}

impl Bench {
    fn sets(&self, arguments: &Arguments, known: &[&'static str]) -> Result<()> {
        let sets = self.folders(&arguments.dirs)?;
        let wanted = |id: &&&str| arguments.presets.is_empty() || arguments.presets.iter().any(|other| other == **id);
        let whole = known.iter().filter(wanted).map(|&preset| Way { preset, without: None });
        let lessened = mechanisms().into_iter().map(|id| Way { preset: known[0], without: Some(id) });
        let presets: Vec<Way> =
            if arguments.ablations { whole.take(1).chain(lessened).collect() } else { whole.collect() };
        let (mut outcomes, mut failures): (Vec<Outcome>, Vec<Failure>) = (Vec::new(), Vec::new());
        for (k, (set, folder)) in sets.iter().enumerate() {
            for (i, preset) in presets.iter().enumerate() {
                eprintln!("[{}/{}] {set}, {}", k * presets.len() + i + 1, sets.len() * presets.len(), preset.name());
                match self.run(set, folder, preset, arguments.no_edits) {
                    Ok(outcome) => outcomes.push(outcome),
                    Err(error) => {
                        eprintln!("{set}, {}: {error:#}", preset.name());
                        failures.push((set.clone(), preset.name(), format!("{error:#}")));
                    }
                }
                // The table is written after each run, so that an interrupted benchmark has one.
                write_files(&self.out, &outcomes, &failures)?;
            }
        }
        println!("{}", table::markdown(&outcomes, &failures));
        println!(
            "{} contains table.md, table.json, a plot of errors for each set, and an overlay sheet for each run",
            shown(&self.out)
        );
        ensure!(failures.is_empty(), "{} of {} runs failed", failures.len(), failures.len() + outcomes.len());
        Ok(())
    }

    /// The sets with unique names.
    fn folders(&self, dirs: &[PathBuf]) -> Result<Vec<(String, PathBuf)>> {
        if dirs.is_empty() {
            return own::write(&self.out);
        }
        sets::named(dirs, |dir| {
            for file in ["project.json", "truth.json"] {
                ensure!(dir.join(file).is_file(), "{dir:?} contains no {file}");
            }
            Ok(())
        })
    }

    fn run(&self, set: &str, folder: &Path, way: &Way, no_edits: bool) -> Result<Outcome> {
        let name = format!("{set}.{}", way.name().replace(' ', "-"));
        let (out, results) = (self.out.join(&name), self.out.join(format!("{name}.json")));
        // Results of an earlier run must not be mistaken for those of this run.
        if results.exists() {
            std::fs::remove_file(&results).with_context(|| format!("cannot remove {results:?}"))?;
        }
        let mut start = command(&self.program);
        start.arg("run").arg(folder).args([
            "--set",
            set,
            "--preset",
            way.preset,
            "--threads",
            &self.threads.to_string(),
        ]);
        way.without.iter().for_each(|id| {
            start.args(["--without", id]);
        });
        start.arg("--out").arg(&out);
        if no_edits {
            start.arg("--no-edits");
        }
        run(&mut start)?;
        let text = std::fs::read_to_string(&results).with_context(|| format!("cannot read {results:?}"))?;
        serde_json::from_str(&text).with_context(|| format!("cannot read {results:?}"))
    }

    /// Times after pins, set by set.
    fn pins(&self, arguments: &Arguments) -> Result<()> {
        let mut found: Vec<(String, Vec<Pinned>)> = Vec::new();
        for (set, folder) in self.folders(&arguments.dirs)? {
            eprintln!("{set}");
            let mut start = command(&self.program);
            start.arg("pins").arg(folder).args(["--threads", &self.threads.to_string()]);
            if arguments.check {
                start.arg("--check");
            }
            let said = capture(&mut start)?;
            let of_set = serde_json::from_str(&said).with_context(|| format!("found {said:?}, expected times"))?;
            found.push((set, of_set));
        }
        let text = pins::markdown(&found);
        self.write("pins.md", text.as_bytes())?;
        println!("{text}\n{} contains pins.md", shown(&self.out));
        Ok(())
    }

    fn growth(&self) -> Result<()> {
        let mut measured: Vec<Measured> = Vec::new();
        // All quantities share one base scene, which is measured once.
        let mut known: Vec<(Puppet, Sample)> = Vec::new();
        for quantity in growth::quantities() {
            let mut samples = Vec::new();
            for (value, puppet) in &quantity.scenes {
                let sample = match known.iter().find(|(other, _)| other == puppet) {
                    Some((_, sample)) => *sample,
                    None => {
                        eprintln!("{}: {value}", quantity.name);
                        self.time(puppet, REPEATS)?
                    }
                };
                known.push((*puppet, sample));
                samples.push((*value, sample));
            }
            measured.push((quantity.name, samples));
        }
        let text = growth::markdown(&measured);
        let drawing = growth::chart(&measured).draw();
        self.write("growth.md", text.as_bytes())?;
        self.write("growth.svg", drawing.svg().as_bytes())?;
        self.write("growth.png", &drawing.png()?)?;
        println!("{text}\n{} contains growth.md, growth.svg and growth.png", shown(&self.out));
        Ok(())
    }

    fn memory(&self) -> Result<()> {
        let mut text = String::from("| 100 frames of 1920×1080, 16 parts, 192 points | seconds | peak MB |\n");
        text += "| --- | ---: | ---: |\n";
        for (keyed, puppet) in [("first and last frame", growth::SHOT), ("five frames", growth::KEYED_SHOT)] {
            eprintln!("100 frames, keyed on {keyed}");
            let sample = self.time(&puppet, 1)?;
            let peak = sample.peak_mb.map_or("–".into(), |mb| format!("{mb:.0}"));
            writeln!(text, "| keyed on {keyed} | {:.1} | {peak} |", sample.seconds)?;
        }
        self.write("memory.md", text.as_bytes())?;
        println!("{text}\n{} contains memory.md", shown(&self.out));
        Ok(())
    }

    /// Tracks a synthetic scene several times. Returns the shortest time and the largest peak memory.
    fn time(&self, puppet: &Puppet, repeats: usize) -> Result<Sample> {
        let folder = self.out.join("drawn");
        xtask_shell::shell::empty_folder(&folder)?;
        let Puppet { width, height, frames, step, parts, points } = *puppet;
        let numbers = [width, height, frames, step, parts, points].map(|n| n.to_string());
        run(command(&self.program).arg("draw").arg(&folder).args(numbers))?;
        let mut best: Option<Sample> = None;
        for _ in 0..repeats {
            let mut start = command(&self.program);
            let said = capture(start.arg("time").arg(&folder).args(["--threads", &self.threads.to_string()]))?;
            let sample: Sample =
                serde_json::from_str(&said).with_context(|| format!("found {said:?}, expected a sample"))?;
            best = Some(best.map_or(sample, |b| Sample {
                seconds: b.seconds.min(sample.seconds),
                peak_mb: b.peak_mb.zip(sample.peak_mb).map(|(a, b)| a.max(b)),
            }));
        }
        std::fs::remove_dir_all(&folder).with_context(|| format!("cannot remove {folder:?}"))?;
        best.context("nothing was measured")
    }

    fn write(&self, name: &str, bytes: &[u8]) -> Result<()> {
        let path = self.out.join(name);
        std::fs::write(&path, bytes).with_context(|| format!("cannot write {path:?}"))
    }
}

fn shown(path: &Path) -> String {
    path.strip_prefix(root()).unwrap_or(path).display().to_string()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn bench() -> Bench {
        Bench { program: "none".into(), out: target().join("xtask-bench-test"), threads: 1 }
    }

    #[test]
    fn sets_get_unique_names() {
        let base = target().join("xtask-bench-sets");
        xtask_shell::shell::empty_folder(&base).unwrap();
        let dirs = ["a/walk", "b/walk", "run"].map(|name| base.join(name));
        for dir in &dirs {
            std::fs::create_dir_all(dir).unwrap();
            std::fs::write(dir.join("project.json"), "{}").unwrap();
        }
        let missing = bench().folders(&dirs).unwrap_err().to_string();
        assert!(missing.contains("walk") && missing.contains("contains no truth.json"), "{missing}");
        dirs.iter().for_each(|dir| std::fs::write(dir.join("truth.json"), "{}").unwrap());
        let names: Vec<String> = bench().folders(&dirs).unwrap().into_iter().map(|(name, _)| name).collect();
        assert_eq!(names, ["walk", "walk-2", "run"]);
        std::fs::remove_dir_all(&base).unwrap();
    }

    #[test]
    fn an_unknown_preset_is_reported_before_anything_is_built() {
        let arguments = Arguments {
            dirs: vec![],
            presets: vec!["best".into()],
            no_edits: true,
            threads: 0,
            ablations: false,
            pins: false,
            check: false,
            growth: false,
            memory: false,
        };
        let error = bench_tracking(&arguments).unwrap_err().to_string();
        assert!(error.starts_with("no preset \"best\": expected one of rototoon, "), "{error}");
    }
}
