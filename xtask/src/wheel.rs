//! Makes wheels of the Python package: one for each system, with the native library in it.
//!
//! hatchling packs them (`xtask/wheel`). The library is called through ctypes and not linked to Python. So one
//! wheel serves every version of Python, and its tag is `py3-none-…`. maturin would give the library's wheel the tag of one
//! interpreter, or generate a loader of its own for cffi.

use crate::licences;
use crate::platform::Platform;
use anyhow::{Context, Result, ensure};
use std::path::{Path, PathBuf};
use xtask_shell::python;
use xtask_shell::shell::{capture, command, copy_folder, empty_folder, root, run, target};

/// The environment with the packager.
pub fn environment() -> Result<PathBuf> {
    python::venv("venv-wheel", &python::find_any()?, &["hatchling==1.33.0"])
}

/// Where the wheel with this platform tag is left.
pub fn place(tag: &str) -> PathBuf {
    target().join("wheels").join(tag).join(format!("rototoon-{}-py3-none-{tag}.whl", env!("CARGO_PKG_VERSION")))
}

/// Packs a library. `tag` is the platform tag of the wheel's name: that of the platform, or one for this machine only.
///
/// The same files give the same bytes.
pub fn build(platform: &Platform, tag: &str, library: &Path) -> Result<PathBuf> {
    let interpreter = environment()?;
    let out = target().join("wheels").join(tag);
    let staged = out.join("package");
    empty_folder(&out)?;
    stage(platform, library, &staged)?;
    run(command(interpreter)
        .args(["-m", "hatchling", "build", "--target", "wheel", "--directory"])
        .arg(&out)
        .current_dir(&staged)
        .env("ROTOTOON_VERSION", env!("CARGO_PKG_VERSION"))
        .env("ROTOTOON_WHEEL_PLATFORM", tag)
        .env("SOURCE_DATE_EPOCH", date()?.to_string()))?;
    let wheel = place(tag);
    ensure!(wheel.is_file(), "hatchling made no {wheel:?}");
    Ok(wheel)
}

/// Makes the folder that is packed: the package with the library and all licences, and the files for hatchling.
fn stage(platform: &Platform, library: &Path, staged: &Path) -> Result<()> {
    let keep = |name: &str| name != "__pycache__" && !name.starts_with('.') && !name.ends_with(".pyc");
    copy_folder(&root().join("xtask/wheel"), staged, &keep)?;
    copy_folder(&root().join("blender-addon/rototoon"), &staged.join("rototoon"), &|name| {
        keep(name) && ![".so", ".dll", ".dylib"].iter().any(|end| name.ends_with(end))
    })?;
    std::fs::copy(root().join("blender-addon/LICENSE"), staged.join("LICENSE"))?;
    let native = staged.join("rototoon/native");
    copy_folder(&licences::folder(platform)?, &native.join("licences"), &|_| true)?;
    std::fs::copy(library, native.join(platform.library)).with_context(|| format!("cannot copy {library:?}"))?;
    Ok(())
}

/// Seconds since 1970 that packed files carry: the time of the commit, so that two builds of one commit are the same.
pub fn date() -> Result<u64> {
    /// The earliest time that a zip can hold, for a folder without a history.
    const EARLIEST: u64 = 315_619_200;
    if let Some(named) = std::env::var_os("SOURCE_DATE_EPOCH") {
        let named = named.to_string_lossy();
        return named
            .parse()
            .with_context(|| format!("SOURCE_DATE_EPOCH: found {named:?}, expected seconds since 1970"));
    }
    let told = capture(command("git").args(["log", "-1", "--format=%ct"]));
    Ok(told.ok().and_then(|text| text.parse().ok()).unwrap_or(EARLIEST).max(EARLIEST))
}
