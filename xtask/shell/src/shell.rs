//! Runs other programs, and finds the workspace's folders.

use anyhow::{Context, Result, bail};
use std::ffi::OsStr;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

/// The workspace's folder.
pub fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).ancestors().nth(2).expect("the package lies in the workspace").to_path_buf()
}

/// The folder of all built files. `CARGO_TARGET_DIR` overrides it.
pub fn target() -> PathBuf {
    std::env::var_os("CARGO_TARGET_DIR").map_or_else(|| root().join("target"), |folder| root().join(folder))
}

/// A command that starts in the workspace's folder.
pub fn command(program: impl AsRef<OsStr>) -> Command {
    let mut command = Command::new(program);
    command.current_dir(root());
    command
}

/// The cargo that started this program.
pub fn cargo() -> Command {
    command(std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into()))
}

/// Runs a command to its end. The error names the command and its exit status.
pub fn run(command: &mut Command) -> Result<()> {
    let status = command.status().with_context(|| format!("cannot start {}", shown(command)))?;
    if !status.success() {
        bail!("{} ended with {status}", shown(command));
    }
    Ok(())
}

/// Runs a command and returns its standard output. The error contains its standard error.
pub fn capture(command: &mut Command) -> Result<String> {
    let output = command.stdin(Stdio::null()).output().with_context(|| format!("cannot start {}", shown(command)))?;
    if !output.status.success() {
        let said = String::from_utf8_lossy(&output.stderr);
        bail!("{} ended with {}: {}", shown(command), output.status, said.trim());
    }
    Ok(String::from_utf8_lossy(&output.stdout).trim().to_owned())
}

/// Whether a program can be started and succeeds with these arguments.
pub fn works(program: &str, arguments: &[&str]) -> bool {
    capture(command(program).args(arguments)).is_ok()
}

/// The command line of a command, for messages.
fn shown(command: &Command) -> String {
    let words = std::iter::once(command.get_program()).chain(command.get_args());
    words.map(|word| word.to_string_lossy()).collect::<Vec<_>>().join(" ")
}

/// Makes an empty folder, and removes the old one.
pub fn empty_folder(path: &Path) -> Result<()> {
    if path.exists() {
        std::fs::remove_dir_all(path).with_context(|| format!("cannot remove {path:?}"))?;
    }
    std::fs::create_dir_all(path).with_context(|| format!("cannot make {path:?}"))
}

/// Copies a folder with its subfolders. Copies only files and folders whose names `keep` accepts.
pub fn copy_folder(from: &Path, to: &Path, keep: &dyn Fn(&str) -> bool) -> Result<()> {
    std::fs::create_dir_all(to).with_context(|| format!("cannot make {to:?}"))?;
    for entry in std::fs::read_dir(from).with_context(|| format!("cannot read {from:?}"))? {
        let entry = entry?;
        let name = entry.file_name().to_string_lossy().into_owned();
        if !keep(&name) {
            continue;
        }
        let (source, copy) = (entry.path(), to.join(&name));
        if entry.file_type()?.is_dir() {
            copy_folder(&source, &copy, keep)?;
        } else {
            std::fs::copy(&source, &copy).with_context(|| format!("cannot copy {source:?} to {copy:?}"))?;
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn errors_name_the_command() {
        let error = run(command("false").arg("quietly")).unwrap_err().to_string();
        assert!(error.contains("false quietly"), "{error}");
        assert!(
            capture(command("no-such-program-here").arg("x"))
                .unwrap_err()
                .to_string()
                .contains("no-such-program-here x")
        );
    }

    #[test]
    fn copies_only_accepted_names() {
        let folder = target().join("xtask-copy-test");
        empty_folder(&folder).unwrap();
        std::fs::create_dir_all(folder.join("a/inner")).unwrap();
        std::fs::create_dir_all(folder.join("a/__pycache__")).unwrap();
        for file in ["a/one.py", "a/inner/two.py", "a/inner/two.pyc", "a/__pycache__/three.py"] {
            std::fs::write(folder.join(file), file).unwrap();
        }
        copy_folder(&folder.join("a"), &folder.join("b"), &|name| name != "__pycache__" && !name.ends_with(".pyc"))
            .unwrap();
        let exists = |file: &str| folder.join(file).exists();
        assert!(exists("b/one.py") && exists("b/inner/two.py"));
        assert!(!exists("b/inner/two.pyc") && !exists("b/__pycache__"));
        std::fs::remove_dir_all(&folder).unwrap();
    }
}
