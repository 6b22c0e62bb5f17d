//! `photograph`: pictures of the panel and of Match Strokes in a real Blender window.
//!
//! The `bpy` wheels have no windows. Debian sid packages a current Blender: it is unpacked into a folder of its own
//! (debootstrap), started there under a virtual screen (Xvfb) and photographed. Sid moves, and the job needs root: where it
//! cannot be done, that is said and nothing fails.

use crate::bundle::{Build, Packager, bundle};
use anyhow::{Context, Result, bail};
use std::path::{Path, PathBuf};
use std::process::Command;
use xtask_shell::shell::{capture, command, root, run, target, works};

/// What the picture needs from Debian.
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

/// What is photographed: see `tests/blender/photograph.py`.
const PICTURES: [&str; 2] = ["panel", "pairs"];

/// Starts Blender under Xvfb for `$1`, waits until the script says that it is drawn, and takes the picture.
const SESSION: &str = r#"
set -u
cd /photograph
export DISPLAY=:77 LIBGL_ALWAYS_SOFTWARE=1 HOME=/photograph BLENDER_USER_RESOURCES=/photograph/resources
rm -rf ready "$1.png" resources
# Without saved preferences the first start asks for a quick set-up in front of everything.
blender --background --python-expr "import bpy; bpy.context.preferences.view.show_splash = False; bpy.ops.wm.save_userpref()" \
  >blender.log 2>&1
Xvfb :77 -screen 0 1600x900x24 >xvfb.log 2>&1 &
screen=$!
sleep 2
blender --window-geometry 0 0 1600 900 --python photograph.py -- rototoon.zip sample/project.json ready "$1" >>blender.log 2>&1 &
blender=$!
for second in $(seq 600); do
  [ -f ready ] && break
  kill -0 "$blender" 2>/dev/null || break
  sleep 1
done
[ -f ready ] && import -window root "$1.png"
kill "$blender" "$screen" 2>/dev/null
cat ready 2>/dev/null || { echo "Blender ended early:"; tail -n 20 blender.log; }
"#;

/// Leaves `panel.png` and `pairs.png` in `target/photograph`, or says why it can't.
pub fn photograph() -> Result<()> {
    if let Some(reason) = cannot() {
        println!("photograph: not done: {reason}");
        return Ok(());
    }
    let bundle = bundle(&Packager::from_wheel()?, Build::WithMeasure)?;
    let folder = target().join("photograph");
    let system = folder.join("debian");
    if let Err(reason) = install(&system) {
        println!("photograph: not done: {reason:#}");
        return Ok(());
    }
    let stage = system.join("photograph");
    std::fs::create_dir_all(&stage)?;
    std::fs::copy(&bundle.zip, stage.join("rototoon.zip"))?;
    std::fs::copy(root().join("tests/blender/photograph.py"), stage.join("photograph.py"))?;
    run(command(&bundle.measure).arg("sample").arg(&stage))?;
    for what in PICTURES {
        let said = {
            let _proc = Mount::proc(&system)?;
            capture(chroot(&system).args(["sh", "-c", SESSION, "sh", what]))?
        };
        let picture = stage.join(format!("{what}.png"));
        if said.trim() != "ready" || !picture.exists() {
            bail!("no picture of {what} was taken: {said}");
        }
        let place = folder.join(format!("{what}.png"));
        std::fs::copy(&picture, &place)?;
        println!("photograph: {}", place.display());
    }
    Ok(())
}

/// Why this machine can't, if it can't.
fn cannot() -> Option<String> {
    if !capture(command("id").arg("-u")).is_ok_and(|id| id == "0") {
        return Some("it needs root for chroot".into());
    }
    if !works("debootstrap", &["--version"]) {
        return Some("debootstrap is missing; install it: apt-get install debootstrap".into());
    }
    None
}

/// Debian sid with Blender in a folder, made once.
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
    // Another mirror than debootstrap's own.
    bootstrap.args(std::env::var_os("DEBIAN_MIRROR"));
    run(&mut bootstrap)?;
    let _proc = Mount::proc(system)?;
    let apt = |words: &[&str]| run(chroot(system).env("DEBIAN_FRONTEND", "noninteractive").arg("apt-get").args(words));
    // A mirror may be a snapshot of some day.
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

/// `/proc` inside the folder, for as long as this lives.
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
