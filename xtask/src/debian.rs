//! A Debian sid in a folder of its own, for tools that this machine lacks: a Blender with windows, or a compiler for Windows and
//! Wine. debootstrap installs it once. Sid changes over time, and debootstrap and chroot need root.

use anyhow::{Context, Result, bail};
use std::path::{Path, PathBuf};
use std::process::Command;
use xtask_shell::shell::{capture, command, run, works};

/// The mirror may be an old snapshot, whose index has expired.
const EXPIRED: [&str; 2] = ["-o", "Acquire::Check-Valid-Until=false"];
/// The certificates that this machine trusts. A network may have one of its own.
const CERTIFICATES: &str = "/etc/ssl/certs/ca-certificates.crt";

/// An installed system.
#[derive(Clone, Debug)]
pub struct Debian {
    /// Its folder.
    pub folder: PathBuf,
}

/// The reason why this machine cannot have one, if there is one.
pub fn cannot() -> Option<String> {
    if !capture(command("id").arg("-u")).is_ok_and(|id| id == "0") {
        return Some("it needs root for chroot".into());
    }
    if !works("debootstrap", &["--version"]) {
        return Some("debootstrap is missing; install it: apt-get install debootstrap".into());
    }
    None
}

impl Debian {
    /// Installs the system with these packages into a folder, once.
    pub fn install(folder: &Path, packages: &[&str]) -> Result<Self> {
        let system = Self { folder: folder.to_owned() };
        let stamp = folder.join("packages-installed");
        let wanted = packages.join("\n");
        if std::fs::read_to_string(&stamp).is_ok_and(|have| have == wanted) {
            return Ok(system);
        }
        // A run that was killed leaves its mounts. What they show must not be removed with the folder.
        if let Some(place) = mounted(folder)? {
            bail!("{place} is mounted, expected nothing below {folder:?}; unmount it: umount {place}");
        }
        if folder.exists() {
            std::fs::remove_dir_all(folder).with_context(|| format!("cannot remove {folder:?}"))?;
        }
        std::fs::create_dir_all(folder).with_context(|| format!("cannot make {folder:?}"))?;
        let mut bootstrap = command("debootstrap");
        bootstrap.args(["--variant=minbase", "sid"]).arg(folder);
        // The variable replaces debootstrap's default mirror.
        bootstrap.args(std::env::var_os("DEBIAN_MIRROR"));
        run(&mut bootstrap)?;
        let _proc = system.proc()?;
        let apt = |words: &[&str]| {
            run(system.command("apt-get").env("DEBIAN_FRONTEND", "noninteractive").args(EXPIRED).args(words))
        };
        apt(&["-qq", "update"])?;
        apt(&[&["-qq", "install", "--yes", "--no-install-recommends", "ca-certificates"], packages].concat())?;
        if Path::new(CERTIFICATES).is_file() {
            std::fs::copy(CERTIFICATES, folder.join(&CERTIFICATES[1..])).context("cannot copy the certificates")?;
        }
        std::fs::write(&stamp, wanted).context("cannot write into the new system")?;
        Ok(system)
    }

    /// A program of the system.
    pub fn command(&self, program: &str) -> Command {
        let mut start = command("chroot");
        start.arg(&self.folder).arg(program).env("PATH", "/usr/sbin:/usr/bin:/sbin:/bin").env("LC_ALL", "C.UTF-8");
        start
    }

    /// Shows `/proc` in it until the mount is dropped.
    pub fn proc(&self) -> Result<Mount> {
        self.mount(Path::new("/proc"), "proc")
    }

    /// Shows a folder of this machine in it, as `to`, until the mount is dropped.
    pub fn mount(&self, from: &Path, to: &str) -> Result<Mount> {
        let place = self.folder.join(to);
        std::fs::create_dir_all(&place).with_context(|| format!("cannot make {place:?}"))?;
        run(command("mount").arg("--bind").arg(from).arg(&place))?;
        Ok(Mount(place))
    }
}

/// A place below a folder where something is mounted.
fn mounted(folder: &Path) -> Result<Option<String>> {
    let mounts = std::fs::read_to_string("/proc/self/mounts").context("cannot read which folders are mounted")?;
    let place =
        mounts.lines().filter_map(|line| line.split(' ').nth(1)).find(|place| Path::new(place).starts_with(folder));
    Ok(place.map(str::to_owned))
}

/// A folder that is shown in the system until this is dropped.
pub struct Mount(PathBuf);

impl Drop for Mount {
    fn drop(&mut self) {
        if let Err(error) = run(command("umount").arg("--lazy").arg(&self.0)) {
            eprintln!("{error:#}");
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    #[cfg(target_os = "linux")]
    fn mounts_are_found_by_their_place() {
        assert!(mounted(Path::new("/proc")).unwrap().is_some());
        assert_eq!(mounted(Path::new("/proc/no-such-place")).unwrap(), None);
    }
}
