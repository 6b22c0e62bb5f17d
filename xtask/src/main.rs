//! Development commands of Rototoon.

#![forbid(unsafe_code)]

mod audit;
mod binary;
mod bundle;
mod debian;
mod demo;
mod disk;
mod docs;
mod elf;
mod fuzz;
mod generate;
mod licences;
mod macos;
mod measure;
mod ofx;
mod photograph;
mod platform;
mod release;
mod steps;
mod test;
mod valgrind;
mod version;
mod wheel;
mod window;
mod windows;

use clap::{Parser, Subcommand};
use std::path::PathBuf;

#[derive(Parser)]
#[command(name = "cargo xtask", about = "Development commands of Rototoon")]
struct Arguments {
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    /// Show the main workflow in real Blender: install, import, track, snap, render. Results are in target/demo.
    Demo {
        /// The project document; the sample cartoon by default.
        #[arg(long)]
        project: Option<PathBuf>,
        /// The binary of an installed Blender; the `bpy` wheel from PyPI by default.
        #[arg(long)]
        blender: Option<PathBuf>,
    },
    /// Run all checks, also in Blender and in an OpenFX host, and list the steps that could not be run.
    Test {
        /// Also run the OpenFX plugin under valgrind.
        #[arg(long)]
        valgrind: bool,
        /// Test the extension and the OpenFX bundle as artists install them, not as the Rust tests build them. Takes longer.
        #[arg(long)]
        release: bool,
        /// Run one step only, on what those before it left.
        #[arg(long, value_name = "NAME")]
        step: Option<String>,
    },
    /// Check licences, sources and known weaknesses of all dependencies, and write bills of materials to target/sbom.
    Audit,
    /// Build and validate the extension's zip and the OpenFX bundle.
    Bundle,
    /// Write the C header and the Python bindings.
    Generate {
        /// Change nothing, and fail if a file is stale.
        #[arg(long)]
        check: bool,
    },
    /// Measure shots a minute and memory of `rototoon batch`, and what a season costs.
    #[command(disable_help_flag = true)]
    BenchBatch(measure::Rest),
    /// Measure fills on line drawings with known colours, with tables and sheets in target/bench-fill.
    #[command(disable_help_flag = true)]
    BenchFill(measure::Rest),
    /// Measure curve fitting beside its peers on six outlines.
    #[command(disable_help_flag = true)]
    BenchFit(measure::Rest),
    /// Measure factorisation beside scikit-learn, reshaping beside libigl, and the style paper's experiments, with plots in target/style.
    #[command(disable_help_flag = true)]
    BenchStyle(measure::Rest),
    /// Measure every preset on sets with known truth, with tables and pictures in target/bench-tracking.
    #[command(disable_help_flag = true)]
    BenchTracking(measure::Rest),
    /// Measure matching and in-betweens on sets with known truth, with sheets in target/bench-tween.
    #[command(disable_help_flag = true)]
    BenchTween(measure::Rest),
    /// Measure in a real Blender window for how long Track holds the main thread (as `photograph`, needs root and debootstrap).
    BenchWindow,
    /// Accept the golden pictures and the generated pages that the tests last wrote.
    Bless,
    /// Build the documentation into target/book.
    Docs {
        /// Also fail where a link, an anchor or a picture is missing.
        #[arg(long)]
        check: bool,
    },
    /// Run the fuzz targets, with libFuzzer if there is a nightly compiler.
    Fuzz {
        /// One target; all by default.
        target: Option<String>,
        /// Minutes for each target.
        #[arg(long, default_value_t = 1.0)]
        minutes: f64,
    },
    /// Photograph every panel and Match Strokes in a real Blender window (Debian sid in a chroot; needs root and debootstrap).
    Photograph,
    /// Press every button of the tab in a real Blender window, with pictures and tables in target/press (as `photograph`, needs root
    /// and debootstrap). Fails where a button does nothing, errs, or has no press.
    Press {
        /// Theme and scale: dark-1x, light-1x, dark-2x, light-2x. All by default.
        #[arg(value_name = "VARIANT", value_parser = ["dark-1x", "light-1x", "dark-2x", "light-2x"])]
        variants: Vec<String>,
    },
    /// Make the whole set of a release below target/release-set, and check each file of it.
    Release {
        /// Publish nothing. The set is published by the workflow of a tag only, so this must be given.
        #[arg(long, required = true)]
        dry_run: bool,
        /// Build the Linux files twice, and compare the bytes.
        #[arg(long)]
        twice: bool,
    },
    /// Build for macOS with zig, and read the files. They are not run.
    Macos,
    /// Build for Windows, read the files, and run the Rust tests under Wine (Debian sid in a chroot; needs root and debootstrap).
    Windows {
        /// Test this package only; may be given several times. All by default.
        #[arg(long, short, value_name = "NAME")]
        package: Vec<String>,
        /// A folder with a `project.json`, whose tracks must be the same bytes as on Linux; may be given several times.
        #[arg(long, value_name = "FOLDER")]
        set: Vec<PathBuf>,
        /// The program of Linux to compare with.
        #[arg(long, value_name = "PROGRAM", default_value = "target/x86_64-unknown-linux-gnu/release/rototoon")]
        linux: PathBuf,
        /// Build and compare what the tests use, not what artists install. Takes a fraction of the time.
        #[arg(long)]
        quick: bool,
    },
}

fn main() -> anyhow::Result<()> {
    match Arguments::parse().command {
        Command::Demo { project, blender } => demo::demo(project, blender),
        Command::Test { step: Some(step), release, .. } => test::step(&step, build(release)),
        Command::Test { valgrind, release, step: None } => test::test(valgrind, build(release)),
        Command::Audit => audit::audit(),
        Command::Bundle => bundle::bundle(&bundle::Packager::from_wheel()?, bundle::Build::Installed).map(|_| ()),
        Command::Generate { check } => generate::generate(check),
        Command::BenchBatch(rest) => measure::run("bench-batch", &rest),
        Command::BenchFill(rest) => measure::run("bench-fill", &rest),
        Command::BenchFit(rest) => measure::run("bench-fit", &rest),
        Command::BenchStyle(rest) => measure::run("bench-style", &rest),
        Command::BenchTracking(rest) => measure::run("bench-tracking", &rest),
        Command::BenchTween(rest) => measure::run("bench-tween", &rest),
        Command::BenchWindow => photograph::bench_window(),
        Command::Bless => measure::run("bless", &measure::Rest::default()),
        Command::Docs { check } => docs::docs(check),
        Command::Fuzz { target, minutes } => fuzz::fuzz(target.as_deref(), minutes),
        Command::Photograph => photograph::photograph(),
        Command::Press { variants } => photograph::press(&variants),
        Command::Release { dry_run: _, twice } => release::release(twice),
        Command::Macos => macos::build().map(|_| ()),
        Command::Windows { package, set, linux, quick } => {
            let profile = if quick { windows::Profile::Tested } else { windows::Profile::Release };
            windows::windows(&package, &set, &linux, profile)
        }
    }
}

fn build(release: bool) -> bundle::Build {
    if release { bundle::Build::Installed } else { bundle::Build::Tested }
}
