//! The systems that Rototoon is built for, and what each calls its files.

/// A system.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Platform {
    /// Its name in Blender's extensions.
    pub blender: &'static str,
    /// The platform tag of its wheel.
    pub wheel: &'static str,
    /// The target that rustc builds for it.
    pub triple: &'static str,
    /// Its folder in an OpenFX bundle (OpenFX 1.4, "Packaging OFX Plug-ins").
    pub ofx: &'static str,
    /// File name of the native library.
    pub library: &'static str,
    /// File name of the OpenFX plugin as rustc builds it.
    pub plugin: &'static str,
    /// File name of the command line program.
    pub cli: &'static str,
    /// What is known of its builds: whether tests run on it here.
    pub checked: &'static str,
}

/// Linux on x86-64. The number in the wheel's tag is the newest glibc that it may need.
pub const LINUX: Platform = Platform {
    blender: "linux-x64",
    wheel: "manylinux_2_28_x86_64",
    triple: "x86_64-unknown-linux-gnu",
    ofx: "Linux-x86-64",
    library: "librototoon_capi.so",
    plugin: "librototoon_ofx.so",
    cli: "rototoon",
    checked: "built and run here",
};

/// Windows on x86-64.
pub const WINDOWS: Platform = Platform {
    blender: "windows-x64",
    wheel: "win_amd64",
    triple: "x86_64-pc-windows-gnu",
    ofx: "Win64",
    library: "rototoon_capi.dll",
    plugin: "rototoon_ofx.dll",
    cli: "rototoon.exe",
    checked: "cross-built and read; not run on Windows",
};

/// macOS on Apple's own processors. The numbers in the wheel's tag are the oldest version of the system.
pub const MACOS: Platform = Platform {
    blender: "macos-arm64",
    wheel: "macosx_11_0_arm64",
    triple: "aarch64-apple-darwin",
    ofx: "MacOS",
    library: "librototoon_capi.dylib",
    plugin: "librototoon_ofx.dylib",
    cli: "rototoon",
    checked: "cross-built and read; not run",
};

/// The tag of wheels that run on this machine only, such as those of the tests.
pub const THIS_MACHINE: &str = "linux_x86_64";
