//! Gives the library its name on macOS. The linker would take the path of the file on the machine that builds it.

fn main() {
    println!("cargo::rerun-if-changed=build.rs");
    if std::env::var("CARGO_CFG_TARGET_OS").is_ok_and(|system| system == "macos") {
        println!("cargo::rustc-cdylib-link-arg=-Wl,-install_name,@rpath/librototoon_capi.dylib");
    }
}
