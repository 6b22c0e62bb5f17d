//! Development commands of Rototoon.

mod bench_fit;
mod bench_style;
mod bench_tracking;
mod bench_tween;
mod bless;
mod bundle;
mod demo;
mod elf;
mod generate;
mod ofx;
mod photograph;
mod python;
mod shell;
mod steps;
mod test;

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
        /// Run only this step, with the files that earlier steps have left.
        #[arg(long, value_name = "NAME")]
        step: Option<String>,
    },
    /// Build and validate the extension's zip and the OpenFX bundle.
    Bundle,
    /// Write the C header and the Python bindings.
    Generate {
        /// Change nothing, and fail if a file is stale.
        #[arg(long)]
        check: bool,
    },
    /// Compare curve fitting with other libraries on six outlines.
    BenchFit(bench_fit::Arguments),
    /// Compare factorisation with scikit-learn and reshaping with libigl, and run the style paper's experiments. Plots are in
    /// target/style.
    BenchStyle(bench_style::Arguments),
    /// Measure every tracking preset on sets with known truth. Tables and pictures are in target/bench-tracking.
    BenchTracking(bench_tracking::Arguments),
    /// Measure matching and in-betweens on sets with known truth. Sheets are in target/bench-tween.
    BenchTween(bench_tween::Arguments),
    /// Accept the pictures that the last tests drew as the new golden pictures.
    Bless,
    /// Take pictures of the panel in a real Blender window (Debian sid in a chroot; needs root and debootstrap).
    Photograph,
}

fn main() -> anyhow::Result<()> {
    match Arguments::parse().command {
        Command::Demo { project, blender } => demo::demo(project, blender),
        Command::Test { step: Some(step), .. } => test::step(&step),
        Command::Test { valgrind, step: None } => test::test(valgrind),
        Command::Bundle => bundle::bundle(&bundle::Packager::from_wheel()?).map(|_| ()),
        Command::Generate { check } => generate::generate(check),
        Command::BenchFit(arguments) => bench_fit::bench_fit(&arguments),
        Command::BenchStyle(arguments) => bench_style::bench_style(&arguments),
        Command::BenchTracking(arguments) => bench_tracking::bench_tracking(&arguments),
        Command::BenchTween(arguments) => bench_tween::bench_tween(&arguments),
        Command::Bless => bless::bless(),
        Command::Photograph => photograph::photograph(),
    }
}
