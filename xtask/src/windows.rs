//! `windows`: builds everything for Windows on x86-64, and runs the Rust tests under Wine.
//!
//! rustup offers the standard library of Windows only where it can download. Debian sid ([`crate::debian`]) has a current
//! compiler, the sources of the standard library, the linker of MinGW-w64, and Wine. The standard library is compiled with the
//! project (`-Zbuild-std`). The C library is the one that is part of Windows, and the rest of MinGW's runtime is linked
//! statically, so nothing has to be installed on Windows: the files are read to check that.
//!
//! Wine is no Windows. What it shows is that the code finds its files, and computes and writes the same there.

use crate::binary::{self, Report};
use crate::bundle;
use crate::debian::{self, Debian, Mount};
use crate::licences::SHIPPED;
use crate::platform::WINDOWS;
use anyhow::{Context, Result, bail, ensure};
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use xtask_shell::shell::{capture, command, copy_folder, empty_folder, root, run, target};

const PACKAGES: [&str; 6] = ["rustc", "cargo", "rust-src", "gcc-mingw-w64-x86-64-posix", "wine", "wine64"];
/// The packages whose tests run under Wine.
const TESTED: [&str; 19] = [
    "rototoon",
    "rototoon-base",
    "rototoon-batch",
    "rototoon-capi",
    "rototoon-cli",
    "rototoon-conform",
    "rototoon-document",
    "rototoon-exchange",
    "rototoon-fill",
    "rototoon-fit",
    "rototoon-image",
    "rototoon-lines",
    "rototoon-pictures",
    "rototoon-render",
    "rototoon-reshape",
    "rototoon-snap",
    "rototoon-style",
    "rototoon-track",
    "rototoon-tween",
];
/// Where the workspace and cargo's home are shown in the system, so that no path of this machine comes into the files.
const SOURCES: &str = "src";
const CARGO: &str = "cargo";
/// Where the folder of the built files is shown.
const BUILT: &str = "built";

/// The built files.
#[derive(Clone, Debug)]
pub struct Built {
    /// The native library.
    pub library: PathBuf,
    /// The command line program.
    pub cli: PathBuf,
    /// The OpenFX plugin.
    pub plugin: PathBuf,
}

/// How the files are optimised.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Profile {
    /// As artists install them.
    Release,
    /// As the tests are built: compiled in a fraction of the time, with checks of overflows and assertions.
    Tested,
}

impl Profile {
    fn folder(self) -> &'static str {
        if self == Self::Release { "release" } else { "debug" }
    }
}

impl Built {
    /// Where a build leaves them.
    pub fn place(profile: Profile) -> Self {
        let folder = folder().join("build").join(WINDOWS.triple).join(profile.folder());
        let at = |name: &str| folder.join(name);
        Self { library: at(WINDOWS.library), cli: at(WINDOWS.cli), plugin: at(WINDOWS.plugin) }
    }
}

/// Builds, checks the files, runs the tests of `packages` (all by default), and compares the tracks of `sets` with those that
/// `linux` computes.
pub fn windows(packages: &[String], sets: &[PathBuf], linux: &Path, profile: Profile) -> Result<()> {
    let system = match system() {
        Ok(system) => system,
        Err(reason) => {
            println!("windows: not done: {reason:#}");
            return Ok(());
        }
    };
    let _mounts = system.mounts()?;
    system.build(profile)?;
    check(&Built::place(profile))?;
    system.compare(sets, linux, profile)?;
    system.test(packages)
}

/// Builds what artists install, and checks it. An error where this machine cannot.
pub fn build() -> Result<Built> {
    let system = system()?;
    let _mounts = system.mounts()?;
    system.build(Profile::Release)?;
    let built = Built::place(Profile::Release);
    check(&built)?;
    Ok(built)
}

fn folder() -> PathBuf {
    target().join("windows")
}

fn system() -> Result<System> {
    if let Some(reason) = debian::cannot() {
        bail!("{reason}");
    }
    Ok(System(Debian::install(&folder().join("debian"), &PACKAGES)?))
}

/// Reads the built files: processor, what they need, what they offer.
fn check(built: &Built) -> Result<()> {
    let library = binary::windows(&built.library)?;
    binary::assert_exports(&built.library, &library, "rototoon_", &functions()?)?;
    let plugin = binary::windows(&built.plugin)?;
    let entries = ["OfxGetNumberOfPlugins", "OfxGetPlugin", "OfxSetHost"].map(String::from).into();
    binary::assert_exports(&built.plugin, &plugin, "Ofx", &entries)?;
    let program = binary::windows(&built.cli)?;
    for (path, report) in [(&built.library, &library), (&built.plugin, &plugin), (&built.cli, &program)] {
        describe(path, report)?;
    }
    Ok(())
}

fn describe(path: &Path, report: &Report) -> Result<()> {
    let (name, size) = (path.file_name().unwrap_or_default().to_string_lossy(), std::fs::metadata(path)?.len());
    let libraries: Vec<&str> = report.imports.keys().map(String::as_str).collect();
    println!("{name}: {size} bytes, {} functions offered, needs {}", report.exports.len(), libraries.join(" "));
    Ok(())
}

/// The functions of the C header.
pub fn functions() -> Result<BTreeSet<String>> {
    let path = root().join("core/capi/include/rototoon.h");
    let header = std::fs::read_to_string(&path).with_context(|| format!("cannot read {path:?}"))?;
    let words = header.split(|c: char| !c.is_ascii_alphanumeric() && c != '_');
    let mut names: BTreeSet<String> = BTreeSet::new();
    // A declaration is a name and an opening parenthesis; comments name functions without one.
    for word in words.filter(|word| word.starts_with("rototoon_")) {
        if header.contains(&format!(" {word}(")) || header.contains(&format!("*{word}(")) {
            names.insert(word.to_owned());
        }
    }
    ensure!(!names.is_empty(), "{path:?}: found no function");
    Ok(names)
}

/// The system with the compiler and Wine.
struct System(Debian);

impl System {
    fn mounts(&self) -> Result<[Mount; 4]> {
        let home = std::env::var_os("CARGO_HOME").map(PathBuf::from);
        let home = home.or_else(|| Some(PathBuf::from(std::env::var_os("HOME")?).join(".cargo")));
        let home = home.context("HOME: found nothing, expected the folder with .cargo")?;
        let own = folder();
        Ok([self.0.proc()?, self.0.mount(&root(), SOURCES)?, self.0.mount(&home, CARGO)?, self.0.mount(&own, BUILT)?])
    }

    fn cargo(&self) -> Command {
        let mut cargo = self.0.command("sh");
        cargo.args(["-c", &format!("cd /{SOURCES} && exec cargo \"$@\""), "cargo"]);
        cargo
            .env("HOME", "/root")
            .env("CARGO_HOME", format!("/{CARGO}"))
            .env("CARGO_TARGET_DIR", format!("/{BUILT}/build"))
            .env("CARGO_INCREMENTAL", "0")
            .env("CARGO_PROFILE_DEV_DEBUG", "none")
            .env("CARGO_PROFILE_RELEASE_DEBUG", "none")
            .env("CARGO_PROFILE_RELEASE_STRIP", "symbols")
            // Lets the stable compiler build the standard library.
            .env("RUSTC_BOOTSTRAP", "1")
            .env("CARGO_TARGET_X86_64_PC_WINDOWS_GNU_LINKER", "x86_64-w64-mingw32-gcc")
            .env("CC_x86_64_pc_windows_gnu", "x86_64-w64-mingw32-gcc")
            // The host's own tools must not come in: it may have other versions.
            .env_remove("RUSTUP_TOOLCHAIN")
            .env_remove("RUSTC")
            .env_remove("CARGO");
        cargo
    }

    fn words(&self, subcommand: &str, profile: Profile, packages: &[&str]) -> Command {
        let mut cargo = self.cargo();
        cargo.args([subcommand, "--locked", "-Zbuild-std=std,panic_unwind", "--target", WINDOWS.triple]);
        if profile == Profile::Release {
            cargo.arg("--release");
        }
        for package in packages {
            cargo.args(["--package", package]);
        }
        cargo
    }

    fn build(&self, profile: Profile) -> Result<()> {
        let mut build = self.words("build", profile, &SHIPPED);
        if profile == Profile::Release {
            build.env(bundle::MARK, bundle::version_of(bundle::Build::Installed)?);
        }
        run(&mut build)
    }

    /// Wine with a folder of its own settings, the drive R and the server `\\server\share`.
    fn wine(&self, command: &mut Command) -> Result<()> {
        let prefix = self.0.folder.join("root/wine");
        command.env("WINEPREFIX", "/root/wine").env("WINEDEBUG", "-all").env("HOME", "/root");
        if !prefix.join("dosdevices").exists() {
            let mut boot = self.0.command("wineboot");
            boot.env("WINEPREFIX", "/root/wine").env("WINEDEBUG", "-all").env("HOME", "/root");
            run(boot.arg("--init").stdout(Stdio::null()).stderr(Stdio::null()))?;
        }
        let drive = self.0.folder.join("root/drive");
        std::fs::create_dir_all(&drive)?;
        let devices = prefix.join("dosdevices");
        std::fs::create_dir_all(devices.join("unc/server"))?;
        for link in ["r:", "unc/server/share"] {
            let place = devices.join(link);
            if place.symlink_metadata().is_err() {
                std::os::unix::fs::symlink("/root/drive", &place).with_context(|| format!("cannot make {place:?}"))?;
            }
        }
        command.env("ROTOTOON_OTHER_DRIVE", r"R:\").env("ROTOTOON_SHARE", r"\\server\share");
        Ok(())
    }

    fn test(&self, packages: &[String]) -> Result<()> {
        let chosen: Vec<&str> =
            if packages.is_empty() { TESTED.to_vec() } else { packages.iter().map(String::as_str).collect() };
        let mut test = self.words("test", Profile::Tested, &chosen);
        test.args(["--no-fail-fast", "--lib", "--bins", "--tests"]);
        test.env("CARGO_TARGET_X86_64_PC_WINDOWS_GNU_RUNNER", "wine");
        self.wine(&mut test)?;
        let log = folder().join("tests.log");
        let file = std::fs::File::create(&log).with_context(|| format!("cannot write {log:?}"))?;
        println!("tests under Wine: the output is in {}", log.display());
        let status = test.stdin(Stdio::null()).stdout(file.try_clone()?).stderr(file).status()?;
        let text = String::from_utf8_lossy(&std::fs::read(&log)?).into_owned();
        let (passed, failed, ignored) = counts(&text);
        println!("windows under Wine: {passed} passed, {failed} failed, {ignored} ignored");
        for line in text.lines().filter(|line| line.starts_with("test ") && line.trim_end().ends_with("FAILED")) {
            println!("{line}");
        }
        ensure!(status.success() && failed == 0, "tests failed under Wine: see {log:?}");
        ensure!(passed > 0, "no test ran under Wine: see {log:?}");
        Ok(())
    }

    /// Tracks sets with both programs. The documents must be the same bytes.
    fn compare(&self, sets: &[PathBuf], linux: &Path, profile: Profile) -> Result<()> {
        for set in sets {
            let name = set.file_name().with_context(|| format!("{set:?} has no name"))?.to_string_lossy();
            let stage = folder().join("compare").join(&*name);
            empty_folder(&stage)?;
            copy_folder(set, &stage.join("shot"), &|name| !name.starts_with('.'))?;
            run(command(linux)
                .arg("track")
                .arg(stage.join("shot/project.json"))
                .arg("-o")
                .arg(stage.join("linux.json")))?;
            let place = format!(r"Z:\{BUILT}\compare\{name}");
            let mut wine = self.0.command("wine");
            self.wine(&mut wine)?;
            let built = format!("/{BUILT}/build/{}/{}", WINDOWS.triple, profile.folder());
            wine.arg(format!("{built}/{}", WINDOWS.cli));
            wine.args(["track", &format!(r"{place}\shot\project.json"), "-o", &format!(r"{place}\windows.json")]);
            capture(&mut wine)?;
            let (ours, theirs) = (std::fs::read(stage.join("linux.json"))?, std::fs::read(stage.join("windows.json"))?);
            ensure!(ours == theirs, "{name}: the tracks differ: compare the files in {stage:?}");
            println!("{name}: {} bytes, the same on Linux and under Wine", ours.len());
        }
        Ok(())
    }
}

/// Passed, failed and ignored tests of all `test result` lines.
fn counts(text: &str) -> (usize, usize, usize) {
    let number = |line: &str, word: &str| -> usize {
        let before = line.split(word).next().unwrap_or_default();
        before.split_whitespace().next_back().and_then(|text| text.parse().ok()).unwrap_or(0)
    };
    text.lines().filter(|line| line.starts_with("test result:")).fold((0, 0, 0), |(p, f, i), line| {
        (p + number(line, " passed"), f + number(line, " failed"), i + number(line, " ignored"))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn results_of_all_programs_are_added() {
        let text = "test result: ok. 12 passed; 0 failed; 1 ignored; 0 measured; 0 filtered out; finished in 0.1s\n\
                    running 3 tests\ntest a ... FAILED\n\
                    test result: FAILED. 2 passed; 1 failed; 0 ignored; 0 measured; 0 filtered out\n";
        assert_eq!(counts(text), (14, 1, 1));
        assert_eq!(counts(""), (0, 0, 0));
    }

    #[test]
    fn the_header_declares_functions() {
        let names = functions().unwrap();
        assert!(names.contains("rototoon_abi_version") && names.contains("rototoon_session_track"), "{names:?}");
        assert!(names.iter().all(|name| name.starts_with("rototoon_") && !name.contains("RototoonText")));
    }
}
