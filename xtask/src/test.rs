//! `test`: everything that is checked, each step to its end, and a summary that hides nothing.

use crate::bundle::{Bundle, Packager, bundle};
use crate::generate::generate;
use crate::python::{self, WHEELS, Wheel};
use crate::shell::{capture, cargo, command, empty_folder, root, run, target, works};
use anyhow::{Result, bail};
use rototoon_tests::{doll, sample};
use std::path::Path;
use std::time::Instant;

/// The package that is built apart: it compiles C++.
const OFX_HOST: &str = "rototoon-ofx-host";

/// How a step ended.
enum Outcome {
    Passed,
    Failed(String),
    NotRun(String),
}

/// The steps done so far.
#[derive(Default)]
struct Report {
    steps: Vec<(String, Outcome, f64)>,
}

impl Report {
    /// Runs a step; `Ok(Some(reason))` says that it could not be run here.
    fn step(&mut self, name: &str, body: impl FnOnce() -> Result<Option<String>>) -> bool {
        println!("\n=== {name}");
        let start = Instant::now();
        let outcome = match body() {
            Ok(None) => Outcome::Passed,
            Ok(Some(reason)) => Outcome::NotRun(reason),
            Err(error) => {
                eprintln!("{error:#}");
                Outcome::Failed(format!("{error:#}"))
            }
        };
        let passed = matches!(outcome, Outcome::Passed);
        self.steps.push((name.to_owned(), outcome, start.elapsed().as_secs_f64()));
        passed
    }

    fn print(&self) {
        println!("\n=== Summary");
        for (name, outcome, seconds) in &self.steps {
            let (word, reason) = match outcome {
                Outcome::Passed => ("passed", String::new()),
                Outcome::Failed(reason) => ("FAILED", format!(": {}", reason.lines().next().unwrap_or_default())),
                Outcome::NotRun(reason) => ("NOT RUN", format!(": {reason}")),
            };
            println!("{word:<8} {name} ({seconds:.0} s){reason}");
        }
    }

    fn finish(&self) -> Result<()> {
        self.print();
        let count = |f: fn(&Outcome) -> bool| self.steps.iter().filter(|(_, outcome, _)| f(outcome)).count();
        let failed = count(|o| matches!(o, Outcome::Failed(_)));
        let not_run = count(|o| matches!(o, Outcome::NotRun(_)));
        if not_run > 0 {
            println!("{not_run} of {} steps could not be run here", self.steps.len());
        }
        if failed > 0 {
            bail!("{failed} of {} steps failed", self.steps.len());
        }
        Ok(())
    }
}

/// Runs all checks. Fails where one fails; what could not be run is said, and fails nothing.
pub fn test(valgrind: bool) -> Result<()> {
    if !works("cc", &["--version"]) {
        bail!("no C compiler (cc) was found; install one, for example: apt-get install gcc");
    }
    let mut report = Report::default();
    report.step("format", || component("fmt", "rustfmt", &["fmt", "--all", "--check"]));
    report.step("clippy", || {
        let arguments = ["clippy", "--quiet", "--workspace", "--exclude", OFX_HOST, "--all-targets"];
        component("clippy", "clippy", &[&arguments[..], &["--", "-D", "warnings"]].concat())
    });
    report.step("Rust tests", || {
        run(cargo().args(["test", "--quiet", "--workspace", "--exclude", OFX_HOST])).map(|()| None)
    });
    report.step("generated files are current", || generate(true).map(|()| None));
    let mut built = None;
    report.step("extension bundle", || {
        built = Some(bundle(&Packager::from_wheel()?)?);
        Ok(None)
    });
    report.step("OpenFX host", || ofx_tests(built.as_ref()));
    if valgrind {
        report.step("OpenFX host under valgrind", valgrind_tests);
    }
    report.step("Python tests", || python_tests(built.as_ref()));
    let files = target().join("sample-files");
    report.step("sample cartoon", || sample_files(&files).map(|()| None));
    for wheel in WHEELS {
        report.step(&format!("Blender {}", wheel.blender), || blender_tests(wheel, built.as_ref(), &files));
    }
    report.finish()
}

/// A cargo subcommand that comes as a component of the toolchain; added by rustup where it is missing.
fn component(subcommand: &str, name: &str, arguments: &[&str]) -> Result<Option<String>> {
    let there = || run(cargo().args([subcommand, "--version"]).stdout(std::process::Stdio::null())).is_ok();
    if !there() {
        let _ = run(command("rustup").args(["component", "add", name]));
    }
    if !there() {
        return Ok(Some(format!("cargo {subcommand} is missing; install it: rustup component add {name}")));
    }
    run(cargo().args(arguments)).map(|()| None)
}

/// The plugin in the official host library, which is compiled for it.
fn ofx_tests(built: Option<&Bundle>) -> Result<Option<String>> {
    let Some(built) = built else { return Ok(Some("the bundle failed".into())) };
    if let Some(reason) = missing_package("c++", "g++") {
        return Ok(Some(reason));
    }
    run(cargo().args(["clippy", "--quiet", "-p", OFX_HOST, "--all-targets", "--", "-D", "warnings"]))?;
    run(cargo().args(["test", "--quiet", "-p", OFX_HOST]).env("ROTOTOON_OFX_BUNDLE", &built.ofx))?;
    Ok(None)
}

/// The same, watched by valgrind, compiled as artists get it: under valgrind tracking would else take very long.
fn valgrind_tests() -> Result<Option<String>> {
    if let Some(reason) = missing_package("valgrind", "valgrind").or_else(|| missing_package("c++", "g++")) {
        return Ok(Some(reason));
    }
    let runner = "valgrind --quiet --error-exitcode=9 --leak-check=full --errors-for-leak-kinds=definite";
    run(cargo()
        .args(["test", "--quiet", "--release", "-p", OFX_HOST, "--test", "main"])
        .env("CARGO_TARGET_X86_64_UNKNOWN_LINUX_GNU_RUNNER", runner))?;
    Ok(None)
}

/// Why a program cannot be had; where the system lets us, its package is installed first.
fn missing_package(program: &str, package: &str) -> Option<String> {
    let there = || works(program, &["--version"]);
    if !there() && capture(command("id").arg("-u")).is_ok_and(|id| id == "0") {
        let _ = run(command("apt-get").args(["update", "--quiet"]));
        let _ = run(command("apt-get").args(["install", "--yes", "--quiet", package]));
    }
    (!there()).then(|| format!("{program} is missing; install it: apt-get install {package}"))
}

/// pytest without Blender, on the packed library.
fn python_tests(built: Option<&Bundle>) -> Result<Option<String>> {
    let Some(built) = built else { return Ok(Some("the bundle failed".into())) };
    let python = python::venv("venv-python", &python::find_any()?, &["pytest", "numpy"])?;
    run(command(python)
        .args(["-m", "pytest", "-q", "-p", "no:cacheprovider", "tests/python"])
        .env("ROTOTOON_LIBRARY", &built.library)
        .env("ROTOTOON_CLI", &built.cli))?;
    Ok(None)
}

/// The sample cartoon and the doll, which tests in Blender track and reshape.
fn sample_files(folder: &Path) -> Result<()> {
    sample::write(&folder.join("sample"))?;
    doll::write(&folder.join("doll"))
}

/// pytest inside one Blender, with the zip installed in a configuration of its own.
fn blender_tests(wheel: Wheel, built: Option<&Bundle>, files: &Path) -> Result<Option<String>> {
    let Some(built) = built else { return Ok(Some("the bundle failed".into())) };
    let Some(python) = python::blender_venv(wheel)? else {
        return Ok(Some(format!("it needs Python {}, which was not found", wheel.python)));
    };
    let resources = target().join(format!("blender-user-{}", wheel.blender));
    empty_folder(&resources)?;
    run(command(python)
        .args(["-m", "pytest", "-q", "-p", "no:cacheprovider", "tests/blender"])
        .env("ROTOTOON_ZIP", &built.zip)
        .env("ROTOTOON_CLI", &built.cli)
        .env("ROTOTOON_ROOT", root())
        .env("ROTOTOON_SAMPLE", files)
        .env("BLENDER_USER_RESOURCES", resources)
        // The library of the zip is what is tested.
        .env_remove("ROTOTOON_LIBRARY"))?;
    Ok(None)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_failed_step_fails_the_whole_and_the_others_go_on() {
        let mut report = Report::default();
        assert!(report.step("a", || Ok(None)));
        assert!(!report.step("b", || bail!("broken")));
        assert!(!report.step("c", || Ok(Some("no such machine".into()))));
        assert_eq!(report.finish().unwrap_err().to_string(), "1 of 3 steps failed");
    }

    #[test]
    fn what_could_not_be_run_fails_nothing() {
        let mut report = Report::default();
        report.step("a", || Ok(Some("no such machine".into())));
        report.finish().unwrap();
    }
}
