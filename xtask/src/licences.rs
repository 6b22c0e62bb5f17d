//! The licences of everything that is built into the library, the program and the plugin.
//!
//! Most licences ask that their text goes with every copy. Cargo knows which packages are built for a system, and each package
//! brings the files of its licence. They are collected into one text, each different text once, with the packages that it
//! belongs to. cargo-about does the same from templates; it takes longer to compile than all of Rototoon.

use crate::platform::Platform;
use anyhow::{Context, Result, ensure};
use serde_json::Value;
use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write;
use std::path::{Path, PathBuf};
use xtask_shell::shell::{capture, cargo, empty_folder, root, target};

/// The packages that artists install.
pub const SHIPPED: [&str; 3] = ["rototoon-capi", "rototoon-cli", "rototoon-ofx"];
/// How the names of licence files begin.
const STARTS: [&str; 6] = ["license", "licence", "copying", "copyright", "notice", "unlicense"];

/// Makes a folder with Rototoon's licence and `THIRD-PARTY.txt` for a system.
pub fn folder(platform: &Platform) -> Result<PathBuf> {
    let folder = target().join("licences").join(platform.triple);
    empty_folder(&folder)?;
    std::fs::copy(root().join("LICENSE"), folder.join("LICENSE"))?;
    std::fs::write(folder.join("THIRD-PARTY.txt"), text(&packages(platform)?)?)?;
    Ok(folder)
}

/// A package from elsewhere.
#[derive(Clone, Debug)]
struct Package {
    /// Name and version.
    title: String,
    licence: String,
    address: String,
    folder: PathBuf,
}

/// The packages that are linked into what artists install on a system, sorted.
fn packages(platform: &Platform) -> Result<Vec<Package>> {
    let mut tree = cargo();
    tree.args([
        "tree",
        "--locked",
        "--edges",
        "normal",
        "--prefix",
        "none",
        "--format",
        "{p}",
        "--target",
        platform.triple,
    ]);
    for package in SHIPPED {
        tree.args(["--package", package]);
    }
    let listed: BTreeSet<String> = capture(&mut tree)?.lines().filter_map(title).collect();
    let metadata = capture(cargo().args(["metadata", "--locked", "--format-version", "1"]))?;
    let metadata: Value = serde_json::from_str(&metadata)?;
    let all = metadata["packages"].as_array().context("cargo metadata lists no packages")?;
    let found: BTreeMap<String, Package> = all.iter().filter_map(described).map(|p| (p.title.clone(), p)).collect();
    let missing: Vec<_> = listed.iter().filter(|title| !found.contains_key(*title)).collect();
    // The packages of the workspace have the project's own licence.
    let missing: Vec<_> = missing.into_iter().filter(|title| !title.starts_with("rototoon")).collect();
    ensure!(missing.is_empty(), "cargo metadata does not know {missing:?}");
    Ok(listed.iter().filter_map(|title| found.get(title).cloned()).collect())
}

/// Name and version of a line of `cargo tree`: `faer v0.24.4 (*)`.
fn title(line: &str) -> Option<String> {
    let mut words = line.split_whitespace();
    let (name, version) = (words.next()?, words.next()?);
    Some(format!("{name} {}", version.strip_prefix('v')?))
}

/// A package of `cargo metadata` that comes from a registry.
fn described(package: &Value) -> Option<Package> {
    package["source"].as_str()?;
    Some(Package {
        title: format!("{} {}", package["name"].as_str()?, package["version"].as_str()?),
        licence: package["license"].as_str().unwrap_or("no licence named").to_owned(),
        address: package["repository"].as_str().unwrap_or("").to_owned(),
        folder: PathBuf::from(package["manifest_path"].as_str()?).parent()?.to_path_buf(),
    })
}

/// The text with all licences.
fn text(packages: &[Package]) -> Result<String> {
    let mut out = String::from("Rototoon contains these packages. Their licences follow.\n\n");
    let mut texts: BTreeMap<String, Vec<&str>> = BTreeMap::new();
    for package in packages {
        let files = files(&package.folder)?;
        let note = if files.is_empty() { "; the package brings no text of it" } else { "" };
        writeln!(out, "{}: {}{note}. {}", package.title, package.licence, package.address)?;
        for file in files {
            let bytes = std::fs::read(&file).with_context(|| format!("cannot read {file:?}"))?;
            let text = String::from_utf8_lossy(&bytes).replace("\r\n", "\n");
            let titles = texts.entry(text.trim().to_owned()).or_default();
            if !titles.contains(&package.title.as_str()) {
                titles.push(&package.title);
            }
        }
    }
    for (text, titles) in texts {
        write!(out, "\n{}\n{}\n\n{text}\n", "=".repeat(80), titles.join(", "))?;
    }
    Ok(out)
}

/// The licence files of a package, sorted.
fn files(folder: &Path) -> Result<Vec<PathBuf>> {
    let entries = std::fs::read_dir(folder).with_context(|| format!("cannot list {folder:?}"))?;
    let licence = |path: &PathBuf| {
        let name = path.file_name().unwrap_or_default().to_string_lossy().to_lowercase();
        path.is_file() && STARTS.iter().any(|start| name.starts_with(start))
    };
    let mut files: Vec<PathBuf> = entries.flatten().map(|entry| entry.path()).filter(licence).collect();
    files.sort();
    Ok(files)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::platform::{LINUX, WINDOWS};

    #[test]
    fn every_package_that_is_linked_has_its_licence() {
        let linux = text(&packages(&LINUX).unwrap()).unwrap();
        for name in ["faer ", "rayon ", "serde_json ", "tiny-skia "] {
            assert!(linux.lines().any(|line| line.starts_with(name)), "{name}");
        }
        assert!(!linux.contains("\nproptest ") && !linux.contains("no licence named"));
        assert!(linux.contains("Permission is hereby granted") && linux.contains("Apache License"));
        let windows = text(&packages(&WINDOWS).unwrap()).unwrap();
        assert!(windows.contains("\nwinapi-util ") && !windows.contains("\nrustix "));
    }

    #[test]
    fn lines_of_the_tree_name_packages() {
        assert_eq!(title("faer v0.24.4 (*)").as_deref(), Some("faer 0.24.4"));
        assert_eq!(title("rototoon v0.1.0 (/home/core)").as_deref(), Some("rototoon 0.1.0"));
        assert_eq!(title(""), None);
    }
}
