//! Builds for macOS on Apple's processors, from Linux, as far as that goes: the files are read and never run.
//!
//! zig brings the system's interface files, and links (cargo-zigbuild). The standard library of macOS comes from rustup; where rustup
//! cannot download it, there is no build.

use crate::binary;
use crate::bundle;
use crate::licences::SHIPPED;
use crate::platform::MACOS;
use crate::windows::{self, Built};
use anyhow::{Context, Result, ensure};
use xtask_shell::shell::{capture, command, run, target};

/// Builds what artists install, and reads it.
pub fn build() -> Result<Built> {
    ensure!(
        capture(command("rustup").args(["target", "list", "--installed"]))
            .is_ok_and(|list| list.contains(MACOS.triple))
            || capture(command("rustup").args(["target", "add", MACOS.triple])).is_ok(),
        "the standard library for {} is missing, and rustup cannot download it",
        MACOS.triple
    );
    let tools = bundle::tools()?;
    let bin = tools.parent().context("an interpreter is in a folder")?;
    let mut build = command(bin.join("cargo-zigbuild"));
    build.args(["zigbuild", "--quiet", "--release", "--target", MACOS.triple]);
    for package in SHIPPED {
        build.args(["--package", package]);
    }
    run(bundle::release_settings(&mut build, &tools)?.env("MACOSX_DEPLOYMENT_TARGET", "11.0"))?;
    let folder = target().join(MACOS.triple).join("release");
    let at = |name: &str| folder.join(name);
    let built = Built { library: at(MACOS.library), cli: at(MACOS.cli), plugin: at(MACOS.plugin) };
    let library = binary::macos(&built.library)?;
    let functions = windows::functions()?.into_iter().map(|name| format!("_{name}")).collect();
    binary::assert_exports(&built.library, &library.report, "_rototoon_", &functions)?;
    for path in [&built.library, &built.plugin, &built.cli] {
        let found = binary::macos(path)?;
        println!(
            "{}: arm64, macOS {} or newer, links {}",
            path.file_name().unwrap_or_default().to_string_lossy(),
            found.oldest,
            found.libraries.join(" ")
        );
    }
    Ok(built)
}
