//! Python interpreters and virtual environments under `target/`.

use crate::shell::{capture, command, run, target};
use anyhow::{Context, Result, bail};
use std::path::{Path, PathBuf};

/// A version of the `bpy` wheel, and the version of Python that it is built for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Wheel {
    /// Version of Blender, as on PyPI.
    pub blender: &'static str,
    /// Version of Python, two numbers.
    pub python: &'static str,
}

/// The Blender versions that are tested, the oldest first: those with long support, and the newest one.
pub const WHEELS: [Wheel; 3] = [
    Wheel { blender: "4.5.15", python: "3.11" },
    Wheel { blender: "5.2.3", python: "3.13" },
    Wheel { blender: "5.3.0", python: "3.13" },
];

/// An interpreter of a version such as "3.11": the first one that runs.
///
/// Candidates are `python3.11`, `python3` and `python` on the search path, then the versions that pyenv has installed. The
/// shims of pyenv may exist and still refuse to run.
pub fn find(version: &str) -> Option<PathBuf> {
    let mut candidates: Vec<PathBuf> = [&format!("python{version}"), "python3", "python"].map(PathBuf::from).into();
    let pyenv = std::env::var_os("PYENV_ROOT").map(PathBuf::from);
    let pyenv = pyenv.or_else(|| Some(PathBuf::from(std::env::var_os("HOME")?).join(".pyenv")));
    if let Some(entries) = pyenv.and_then(|folder| std::fs::read_dir(folder.join("versions")).ok()) {
        let mut found: Vec<PathBuf> = entries.flatten().map(|e| e.path().join("bin/python")).collect();
        found.sort();
        candidates.extend(found);
    }
    candidates.into_iter().find(|python| version_of(python).is_ok_and(|found| found == version))
}

fn version_of(python: &Path) -> Result<String> {
    capture(command(python).args(["-c", "import sys; print('%d.%d' % sys.version_info[:2])"]))
}

/// An interpreter of version 3.11 or later. Older versions lack `tomllib`.
pub fn find_any() -> Result<PathBuf> {
    ["3.11", "3.13", "3.12", "3.14"].iter().find_map(|v| find(v)).context(
        "found no Python of version 3.11 or later; install it, for example: apt-get install python3.11 python3.11-venv",
    )
}

/// Makes a virtual environment `target/<name>` with these requirements and returns its interpreter. It is made once: a file
/// in it lists the installed requirements. Downloads are tried twice.
pub fn venv(name: &str, python: &Path, requirements: &[&str]) -> Result<PathBuf> {
    let folder = target().join(name);
    let interpreter = folder.join("bin/python");
    let stamp = folder.join("requirements-installed.txt");
    let wanted = requirements.join("\n");
    if std::fs::read_to_string(&stamp).is_ok_and(|have| have == wanted) && version_of(&interpreter).is_ok() {
        return Ok(interpreter);
    }
    println!("Python environment {name}: {}", requirements.join(", "));
    let plain = capture(command(python).args(["-m", "venv", "--clear"]).arg(&folder));
    if let Err(reason) = plain {
        // Debian has ensurepip in a package of its own. An environment without pip works too, if another pip fills it.
        capture(command(python).args(["-m", "venv", "--clear", "--without-pip"]).arg(&folder)).map_err(|_| reason)?;
    }
    if let Err(first) = install(python, &interpreter, requirements) {
        println!("{first:#}\ntrying again");
        install(python, &interpreter, requirements)?;
    }
    std::fs::write(&stamp, wanted).with_context(|| format!("cannot write {stamp:?}"))?;
    Ok(interpreter)
}

fn install(python: &Path, interpreter: &Path, requirements: &[&str]) -> Result<()> {
    // Packages of this size are downloaded once, so pip keeps no second copy of them. Python compiles the modules that are
    // used when it first reads them. Blender's wheel and NumPy have many that no test uses: all of them would take 5 s of 12.
    let flags = ["install", "--disable-pip-version-check", "--no-cache-dir", "--no-compile"];
    if capture(command(interpreter).args(["-m", "pip", "--version"])).is_ok() {
        return run(command(interpreter).args(["-m", "pip"]).args(flags).args(requirements));
    }
    if capture(command(python).args(["-m", "pip", "--version"])).is_ok() {
        let pip = ["-m", "pip", "--python"];
        return run(command(python).args(pip).arg(interpreter).args(flags).args(requirements));
    }
    bail!("{} has no pip; install it, for example: apt-get install python3-pip python3-venv", python.display())
}

/// The environment with a Blender wheel and pytest; `None` if its version of Python is not installed.
pub fn blender_venv(wheel: Wheel) -> Result<Option<PathBuf>> {
    let Some(python) = find(wheel.python) else { return Ok(None) };
    let bpy = format!("bpy=={}", wheel.blender);
    venv(&format!("venv-bpy-{}", wheel.blender), &python, &[&bpy, "pytest"]).map(Some)
}

/// The environment of the oldest supported Blender whose version of Python is installed.
pub fn any_blender_venv() -> Result<(Wheel, PathBuf)> {
    for wheel in WHEELS {
        if let Some(python) = blender_venv(wheel)? {
            return Ok((wheel, python));
        }
    }
    bail!(
        "found neither Python 3.11 nor 3.13, which Blender's wheels need; install one, for example: apt-get install \
         python3.11 python3.11-venv"
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_found_interpreter_has_the_requested_version() {
        assert_eq!(find("2.99"), None);
        for version in ["3.11", "3.13"] {
            if let Some(python) = find(version) {
                assert_eq!(version_of(&python).unwrap(), version);
            }
        }
    }
}
