//! `bundle`: makes the extension's zip, which Blender installs, and the OpenFX bundle ([`crate::ofx`]).
//!
//! The extension carries the Python package with the native library as a wheel ([`crate::wheel`]), as Blender asks of extensions:
//! its packager then makes one zip for each system, and takes out the wheels of the others.
//!
//! The native library must load on every Linux on which Blender runs. So it is built against an old glibc, with zig as the
//! linker (cargo-zigbuild and ziglang from PyPI, in an environment under `target/`). A check reads the symbol versions that
//! the library needs. Blender's own packager builds and validates the zip.

use crate::platform::{LINUX, Platform, THIS_MACHINE};
use crate::version::Kind;
use crate::{docs, elf, ofx, version, wheel};
use anyhow::{Context, Result, ensure};
use std::path::{Path, PathBuf};
use std::process::Command;
use xtask_shell::python;
use xtask_shell::shell::{capture, cargo, command, copy_folder, empty_folder, root, run, target};

/// The newest glibc that the library may need: that of the systems which Blender's own builds support (VFX platform CY2023
/// and later).
pub const GLIBC: (u32, u32) = (2, 28);
/// The packages that are tested together, as arguments of cargo: all but the OpenFX host, which compiles C++.
pub const TESTED: [&str; 3] = ["--workspace", "--exclude", "rototoon-ofx-host"];
const TRIPLE: &str = LINUX.triple;
/// The variable from which the core takes the version of a build (`rototoon::VERSION`). The builds of the tests have none: each change of a file would
/// link all of them again.
pub const MARK: &str = "ROTOTOON_BUILD";

/// The files that `bundle` makes.
#[derive(Clone, Debug)]
pub struct Bundle {
    /// The extension.
    pub zip: PathBuf,
    /// The native library.
    pub library: PathBuf,
    /// The Python package with the library, as a wheel.
    pub wheel: PathBuf,
    /// The OpenFX plugin as cargo builds it.
    pub plugin: PathBuf,
    /// The command line.
    pub cli: PathBuf,
    /// The OpenFX bundle.
    pub ofx: PathBuf,
    /// The development commands that need the core; built with [`Build::WithMeasure`] only.
    pub measure: PathBuf,
    /// The version, which all of them but the binaries of the tests name.
    pub version: String,
}

/// Which build of the library, the command line and the OpenFX plugin is packed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Build {
    /// What artists install: optimised, without line tables, for every Linux with [`GLIBC`].
    Installed,
    /// The same, and with it the development commands that need the core, so that the core is compiled once for both.
    WithMeasure,
    /// Optimised, but for systems like this one: no tools that build against an old glibc, no OpenFX plugin. With the development
    /// commands that need the core.
    Here,
    /// What the Rust tests are built from: little optimised, and only for systems like this one. Nothing is compiled for it
    /// once the tests are built.
    Tested,
    /// As `Tested`, with the documentation in the extension.
    TestedWithHelp,
}

impl Bundle {
    /// Where a build leaves it.
    pub fn of(build: Build) -> Result<Self> {
        let built = match build {
            Build::Tested | Build::TestedWithHelp => target().join("debug"),
            Build::Here => target().join("release"),
            Build::Installed | Build::WithMeasure => target().join(TRIPLE).join("release"),
        };
        let version = version_of(build)?;
        Ok(Self {
            // One name for all builds, so that they do not pile up. The manifest in it has the version.
            zip: target().join("rototoon-linux_x64.zip"),
            wheel: wheel::place(tag(build), &version),
            version,
            library: built.join(LINUX.library),
            plugin: built.join(LINUX.plugin),
            cli: built.join(LINUX.cli),
            ofx: ofx::place(),
            measure: built.join("xtask-measure"),
        })
    }
}

/// The program that packs the extension: Blender's packager in a wheel, or an installed Blender.
#[derive(Clone, Debug)]
pub enum Packager {
    /// Interpreter of an environment with the `bpy` wheel.
    Wheel(PathBuf),
    /// A Blender binary.
    Blender(PathBuf),
}

/// Builds, packs and validates.
pub fn bundle(packager: &Packager, build: Build) -> Result<Bundle> {
    ensure!(cfg!(all(target_os = "linux", target_arch = "x86_64")), "the bundle is built on Linux x86-64 only");
    let bundle = Bundle::of(build)?;
    compile(build)?;
    if build != Build::Here {
        ofx::lay_out(&bundle.plugin, &bundle.version)?;
    }
    let wheels = [(LINUX, wheel::build(&LINUX, tag(build), &bundle.version, &bundle.library)?)];
    let zips = pack_extension(packager, &wheels, &bundle.version, !matches!(build, Build::Tested | Build::Here))?;
    zips.iter().try_for_each(|zip| rename(zip, &bundle.zip))?;
    println!("bundle: {} ({})", bundle.zip.display(), bundle.version);
    Ok(bundle)
}

/// The version of a build.
pub fn version_of(build: Build) -> Result<String> {
    version::of(match build {
        Build::Installed | Build::WithMeasure => Kind::Installed,
        Build::Here => Kind::Here,
        Build::Tested | Build::TestedWithHelp => Kind::Tested,
    })
}

/// The platform tag of a build's wheel: only what artists install runs on other machines too.
pub fn tag(build: Build) -> &'static str {
    match build {
        Build::Installed | Build::WithMeasure => LINUX.wheel,
        Build::Here | Build::Tested | Build::TestedWithHelp => THIS_MACHINE,
    }
}

/// Compiles the files of a build.
pub fn compile(build: Build) -> Result<()> {
    match build {
        Build::Tested | Build::TestedWithHelp => compile_tested(),
        Build::Here => compile_here(),
        Build::Installed | Build::WithMeasure => {
            compile_installed(build)?;
            let Bundle { library, cli, plugin, .. } = Bundle::of(build)?;
            [library, cli, plugin].iter().try_for_each(|file| elf::assert_glibc(file, GLIBC))
        }
    }
}

/// Packs the extension with these wheels: one zip for each system, in a folder that the next call makes empty.
pub fn pack_extension(
    packager: &Packager,
    wheels: &[(Platform, PathBuf)],
    version: &str,
    help: bool,
) -> Result<Vec<PathBuf>> {
    let staged = stage(wheels, version)?;
    if help {
        docs::put_into(&staged.join("help"))?;
    }
    pack(packager, &staged, wheels, version)
}

/// The name that Blender's packager gives the zip of a system.
pub fn zip_name(platform: &Platform, version: &str) -> String {
    format!("rototoon-{version}-{}.zip", platform.blender.replace('-', "_"))
}

/// Gives a file another place in the folder of built files.
pub fn rename(from: &Path, to: &Path) -> Result<()> {
    std::fs::rename(from, to).with_context(|| format!("cannot move {from:?} to {to:?}"))
}

/// The interpreter of an environment with zig and cargo-zigbuild, which build against an old glibc.
pub fn tools() -> Result<PathBuf> {
    python::venv("venv-build", &python::find_any()?, &["cargo-zigbuild==0.24.1", "ziglang==0.17.1"])
}

/// Everything that the Rust tests use, in the same selection of packages: another one would compile dependencies again.
pub fn compile_tested() -> Result<()> {
    run(cargo().args(["build", "--quiet"]).args(TESTED))
}

/// Library, command line and development commands, for this machine. Cargo shows its progress.
fn compile_here() -> Result<()> {
    run(cargo()
        .args(["build", "--release", "-p", "rototoon-capi", "-p", "rototoon-cli", "-p", "xtask-measure"])
        .env(MARK, version_of(Build::Here)?)
        .env("CARGO_PROFILE_RELEASE_DEBUG", "none"))
}

/// Library, command line and OpenFX plugin as artists install them.
fn compile_installed(build: Build) -> Result<()> {
    let tools = tools()?;
    let bin = tools.parent().context("an interpreter is in a folder")?;
    if !capture(command("rustup").args(["target", "list", "--installed"])).is_ok_and(|list| list.contains(TRIPLE)) {
        // Without rustup the standard library of this machine's toolchain is used.
        let _ = capture(command("rustup").args(["target", "add", TRIPLE]));
    }
    let versioned = format!("{TRIPLE}.{}.{}", GLIBC.0, GLIBC.1);
    let mut zigbuild = command(bin.join("cargo-zigbuild"));
    zigbuild
        .args(["zigbuild", "--quiet", "--locked", "--release", "--target", &versioned])
        .args(["-p", "rototoon-capi", "-p", "rototoon-cli", "-p", "rototoon-ofx"])
        .args(if build == Build::WithMeasure { &["-p", "xtask-measure"][..] } else { &[] });
    run(release_settings(&mut zigbuild, &tools)?)
}

/// Settings of a build that artists install: zig on the search path, no line tables, no path of this machine.
pub fn release_settings<'c>(build: &'c mut Command, tools: &Path) -> Result<&'c mut Command> {
    let bin = tools.parent().context("an interpreter is in a folder")?;
    let path = std::env::var_os("PATH").unwrap_or_default();
    let path = std::env::join_paths(std::iter::once(bin.to_path_buf()).chain(std::env::split_paths(&path)))?;
    Ok(build
        .env("PATH", path)
        .env(MARK, version_of(Build::Installed)?)
        .env("CARGO_ENCODED_RUSTFLAGS", renamed_paths().join("\x1f"))
        // Line tables would only make the zip larger.
        .env("CARGO_PROFILE_RELEASE_DEBUG", "none")
        .env("CARGO_PROFILE_RELEASE_STRIP", "symbols"))
}

/// The folder with the downloaded packages.
pub fn cargo_home() -> PathBuf {
    let home = || Some(PathBuf::from(std::env::var_os("HOME")?).join(".cargo"));
    std::env::var_os("CARGO_HOME").map(PathBuf::from).or_else(home).unwrap_or_default()
}

/// Flags of the compiler. Messages of panics name source files. The names must not depend on where the sources are.
pub fn renamed_paths() -> Vec<String> {
    let renamed = [(cargo_home(), "/cargo"), (root(), "/rototoon")];
    renamed.map(|(from, to)| format!("--remap-path-prefix={}={to}", from.display())).into()
}

/// Makes the folder that is packed: the add-on's files and the wheels.
fn stage(wheels: &[(Platform, PathBuf)], version: &str) -> Result<PathBuf> {
    let staged = target().join("bundle/rototoon");
    empty_folder(&staged)?;
    // The package `rototoon` is in the wheels.
    let keep = |name: &str| {
        !name.starts_with('.') && !["__pycache__", "tests", "rototoon"].contains(&name) && !name.ends_with(".pyc")
    };
    copy_folder(&root().join("blender-addon"), &staged, &keep)?;
    let folder = staged.join("wheels");
    std::fs::create_dir_all(&folder)?;
    let mut names = Vec::new();
    for (_, wheel) in wheels {
        let name = wheel.file_name().with_context(|| format!("{wheel:?} has no name"))?.to_string_lossy().into_owned();
        std::fs::copy(wheel, folder.join(&name)).with_context(|| format!("cannot copy {wheel:?}"))?;
        names.push(format!("./wheels/{name}"));
    }
    let platforms: Vec<&str> = wheels.iter().map(|(platform, _)| platform.blender).collect();
    let place = staged.join("blender_manifest.toml");
    let text = std::fs::read_to_string(&place).context("blender_manifest.toml")?;
    std::fs::write(&place, manifest(&text, version, &platforms, &names)?)?;
    version::mark(&staged.join("build.py"), version)?;
    Ok(staged)
}

/// The manifest with the version, the systems and the wheels of a zip.
fn manifest(text: &str, version: &str, platforms: &[&str], wheels: &[String]) -> Result<String> {
    let known = text.lines().find(|line| line.starts_with("platforms = ")).unwrap_or_default();
    // Blender's validator accepts platform names that do not exist.
    for platform in platforms {
        ensure!(
            known.contains(&format!("{platform:?}")),
            "blender_manifest.toml: found {known:?}, expected {platform:?} in it"
        );
    }
    ensure!(
        !text.contains("\nwheels"),
        "blender_manifest.toml: found wheels, expected none: they are entered when it is packed"
    );
    let numbered =
        text.lines().find(|line| line.starts_with("version = ")).context("blender_manifest.toml: no version")?;
    let text = text.replacen(&format!("\n{numbered}\n"), &format!("\nversion = {version:?}\n"), 1);
    Ok(text.replace(known, &format!("platforms = {platforms:?}\nwheels = {wheels:?}")))
}

fn pack(packager: &Packager, staged: &Path, wheels: &[(Platform, PathBuf)], version: &str) -> Result<Vec<PathBuf>> {
    let out = target().join("bundle/out");
    empty_folder(&out)?;
    let words = ["build", "--split-platforms", "--source-dir"];
    run(packager.command()?.args(words).arg(staged).arg("--output-dir").arg(&out))?;
    let mut built: Vec<String> = std::fs::read_dir(&out)?
        .map(|entry| Ok(entry?.file_name().to_string_lossy().into_owned()))
        .collect::<Result<_>>()?;
    let mut expected: Vec<String> = wheels.iter().map(|(platform, _)| zip_name(platform, version)).collect();
    built.sort();
    expected.sort();
    ensure!(built == expected, "the packager made {built:?}, expected {expected:?}");
    let zips: Vec<PathBuf> = built.iter().map(|name| out.join(name)).collect();
    for zip in &zips {
        // The packager writes the manifest anew, with the time of day.
        wheel::archive(zip, zip)?;
        let said = capture(packager.command()?.arg("validate").arg(zip))?;
        ensure!(!said.to_lowercase().contains("warning"), "{zip:?}: the validator says: {said}");
    }
    Ok(zips)
}

impl Packager {
    /// The oldest Blender wheel whose version of Python is installed.
    pub fn from_wheel() -> Result<Self> {
        Ok(Self::Wheel(python::any_blender_venv()?.1))
    }

    fn command(&self) -> Result<Command> {
        Ok(match self {
            Self::Wheel(interpreter) => {
                let mut command = command(interpreter);
                command.arg(blender_ext(interpreter)?);
                command
            }
            Self::Blender(binary) => {
                let mut command = command(binary);
                command.args(["--background", "--factory-startup", "--command", "extension"]);
                command
            }
        })
    }
}

/// The path of Blender's packager in the wheel: `bpy/<version>/scripts/addons_core/bl_pkg/cli/blender_ext.py`.
fn blender_ext(interpreter: &Path) -> Result<PathBuf> {
    let find = "import sysconfig; print(sysconfig.get_paths()['platlib'])";
    let bpy = Path::new(&capture(command(interpreter).args(["-c", find]))?).join("bpy");
    let entries = std::fs::read_dir(&bpy).with_context(|| format!("no bpy wheel at {bpy:?}"))?;
    let script = "scripts/addons_core/bl_pkg/cli/blender_ext.py";
    let mut found = entries.flatten().map(|entry| entry.path().join(script)).filter(|path| path.exists());
    found.next().with_context(|| format!("no {script} in {bpy:?}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_manifest_names_wheels_and_systems() {
        let text = "schema_version = \"1.0.0\"\nversion = \"1.0.0\"\nplatforms = [\"linux-x64\", \"windows-x64\"]\n\n[permissions]\n";
        let made = manifest(text, "2.0.0-dev1+h2", &["linux-x64"], &["./wheels/a.whl".to_owned()]).unwrap();
        let expected = "schema_version = \"1.0.0\"\nversion = \"2.0.0-dev1+h2\"\nplatforms = [\"linux-x64\"]\nwheels = [\"./wheels/a.whl\"]\n\n[permissions]\n";
        assert_eq!(made, expected);
        assert!(manifest(text, "2.0.0", &["linux-arm64"], &[]).is_err());
        assert!(manifest(&made, "2.0.0", &["linux-x64"], &[]).is_err());
    }
}
