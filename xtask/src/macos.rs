//! Builds for macOS on Apple's processors, from Linux, as far as that goes: the files are read and never run.
//!
//! zig brings the interface files of the system's C library, and links (cargo-zigbuild). The standard library of macOS comes from
//! rustup; where rustup cannot download it, there is no build.
//!
//! Ctrl-C reaches the command line through a package that links two more libraries of the system. `xtask/macos` describes these: where
//! the system keeps them, and one function of each. The linker asks for no more.

use crate::binary;
use crate::bundle;
use crate::licences::SHIPPED;
use crate::platform::MACOS;
use crate::windows::{self, Built};
use anyhow::{Context, Result, ensure};
use xtask_shell::shell::{capture, command, root, run, target};

/// The oldest system that the files run on.
const OLDEST: &str = "11.0";
/// The descriptions of libraries of the system, below the workspace.
const INTERFACES: &str = "xtask/macos";

/// Builds what artists install, and reads it.
pub fn build() -> Result<Built> {
    ensure!(
        has_standard_library(),
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
    let flags = [bundle::renamed_paths(), linked()].concat();
    run(bundle::release_settings(&mut build, &tools)?
        .env("MACOSX_DEPLOYMENT_TARGET", OLDEST)
        // rustc would strip the files after they are signed. The linker leaves the names out instead.
        .env("CARGO_PROFILE_RELEASE_STRIP", "none")
        .env("CARGO_ENCODED_RUSTFLAGS", flags.join("\x1f")))?;
    let folder = target().join(MACOS.triple).join("release");
    let at = |name: &str| folder.join(name);
    let built = Built { library: at(MACOS.library), cli: at(MACOS.cli), plugin: at(MACOS.plugin) };
    check(&built)?;
    Ok(built)
}

fn has_standard_library() -> bool {
    let listed = capture(command("rustup").args(["target", "list", "--installed"]));
    listed.is_ok_and(|list| list.contains(MACOS.triple))
        || capture(command("rustup").args(["target", "add", MACOS.triple])).is_ok()
}

/// Tells the linker where the interfaces are, and that it leaves out the names of what is not offered.
fn linked() -> Vec<String> {
    let interfaces = root().join(INTERFACES);
    let search = ["native", "framework"].map(|kind| format!("-L{kind}={}", interfaces.display()));
    search.into_iter().chain(["-Clink-arg=-s".to_owned()]).collect()
}

/// Reads the files: processor, oldest system, libraries, signature, functions.
fn check(built: &Built) -> Result<()> {
    let library = binary::macos(&built.library)?;
    let functions = windows::functions()?.into_iter().map(|name| format!("_{name}")).collect();
    binary::assert_exports(&built.library, &library.report, "_rototoon_", &functions)?;
    let plugin = binary::macos(&built.plugin)?;
    let entries = ["_OfxGetNumberOfPlugins", "_OfxGetPlugin", "_OfxSetHost"].map(String::from).into();
    binary::assert_exports(&built.plugin, &plugin.report, "_Ofx", &entries)?;
    let program = binary::macos(&built.cli)?;
    for (path, found) in [(&built.library, &library), (&built.plugin, &plugin), (&built.cli, &program)] {
        println!(
            "{}: {} bytes, arm64, macOS {} or newer, signed, {} functions offered, links {}",
            path.file_name().unwrap_or_default().to_string_lossy(),
            std::fs::metadata(path)?.len(),
            found.oldest,
            found.report.exports.len(),
            found.libraries.join(" ")
        );
    }
    ensure!(program.install_name.is_none(), "{:?} is a library, expected a program", built.cli);
    Ok(())
}
