//! Compiles the official HostSupport library, the XML parser that comes with it, and the bridge to it.

use std::path::{Path, PathBuf};
use std::process::Command;

fn main() {
    let openfx = source("openfx-sys").join("openfx");
    let (host, expat) = (openfx.join("HostSupport"), openfx.join("HostSupport/expat-2.0.1/lib"));
    cc::Build::new()
        .files(["xmlparse.c", "xmlrole.c", "xmltok.c"].map(|file| expat.join(file)))
        .include(&expat)
        .define("HAVE_MEMMOVE", None)
        .define("XML_NS", None)
        .define("XML_DTD", None)
        .define("XML_CONTEXT_BYTES", "1024")
        .define("BYTEORDER", if cfg!(target_endian = "little") { "1234" } else { "4321" })
        .warnings(false)
        .compile("rototoon_expat");
    let mut build = cxx_build::bridge("src/bridge.rs");
    build
        .files(sources(&host.join("src")))
        .files(sources(Path::new("src/host")))
        .include(openfx.join("include"))
        .include(host.join("include"))
        .include(&expat)
        .define("OFX_SUPPORTS_MULTITHREAD", None)
        .define("OFX_DEBUG_ACTIONS", None)
        .define("OFX_DEBUG_PROPERTIES", None)
        .define("OFX_DEBUG_PARAMETERS", None)
        .std("c++14")
        // The library relies on other compilers' headers to include `cstring`.
        .flag("-include")
        .flag("cstring")
        .warnings(false)
        .compile("rototoon_ofx_host");
    // The plugin looks OpenGL up in its host's process. The tests export functions of these names that record lines.
    println!("cargo::rustc-link-arg-tests=-Wl,--export-dynamic-symbol=gl*");
    for file in ["build.rs", "src/bridge.rs", "src/host.h", "src/host"] {
        println!("cargo::rerun-if-changed={file}");
    }
}

/// The folder of a package of `Cargo.lock`, which Cargo downloads if needed.
fn source(package: &str) -> PathBuf {
    let cargo = std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
    let output = Command::new(cargo)
        .args(["metadata", "--format-version", "1"])
        .output()
        .unwrap_or_else(|error| panic!("cannot start cargo metadata: {error}"));
    assert!(output.status.success(), "cargo metadata: {}", String::from_utf8_lossy(&output.stderr));
    let metadata: serde_json::Value = serde_json::from_slice(&output.stdout).expect("cargo metadata prints JSON");
    let packages = metadata["packages"].as_array().expect("metadata lists packages");
    let found = packages.iter().find(|candidate| candidate["name"] == package);
    let manifest = found.and_then(|found| found["manifest_path"].as_str());
    let manifest = manifest.unwrap_or_else(|| panic!("cargo metadata lists no package {package}"));
    Path::new(manifest).parent().expect("a manifest is in a folder").to_path_buf()
}

fn sources(folder: &Path) -> Vec<PathBuf> {
    let entries = std::fs::read_dir(folder).unwrap_or_else(|error| panic!("cannot read {folder:?}: {error}"));
    let mut files: Vec<PathBuf> = entries.flatten().map(|entry| entry.path()).collect();
    files.retain(|file| file.extension().is_some_and(|extension| extension == "cpp"));
    files.sort();
    files
}
