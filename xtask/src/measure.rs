//! Commands that need the core: they are handed on to the package `xtask-measure`, which is built when it is first needed.

use anyhow::Result;
use std::ffi::OsString;
use xtask_shell::shell::{self, cargo};

/// The package that has these commands.
const PACKAGE: &str = "xtask-measure";

/// Arguments that are handed on as they are; `--help` too.
#[derive(clap::Args, Default)]
pub struct Rest {
    /// Options of the command; `--help` lists them.
    #[arg(trailing_var_arg = true, allow_hyphen_values = true)]
    arguments: Vec<OsString>,
}

/// Runs one of its commands.
pub fn run(name: &str, rest: &Rest) -> Result<()> {
    let mut command = cargo();
    // Measurements are made by optimised programs: with the same profile the core is compiled once.
    command.args(["run", "--quiet", "--release", "--package", PACKAGE, "--", name]).args(&rest.arguments);
    shell::run(&mut command)
}
