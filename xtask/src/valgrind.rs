//! Finds a valgrind that knows this project's code.
//!
//! The machine's own counts if it is newer than [`OLD`]. That one stops at `vmovq` from register to register in its form with the
//! byte D6, an instruction of AVX, which the compiler puts into the vectorised optical flow; it knows that form only with a place in
//! memory. Otherwise the package of Debian sid is unpacked once into the target folder, where nothing of the system changes: apt
//! keeps its lists there, so it checks the signatures and needs no root. Only the programs are taken. They are linked statically,
//! except a launcher that needs glibc 2.34.

use anyhow::{Context, Result, bail};
use std::path::{Path, PathBuf};
use std::process::Command;
use xtask_shell::shell::{capture, command, empty_folder, run, target, works};

/// The newest version that is too old.
const OLD: [u32; 2] = [3, 19];
/// The keys with which Debian signs its packages.
const KEYS: &str = "/usr/share/keyrings/debian-archive-keyring.gpg";

/// A valgrind.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Valgrind {
    /// Its program.
    pub program: PathBuf,
    /// The folder of its tools, for the variable `VALGRIND_LIB`, where it is not where the program expects it.
    pub tools: Option<PathBuf>,
}

impl Valgrind {
    /// A valgrind that is new enough, or the reason why there is none. The machine has one already.
    pub fn find() -> Result<Result<Self, String>> {
        let own = Self { program: "valgrind".into(), tools: None };
        let version = own.version()?;
        if !is_old(&version) {
            return Ok(Ok(own));
        }
        let folder = target().join("valgrind");
        let unpacked = Self::in_folder(&folder.join("debian"));
        if !unpacked.version().is_ok_and(|version| !is_old(&version)) {
            let got = mirror().and_then(|mirror| unpack(&folder, &mirror));
            if let Err(error) = got {
                return Ok(Err(format!(
                    "{version} does not know all of AVX; take a newer one. Debian's newest cannot be had: {error:#}"
                )));
            }
        }
        let newer = unpacked.version().with_context(|| format!("the valgrind in {folder:?} does not run"))?;
        if is_old(&newer) {
            bail!("found {newer} in Debian sid, expected one that is newer than {OLD:?}");
        }
        println!("{version} does not know all of AVX; {newer} of Debian sid is used");
        Ok(Ok(unpacked))
    }

    fn in_folder(folder: &Path) -> Self {
        // `bin/valgrind` is a script with the places of an installed package.
        Self { program: folder.join("usr/bin/valgrind.bin"), tools: Some(folder.join("usr/libexec/valgrind")) }
    }

    /// Lets a command find the tools.
    pub fn prepare<'a>(&self, command: &'a mut Command) -> &'a mut Command {
        command.envs(self.tools.iter().map(|tools| ("VALGRIND_LIB", tools)))
    }

    fn version(&self) -> Result<String> {
        capture(self.prepare(command(&self.program).arg("--version")))
    }
}

/// Whether a version, such as `valgrind-3.19.0`, is too old.
fn is_old(version: &str) -> bool {
    let numbers = version.trim().trim_start_matches("valgrind-").split('.').map_while(|part| part.parse::<u32>().ok());
    numbers.take(2).collect::<Vec<u32>>() <= OLD.to_vec()
}

/// The mirror of Debian that this machine uses. A variable overrides it.
fn mirror() -> Result<String> {
    if let Ok(mirror) = std::env::var("DEBIAN_MIRROR") {
        return Ok(mirror);
    }
    let words = ["indextargets", "--format", "$(REPO_URI)", "Created-By: Packages", "Origin: Debian", "Label: Debian"];
    let found = capture(command("apt-get").args(words))?;
    let first = found.lines().next().filter(|line| !line.is_empty());
    first.map(str::to_owned).context("apt knows no mirror of Debian; name one in the variable DEBIAN_MIRROR")
}

/// Unpacks the package of Debian sid into a folder.
fn unpack(folder: &Path, mirror: &str) -> Result<()> {
    for program in ["apt-get", "dpkg-deb"] {
        if !works(program, &["--version"]) {
            bail!("{program} is missing");
        }
    }
    if !Path::new(KEYS).is_file() {
        bail!("{KEYS} is missing; install it: apt-get install debian-archive-keyring");
    }
    empty_folder(folder)?;
    for place in ["state/lists/partial", "cache/archives/partial", "package"] {
        std::fs::create_dir_all(folder.join(place)).with_context(|| format!("cannot make folders in {folder:?}"))?;
    }
    let (sources, status) = (folder.join("sources.list"), folder.join("status"));
    for (file, text) in [(&sources, format!("deb [signed-by={KEYS}] {mirror} sid main\n")), (&status, String::new())] {
        std::fs::write(file, text).with_context(|| format!("cannot write {file:?}"))?;
    }
    let place = |name: &str, path: &Path| format!("{name}={}", path.display());
    let places = [
        place("Dir::State", &folder.join("state")),
        place("Dir::State::status", &status),
        place("Dir::Cache", &folder.join("cache")),
        place("Dir::Etc::sourcelist", &sources),
        place("Dir::Etc::sourceparts", Path::new("/dev/null")),
        // Root would give the work to a user who may not write here.
        "APT::Sandbox::User=root".to_owned(),
    ];
    let options = || places.iter().flat_map(|place| ["-o", place]);
    run(command("apt-get").args(options()).args(["--quiet", "--quiet", "update"]))?;
    let package = folder.join("package");
    run(command("apt-get").args(options()).args(["--quiet", "--quiet", "download", "valgrind"]).current_dir(&package))?;
    let mut files = std::fs::read_dir(&package).with_context(|| format!("cannot read {package:?}"))?.flatten();
    let file = files.next().with_context(|| format!("apt left no package in {package:?}"))?.path();
    run(command("dpkg-deb").arg("--extract").arg(file).arg(folder.join("debian")))?;
    // They are large, and old at the next time.
    for name in ["state", "cache", "package"] {
        std::fs::remove_dir_all(folder.join(name)).with_context(|| format!("cannot remove {name} in {folder:?}"))?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_old_valgrind_is_known() {
        assert!(["valgrind-3.19.0", "valgrind-3.9.1\n", "valgrind-2.4"].iter().all(|version| is_old(version)));
        assert!(!["valgrind-3.20.0", "valgrind-3.27.1", "valgrind-4.0"].iter().any(|version| is_old(version)));
    }

    #[test]
    fn only_an_unpacked_one_needs_its_tools_named() {
        let named = |valgrind: Valgrind| {
            let mut command = command("true");
            valgrind.prepare(&mut command);
            command.get_envs().map(|(name, value)| (name.to_owned(), value.map(ToOwned::to_owned))).collect::<Vec<_>>()
        };
        assert_eq!(named(Valgrind { program: "valgrind".into(), tools: None }), []);
        let tools = Path::new("a/usr/libexec/valgrind").as_os_str().to_owned();
        assert_eq!(named(Valgrind::in_folder(Path::new("a"))), [("VALGRIND_LIB".into(), Some(tools))]);
    }
}
