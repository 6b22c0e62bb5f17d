//! `test`: runs all checks. Each is a step of its own ([`crate::steps`]).

use crate::bundle::{self, Bundle, Packager, bundle};
use crate::generate::generate;
use crate::python::{self, WHEELS, Wheel};
use crate::shell::{capture, cargo, command, empty_folder, root, run, target, works};
use crate::steps::{Step, in_own_process, run_all};
use anyhow::{Result, bail};
use rototoon_tests::{doll, sample};
use std::path::PathBuf;

/// The package that is built separately, because it compiles C++.
const OFX_HOST: &str = "rototoon-ofx-host";
/// Number of steps that run at the same time.
const AT_ONCE: usize = 2;
/// Names of the steps that others need.
const ENVIRONMENTS: &str = "Python environments";
const BUNDLE: &str = "extension bundle";
const FILES: &str = "sample cartoon";

/// Runs all checks. Fails if one of them fails. Checks that cannot be run here are listed and do not count as failures.
pub fn test(valgrind: bool) -> Result<()> {
    if !works("cc", &["--version"]) {
        bail!("no C compiler (cc) was found; install one, for example: apt-get install gcc");
    }
    let steps = steps(valgrind);
    let run = |name: &str| {
        println!("started: {name}");
        in_own_process(name)
    };
    run_all(&steps, AT_ONCE, &run).finish()
}

/// Runs one check. [`test`] runs this function in a process of its own for each check.
pub fn step(name: &str) -> Result<()> {
    let steps = steps(true);
    let Some(step) = steps.iter().find(|step| step.name == name) else {
        let names: Vec<&str> = steps.iter().map(|step| &step.name[..]).collect();
        bail!("--step: found {name:?}, expected one of {names:?}");
    };
    step.run_here()
}

/// All checks, in an order that starts those that others need first.
fn steps(valgrind: bool) -> Vec<Step> {
    let mut steps = vec![
        Step::new("format", || component("fmt", "rustfmt", &["fmt", "--all", "--check"])),
        Step::new(ENVIRONMENTS, || environments().map(|()| None)),
        Step::new("clippy", clippy).builds(),
        Step::new(BUNDLE, || bundle(&Packager::from_wheel()?).map(|_| None)).after(ENVIRONMENTS),
        Step::new("Rust tests", rust_tests).builds().after("clippy"),
        Step::new("generated files are current", || generate(true).map(|()| None)),
        Step::new(FILES, || sample_files().map(|()| None)),
        Step::new("Python tests", python_tests).needs(BUNDLE),
        Step::new("OpenFX host", ofx_tests).builds().needs(BUNDLE),
    ];
    for wheel in WHEELS {
        let name = format!("Blender {}", wheel.blender);
        steps.push(Step::new(&name, move || blender_tests(wheel)).needs(BUNDLE).needs(FILES));
    }
    if valgrind {
        steps.push(Step::new("OpenFX host under valgrind", valgrind_tests).after("OpenFX host"));
    }
    steps
}

/// Makes the Python environments of all steps in advance. Downloads leave the processors to the compiler meanwhile.
fn environments() -> Result<()> {
    bundle::tools()?;
    python_environment()?;
    for wheel in WHEELS {
        python::blender_venv(wheel)?;
    }
    Ok(())
}

fn clippy() -> Result<Option<String>> {
    let arguments = ["clippy", "--quiet", "--workspace", "--exclude", OFX_HOST, "--all-targets"];
    component("clippy", "clippy", &[&arguments[..], &["--", "-D", "warnings"]].concat())
}

fn rust_tests() -> Result<Option<String>> {
    run(cargo().args(["test", "--quiet", "--no-fail-fast", "--workspace", "--exclude", OFX_HOST])).map(|()| None)
}

/// Runs a Cargo subcommand that is a component of the toolchain. If it is missing, rustup adds it.
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

/// Tests the plugin in a host with the official host library, which is compiled for it.
fn ofx_tests() -> Result<Option<String>> {
    if let Some(reason) = missing_package("c++", "g++") {
        return Ok(Some(reason));
    }
    run(cargo().args(["clippy", "--quiet", "-p", OFX_HOST, "--all-targets", "--", "-D", "warnings"]))?;
    run(cargo().args(["test", "--quiet", "-p", OFX_HOST]).env("ROTOTOON_OFX_BUNDLE", Bundle::last().ofx))?;
    Ok(None)
}

/// Runs the same tests under valgrind, as a release build, because an unoptimised tracker would take very long.
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

/// The reason why a program is missing, if it is. Root installs its package first.
fn missing_package(program: &str, package: &str) -> Option<String> {
    let there = || works(program, &["--version"]);
    if !there() && capture(command("id").arg("-u")).is_ok_and(|id| id == "0") {
        let _ = run(command("apt-get").args(["update", "--quiet"]));
        let _ = run(command("apt-get").args(["install", "--yes", "--quiet", package]));
    }
    (!there()).then(|| format!("{program} is missing; install it: apt-get install {package}"))
}

/// Runs pytest without Blender, with the library of the bundle.
fn python_tests() -> Result<Option<String>> {
    let built = Bundle::last();
    run(command(python_environment()?)
        .args(["-m", "pytest", "-q", "-p", "no:cacheprovider", "tests/python"])
        .env("ROTOTOON_LIBRARY", &built.library)
        .env("ROTOTOON_CLI", &built.cli))?;
    Ok(None)
}

fn python_environment() -> Result<PathBuf> {
    python::venv("venv-python", &python::find_any()?, &["pytest", "numpy"])
}

/// The folder of the sample cartoon and the doll.
fn files() -> PathBuf {
    target().join("sample-files")
}

/// Writes the sample cartoon and the doll, which tests in Blender track and reshape.
fn sample_files() -> Result<()> {
    sample::write(&files().join("sample"))?;
    doll::write(&files().join("doll"))
}

/// Runs pytest inside one version of Blender, with the zip installed in a configuration of its own.
fn blender_tests(wheel: Wheel) -> Result<Option<String>> {
    let built = Bundle::last();
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
        .env("ROTOTOON_SAMPLE", files())
        .env("BLENDER_USER_RESOURCES", resources)
        // The tests must use the library in the zip.
        .env_remove("ROTOTOON_LIBRARY"))?;
    Ok(None)
}
