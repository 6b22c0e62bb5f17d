//! A real Blender window on a virtual screen, in which scripts of `tests/blender` run.
//!
//! The `bpy` wheels have no windows, but Debian sid packages a current Blender ([`crate::debian`]). There it runs on a virtual
//! screen (Xvfb), of which pictures can be taken. If there is no window to be had, the command says so and succeeds.

use crate::bundle::{Build, Packager, bundle};
use crate::debian::Debian;
use anyhow::{Result, bail};
use std::path::{Path, PathBuf};
use xtask_shell::shell::{capture, copy_folder, root, target};

/// What a window needs from Debian.
const PACKAGES: [&str; 9] = [
    "blender",
    "xvfb",
    "imagemagick",
    "python3-numpy",
    "libgl1-mesa-dri",
    "libegl-mesa0",
    "python3-cattr",
    "python3-requests",
    "python3-pytest",
];

/// Starts Blender under Xvfb with `$SCRIPT` and its `$WORDS`, and waits until the script says that it has ended.
const SESSION: &str = r#"
set -u
cd /photograph
export LIBGL_ALWAYS_SOFTWARE=1 HOME=/photograph BLENDER_USER_RESOURCES=/photograph/resources
rm -rf ready pictures resources table.md studio
# Without saved preferences the first start asks for a quick set-up in front of everything.
blender --background --python-expr "import bpy; bpy.context.preferences.view.show_splash = False; bpy.ops.wm.save_userpref()" \
  >blender.log 2>&1
# Xvfb looks for a free number, since other screens may be in use. The screen is a file, which is read faster than by a client.
Xvfb -displayfd 3 -fbdir /photograph -screen 0 "${WIDTH}x${HEIGHT}x24" 3>display >xvfb.log 2>&1 &
screen=$!
for second in $(seq 30); do [ -s display ] && break; sleep 1; done
export DISPLAY=:$(cat display)
blender --window-geometry 0 0 $WIDTH $HEIGHT $OPTIONS --python $SCRIPT -- $WORDS >>blender.log 2>&1 &
blender=$!
for second in $(seq $PATIENCE); do
  [ -f ready ] && break
  kill -0 "$blender" 2>/dev/null || break
  sleep 1
done
kill "$blender" "$screen" 2>/dev/null
cat ready 2>/dev/null || { echo "Blender ended early:"; tail -n 20 blender.log; }
"#;

/// A script that runs in the window.
#[derive(Clone, Debug)]
pub struct Script {
    /// Its file in `tests/blender`. It may import the files beside it.
    pub file: &'static str,
    /// Its arguments; it writes the file `ready` at the end.
    pub words: String,
    /// Further options of Blender.
    pub options: &'static str,
    /// The build that is installed.
    pub build: Build,
    /// Width and height of the screen in pixels.
    pub screen: (u32, u32),
    /// Seconds until it must have ended.
    pub patience: u32,
}

/// What a script left.
#[derive(Clone, Debug)]
pub struct Stage {
    /// The folder that it worked in.
    pub folder: PathBuf,
    /// The lines after the first one of what it said at its end.
    pub said: Vec<String>,
}

/// Runs a script in a Blender window with the built extension. `prepare` puts further files into the folder that it works in. Returns
/// what the script left; `None`, after a word about the reason, where this machine has no such window.
pub fn in_window(name: &str, script: &Script, prepare: impl Fn(&Path) -> Result<()>) -> Result<Option<Stage>> {
    if let Some(reason) = crate::debian::cannot() {
        println!("{name}: not done: {reason}");
        return Ok(None);
    }
    let bundle = bundle(&Packager::from_wheel()?, script.build)?;
    let system = match Debian::install(&target().join("photograph/debian"), &PACKAGES) {
        Ok(system) => system,
        Err(reason) => {
            println!("{name}: not done: {reason:#}");
            return Ok(None);
        }
    };
    let folder = system.folder.join("photograph");
    std::fs::create_dir_all(&folder)?;
    std::fs::copy(&bundle.zip, folder.join("rototoon.zip"))?;
    copy_folder(&root().join("tests/blender"), &folder, &|name| name.ends_with(".py"))?;
    prepare(&folder)?;
    let said = {
        let _proc = system.proc()?;
        let mut session = system.command("sh");
        session.env("SCRIPT", script.file).env("WORDS", &script.words).env("OPTIONS", script.options);
        session.env("WIDTH", script.screen.0.to_string()).env("HEIGHT", script.screen.1.to_string());
        capture(session.env("PATIENCE", script.patience.to_string()).args(["-c", SESSION]))?
    };
    let mut lines = said.trim().lines().map(str::to_owned);
    if lines.next().as_deref() != Some("ready") {
        bail!("{name}: {said}");
    }
    Ok(Some(Stage { folder, said: lines.collect() }))
}
