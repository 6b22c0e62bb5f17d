//! Tells the linker to keep the plugin in memory once it is loaded: threads that end late must find their code, and a host
//! that unloads and loads again finds the plugin as it left it.

fn main() {
    println!("cargo::rerun-if-changed=build.rs");
    if std::env::var("CARGO_CFG_TARGET_OS").is_ok_and(|os| os == "linux") {
        println!("cargo::rustc-cdylib-link-arg=-Wl,-z,nodelete");
    }
}
