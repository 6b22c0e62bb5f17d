//! Makes wheels of the Python package: one for each system, with the native library in it.
//!
//! hatchling packs them (`xtask/wheel`). The library is called through ctypes and not linked to Python. So one
//! wheel serves every version of Python, and its tag is `py3-none-…`. maturin would give the library's wheel the tag of one
//! interpreter, or generate a loader of its own for cffi.

use crate::licences;
use crate::platform::Platform;
use crate::version;
use anyhow::{Context, Result, ensure};
use std::path::{Path, PathBuf};
use xtask_shell::python;
use xtask_shell::shell::{command, copy_folder, empty_folder, root, run, target};

/// The environment with the packager.
pub fn environment() -> Result<PathBuf> {
    python::venv("venv-wheel", &python::find_any()?, &["hatchling==1.33.0"])
}

/// Where the wheel of a version with this platform tag is left.
pub fn place(tag: &str, version: &str) -> PathBuf {
    target().join("wheels").join(tag).join(format!("rototoon-{}-py3-none-{tag}.whl", version::of_wheel(version)))
}

/// The wheel that was made last with this platform tag. Its sources may have been changed since.
pub fn made(tag: &str) -> Result<PathBuf> {
    let folder = target().join("wheels").join(tag);
    let entries = std::fs::read_dir(&folder).with_context(|| format!("cannot read {folder:?}"))?;
    let mut wheels =
        entries.flatten().map(|entry| entry.path()).filter(|path| path.extension() == Some("whl".as_ref()));
    wheels.next().with_context(|| format!("no wheel is in {folder:?}"))
}

/// Packs a library. `tag` is the platform tag of the wheel's name: that of the platform, or one for this machine only.
///
/// The same files give the same bytes.
pub fn build(platform: &Platform, tag: &str, version: &str, library: &Path) -> Result<PathBuf> {
    let interpreter = environment()?;
    let out = target().join("wheels").join(tag);
    let staged = out.join("package");
    empty_folder(&out)?;
    stage(platform, library, &staged)?;
    version::mark(&staged.join("rototoon/build.py"), version)?;
    run(command(interpreter)
        .args(["-m", "hatchling", "build", "--target", "wheel", "--directory"])
        .arg(&out)
        .current_dir(&staged)
        .env("ROTOTOON_VERSION", version::of_wheel(version))
        .env("ROTOTOON_WHEEL_PLATFORM", tag)
        .env("SOURCE_DATE_EPOCH", version::date()?.to_string()))?;
    let wheel = place(tag, version);
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

/// Packs a folder, or packs a zip again, with the time of the commit: the same content gives the same bytes.
pub fn archive(source: &Path, zip: &Path) -> Result<()> {
    run(command(environment()?)
        .arg(root().join("xtask/archive.py"))
        .args([source, zip])
        .arg(version::date()?.to_string()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use xtask_shell::shell::capture;

    /// Packs two files in this order, at this time of day, as other programs would.
    const PACK: &str = "import sys, zipfile
with zipfile.ZipFile(sys.argv[1], 'w') as out:
    for name in sys.argv[3:]:
        out.writestr(zipfile.ZipInfo(name, (2026, 1, 1, int(sys.argv[2]), 0, 0)), name * 100)";

    #[test]
    fn a_zip_that_is_packed_again_depends_on_its_content_only() {
        let folder = target().join("xtask-archive-test");
        empty_folder(&folder).unwrap();
        let python = python::find_any().unwrap();
        let pack = |name: &str, words: [&str; 3]| {
            let zip = folder.join(name);
            run(command(&python).args(["-c", PACK]).arg(&zip).args(words)).unwrap();
            let before = std::fs::read(&zip).unwrap();
            run(command(&python).arg(root().join("xtask/archive.py")).args([&zip, &zip]).arg("1000000000")).unwrap();
            (before, std::fs::read(&zip).unwrap())
        };
        let (morning, one) = pack("one.zip", ["8", "a.txt", "b/c.txt"]);
        let (evening, other) = pack("other.zip", ["20", "b/c.txt", "a.txt"]);
        let (_, more) = pack("more.zip", ["8", "a.txt", "b/d.txt"]);
        assert!(morning != evening && one == other && one != more);
        // No zip can hold a time before 1980; nothing is left of one that was broken off.
        let early = folder.join("early.zip");
        let script = root().join("xtask/archive.py");
        assert!(capture(command(&python).arg(script).args([&folder.join("one.zip"), &early]).arg("0")).is_err());
        assert!(!early.exists() && !folder.join("early.zip.unfinished").exists());
        std::fs::remove_dir_all(&folder).unwrap();
    }
}
