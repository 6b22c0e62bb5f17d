//! Development commands of Rototoon.

mod bench_fit;
mod bench_style;
mod bench_tracking;
mod bench_tween;
mod bless;
mod bundle;
mod demo;
mod docs;
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
    /// Show the main job in real Blender: install, import, track, snap, render. Results are in target/demo.
    Demo {
        /// A project document; the sample cartoon where none is given.
        #[arg(long)]
        project: Option<PathBuf>,
        /// An installed Blender; the `bpy` wheel from PyPI where none is given.
        #[arg(long)]
        blender: Option<PathBuf>,
    },
    /// Run every check, in Blender and in an OpenFX host too, and say what could not be run.
    Test {
        /// Also run the OpenFX plugin under valgrind.
        #[arg(long)]
        valgrind: bool,
        /// Run one step only, on what those before it left.
        #[arg(long, value_name = "NAME")]
        step: Option<String>,
    },
    /// Build and validate the extension's zip and the OpenFX bundle.
    Bundle,
    /// Write the C header and the Python bindings.
    Generate {
        /// Change nothing; fail where a file is stale.
        #[arg(long)]
        check: bool,
    },
    /// Measure curve fitting beside its peers on six outlines.
    BenchFit(bench_fit::Arguments),
    /// Measure factorisation beside scikit-learn, reshaping beside libigl, and the style paper's experiments, with plots in target/style.
    BenchStyle(bench_style::Arguments),
    /// Measure every preset on sets with known truth, with tables and pictures in target/bench-tracking.
    BenchTracking(bench_tracking::Arguments),
    /// Measure matching and in-betweens on sets with known truth, with sheets in target/bench-tween.
    BenchTween(bench_tween::Arguments),
    /// Accept the golden pictures and the generated pages that the tests last wrote.
    Bless,
    /// Build the documentation into target/book.
    Docs {
        /// Also fail where a link, an anchor or a picture is missing.
        #[arg(long)]
        check: bool,
    },
    /// Photograph every panel and Match Strokes in a real Blender window (Debian sid in a chroot; needs root and debootstrap).
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
        Command::Docs { check } => docs::docs(check),
        Command::Photograph => photograph::photograph(),
    }
}
