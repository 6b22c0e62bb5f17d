//! `photograph`: the documentation's pictures of every panel and of Match Strokes, taken in a real Blender window. `bench-window`:
//! for how long Track holds that window's main thread.
//!
//! The `bpy` wheels have no windows, but Debian sid packages a current Blender. debootstrap installs it into a folder of its
//! own. There it runs on a virtual screen (Xvfb), of which a picture is taken. Sid changes over time, and debootstrap and
//! chroot need root. If the pictures cannot be taken, the command says so and succeeds.

use crate::bundle::{Build, Packager, bundle};
use anyhow::{Context, Result, bail};
use std::path::{Path, PathBuf};
use std::process::Command;
use xtask_shell::shell::{capture, command, root, run, target, works};

/// Where the documentation's pictures are, below the workspace's folder.
const PICTURES: &str = "docs/src/pictures";
/// What the pictures need from Debian.
const PACKAGES: [&str; 9] = [
    "blender",
    "xvfb",
    "imagemagick",
    "python3-numpy",
    "libgl1-mesa-dri",
    "libegl-mesa0",
    "python3-cattr",
    "python3-requests",
    "ca-certificates",
];

/// Starts Blender under Xvfb with `$SCRIPT` and its `$WORDS`, and waits until the script says that it has ended.
const SESSION: &str = r#"
set -u
cd /photograph
export DISPLAY=:77 LIBGL_ALWAYS_SOFTWARE=1 HOME=/photograph BLENDER_USER_RESOURCES=/photograph/resources
rm -rf ready pictures resources table.md
# Without saved preferences the first start asks for a quick set-up in front of everything.
blender --background --python-expr "import bpy; bpy.context.preferences.view.show_splash = False; bpy.ops.wm.save_userpref()" \
  >blender.log 2>&1
Xvfb :77 -screen 0 1600x1280x24 >xvfb.log 2>&1 &
screen=$!
sleep 2
blender --window-geometry 0 0 1600 1280 --python $SCRIPT -- $WORDS >>blender.log 2>&1 &
blender=$!
for second in $(seq $PATIENCE); do
  [ -f ready ] && break
  kill -0 "$blender" 2>/dev/null || break
  sleep 1
done
kill "$blender" "$screen" 2>/dev/null
[ -d pictures ] && mogrify -resize "1200x>" -strip +dither -colors 256 -define png:compression-level=9 pictures/*.png
cat ready 2>/dev/null || { echo "Blender ended early:"; tail -n 20 blender.log; }
"#;

/// A script that runs in the window.
struct Script {
    /// Its file in `tests/blender`, and files beside it that it imports.
    files: &'static [&'static str],
    /// Its arguments; it writes the file `ready` at the end.
    words: &'static str,
    /// Seconds until it must have ended.
    patience: u32,
}

const PHOTOGRAPH: Script =
    Script { files: &["photograph.py"], words: "rototoon.zip sample pictures ready", patience: 900 };
const BENCH: Script =
    Script { files: &["bench_window.py", "shots.py"], words: "rototoon.zip table.md ready", patience: 3600 };

/// Writes the pictures of the documentation, or says why it can't.
pub fn photograph() -> Result<()> {
    match in_window("photograph", &PHOTOGRAPH)? {
        Some(stage) => accept(&stage.join("pictures"), &root().join(PICTURES)),
        None => Ok(()),
    }
}

/// Prints for how long Track holds the main thread of a window, or says why it can't.
pub fn bench_window() -> Result<()> {
    let Some(stage) = in_window("bench-window", &BENCH)? else { return Ok(()) };
    let table = std::fs::read_to_string(stage.join("table.md")).context("the script left no table")?;
    println!("{table}");
    Ok(())
}

/// Runs a script in a Blender window with the built extension. Returns the folder that the script worked in; `None`, after a word
/// about the reason, where this machine has no such window.
fn in_window(name: &str, script: &Script) -> Result<Option<PathBuf>> {
    if let Some(reason) = cannot() {
        println!("{name}: not done: {reason}");
        return Ok(None);
    }
    let bundle = bundle(&Packager::from_wheel()?, Build::WithMeasure)?;
    let system = target().join("photograph/debian");
    if let Err(reason) = install(&system) {
        println!("{name}: not done: {reason:#}");
        return Ok(None);
    }
    let stage = system.join("photograph");
    std::fs::create_dir_all(&stage)?;
    std::fs::copy(&bundle.zip, stage.join("rototoon.zip"))?;
    for file in script.files {
        std::fs::copy(root().join("tests/blender").join(file), stage.join(file))?;
    }
    run(command(&bundle.measure).arg("sample").arg(&stage))?;
    let said = {
        let _proc = Mount::proc(&system)?;
        let mut session = chroot(&system);
        session.env("SCRIPT", script.files[0]).env("WORDS", script.words);
        capture(session.env("PATIENCE", script.patience.to_string()).args(["sh", "-c", SESSION]))?
    };
    if said.trim() != "ready" {
        bail!("{name}: {said}");
    }
    Ok(Some(stage))
}

/// Copies the pictures into the documentation. They are looked at before they are committed.
fn accept(taken: &Path, kept: &Path) -> Result<()> {
    std::fs::create_dir_all(kept)?;
    for entry in std::fs::read_dir(taken).with_context(|| format!("cannot read {taken:?}"))? {
        let path = entry?.path();
        if path.extension().is_none_or(|extension| extension != "png") {
            continue;
        }
        let place = kept.join(path.file_name().context("a picture has a name")?);
        std::fs::copy(&path, &place).with_context(|| format!("cannot write {place:?}"))?;
        println!("photograph: {}", place.display());
    }
    Ok(())
}

/// The reason why this machine cannot take pictures, if there is one.
fn cannot() -> Option<String> {
    if !capture(command("id").arg("-u")).is_ok_and(|id| id == "0") {
        return Some("it needs root for chroot".into());
    }
    if !works("debootstrap", &["--version"]) {
        return Some("debootstrap is missing; install it: apt-get install debootstrap".into());
    }
    None
}

/// Installs Debian sid with Blender into a folder, once.
fn install(system: &Path) -> Result<()> {
    let stamp = system.join("photograph-installed");
    if stamp.exists() {
        return Ok(());
    }
    if system.exists() {
        std::fs::remove_dir_all(system)?;
    }
    std::fs::create_dir_all(system)?;
    let mut bootstrap = command("debootstrap");
    bootstrap.args(["--variant=minbase", "sid"]).arg(system);
    // The variable replaces debootstrap's default mirror.
    bootstrap.args(std::env::var_os("DEBIAN_MIRROR"));
    run(&mut bootstrap)?;
    let _proc = Mount::proc(system)?;
    let apt = |words: &[&str]| run(chroot(system).env("DEBIAN_FRONTEND", "noninteractive").arg("apt-get").args(words));
    // The mirror may be an old snapshot, whose index has expired.
    apt(&["-qq", "-o", "Acquire::Check-Valid-Until=false", "update"])?;
    let mut words = vec!["-qq", "install", "--yes", "--no-install-recommends"];
    words.extend(PACKAGES);
    apt(&words)?;
    std::fs::write(&stamp, "").context("cannot write into the new system")
}

fn chroot(system: &Path) -> Command {
    let mut start = command("chroot");
    start.arg(system).env("PATH", "/usr/sbin:/usr/bin:/sbin:/bin").env("LC_ALL", "C.UTF-8");
    start
}

/// Mounts `/proc` inside the folder until it is dropped.
struct Mount(PathBuf);

impl Mount {
    fn proc(system: &Path) -> Result<Self> {
        let place = system.join("proc");
        run(command("mount").args(["--bind", "/proc"]).arg(&place))?;
        Ok(Self(place))
    }
}

impl Drop for Mount {
    fn drop(&mut self) {
        if let Err(error) = run(command("umount").arg("--lazy").arg(&self.0)) {
            eprintln!("{error:#}");
        }
    }
}
