//! The version of a build. Whoever installs one build over another must get the new one, and a bug report must say which build it is about.
//!
//! What a release publishes has the version of `Cargo.toml`. It is a release if the changelog begins with the section of that version, and nothing
//! was changed since it was tagged. Every other build has a version like `0.1.1-dev20261201004020+h1a2b3c4d`: that of the next release, the time of
//! the commit, and a hash of what is built. It rises from commit to commit, lies between two releases, and is another one for other sources.
//! The same sources give the same version, also without a history, as in the archive of a commit.
//!
//! The text is a semantic version, as Blender's manifests want it, and a version of Python's packages (PEP 440), which write `.dev` for `-dev`.

use crate::generate;
use anyhow::{Context, Result};
use std::collections::BTreeMap;
use std::path::Path;
use xtask_shell::shell::{capture, command, root};

/// The version of the workspace: that of the last release, or of the next one.
const WORKSPACE: &str = env!("CARGO_PKG_VERSION");
/// The line of a Python file that tells its build; the packer puts the version in the place of the word.
const SOURCE: &str = "BUILD = \"source\"";
/// What builds are made from.
const SOURCES: [&str; 8] =
    [".cargo/config.toml", "Cargo.lock", "Cargo.toml", "blender-addon", "core", "docs", "ofx-plugin", "xtask"];

/// What a build is for. Builds of one kind from the same sources are the same.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// What artists install.
    Installed,
    /// Optimised, for systems like this one.
    Here,
    /// What the tests are built from.
    Tested,
}

/// The version of a build, such as "0.2.0" or "0.1.1-dev20261201004020+h1a2b3c4d".
pub fn of(kind: Kind) -> Result<String> {
    let path = root().join("CHANGELOG.md");
    let changelog = std::fs::read_to_string(&path).with_context(|| format!("cannot read {path:?}"))?;
    if kind == Kind::Installed && newest(&changelog) == Some(WORKSPACE) && !is_changed() {
        return Ok(WORKSPACE.to_owned());
    }
    let compiler = capture(command("rustc").arg("--version"))?;
    Ok(between(WORKSPACE, &changelog, date()?, hash_of(&[&format!("{kind:?}"), &compiler])?))
}

/// Seconds since 1970 that packed files carry: the time of the commit, so that two builds of one commit are the same.
pub fn date() -> Result<u64> {
    /// The earliest time that a zip can hold, for a folder without a history.
    const EARLIEST: u64 = 315_619_200;
    if let Some(named) = std::env::var_os("SOURCE_DATE_EPOCH") {
        let named = named.to_string_lossy();
        let date: u64 = named
            .parse()
            .with_context(|| format!("SOURCE_DATE_EPOCH: found {named:?}, expected seconds since 1970"))?;
        return Ok(date.max(EARLIEST));
    }
    // Git writes the time into the archive of a commit, which has no history.
    let archived = || std::fs::read_to_string(root().join(".ci/commit-time")).ok()?.trim().parse().ok();
    let told = || capture(command("git").args(["log", "-1", "--format=%ct"])).ok()?.parse().ok();
    Ok(archived().or_else(told).unwrap_or(EARLIEST).max(EARLIEST))
}

/// The version as Python's packages write it, in the names of wheels.
pub fn of_wheel(version: &str) -> String {
    version.replace("-dev", ".dev")
}

/// Tells a copy of a Python file of which build it is.
pub fn mark(file: &Path, version: &str) -> Result<()> {
    let text = std::fs::read_to_string(file).with_context(|| format!("cannot read {file:?}"))?;
    anyhow::ensure!(text.contains(SOURCE), "{file:?}: found no line {SOURCE}");
    let text = text.replace(SOURCE, &format!("BUILD = {version:?}"));
    std::fs::write(file, text).with_context(|| format!("cannot write {file:?}"))
}

/// The version of the changelog's first section that has a text; `None` for *Unreleased*.
fn newest(changelog: &str) -> Option<&str> {
    let sections = changelog.split("\n## ").skip(1);
    let mut written =
        sections.filter_map(|section| section.split_once('\n')).filter(|(_, text)| !text.trim().is_empty());
    written.next()?.0.split(' ').next().filter(|name| *name != "Unreleased")
}

/// Whether the workspace is another one than that of the tag of its version. Without a history nobody knows.
fn is_changed() -> bool {
    let git = |words: &[&str]| capture(command("git").args(words)).ok();
    // Of another project's history in a folder above nothing counts.
    if git(&["rev-parse", "--show-prefix"]).is_none_or(|place| !place.is_empty()) {
        return false;
    }
    let tagged = git(&["rev-parse", "--verify", "--quiet", &format!("v{WORKSPACE}^{{commit}}")]);
    let head = git(&["rev-parse", "HEAD"]);
    git(&["status", "--porcelain", "--untracked-files=no"]).is_none_or(|changes| !changes.is_empty())
        || tagged.is_some_and(|tagged| Some(tagged) != head)
}

/// The version of a build between two releases.
fn between(workspace: &str, changelog: &str, date: u64, hash: u64) -> String {
    let is_released = format!("{changelog}\n").contains(&format!("\n## {workspace}"));
    let next = match workspace.rsplit_once('.') {
        Some((series, patch)) if is_released => {
            format!("{series}.{}", patch.parse::<u64>().map_or(1, |patch| patch + 1))
        }
        _ => workspace.to_owned(),
    };
    format!("{next}-dev{}+h{:08x}", digits(date), hash >> 32)
}

/// A time as year, month, day, hour, minute and second in UTC, 14 digits. `date` is in seconds since 1970.
fn digits(date: u64) -> String {
    let (days, second) = (date / 86_400, date % 86_400);
    // Days of the years since 1 March of the year 0, in eras of 400 years (H. Hinnant, "chrono-compatible low-level date algorithms").
    let day = days + 719_468;
    let (era, of_era) = (day / 146_097, day % 146_097);
    let of_year = |day: u64| (day - day / 1460 + day / 36_524 - day / 146_096) / 365;
    let years = of_year(of_era);
    let rest = of_era - (365 * years + years / 4 - years / 100);
    let months = (5 * rest + 2) / 153;
    let (day, month) = (rest - (153 * months + 2) / 5 + 1, if months < 10 { months + 3 } else { months - 9 });
    let year = era * 400 + years + u64::from(month <= 2);
    format!("{year:04}{month:02}{day:02}{:02}{:02}{:02}", second / 3600, second / 60 % 60, second % 60)
}

/// A hash of the sources, and of what else makes a build another one.
fn hash_of(further: &[&str]) -> Result<u64> {
    let mut files = BTreeMap::new();
    for source in SOURCES {
        collect(&root().join(source), source.to_owned(), &mut files)?;
    }
    let mut listed: Vec<String> = files.into_iter().map(|(name, hash)| format!("{name} {hash:016x}")).collect();
    listed.extend(further.iter().map(|&text| text.to_owned()));
    Ok(generate::hash(listed.join("\n").as_bytes()))
}

/// The hash of each file by its name with forward slashes. What builds and tests leave is left out.
fn collect(path: &Path, name: String, files: &mut BTreeMap<String, u64>) -> Result<()> {
    let failed = || format!("cannot read {path:?}");
    if !path.is_dir() {
        files.insert(name, generate::hash(&std::fs::read(path).with_context(failed)?));
        return Ok(());
    }
    for entry in std::fs::read_dir(path).with_context(failed)? {
        let entry = entry.with_context(failed)?;
        let own = entry.file_name().to_string_lossy().into_owned();
        let made = [".pyc", ".so", ".dll", ".dylib", ".cdx.json"].iter().any(|end| own.ends_with(end));
        if !made && !own.starts_with('.') && !["__pycache__", "target"].contains(&own.as_str()) {
            collect(&entry.path(), format!("{name}/{own}"), files)?;
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn builds_lie_between_the_releases_and_rise() {
        let before = "# Changes\n\n## Unreleased\n\n- new\n\n## 0.1.0\n\n- first\n";
        let one = between("0.1.0", before, 1_796_085_620, 0x1a2b_3c4d_0000_0000);
        assert_eq!(one, "0.1.1-dev20261201004020+h1a2b3c4d");
        assert_eq!(of_wheel(&one), "0.1.1.dev20261201004020+h1a2b3c4d");
        assert!(
            one < between("0.1.0", before, 1_796_085_621, 0),
            "as texts too, which is how semantic versions compare"
        );
        assert_eq!(
            between("0.2.0", before, 1_796_085_620, 0),
            "0.2.0-dev20261201004020+h00000000",
            "its release is still to come"
        );
    }

    #[test]
    fn the_changelog_says_whether_it_is_a_release() {
        assert_eq!(newest("# Changes\n\n## Unreleased\n\n- new\n\n## 0.1.0\n\n- first\n"), None);
        assert_eq!(newest("# Changes\n\n## Unreleased\n\n## 0.2.0 (2026-12-01)\n\n- new\n"), Some("0.2.0"));
        assert_eq!(newest("# Changes\n\n## 0.2.0 (2026-12-01)\n\n- new\n\n## 0.1.0\n\n- first\n"), Some("0.2.0"));
        assert_eq!(newest("# Changes\n"), None);
    }

    #[test]
    fn times_are_those_of_the_calendar() {
        let known = [
            (0, "19700101000000"),
            (951_827_696, "20000229123456"),
            (951_868_800, "20000301000000"),
            (1_735_689_599, "20241231235959"),
            (4_107_542_400, "21000301000000"),
        ];
        known.iter().for_each(|(date, told)| assert_eq!(digits(*date), *told));
    }

    #[test]
    fn the_same_sources_have_one_version_and_each_kind_of_build_its_own() {
        let [tested, again, here] = [Kind::Tested, Kind::Tested, Kind::Here].map(|kind| of(kind).unwrap());
        assert!(tested == again && tested != here, "{tested} {again} {here}");
    }
}
