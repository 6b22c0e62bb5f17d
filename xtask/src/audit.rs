//! `audit`: what comes into the programs from elsewhere.
//!
//! cargo-deny checks the rules of `deny.toml`: licences, sources, and known weaknesses. The list of weaknesses comes
//! from the RustSec database. Where it cannot be loaded, the other rules are checked and a line says so.
//! cargo-cyclonedx writes a bill of materials in the format CycloneDX for each program to `target/sbom`.
//!
//! Both tools are compiled at the first use, which takes some minutes. So this is a command of its own and no step of
//! `test`.

use crate::licences::SHIPPED;
use crate::version;
use anyhow::{Context, Result, ensure};
use std::path::{Path, PathBuf};
use xtask_shell::shell::{capture, cargo, command, root, run, target};

/// A tool and its version.
const DENY: (&str, &str) = ("cargo-deny", "0.20.2");
const CYCLONEDX: (&str, &str) = ("cargo-cyclonedx", "0.5.9");

/// Checks the rules and writes the bills of materials.
pub fn audit() -> Result<()> {
    let deny = tool(DENY)?;
    run(command(&deny).current_dir(root()).args(["--log-level", "error", "check", "licenses", "bans", "sources"]))?;
    println!("licences and sources: as deny.toml allows");
    let check = || command(&deny).current_dir(root()).args(["--log-level", "error", "check", "advisories"]).status();
    match database(&deny) {
        Ok(()) => ensure!(check()?.success(), "a dependency has a known weakness"),
        Err(reason) => println!("known weaknesses: not checked, since the database cannot be loaded: {reason}"),
    }
    bills().map(|_| ())
}

/// Loads the database of known weaknesses.
fn database(deny: &PathBuf) -> Result<()> {
    capture(command(deny).current_dir(root()).args(["fetch", "db"])).map(|_| ())
}

/// Writes the bills of materials of what artists install, and returns their paths.
pub fn bills() -> Result<Vec<PathBuf>> {
    let program = tool(CYCLONEDX)?;
    let folder = target().join("sbom");
    std::fs::create_dir_all(&folder)?;
    let mut made = Vec::new();
    // With a date of its own the tool takes neither the time of day nor a number by chance.
    let date = version::date()?.to_string();
    let words = ["cyclonedx", "--format", "json", "--quiet"];
    run(command(program).current_dir(root()).args(words).env("SOURCE_DATE_EPOCH", date))?;
    for entry in manifests()? {
        let (name, written) = entry;
        if !written.is_file() {
            continue;
        }
        if SHIPPED.contains(&name.as_str()) {
            let to = folder.join(format!("{name}.cdx.json"));
            let text = std::fs::read_to_string(&written).with_context(|| format!("cannot read {written:?}"))?;
            std::fs::write(&to, without_place(&text, &root())).with_context(|| format!("cannot write {to:?}"))?;
            println!("{}", to.display());
            made.push(to);
        }
        // The tool writes beside each package's manifest.
        std::fs::remove_file(&written)?;
    }
    Ok(made)
}

/// A bill that names the workspace's packages, but not where the workspace lies on this machine.
fn without_place(bill: &str, workspace: &Path) -> String {
    bill.replace(&*workspace.to_string_lossy(), "/rototoon")
}

/// Each package of the workspace with the file that the tool writes for it.
fn manifests() -> Result<Vec<(String, PathBuf)>> {
    let text = capture(cargo().args(["metadata", "--no-deps", "--format-version", "1"]))?;
    let data: serde_json::Value = serde_json::from_str(&text)?;
    let packages = data["packages"].as_array().context("cargo metadata has no packages")?;
    let one = |package: &serde_json::Value| {
        let name = package["name"].as_str()?.to_owned();
        let folder = PathBuf::from(package["manifest_path"].as_str()?).parent()?.to_path_buf();
        Some((name.clone(), folder.join(format!("{name}.cdx.json"))))
    };
    Ok(packages.iter().filter_map(one).collect())
}

/// A tool from crates.io, compiled into `target` at its first use.
fn tool((name, version): (&str, &str)) -> Result<PathBuf> {
    let folder = target().join(format!("{name}-{version}"));
    let program = folder.join("bin").join(name);
    if !program.is_file() {
        println!("compiling {name} {version}");
        run(cargo()
            .args(["install", "--quiet", "--locked", name, "--version", version, "--root"])
            .arg(&folder)
            .env("CARGO_PROFILE_RELEASE_OPT_LEVEL", "1")
            .env("CARGO_PROFILE_RELEASE_LTO", "off")
            .env("CARGO_TARGET_DIR", target().join("tools-build")))?;
    }
    Ok(program)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bills_do_not_name_the_machine() {
        let bill = r#"{"bom-ref": "path+file:///home/anna/work/core#rototoon@0.1.0"}"#;
        let made = without_place(bill, Path::new("/home/anna/work"));
        assert_eq!(made, r#"{"bom-ref": "path+file:///rototoon/core#rototoon@0.1.0"}"#);
    }
}
