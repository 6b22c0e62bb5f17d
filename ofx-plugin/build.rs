//! Makes the linker mark the plugin as never unloaded. Threads that end late still need its code, and a host that unloads
//! and loads the plugin again gets it with its state.
//!
//! On macOS it gives the plugin its name: the linker would take the path of the file on the machine that builds it.

fn main() {
    println!("cargo::rerun-if-changed=build.rs");
    match std::env::var("CARGO_CFG_TARGET_OS").as_deref() {
        Ok("linux") => println!("cargo::rustc-cdylib-link-arg=-Wl,-z,nodelete"),
        Ok("macos") => println!("cargo::rustc-cdylib-link-arg=-Wl,-install_name,@rpath/librototoon_ofx.dylib"),
        _ => {}
    }
}
