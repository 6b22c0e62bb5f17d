//! Development commands that need the core. `cargo xtask` starts them; they are a program of their own so that the other
//! commands are built in seconds.

mod bench_batch;
mod bench_fill;
mod bench_fit;
mod bench_style;
mod bench_tracking;
mod bench_tween;
mod bless;
mod report;
mod sets;

use clap::{Parser, Subcommand};
use rototoon_tests::{doll, sample};
use std::path::PathBuf;

#[derive(Parser)]
#[command(name = "cargo xtask", about = "Development commands of Rototoon that need the core")]
struct Arguments {
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    /// Measure shots a minute and memory of `rototoon batch`, and what a season costs, with tables in target/bench-batch.
    BenchBatch(bench_batch::Arguments),
    /// Measure fills on line drawings with known colours, with tables and sheets in target/bench-fill.
    BenchFill(bench_fill::Arguments),
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
    /// Write the contact sheet and the table of the demo.
    Report {
        /// The document that was given to the demo.
        project: PathBuf,
        /// The demo's folder.
        out: PathBuf,
    },
    /// Write the sample cartoon to FOLDER/sample and the jointed doll to FOLDER/doll.
    Sample {
        /// The folder to write to.
        folder: PathBuf,
    },
}

fn main() -> anyhow::Result<()> {
    match Arguments::parse().command {
        Command::BenchBatch(arguments) => bench_batch::bench_batch(&arguments),
        Command::BenchFill(arguments) => bench_fill::bench_fill(&arguments),
        Command::BenchFit(arguments) => bench_fit::bench_fit(&arguments),
        Command::BenchStyle(arguments) => bench_style::bench_style(&arguments),
        Command::BenchTracking(arguments) => bench_tracking::bench_tracking(&arguments),
        Command::BenchTween(arguments) => bench_tween::bench_tween(&arguments),
        Command::Bless => bless::bless(),
        Command::Report { project, out } => report::report(&project, &out),
        Command::Sample { folder } => {
            sample::write(&folder.join("sample"))?;
            doll::write(&folder.join("doll"))
        }
    }
}
