//! Marks the tracker by its sources, so that a cache never gives the results of another one.
//!
//! The version number alone would not do: it stays the same while the code changes. Results depend on the code of this crate and of those of the
//! project that it uses, on the versions of all packages, on the compiler and its settings, and on the target, whose mathematical functions may round differently.

use std::collections::BTreeMap;
use std::env::var;
use std::fs::{read, read_dir};
use std::path::{Path, PathBuf};
use std::process::Command;

/// What the tracker is compiled from, from its own folder.
const SOURCES: [&str; 6] = ["src", "../base/src", "../fit/src", "../fourier/src", "../image/src", "../lines/src"];
/// The versions of all packages, and how they are built.
const BUILD: [&str; 2] = ["../../Cargo.lock", "../../Cargo.toml"];

fn main() -> std::io::Result<()> {
    let mut files = BTreeMap::new();
    for folder in SOURCES {
        println!("cargo::rerun-if-changed={folder}");
        collect(Path::new(folder), &mut files)?;
    }
    for file in BUILD {
        println!("cargo::rerun-if-changed={file}");
        files.insert(PathBuf::from(file), read(file)?);
    }
    let mut hasher = blake3::Hasher::new();
    for bytes in files.values() {
        hasher.update(&(bytes.len() as u64).to_le_bytes()).update(bytes);
    }
    for name in ["TARGET", "CARGO_CFG_TARGET_FEATURE", "OPT_LEVEL"] {
        hasher.update(var(name).unwrap_or_default().as_bytes());
    }
    let compiler = Command::new(var("RUSTC").unwrap_or_else(|_| "rustc".into())).arg("-vV").output()?;
    hasher.update(&compiler.stdout);
    println!("cargo::rustc-env=ROTOTOON_TRACKER={}", hasher.finalize().to_hex());
    Ok(())
}

fn collect(folder: &Path, files: &mut BTreeMap<PathBuf, Vec<u8>>) -> std::io::Result<()> {
    for entry in read_dir(folder)? {
        let path = entry?.path();
        if path.is_dir() {
            collect(&path, files)?;
        } else {
            let bytes = read(&path)?;
            files.insert(path, bytes);
        }
    }
    Ok(())
}
