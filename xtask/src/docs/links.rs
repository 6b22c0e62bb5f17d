//! Dead links: files, anchors and pictures that are named and not there.
//!
//! The rendered pages are checked, since only mdBook knows which anchors its headings get. Its HTML is regular enough that
//! a scan of the tags' attributes finds all of them; no tree is built. Links to other hosts are not followed.

use anyhow::{Context, Result};
use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Component, Path, PathBuf};

/// Pages that repeat what other pages have.
const REPEATED: [&str; 3] = ["print.html", "toc.html", "404.html"];

/// What a page names and what it can be named by.
#[derive(Debug, Default)]
struct Page {
    anchors: BTreeSet<String>,
    targets: BTreeSet<String>,
}

/// Every dead link of a built book.
pub fn check_book(book: &Path) -> Result<Vec<String>> {
    let mut pages = BTreeMap::new();
    for path in files(book, "html")? {
        let name = path.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default();
        if !REPEATED.contains(&&*name) {
            let text = fs::read_to_string(&path).with_context(|| format!("cannot read {path:?}"))?;
            pages.insert(path, page(&text));
        }
    }
    let mut problems = Vec::new();
    for (path, page) in &pages {
        let shown = path.strip_prefix(book).unwrap_or(path).display();
        for target in &page.targets {
            if let Some(problem) = dead(path, target, &pages) {
                problems.push(format!("{shown}: {problem}"));
            }
        }
    }
    Ok(problems)
}

/// Pages that the table of contents leaves out, and pictures that no page shows.
pub fn check_sources(sources: &Path) -> Result<Vec<String>> {
    let mut text = String::new();
    let pages = files(sources, "md")?;
    for path in &pages {
        text += &fs::read_to_string(path).with_context(|| format!("cannot read {path:?}"))?;
    }
    let summary = fs::read_to_string(sources.join("SUMMARY.md")).context("cannot read SUMMARY.md")?;
    let below = |path: &Path| path.strip_prefix(sources).unwrap_or(path).display().to_string();
    let mut problems = Vec::new();
    for name in pages.iter().map(|path| below(path)).filter(|name| name != "SUMMARY.md") {
        if !summary.contains(&format!("]({name})")) {
            problems.push(format!("{name}: SUMMARY.md does not name this page"));
        }
    }
    for path in files(sources, "png")? {
        let file = path.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default();
        if !text.contains(&file) {
            problems.push(format!("{}: no page shows this picture", below(&path)));
        }
    }
    Ok(problems)
}

/// Dead links of a Markdown page outside the book. Links to sources of the book are looked up in the built book.
pub fn check_page(root: &Path, name: &str, book: &Path) -> Result<Vec<String>> {
    let text = fs::read_to_string(root.join(name)).with_context(|| format!("cannot read {name}"))?;
    let mut problems = Vec::new();
    for target in markdown_targets(&text).into_iter().filter(|target| !is_elsewhere(target)) {
        let (file, anchor) = target.split_once('#').unwrap_or((&target, ""));
        if !file.is_empty() && !root.join(file).exists() {
            problems.push(format!("{name}: {target}: there is no such file"));
            continue;
        }
        let Some(source) = file.strip_prefix("docs/src/").filter(|_| !anchor.is_empty()) else { continue };
        let built = book.join(Path::new(source).with_extension("html"));
        let html = fs::read_to_string(&built).with_context(|| format!("cannot read {built:?}"))?;
        if !page(&html).anchors.contains(anchor) {
            problems.push(format!("{name}: {target}: the page has no such anchor"));
        }
    }
    Ok(problems)
}

/// Why a target is dead, if it is.
fn dead(from: &Path, target: &str, pages: &BTreeMap<PathBuf, Page>) -> Option<String> {
    if is_elsewhere(target) {
        return None;
    }
    let target = &decoded(target);
    let (file, anchor) = target.split_once('#').unwrap_or((target, ""));
    let file = file.split('?').next().unwrap_or_default();
    let path = if file.is_empty() { from.to_path_buf() } else { joined(from.parent()?, file) };
    let path = if path.is_dir() { path.join("index.html") } else { path };
    if !path.exists() {
        return Some(format!("{target}: there is no such file"));
    }
    // Of pages that are not checked the anchors are not known.
    let known = pages.get(&path).is_none_or(|page| anchor.is_empty() || page.anchors.contains(anchor));
    (!known).then(|| format!("{target}: the page has no such anchor"))
}

/// Whether a link leaves the book.
fn is_elsewhere(target: &str) -> bool {
    ["http:", "https:", "mailto:", "data:", "javascript:", "//"].iter().any(|start| target.starts_with(start))
}

/// Anchors and targets of a rendered page.
fn page(html: &str) -> Page {
    let mut page = Page::default();
    for tag in html.split('<').skip(1).filter_map(|rest| rest.split_once('>').map(|(tag, _)| tag)) {
        for (name, value) in attributes(tag) {
            match name {
                "id" | "name" => page.anchors.insert(value),
                "href" | "src" => page.targets.insert(value),
                _ => false,
            };
        }
    }
    page
}

/// The attributes of a tag whose values stand in double quotes.
fn attributes(tag: &str) -> Vec<(&str, String)> {
    let mut found = Vec::new();
    let mut rest = tag;
    while let Some((before, after)) = rest.split_once("=\"") {
        let name = before.rsplit(|c: char| c.is_whitespace() || c == '"').next().unwrap_or_default();
        let Some((value, next)) = after.split_once('"') else { break };
        found.push((name, value.replace("&amp;", "&").replace("&quot;", "\"")));
        rest = next;
    }
    found
}

/// Targets of links and pictures in Markdown, outside of code.
fn markdown_targets(text: &str) -> Vec<String> {
    let mut targets = Vec::new();
    let mut fenced = false;
    for line in text.lines() {
        fenced ^= line.trim_start().starts_with("```");
        if fenced || line.starts_with("    ") {
            continue;
        }
        for rest in line.split("](").skip(1) {
            targets.extend(rest.split(')').next().map(str::to_owned));
        }
    }
    targets
}

/// A path joined to a folder, without `.` and `..`.
fn joined(folder: &Path, file: &str) -> PathBuf {
    let mut path = folder.to_path_buf();
    for component in Path::new(file).components() {
        match component {
            Component::ParentDir => drop(path.pop()),
            Component::Normal(name) => path.push(name),
            _ => {}
        }
    }
    path
}

/// `%20` and the like as characters.
fn decoded(target: &str) -> String {
    let mut bytes = Vec::new();
    let mut rest = target.as_bytes();
    while let [first, tail @ ..] = rest {
        let code = tail.get(..2).and_then(|two| std::str::from_utf8(two).ok());
        match code.and_then(|code| u8::from_str_radix(code, 16).ok()).filter(|_| *first == b'%') {
            Some(byte) => {
                bytes.push(byte);
                rest = &tail[2..];
            }
            None => {
                bytes.push(*first);
                rest = tail;
            }
        }
    }
    String::from_utf8_lossy(&bytes).into_owned()
}

/// All files below a folder with this extension, in order.
fn files(folder: &Path, extension: &str) -> Result<Vec<PathBuf>> {
    let mut found = Vec::new();
    for entry in fs::read_dir(folder).with_context(|| format!("cannot read {folder:?}"))? {
        let path = entry?.path();
        if path.is_dir() {
            found.extend(files(&path, extension)?);
        } else if path.extension().is_some_and(|own| own == extension) {
            found.push(path);
        }
    }
    found.sort();
    Ok(found)
}

#[cfg(test)]
mod tests {
    use super::*;
    use xtask_shell::shell::{empty_folder, target};

    fn folder(name: &str, pages: &[(&str, &str)]) -> PathBuf {
        let folder = target().join(format!("xtask-links-{name}"));
        empty_folder(&folder).unwrap();
        for (file, text) in pages {
            let path = folder.join(file);
            fs::create_dir_all(path.parent().unwrap()).unwrap();
            fs::write(path, text).unwrap();
        }
        folder
    }

    #[test]
    fn dead_links_anchors_and_pictures_are_found() {
        let one = r##"<h1 id="top">One</h1><a class="header" href="#top">x</a><a href="two.html#part%20two">x</a>
            <a href="https://example.org/none">x</a><img src="there.png" alt="x"><a href="deep/three.html">x</a>
            <a href="gone.html">x</a><a href="two.html#nowhere">x</a><a href="#missing">x</a><img alt="" src="gone.png">"##;
        let three = r#"<a href="../one.html#top">x</a><a href="../../outside.html">x</a>"#;
        let pages =
            [("one.html", one), ("two.html", r#"<h2 id="part two">"#), ("there.png", ""), ("deep/three.html", three)];
        let problems = check_book(&folder("book", &pages)).unwrap();
        let expected = [
            "deep/three.html: ../../outside.html: there is no such file",
            "one.html: #missing: the page has no such anchor",
            "one.html: gone.html: there is no such file",
            "one.html: gone.png: there is no such file",
            "one.html: two.html#nowhere: the page has no such anchor",
        ];
        assert_eq!(problems, expected);
    }

    #[test]
    fn pages_without_an_entry_and_pictures_without_a_page_are_found() {
        let summary = "- [One](one.md)\n- [Two](deep/two.md)\n";
        let pages = [
            ("SUMMARY.md", summary),
            ("one.md", "![x](pictures/shown.png)"),
            ("deep/two.md", ""),
            ("deep/three.md", ""),
            ("pictures/shown.png", ""),
            ("pictures/alone.png", ""),
        ];
        let problems = check_sources(&folder("sources", &pages)).unwrap();
        let expected =
            ["deep/three.md: SUMMARY.md does not name this page", "pictures/alone.png: no page shows this picture"];
        assert_eq!(problems, expected);
    }

    #[test]
    fn links_from_outside_the_book_are_looked_up_in_it() {
        let readme = "[a](docs/src/one.md#top) [b](docs/src/one.md#gone) ![c](gone.png)\n\n    [code](no.md)\n";
        let pages = [("README.md", readme), ("docs/src/one.md", ""), ("book/one.html", r#"<h1 id="top">"#)];
        let root = folder("outside", &pages);
        let problems = check_page(&root, "README.md", &root.join("book")).unwrap();
        let expected = [
            "README.md: docs/src/one.md#gone: the page has no such anchor",
            "README.md: gone.png: there is no such file",
        ];
        assert_eq!(problems, expected);
    }
}
