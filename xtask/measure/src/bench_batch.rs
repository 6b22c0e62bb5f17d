//! `bench-batch`: how many shots a minute `rototoon batch` does, what memory it takes, and what a season would cost.
//!
//! Three measurements, with tables in `target/bench-batch/table.md` and a chart beside it:
//!
//! 1. Many small generated shots with several numbers of shots at a time: shots a minute, processor time, memory over time.
//! 2. One shot of 1920 × 1080, flat and with grain, with and without the memory to keep its frames, step by step.
//! 3. From the second, for both: hours, reading and memory of 1000 shots of 100 frames on 1 to 64 workers.
//!
//! The hours are computed from processor time, because that is the same on a machine that does other work too. Wall-clock
//! times are shown beside it.

use anyhow::{Context, Result, ensure};
use clap::Args;
use rototoon_tests::chart::{Axis, Chart, INKS, Panel, Series};
use rototoon_tests::grain;
use rototoon_tests::puppet::Puppet;
use serde_json::{Value, json};
use std::fmt::Write;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::thread::sleep;
use std::time::{Duration, Instant};
use xtask_shell::shell::{cargo, empty_folder, run, target};

/// Time between two looks at the memory.
const PAUSE: Duration = Duration::from_millis(100);
/// The season whose cost is computed.
const SEASON: (usize, usize) = (1000, 100);
/// Kinds of footage, and the standard deviation of their grain in steps of 8 bits.
const FOOTAGE: [(&str, f64); 2] = [("flat", 0.0), ("grainy", 4.0)];
/// Workers of the table.
const WORKERS: [usize; 7] = [1, 2, 4, 8, 16, 32, 64];

/// The arguments of `bench-batch`.
#[derive(Args)]
pub struct Arguments {
    /// Number of small shots.
    #[arg(long, value_name = "N", default_value_t = 200)]
    shots: usize,
    /// Shots at a time, several numbers.
    #[arg(long, value_name = "N", value_delimiter = ',', default_values_t = [1, 2, 4])]
    jobs: Vec<usize>,
    /// Frames of the shots of 1920x1080.
    #[arg(long, value_name = "N", default_value_t = 100)]
    frames: usize,
    /// The program to measure, instead of one that is built.
    #[arg(long, value_name = "FILE")]
    program: Option<PathBuf>,
}

/// Runs the benchmark.
pub fn bench_batch(arguments: &Arguments) -> Result<()> {
    let bench = Bench { program: program(arguments)?, out: target().join("bench-batch") };
    empty_folder(&bench.out)?;
    let mut text = String::new();
    if arguments.shots > 0 {
        let manifest = small_shots(&bench.out, arguments.shots)?;
        let runs: Vec<Run> =
            arguments.jobs.iter().map(|&jobs| bench.batch(&manifest, jobs, None)).collect::<Result<_>>()?;
        text += &throughput(&runs, arguments.shots);
        fs::write(bench.out.join("memory.png"), chart(&runs).draw().png()?)?;
    }
    if arguments.frames > 0 {
        for footage in FOOTAGE {
            let (manifest, bytes) = large_shot(&bench.out, footage, arguments.frames)?;
            let kept = bench.batch(&manifest, 1, None)?;
            // So little that no frame is kept.
            let plain = bench.batch(&manifest, 1, Some(0.001))?;
            text += &by_step(footage, &kept, &plain, arguments.frames);
            text += &season(footage, &kept, arguments.frames, bytes);
        }
    }
    print!("{text}");
    fs::write(bench.out.join("table.md"), text).context("cannot write the tables")
}

fn program(arguments: &Arguments) -> Result<PathBuf> {
    if let Some(program) = &arguments.program {
        return program.canonicalize().with_context(|| format!("no program {program:?}"));
    }
    run(cargo().args(["build", "--quiet", "--release", "--package", "rototoon-cli"]))?;
    Ok(target().join("release/rototoon"))
}

/// Writes shots of different lengths and numbers of parts, and their manifest.
fn small_shots(out: &Path, count: usize) -> Result<PathBuf> {
    let shots: Vec<Value> = (0..count)
        .map(|k| {
            let puppet =
                Puppet { width: 320, height: 180, frames: 12 + k % 7 * 4, step: 12, parts: 2 + k % 3, points: 8 };
            puppet.write(&out.join(format!("small/{k:03}")))?;
            Ok(json!({"name": format!("sh{k:03}"), "project": format!("small/{k:03}/project.json")}))
        })
        .collect::<Result<_>>()?;
    manifest(&out.join("small.json"), &shots)
}

/// Writes a shot of 1920 × 1080 and its manifest. Returns the bytes of its frames too.
fn large_shot(out: &Path, (name, sigma): (&str, f64), frames: usize) -> Result<(PathBuf, u64)> {
    let puppet = Puppet { width: 1920, height: 1080, frames, step: 12, parts: 16, points: 12 };
    puppet.write(&out.join(name))?;
    let mut bytes = 0;
    for frame in 0..frames {
        let path = out.join(format!("{name}/frames/frame_{frame:04}.png"));
        if sigma > 0.0 {
            grain::on_file(&path, sigma, frame as u64)?;
        }
        bytes += fs::metadata(&path).with_context(|| format!("cannot read {path:?}"))?.len();
    }
    let shot = json!({"name": name, "project": format!("{name}/project.json")});
    Ok((manifest(&out.join(format!("{name}.json")), &[shot])?, bytes))
}

fn manifest(path: &Path, shots: &[Value]) -> Result<PathBuf> {
    let steps = json!([{"do": "check"}, {"do": "track"}, {"do": "snap"},
        {"do": "render", "what": "matte", "to": "matte_%04d.png"}, {"do": "render", "what": "overlay", "to": "look_%04d.png"}]);
    let text = json!({"rototoon_batch": 1, "steps": steps, "shots": shots}).to_string();
    fs::write(path, text).with_context(|| format!("cannot write {path:?}"))?;
    Ok(path.to_owned())
}

struct Bench {
    program: PathBuf,
    out: PathBuf,
}

/// A batch that was run.
struct Run {
    jobs: usize,
    /// Seconds by the clock.
    seconds: f64,
    /// Seconds of processors, of the batch and all of its programs.
    processor: f64,
    /// Resident bytes of the batch and its programs, by the second.
    memory: Vec<(f64, u64)>,
    /// The lines of its report that tell of steps.
    steps: Vec<Value>,
}

impl Bench {
    fn batch(&self, manifest: &Path, jobs: usize, memory: Option<f64>) -> Result<Run> {
        let folder = self.out.join("results");
        empty_folder(&folder)?;
        let mut command = Command::new(&self.program);
        command.arg("batch").arg(manifest).arg("-o").arg(&folder).args(["--fine", "keys", "--threads", "1", "--jobs"]);
        command.arg(jobs.to_string()).args(memory.map(|gigabytes| format!("--memory={gigabytes}")));
        let (before, start) = (children_seconds()?, Instant::now());
        let mut child =
            command.stdin(Stdio::null()).stderr(Stdio::null()).spawn().context("cannot start the program")?;
        let mut memory = Vec::new();
        let status = loop {
            if let Some(status) = child.try_wait()? {
                break status;
            }
            memory.push((start.elapsed().as_secs_f64(), resident(child.id())));
            sleep(PAUSE);
        };
        ensure!(status.success(), "rototoon batch ended with {status}: see {folder:?}");
        let seconds = start.elapsed().as_secs_f64();
        let report = fs::read_to_string(folder.join("report.jsonl")).context("no report")?;
        let steps: Vec<Value> = report.lines().filter_map(|line| serde_json::from_str(line).ok()).collect();
        let steps = steps.into_iter().filter(|line| line["event"] == "step").collect();
        Ok(Run { jobs, seconds, processor: children_seconds()? - before, memory, steps })
    }
}

/// Seconds of processors that ended children of this process and their children took.
fn children_seconds() -> Result<f64> {
    let stat = fs::read_to_string("/proc/self/stat").context("the system tells no processor time")?;
    // The second field is a name in parentheses; the ticks are the 16th and 17th, a hundredth of a second each.
    let after = stat.rsplit(')').next().unwrap_or_default();
    let ticks = after.split_whitespace().skip(13).take(2).filter_map(|field| field.parse::<f64>().ok());
    Ok(ticks.sum::<f64>() / 100.0)
}

/// Resident bytes of a process and its children.
fn resident(id: u32) -> u64 {
    let children = fs::read_to_string(format!("/proc/{id}/task/{id}/children")).unwrap_or_default();
    // Children are those of each thread.
    let threads = fs::read_dir(format!("/proc/{id}/task")).into_iter().flatten().flatten();
    let of_threads = threads.filter_map(|thread| fs::read_to_string(thread.path().join("children")).ok());
    let mut ids: Vec<u32> = of_threads.chain([children]).flat_map(|text| numbers(&text)).chain([id]).collect();
    ids.sort_unstable();
    ids.dedup();
    ids.into_iter().map(own_resident).sum()
}

fn numbers(text: &str) -> Vec<u32> {
    text.split_whitespace().filter_map(|word| word.parse().ok()).collect()
}

fn own_resident(id: u32) -> u64 {
    let status = fs::read_to_string(format!("/proc/{id}/status")).unwrap_or_default();
    let line = status.lines().find_map(|line| line.strip_prefix("VmRSS:"));
    line.and_then(|line| line.trim().strip_suffix("kB")?.trim().parse::<u64>().ok()).unwrap_or(0) * 1024
}

fn throughput(runs: &[Run], shots: usize) -> String {
    let mut text = format!("## {shots} shots of 320×180, 12 to 36 frames, 2 to 4 parts\n\n");
    text += "| at a time | seconds | shots a minute | processor seconds | shots a processor minute | peak MB | MB in the first quarter | MB in the last quarter |\n";
    text += "| ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: |\n";
    for run in runs {
        let quarter = |first: f64, last: f64| {
            let part = run.memory.iter().filter(|(at, _)| (first..=last).contains(&(at / run.seconds)));
            megabytes(part.map(|(_, bytes)| *bytes).max().unwrap_or(0))
        };
        let minutes = |seconds: f64| 60.0 * shots as f64 / seconds;
        let _ = writeln!(
            text,
            "| {} | {:.1} | {:.0} | {:.1} | {:.0} | {:.0} | {:.0} | {:.0} |",
            run.jobs,
            run.seconds,
            minutes(run.seconds),
            run.processor,
            minutes(run.processor),
            quarter(0.0, 1.0),
            quarter(0.0, 0.25),
            quarter(0.75, 1.0)
        );
    }
    text + "\n"
}

fn megabytes(bytes: u64) -> f64 {
    bytes as f64 / 1e6
}

/// Parts of a run in the chart of the memory. Each shows its greatest value: the memory rises and falls with every shot, and what
/// matters is whether its height grows.
const PARTS: usize = 40;

/// The greatest memory in each part of a run: percent of the run, megabytes.
fn heights(run: &Run) -> Vec<(f64, f64)> {
    let mut most = [0u64; PARTS];
    for (at, bytes) in &run.memory {
        let part = (at / run.seconds * PARTS as f64) as usize;
        most[part.min(PARTS - 1)] = most[part.min(PARTS - 1)].max(*bytes);
    }
    let middle = |part: usize| 100.0 * (part as f64 + 0.5) / PARTS as f64;
    most.iter().enumerate().map(|(part, bytes)| (middle(part), megabytes(*bytes))).collect()
}

/// Memory over the run, a line for each number of shots at a time.
fn chart(runs: &[Run]) -> Chart {
    let most = runs.iter().flat_map(|run| &run.memory).map(|(_, bytes)| megabytes(*bytes)).fold(1.0, f64::max);
    let series = runs.iter().zip(INKS).map(|(run, ink)| Series {
        name: format!("{} at a time", run.jobs),
        ink,
        dashed: false,
        runs: vec![heights(run)],
    });
    let axis = |label: &str, high: f64| Axis { label: label.into(), low: 0.0, high, logarithmic: false };
    Chart {
        title: "Memory of rototoon batch and its programs".into(),
        note: format!("The most in each of {PARTS} parts of a run."),
        x: axis("% of the run", 100.0),
        panels: vec![Panel { y: axis("MB", 1.1 * most), height: 220.0, series: series.collect() }],
        marked: Vec::new(),
    }
}

fn number(line: &Value, field: &str) -> f64 {
    line[field].as_f64().unwrap_or(0.0)
}

fn by_step((name, sigma): (&str, f64), kept: &Run, plain: &Run, frames: usize) -> String {
    let mut text = format!("## One {name} shot of 1920×1080 (σ {sigma}), {frames} frames, 16 parts, one thread\n\n");
    text += "| step | processor ms a frame, frames kept | decoded again | peak MB, frames kept | decoded again |\n";
    text += "| --- | ---: | ---: | ---: | ---: |\n";
    for (one, other) in kept.steps.iter().zip(&plain.steps) {
        let each = |line: &Value| 1000.0 * number(line, "processor_seconds") / frames as f64;
        let peak = |line: &Value| number(line, "peak_bytes") / 1e6;
        let name = one["step"].as_str().unwrap_or_default();
        let _ = writeln!(
            text,
            "| {name} | {:.1} | {:.1} | {:.0} | {:.0} |",
            each(one),
            each(other),
            peak(one),
            peak(other)
        );
    }
    let all = |run: &Run| 1000.0 * run.processor / frames as f64;
    let _ = writeln!(text, "| all, with hashes and contact sheet | {:.1} | {:.1} | | |", all(kept), all(plain));
    let _ = writeln!(text, "\nBy the clock: {:.1} s and {:.1} s.\n", kept.seconds, plain.seconds);
    text
}

/// What a season costs, from a shot that was measured.
fn season((name, _): (&str, f64), run: &Run, frames: usize, bytes: u64) -> String {
    let (shots, length) = SEASON;
    let each = run.processor / frames as f64;
    let all = each * (shots * length) as f64;
    let size = bytes as f64 / frames as f64 / 1e6;
    let peak = run.steps.iter().map(|line| number(line, "peak_bytes")).fold(0.0, f64::max);
    let kept = run.steps.iter().map(|line| number(line, "kept_bytes")).fold(0.0, f64::max);
    // What is kept grows with the frames, and so does what a shot needs.
    let need = (peak + kept * (length as f64 / frames as f64 - 1.0)) / 1e9;
    let mut text = format!("## {shots} {name} shots of {length} frames of 1920×1080\n\n");
    text += "| workers, one core each | hours | frames a second | read MB a second | GB if all are on one machine |\n";
    text += "| ---: | ---: | ---: | ---: | ---: |\n";
    for workers in WORKERS {
        let rate = workers as f64 / each;
        let hours = all / workers as f64 / 3600.0;
        let memory = need * workers as f64;
        let _ = writeln!(text, "| {workers} | {hours:.1} | {rate:.1} | {:.1} | {memory:.0} |", rate * size);
    }
    let _ = writeln!(text, "\n{:.2} s of a processor a frame; {size:.2} MB a frame on the disk.", each);
    text
}
