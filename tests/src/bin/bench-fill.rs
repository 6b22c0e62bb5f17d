//! Measures fills on a film with known colours, for `cargo xtask bench-fill`.
//!
//! `bench-fill DIR OUT` measures the set in the folder DIR. It writes the results to OUT.json and a sheet of the worst drawings to
//! OUT.png. The set is named after OUT.

use anyhow::{Context, Result};
use clap::Parser;
use rototoon_tests::filling::run::measure;
use std::path::PathBuf;

#[derive(Parser)]
#[command(about = "Measures fills on a film with known colours")]
struct Arguments {
    /// The folder with frames/*.png and colour/*.png.
    folder: PathBuf,
    /// The path of the results without its extension.
    out: PathBuf,
}

fn main() -> Result<()> {
    let Arguments { folder, out } = Arguments::parse();
    let name = out.file_name().context("OUT has no name")?.to_string_lossy().into_owned();
    let with = |extension: &str| out.with_file_name(format!("{name}.{extension}"));
    let outcome = measure(&folder, &name, &with("png"))?;
    let path = with("json");
    std::fs::write(&path, serde_json::to_vec_pretty(&outcome)?).with_context(|| format!("cannot write {path:?}"))
}
