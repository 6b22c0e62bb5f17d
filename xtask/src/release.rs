//! `release --dry-run`: makes everything that a release publishes, below `target/release-set`, and checks each file.
//!
//! For each system that can be built here: the extension's zip, the wheel of the Python package, the command line. For all of
//! them together: the OpenFX bundle, bills of materials, the section of the changelog, checksums. The workflow of a tag runs the
//! same command and publishes what it made. The set says of each file how far it was tried.
//!
//! Files carry the time of the commit and no path of the machine, so two builds of one commit are the same bytes.

use crate::bundle::{self, Build, Bundle, Packager};
use crate::platform::{LINUX, MACOS, Platform, WINDOWS};
use crate::{audit, binary, licences, macos, ofx, version, wheel, windows};
use anyhow::{Context, Result, bail, ensure};
use std::fmt::Write;
use std::path::{Path, PathBuf};
use xtask_shell::shell::{capture, command, copy_folder, empty_folder, root, run, target};

/// The version of the workspace, with which the manifest and the changelog agree.
const WORKSPACE: &str = env!("CARGO_PKG_VERSION");
/// Names of files that are no parts of the set's checksums.
const SUMS: &str = "SHA256SUMS";

/// A system with its built files.
struct Built {
    platform: Platform,
    library: PathBuf,
    cli: PathBuf,
    plugin: PathBuf,
}

/// Makes the set and checks it. With `twice` the Linux files are made anew and must be the same.
pub fn release(twice: bool) -> Result<()> {
    check_versions()?;
    let notes = section(&read("CHANGELOG.md")?, WORKSPACE)?;
    let mut built = vec![linux()?];
    let mut missing = Vec::new();
    let others = [(WINDOWS, windows::build as fn() -> Result<windows::Built>), (MACOS, macos::build)];
    for (platform, build) in others {
        match build() {
            Ok(windows::Built { library, cli, plugin }) => built.push(Built { platform, library, cli, plugin }),
            Err(reason) => missing.push((platform, reason)),
        }
    }
    let set = target().join("release-set");
    make(&set, &built, &notes)?;
    if twice {
        compare(&set)?;
    }
    for (platform, reason) in &missing {
        println!("not in the set: {}: {reason:#}", platform.blender);
    }
    report(&set, &built)
}

fn linux() -> Result<Built> {
    bundle::compile(Build::Installed)?;
    let Bundle { library, cli, plugin, .. } = Bundle::of(Build::Installed)?;
    Ok(Built { platform: LINUX, library, cli, plugin })
}

/// Writes the set.
fn make(set: &Path, built: &[Built], notes: &str) -> Result<()> {
    empty_folder(set)?;
    let version = bundle::version_of(Build::Installed)?;
    let mut wheels = Vec::new();
    for Built { platform, library, cli, plugin } in built {
        for file in [library, cli, plugin] {
            binary::assert_no_paths(file, &[&root(), &target(), &bundle::cargo_home()])?;
        }
        let made = wheel::build(platform, platform.wheel, &version, library)?;
        std::fs::copy(&made, set.join(made.file_name().context("a wheel has a name")?))?;
        wheels.push((*platform, made));
        let name = format!("rototoon-{version}-cli-{}", platform.blender);
        let folder = target().join("release-parts").join(&name);
        empty_folder(&folder)?;
        copy_folder(&licences::folder(platform)?, &folder, &|_| true)?;
        std::fs::copy(cli, folder.join(platform.cli)).with_context(|| format!("cannot copy {cli:?}"))?;
        wheel::archive(&folder, &set.join(format!("{name}.zip")))?;
    }
    for zip in bundle::pack_extension(&Packager::from_wheel()?, &wheels, &version, true)? {
        bundle::rename(&zip, &set.join(zip.file_name().context("a zip has a name")?))?;
    }
    let place = target().join("release-parts/Rototoon.ofx.bundle");
    let plugins: Vec<(Platform, PathBuf)> = built.iter().map(|b| (b.platform, b.plugin.clone())).collect();
    ofx::lay_out_at(&place, &plugins, &version)?;
    wheel::archive(&place, &set.join(format!("rototoon-{version}-openfx.zip")))?;
    for bill in audit::bills()? {
        binary::assert_no_paths(&bill, &[&root(), &target(), &bundle::cargo_home()])?;
        std::fs::copy(&bill, set.join(bill.file_name().context("a bill has a name")?))?;
    }
    std::fs::write(set.join("RELEASE-NOTES.md"), notes)?;
    std::fs::write(set.join(SUMS), sums(set)?).context("cannot write the checksums")
}

/// A line for each file of the set with its SHA-256, as `sha256sum --check` reads them.
fn sums(set: &Path) -> Result<String> {
    let names = names(set)?;
    let mut sum = command("sha256sum");
    sum.current_dir(set).args(names.iter().filter(|name| *name != SUMS));
    Ok(capture(&mut sum)? + "\n")
}

fn names(set: &Path) -> Result<Vec<String>> {
    let entries = std::fs::read_dir(set).with_context(|| format!("cannot list {set:?}"))?;
    let mut names: Vec<String> =
        entries.map(|entry| Ok(entry?.file_name().to_string_lossy().into_owned())).collect::<Result<_>>()?;
    names.sort();
    Ok(names)
}

/// Checks each file and prints the table.
fn report(set: &Path, built: &[Built]) -> Result<()> {
    run(command("sha256sum").current_dir(set).args(["--check", "--quiet", SUMS]))?;
    let (found, version) = (names(set)?, bundle::version_of(Build::Installed)?);
    for Built { platform, .. } in built {
        let wheel = format!("rototoon-{}-py3-none-{}.whl", version::of_wheel(&version), platform.wheel);
        let cli = format!("rototoon-{version}-cli-{}.zip", platform.blender);
        for name in [wheel, bundle::zip_name(platform, &version), cli] {
            ensure!(found.contains(&name), "the set lacks {name}");
        }
    }
    let sums = std::fs::read_to_string(set.join(SUMS))?;
    let mut table = String::from("| file | bytes | SHA-256 | tried |\n| --- | ---: | --- | --- |\n");
    for name in found.iter().filter(|name| *name != SUMS) {
        let path = set.join(name);
        if name.ends_with(".zip") || name.ends_with(".whl") {
            run(command(wheel::environment()?).args(["-c", TEST_ZIP]).arg(&path))?;
        }
        let size = std::fs::metadata(&path)?.len();
        ensure!(size > 0, "{name} is empty");
        let sum = sums.lines().find(|line| line.ends_with(&format!("  {name}"))).context("a file has no checksum")?;
        let tried = built.iter().find(|b| {
            [b.platform.blender, b.platform.wheel, &b.platform.blender.replace('-', "_")]
                .iter()
                .any(|id| name.contains(*id))
        });
        writeln!(table, "| {name} | {size} | {} | {} |", &sum[..16], tried.map_or("", |b| b.platform.checked))?;
    }
    println!("{table}");
    println!("release set: {}", set.display());
    Ok(())
}

/// Reads every file of a zip, and finds what a release must not contain.
const TEST_ZIP: &str = "import sys, zipfile
with zipfile.ZipFile(sys.argv[1]) as file:
    damaged = file.testzip()
    assert damaged is None, f'{sys.argv[1]}: {damaged} is damaged'
    names = file.namelist()
    assert len(names) == len(set(names)), f'{sys.argv[1]}: a name is there twice'
    strange = [name for name in names if name.endswith('.pyc') or name.startswith('/') or '..' in name.split('/')]
    assert not strange, f'{sys.argv[1]}: {strange}'
    assert any('licen' in name.lower() for name in names), f'{sys.argv[1]}: no licence'";

/// Makes the Linux files of the set anew, in another folder, and compares all bytes.
fn compare(set: &Path) -> Result<()> {
    let folder = target().join("release-again");
    empty_folder(&folder)?;
    lend_tools(&folder)?;
    run(command(std::env::current_exe()?).arg("bundle").env("CARGO_TARGET_DIR", &folder))?;
    // The zips of the set name the wheels of all systems. So the zip for Linux alone is made of the first build too.
    let first = bundle::bundle(&Packager::from_wheel()?, Build::Installed)?;
    let wheel = first.wheel.file_name().context("a wheel has a name")?;
    let pairs = [
        (first.library.clone(), in_folder(&folder, &first.library)?),
        (first.cli.clone(), in_folder(&folder, &first.cli)?),
        (first.plugin.clone(), in_folder(&folder, &first.plugin)?),
        (set.join(wheel), in_folder(&folder, &first.wheel)?),
        (first.zip.clone(), in_folder(&folder, &first.zip)?),
    ];
    let mut differ = Vec::new();
    for (one, other) in pairs {
        let name = one.file_name().unwrap_or_default().to_string_lossy().into_owned();
        let (sum, again) = (sum(&one)?, sum(&other)?);
        println!("{name}: first build {}, second build {}", &sum[..16], &again[..16]);
        if sum != again {
            differ.push(name);
        }
    }
    ensure!(differ.is_empty(), "two builds of one commit differ in {differ:?}: compare with the files in {folder:?}");
    std::fs::remove_dir_all(&folder).with_context(|| format!("cannot remove {folder:?}"))
}

/// The place of a file of the target folder in another one.
fn in_folder(folder: &Path, file: &Path) -> Result<PathBuf> {
    Ok(folder.join(file.strip_prefix(target())?))
}

/// Shows the installed tools in another target folder: they need not be downloaded again.
fn lend_tools(folder: &Path) -> Result<()> {
    for name in names(&target())?.iter().filter(|name| name.starts_with("venv-") || name.starts_with("mdbook-")) {
        #[cfg(unix)]
        std::os::unix::fs::symlink(target().join(name), folder.join(name))
            .with_context(|| format!("cannot show {name} in {folder:?}"))?;
    }
    Ok(())
}

/// The SHA-256 of a file.
fn sum(path: &Path) -> Result<String> {
    let said = capture(command("sha256sum").arg(path))?;
    Ok(said.split(' ').next().unwrap_or_default().to_owned())
}

/// Fails unless the places that name the version agree.
fn check_versions() -> Result<()> {
    let manifest = read("blender-addon/blender_manifest.toml")?;
    let line = format!("version = {WORKSPACE:?}");
    ensure!(
        manifest.lines().any(|found| found == line),
        "blender_manifest.toml: found another version, expected {line}, as in Cargo.toml"
    );
    Ok(())
}

fn read(name: &str) -> Result<String> {
    let path = root().join(name);
    std::fs::read_to_string(&path).with_context(|| format!("cannot read {path:?}"))
}

/// The section of a version in the changelog; *Unreleased* where the version has none yet.
fn section(changelog: &str, version: &str) -> Result<String> {
    for heading in [format!("## {version}"), "## Unreleased".to_owned()] {
        let begins = |line: &str| line == heading || line.starts_with(&format!("{heading} "));
        let mut lines = changelog.lines().skip_while(|line| !begins(line));
        if lines.next().is_some() {
            let text: Vec<&str> = lines.take_while(|line| !line.starts_with("## ")).collect();
            let text = text.join("\n").trim().to_owned();
            ensure!(!text.is_empty(), "CHANGELOG.md: the section {heading:?} is empty");
            return Ok(text + "\n");
        }
    }
    bail!("CHANGELOG.md: found neither {version} nor Unreleased, expected a section of one of them")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_section_of_a_version_is_found() {
        let text =
            "# Changes\n\n## Unreleased\n\n- new\n\n## 0.2.0 (2026-01-01)\n\n### Core\n- old\n\n## 0.1.0\n- first\n";
        assert_eq!(section(text, "0.2.0").unwrap(), "### Core\n- old\n");
        assert_eq!(section(text, "0.1.0").unwrap(), "- first\n");
        assert_eq!(section(text, "0.3.0").unwrap(), "- new\n");
        assert!(section("# Changes\n", "0.3.0").is_err());
        assert!(section("## 0.2.00\n- a\n", "0.2.0").is_err());
    }

    #[test]
    fn the_manifest_has_the_version() {
        check_versions().unwrap();
    }
}
