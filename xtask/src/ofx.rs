//! Makes the OpenFX bundle `target/Rototoon.ofx.bundle`, with the folders of OpenFX 1.4 ("Packaging OFX Plug-ins").

use crate::platform::{LINUX, Platform};
use crate::{elf, licences};
use anyhow::{Context, Result, ensure};
use std::path::{Path, PathBuf};
use xtask_shell::shell::{empty_folder, root, target};

/// The system libraries that the plugin may link: the parts of glibc, and the unwinder.
const SYSTEM: [&str; 7] =
    ["libc.so.6", "libm.so.6", "libdl.so.2", "libpthread.so.0", "librt.so.1", "libgcc_s.so.1", "ld-linux-x86-64.so.2"];

/// The folder of the bundle.
pub fn place() -> PathBuf {
    target().join("Rototoon.ofx.bundle")
}

/// Makes the bundle of the Linux plugin of a build.
pub fn lay_out(library: &Path, version: &str) -> Result<()> {
    let place = place();
    lay_out_at(&place, &[(LINUX, library.to_owned())], version)?;
    println!("OpenFX: {}", place.display());
    println!("  copy it to /usr/OFX/Plugins or to a folder of OFX_PLUGIN_PATH, where hosts look for plugins;");
    println!("  remove an older one first: a host that has it loaded crashes if it is written over");
    Ok(())
}

/// Makes a bundle with the plugins of several systems: hosts take the one in their own system's folder.
pub fn lay_out_at(place: &Path, plugins: &[(Platform, PathBuf)], version: &str) -> Result<()> {
    // A bundle that is there stays until all plugins are known to be good.
    for (_, plugin) in plugins.iter().filter(|(platform, _)| *platform == LINUX) {
        check(plugin)?;
    }
    empty_folder(place)?;
    let contents = place.join("Contents");
    let resources = contents.join("Resources");
    std::fs::create_dir_all(&resources)?;
    std::fs::write(contents.join("Info.plist"), property_list(version))?;
    for (platform, plugin) in plugins {
        let binaries = contents.join(platform.ofx);
        std::fs::create_dir_all(&binaries)?;
        let binary = binaries.join("Rototoon.ofx");
        std::fs::copy(plugin, &binary).with_context(|| format!("cannot copy {plugin:?}"))?;
        let notices = licences::folder(platform)?.join("THIRD-PARTY.txt");
        std::fs::copy(notices, resources.join(format!("THIRD-PARTY-{}.txt", platform.ofx)))?;
    }
    let icons = root().join("ofx-plugin/resources");
    for entry in std::fs::read_dir(&icons).with_context(|| format!("cannot read {icons:?}"))? {
        let icon = entry?;
        std::fs::copy(icon.path(), resources.join(icon.file_name()))?;
    }
    std::fs::copy(root().join("LICENSE"), resources.join("LICENSE"))?;
    Ok(())
}

/// Fails where a plugin of Linux needs more than the system.
fn check(library: &Path) -> Result<()> {
    let file = std::fs::read(library).with_context(|| format!("cannot read {library:?}"))?;
    let needed = elf::needed_libraries(&file).with_context(|| format!("{library:?}"))?;
    let foreign: Vec<_> = needed.iter().filter(|name| !SYSTEM.contains(&name.as_str())).collect();
    ensure!(foreign.is_empty(), "{library:?} links {foreign:?}, expected only libraries of {SYSTEM:?}");
    Ok(())
}

fn property_list(version: &str) -> String {
    // Only the second of the versions may have more than three numbers in it.
    let released = version.split('-').next().unwrap_or(version);
    let entries = [
        ("CFBundleDevelopmentRegion", "English"),
        ("CFBundleExecutable", "Rototoon.ofx"),
        ("CFBundleIdentifier", "org.rototoon.ofx"),
        ("CFBundleInfoDictionaryVersion", "6.0"),
        ("CFBundleName", "Rototoon"),
        ("CFBundlePackageType", "BNDL"),
        ("CFBundleShortVersionString", released),
        ("CFBundleVersion", version),
    ];
    let lines: String =
        entries.iter().map(|(key, value)| format!("    <key>{key}</key>\n    <string>{value}</string>\n")).collect();
    format!(
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<!DOCTYPE plist PUBLIC \"-//Apple//DTD PLIST 1.0//EN\" \
         \"http://www.apple.com/DTDs/PropertyList-1.0.dtd\">\n<plist version=\"1.0\">\n<dict>\n{lines}</dict>\n</plist>\n"
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_property_list_names_the_binary() {
        let text = property_list("0.2.0-dev1+h2");
        assert!(text.contains("<key>CFBundleExecutable</key>\n    <string>Rototoon.ofx</string>"));
        assert_eq!(text.matches("<key>").count(), text.matches("<string>").count());
    }

    #[test]
    fn other_files_are_refused_and_the_bundle_stays() {
        let folder = target().join("xtask-ofx-test");
        empty_folder(&folder).unwrap();
        let other = folder.join("not-elf.so");
        std::fs::write(&other, "text").unwrap();
        let place = folder.join("Rototoon.ofx.bundle");
        std::fs::create_dir_all(&place).unwrap();
        std::fs::write(place.join("old"), "").unwrap();
        assert!(lay_out_at(&place, &[(LINUX, other)], "0.2.0").is_err());
        assert!(place.join("old").is_file());
        std::fs::remove_dir_all(&folder).unwrap();
    }
}
