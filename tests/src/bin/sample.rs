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
    let own = folder.join("doll");
    std::fs::create_dir_all(&own).with_context(|| format!("cannot make the folder {own:?}"))?;
    let document = doll::document()?;
    let ground = sample::background::paint(sample::WIDTH, sample::HEIGHT).context("no ground")?;
    std::fs::write(own.join("doll_0.png"), doll::paint(ground, &document, 0).encode_png()?)?;
    Ok(std::fs::write(own.join("doll.json"), document.to_json())?)
}
