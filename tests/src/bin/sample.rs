//! Writes the sample cartoon and the jointed doll into a folder, for tests that are not written in Rust.
//!
//! `sample FOLDER` writes `FOLDER/sample` (footage, `project.json` with the artist's keys and limbs, `truth.json`) and
//! `FOLDER/doll` (`doll.json`, one drawing with limbs and marks, and its footage).

use anyhow::Result;
use clap::Parser;
use rototoon_tests::{doll, sample};
use std::path::PathBuf;

#[derive(Parser)]
#[command(about = "Writes the sample cartoon and the jointed doll")]
struct Arguments {
    /// The folder to write to.
    folder: PathBuf,
}

fn main() -> Result<()> {
    let Arguments { folder } = Arguments::parse();
    sample::write(&folder.join("sample"))?;
    doll::write(&folder.join("doll"))
}
