//! Marks code by its sources, so that a cache never gives the results of another program. Build scripts of the crates with a cache share it.
//!
//! The version number alone would not do: it stays the same while the code changes. Results depend on the code of a crate and of those of the
//! project that it uses, on the versions of all packages, on the compiler and its settings, and on the target, whose mathematical functions may round differently.

use std::collections::BTreeMap;
use std::env::var;
use std::fs::{read, read_dir};
use std::path::{Path, PathBuf};
use std::process::Command;

/// The versions of all packages, and how they are built.
const BUILD: [&str; 2] = ["Cargo.lock", "Cargo.toml"];

/// Puts the mark of some files and folders into the environment variable `name` of the crate. `workspace` is the folder of all packages. Paths
/// begin in the folder of the crate.
pub fn put(name: &str, sources: &[&str], workspace: &str) -> std::io::Result<()> {
    let mut files = BTreeMap::new();
    let build = BUILD.map(|file| format!("{workspace}/{file}"));
    for source in sources.iter().copied().chain(build.iter().map(String::as_str)) {
        println!("cargo::rerun-if-changed={source}");
        collect(Path::new(source), &mut files)?;
    }
    let mut hasher = blake3::Hasher::new();
    for bytes in files.values() {
        hasher.update(&(bytes.len() as u64).to_le_bytes()).update(bytes);
    }
    for setting in ["TARGET", "CARGO_CFG_TARGET_FEATURE", "OPT_LEVEL"] {
        hasher.update(var(setting).unwrap_or_default().as_bytes());
    }
    let compiler = Command::new(var("RUSTC").unwrap_or_else(|_| "rustc".into())).arg("-vV").output()?;
    hasher.update(&compiler.stdout);
    println!("cargo::rustc-env={name}={}", hasher.finalize().to_hex());
    Ok(())
}

fn collect(path: &Path, files: &mut BTreeMap<PathBuf, Vec<u8>>) -> std::io::Result<()> {
    if path.is_dir() {
        return read_dir(path)?.try_for_each(|entry| collect(&entry?.path(), files));
    }
    files.insert(path.into(), read(path)?);
    Ok(())
}
