//! Writes the sample cartoon and the jointed doll into a folder, for tests that are not written in Rust.
//!
//! `sample FOLDER` leaves `FOLDER/sample` (footage, `project.json` with the artist's keys and limbs, `truth.json`) and `FOLDER/doll`
//! (`doll.json`, one drawing with limbs and marks, and its footage).

use anyhow::{Context, Result};
use rototoon_tests::{doll, sample};
use std::path::PathBuf;

fn main() -> Result<()> {
    let folder = PathBuf::from(std::env::args_os().nth(1).context("usage: sample FOLDER")?);
    sample::write(&folder.join("sample"))?;
    doll::write(&folder.join("doll"))
}
