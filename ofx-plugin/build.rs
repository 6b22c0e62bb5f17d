//! Makes the linker mark the plugin as never unloaded. Threads that end late still need its code, and a host that unloads
//! and loads the plugin again gets it with its state.

fn main() {
    println!("cargo::rerun-if-changed=build.rs");
    if std::env::var("CARGO_CFG_TARGET_OS").is_ok_and(|os| os == "linux") {
        println!("cargo::rustc-cdylib-link-arg=-Wl,-z,nodelete");
    }
}
