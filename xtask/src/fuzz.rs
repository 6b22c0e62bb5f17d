//! `fuzz`: runs the targets of `tests/fuzz`, with libFuzzer if there is a nightly compiler, and otherwise with the loop of
//! `fuzz-stable`, which changes seeds and sees nothing of the code.
//!
//! cargo-fuzz builds the programs; it is compiled once below `target/` if it is not on the search path. The programs are
//! started without it, because it would look for changes of the sources before each target.

use anyhow::{Context, Result, bail, ensure};
use std::collections::BTreeSet;
use std::ffi::OsString;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::Instant;
use xtask_shell::shell::{capture, cargo, command, root, run, target, works};

/// The cargo-fuzz that is compiled where none is installed.
const VERSION: &str = "0.13.2";
/// The folder in cargo-fuzz's layout.
const FOLDER: &str = "tests/fuzz/fuzz";
/// The stable program, in the folder of built files.
const STABLE: &str = "debug/fuzz-stable";
/// The system for which cargo-fuzz builds.
const TRIPLE: &str = "x86_64-unknown-linux-gnu";
/// Limits of one execution: memory in MB, seconds, bytes of the input. A single allocation is not limited, because the
/// product asks for memory by trying to reserve it; what it then uses is.
const LIMITS: [&str; 4] = ["-rss_limit_mb=2048", "-malloc_limit_mb=16777216", "-timeout=10", "-max_len=4096"];

/// What the runs of a target gave.
struct Outcome {
    name: String,
    executions: u64,
    seconds: f64,
    findings: Vec<PathBuf>,
}

/// Runs one target or all, each for some minutes. Fails if there is a finding.
pub fn fuzz(target: Option<&str>, minutes: f64) -> Result<()> {
    ensure!(minutes > 0.0 && minutes <= 10_000.0, "minutes: found {minutes}, expected a positive number to 10000");
    let names = names(target)?;
    run(cargo().args(["build", "--quiet", "--package", "rototoon-fuzz", "--bin", "fuzz-stable"]))?;
    let nightly = works("rustup", &["run", "nightly", "rustc", "--version"]);
    if nightly {
        build(target)?;
    } else {
        println!("fuzz: no nightly compiler (rustup toolchain install nightly); changing seeds without libFuzzer");
    }
    let seconds = (minutes * 60.0).ceil() as u64;
    let mut outcomes = Vec::new();
    for name in names {
        println!("fuzz: {name}");
        outcomes.push(if nightly { with_libfuzzer(&name, seconds)? } else { without(&name, seconds)? });
    }
    print(&outcomes);
    let findings: usize = outcomes.iter().map(|outcome| outcome.findings.len()).sum();
    ensure!(findings == 0, "{findings} findings; docs/src/contributing/fuzzing.md says what to do with them");
    Ok(())
}

/// The names of the targets: those of the programs for libFuzzer.
fn names(wanted: Option<&str>) -> Result<Vec<String>> {
    let folder = root().join(FOLDER).join("fuzz_targets");
    let mut names = Vec::new();
    for entry in std::fs::read_dir(&folder).with_context(|| format!("cannot read {}", folder.display()))? {
        names.extend(entry?.path().file_stem().map(|name| name.to_string_lossy().into_owned()));
    }
    names.sort();
    match wanted {
        None => Ok(names),
        Some(name) if names.iter().any(|known| known == name) => Ok(vec![name.to_owned()]),
        Some(name) => bail!("target: found {name:?}, expected one of {}", names.join(", ")),
    }
}

/// Builds the programs for libFuzzer.
fn build(target_name: Option<&str>) -> Result<()> {
    // The same versions of all dependencies as the workspace's.
    std::fs::copy(root().join("Cargo.lock"), root().join(FOLDER).join("Cargo.lock"))?;
    let program = cargo_fuzz()?;
    run(nightly(&program)
        .args(["fuzz", "build", "--fuzz-dir", FOLDER, "--target", TRIPLE])
        .args(target_name)
        .env_remove("CARGO_BUILD_BUILD_DIR")
        .env("CARGO_TARGET_DIR", libfuzzer_target()))
}

/// The folder of what libFuzzer's programs are built from. They share nothing with other builds.
fn libfuzzer_target() -> PathBuf {
    target().join("fuzz")
}

/// A program that starts the nightly cargo, and not the one that started this program.
fn nightly(program: &Path) -> Command {
    let mut command = command(program);
    command.env_remove("CARGO").env("RUSTUP_TOOLCHAIN", "nightly");
    command
}

/// cargo-fuzz from the search path, or compiled once.
fn cargo_fuzz() -> Result<PathBuf> {
    let fits = |program: &Path| capture(command(program).arg("--version")).is_ok();
    let on_path = PathBuf::from("cargo-fuzz");
    let folder = target().join("cargo-fuzz");
    let compiled = folder.join("bin/cargo-fuzz");
    for program in [on_path, compiled.clone()] {
        if fits(&program) {
            return Ok(program);
        }
    }
    println!("fuzz: no cargo-fuzz; compiling it once");
    run(cargo()
        .args(["install", "--quiet", "--locked", "cargo-fuzz", "--version", VERSION, "--force", "--root"])
        .arg(&folder)
        .env("CARGO_TARGET_DIR", target().join("cargo-fuzz-build")))?;
    ensure!(fits(&compiled), "cargo install left no cargo-fuzz that runs");
    Ok(compiled)
}

/// A folder of a target, below that of built files.
fn folder(kind: &str, name: &str) -> Result<PathBuf> {
    let folder = libfuzzer_target().join(kind).join(name);
    std::fs::create_dir_all(&folder).with_context(|| format!("cannot make {}", folder.display()))?;
    Ok(folder)
}

fn with_libfuzzer(name: &str, seconds: u64) -> Result<Outcome> {
    let (corpus, seeds, artifacts) = (folder("corpus", name)?, folder("seeds", name)?, folder("artifacts", name)?);
    run(command(target().join(STABLE)).args(["seeds", name]).arg(&seeds))?;
    let before = files(&artifacts)?;
    let mut prefix = OsString::from("-artifact_prefix=");
    prefix.push(artifacts.join(""));
    let begun = Instant::now();
    let program = libfuzzer_target().join(TRIPLE).join("release").join(name);
    let words = root().join(FOLDER).join("dictionaries").join(format!("{name}.dict"));
    let output = command(&program)
        .args(words.is_file().then(|| format!("-dict={}", words.display())))
        .args([&corpus, &seeds])
        .args(LIMITS)
        .arg(format!("-max_total_time={seconds}"))
        .arg("-print_final_stats=1")
        .arg(prefix)
        // One core is enough, and threads would take turns in another order on each run.
        .env("RAYON_NUM_THREADS", "1")
        .env("ASAN_OPTIONS", "detect_odr_violation=0:allocator_may_return_null=1")
        .output()
        .with_context(|| format!("cannot start {}", program.display()))?;
    let said = String::from_utf8_lossy(&output.stderr);
    let findings: Vec<PathBuf> =
        files(&artifacts)?.difference(&before).filter(|file| is_finding(file)).cloned().collect();
    if !output.status.success() {
        let log = artifacts.join("last.log");
        std::fs::write(&log, said.as_bytes())?;
        ensure!(!findings.is_empty(), "{name} ended with {} and left no input; see {}", output.status, log.display());
    }
    let executions = number_after(&said, "stat::number_of_executed_units:").or_else(|| last_count(&said));
    Ok(Outcome {
        name: name.to_owned(),
        executions: executions.unwrap_or_default(),
        seconds: begun.elapsed().as_secs_f64(),
        findings,
    })
}

fn files(folder: &Path) -> Result<BTreeSet<PathBuf>> {
    std::fs::read_dir(folder)?.map(|entry| Ok(entry?.path())).collect()
}

/// Whether libFuzzer's file is a finding. An input that took ten seconds without passing the limit is none.
fn is_finding(file: &Path) -> bool {
    let name = file.file_name().unwrap_or_default().to_string_lossy();
    ["crash-", "leak-", "oom-", "timeout-"].iter().any(|kind| name.starts_with(kind))
}

fn number_after(text: &str, word: &str) -> Option<u64> {
    let rest = &text[text.rfind(word)? + word.len()..];
    rest.split_whitespace().next()?.parse().ok()
}

/// The number of executions in libFuzzer's last line of progress (`#1234 NEW …`): a crash has no statistics.
fn last_count(text: &str) -> Option<u64> {
    let count = |line: &str| line.strip_prefix('#')?.split_whitespace().next()?.parse().ok();
    text.lines().rev().find_map(count)
}

fn without(name: &str, seconds: u64) -> Result<Outcome> {
    let findings = folder("stable", name)?;
    let begun = Instant::now();
    let mut program = command(target().join(STABLE));
    program.args(["run", name, &seconds.to_string()]).arg(&findings);
    let output = program.output().with_context(|| format!("cannot start {STABLE}"))?;
    let said = String::from_utf8_lossy(&output.stdout);
    let mut found: Vec<PathBuf> =
        said.lines().filter_map(|line| line.strip_prefix("finding ")).map(PathBuf::from).collect();
    if !output.status.success() && found.is_empty() {
        // The process died. The file of the input that ran is what is left.
        found.extend(files(&findings)?.into_iter().filter(|file| file.to_string_lossy().contains("present-")));
        ensure!(!found.is_empty(), "{name} ended with {}: {}", output.status, String::from_utf8_lossy(&output.stderr));
    }
    Ok(Outcome {
        name: name.to_owned(),
        executions: number_after(&said, "executions").unwrap_or_default(),
        seconds: begun.elapsed().as_secs_f64(),
        findings: found,
    })
}

fn print(outcomes: &[Outcome]) {
    println!("\n{:<12} {:>12} {:>8} {:>8}", "target", "executions", "seconds", "findings");
    for Outcome { name, executions, seconds, findings } in outcomes {
        println!("{name:<12} {executions:>12} {seconds:>8.0} {:>8}", findings.len());
    }
    for Outcome { name, findings, .. } in outcomes {
        findings.iter().for_each(|file| println!("finding of {name}: {}", file.display()));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn executions_are_read_of_what_libfuzzer_says() {
        let said = "#2\tINITED cov: 5\n#77\tNEW    cov: 9\nstat::number_of_executed_units: 1234\nstat::x: 1\n";
        assert_eq!(number_after(said, "stat::number_of_executed_units:"), Some(1234));
        assert_eq!(last_count(said), Some(77));
        assert_eq!(last_count("nothing"), None);
    }

    #[test]
    fn targets_are_known_by_their_programs() {
        assert!(names(None).unwrap().len() >= 18);
        assert_eq!(names(Some("svg")).unwrap(), ["svg"]);
        assert!(names(Some("gif")).unwrap_err().to_string().contains("expected one of bvh, clips"));
    }
}
