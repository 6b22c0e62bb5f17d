//! The documentation's page of commands is what `--help` says.

use std::path::Path;
use std::process::Command;
use std::{env, fs};

const PAGE: &str = "docs/src/generated/command-line.md";
const HEAD: &str =
    "<!-- Generated from the program's own help. Change that, run the tests, then `cargo xtask bless`. -->

# All commands and options

Each section is the output of `rototoon help COMMAND`. [The command line](../scripts/command-line.md) explains how the
commands work together.
";

/// The help of a command, such as `["style", "clip"]`.
fn help(command: &[&str]) -> String {
    let output = Command::new(env!("CARGO_BIN_EXE_rototoon")).args(command).arg("--help").output().unwrap();
    assert!(output.status.success(), "{command:?}");
    // On Windows the program's name ends in .exe.
    String::from_utf8(output.stdout).unwrap().replace("rototoon.exe", "rototoon")
}

/// The names below the line "Commands:".
fn subcommands(help: &str) -> Vec<&str> {
    let lines = help.lines().skip_while(|line| *line != "Commands:").skip(1).take_while(|line| !line.is_empty());
    lines.filter_map(|line| line.split_whitespace().next()).filter(|name| *name != "help").collect()
}

/// A section for a command, then those of its subcommands.
fn section(page: &mut String, command: &[&str]) {
    let text = help(command);
    let lines: Vec<&str> = text.lines().map(str::trim_end).collect();
    let title = [&["rototoon"], command].concat().join(" ");
    *page += &format!("\n## {title}\n\n```text\n{}\n```\n", lines.join("\n").trim_end());
    for name in subcommands(&text) {
        section(page, &[command, &[name]].concat());
    }
}

#[test]
fn the_page_of_commands_is_current() {
    let mut page = HEAD.to_owned();
    section(&mut page, &[]);
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).ancestors().nth(2).unwrap();
    let target = env::var_os("CARGO_TARGET_DIR").map_or_else(|| root.join("target"), |folder| root.join(folder));
    let written = target.join("golden/command-line.md");
    fs::create_dir_all(written.parent().unwrap()).unwrap();
    fs::write(&written, &page).unwrap();
    let kept = fs::read_to_string(root.join(PAGE)).unwrap_or_default();
    assert!(kept == page, "{PAGE} is stale: look at {}; `cargo xtask bless` accepts it", written.display());
}
