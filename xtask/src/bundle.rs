//! `bundle`: makes the extension's zip, which Blender installs, and the OpenFX bundle ([`crate::ofx`]).
//!
//! The native library must load on every Linux on which Blender runs. So it is built against an old glibc, with zig as the
//! linker (cargo-zigbuild and ziglang from PyPI, in an environment under `target/`). A check reads the symbol versions that
//! the library needs. Blender's own packager builds and validates the zip.

use crate::{docs, elf, ofx};
use anyhow::{Context, Result, bail, ensure};
use std::path::{Path, PathBuf};
use std::process::Command;
use xtask_shell::python;
use xtask_shell::shell::{capture, cargo, command, copy_folder, empty_folder, root, run, target};

/// The newest glibc that the library may need: that of the systems which Blender's own builds support (VFX platform CY2023
/// and later).
pub const GLIBC: (u32, u32) = (2, 28);
/// The packages that are tested together, as arguments of cargo: all but the OpenFX host, which compiles C++.
pub const TESTED: [&str; 3] = ["--workspace", "--exclude", "rototoon-ofx-host"];
const TRIPLE: &str = "x86_64-unknown-linux-gnu";
const LIBRARY: &str = "librototoon_capi.so";
const PLUGIN: &str = "librototoon_ofx.so";

/// The files that `bundle` makes.
#[derive(Clone, Debug)]
pub struct Bundle {
    /// The extension.
    pub zip: PathBuf,
    /// The native library.
    pub library: PathBuf,
    /// The command line.
    pub cli: PathBuf,
    /// The OpenFX bundle.
    pub ofx: PathBuf,
    /// The development commands that need the core; built with [`Build::WithMeasure`] only.
    pub measure: PathBuf,
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
    pub fn of(build: Build) -> Self {
        let built = match build {
            Build::Tested | Build::TestedWithHelp => target().join("debug"),
            Build::Here => target().join("release"),
            Build::Installed | Build::WithMeasure => target().join(TRIPLE).join("release"),
        };
        let zip = target().join(format!("rototoon-{}-linux_x64.zip", env!("CARGO_PKG_VERSION")));
        Self {
            zip,
            library: built.join(LIBRARY),
            cli: built.join("rototoon"),
            ofx: ofx::place(),
            measure: built.join("xtask-measure"),
        }
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
    let bundle = Bundle::of(build);
    let plugin = bundle.library.with_file_name(PLUGIN);
    match build {
        Build::Tested | Build::TestedWithHelp => compile_tested()?,
        Build::Here => compile_here()?,
        Build::Installed | Build::WithMeasure => {
            compile_installed(build)?;
            for file in [&bundle.library, &bundle.cli, &plugin] {
                elf::assert_glibc(file, GLIBC)?;
            }
        }
    }
    if build != Build::Here {
        ofx::lay_out(&plugin)?;
    }
    let staged = stage(&bundle.library)?;
    if !matches!(build, Build::Tested | Build::Here) {
        docs::put_into(&staged.join("help"))?;
    }
    pack(packager, &staged, &bundle.zip)?;
    println!("bundle: {}", bundle.zip.display());
    Ok(bundle)
}

/// The interpreter of an environment with zig and cargo-zigbuild, which build against an old glibc.
pub fn tools() -> Result<PathBuf> {
    python::venv("venv-build", &python::find_any()?, &["cargo-zigbuild", "ziglang"])
}

/// Everything that the Rust tests use, in the same selection of packages: another one would compile dependencies again.
pub fn compile_tested() -> Result<()> {
    run(cargo().args(["build", "--quiet"]).args(TESTED))
}

/// Library, command line and development commands, for this machine. Cargo shows its progress.
fn compile_here() -> Result<()> {
    run(cargo()
        .args(["build", "--release", "-p", "rototoon-capi", "-p", "rototoon-cli", "-p", "xtask-measure"])
        .env("CARGO_PROFILE_RELEASE_DEBUG", "none"))
}

/// Library, command line and OpenFX plugin as artists install them.
fn compile_installed(build: Build) -> Result<()> {
    let tools = tools()?;
    let bin = tools.parent().context("an interpreter is in a folder")?;
    let path = std::env::var_os("PATH").unwrap_or_default();
    let path = std::env::join_paths(std::iter::once(bin.to_path_buf()).chain(std::env::split_paths(&path)))?;
    if !capture(command("rustup").args(["target", "list", "--installed"])).is_ok_and(|list| list.contains(TRIPLE)) {
        // Without rustup the standard library of this machine's toolchain is used.
        let _ = capture(command("rustup").args(["target", "add", TRIPLE]));
    }
    let versioned = format!("{TRIPLE}.{}.{}", GLIBC.0, GLIBC.1);
    run(command(bin.join("cargo-zigbuild"))
        .args(["zigbuild", "--quiet", "--release", "--target", &versioned])
        .args(["-p", "rototoon-capi", "-p", "rototoon-cli", "-p", "rototoon-ofx"])
        .args(if build == Build::WithMeasure { &["-p", "xtask-measure"][..] } else { &[] })
        .env("PATH", path)
        // Line tables would only make the zip larger.
        .env("CARGO_PROFILE_RELEASE_DEBUG", "none")
        .env("CARGO_PROFILE_RELEASE_STRIP", "symbols"))
}

/// Makes the folder that is packed: the add-on's files, the library, the licences.
fn stage(library: &Path) -> Result<PathBuf> {
    let staged = target().join("bundle/rototoon");
    empty_folder(&staged)?;
    let keep = |name: &str| {
        !name.starts_with('.')
            && !["__pycache__", "tests"].contains(&name)
            && !name.ends_with(".pyc")
            && !name.ends_with(".so")
    };
    copy_folder(&root().join("blender-addon"), &staged, &keep)?;
    let native = staged.join("rototoon/native");
    std::fs::copy(library, native.join(LIBRARY)).with_context(|| format!("cannot copy {library:?}"))?;
    // The add-on's own licence is in its folder; the library's goes beside the library.
    std::fs::copy(root().join("LICENSE"), native.join("LICENSE"))?;
    let manifest = std::fs::read_to_string(staged.join("blender_manifest.toml")).context("blender_manifest.toml")?;
    // Blender's validator accepts platform names that do not exist.
    let platforms = manifest.lines().find(|line| line.starts_with("platforms")).unwrap_or_default();
    ensure!(
        platforms.contains("[\"linux-x64\"]"),
        "blender_manifest.toml: {platforms:?}, expected platforms = [\"linux-x64\"]"
    );
    Ok(staged)
}

fn pack(packager: &Packager, staged: &Path, place: &Path) -> Result<()> {
    let out = target().join("bundle/out");
    empty_folder(&out)?;
    run(packager
        .command()?
        .args(["build", "--split-platforms", "--source-dir"])
        .arg(staged)
        .arg("--output-dir")
        .arg(&out))?;
    let built: Vec<PathBuf> = std::fs::read_dir(&out)?.map(|e| Ok(e?.path())).collect::<Result<_>>()?;
    let [zip] = built.as_slice() else { bail!("the packager made {built:?}, expected one zip") };
    ensure!(zip.file_name() == place.file_name(), "the packager made {zip:?}, expected the file name of {place:?}");
    run(packager.command()?.arg("validate").arg(zip))?;
    std::fs::rename(zip, place).with_context(|| format!("cannot move {zip:?} to {place:?}"))
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
