//! Checks the direction of dependencies in the core:
//!
//! `numeric ← geometry ← curve ← fit` and
//! `numeric ← geometry ← scene ← {image, track, snap, tween, style, reshape, render, export, import, project} ← pipeline`.
//!
//! Track, snap, tween and render may also use image. Tween may also use curve and fit, and reshape may use curve. Track,
//! snap, tween and style never use each other.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};

/// Each module of the core with the modules that it may use.
const ALLOWED: [(&str, &[&str]); 16] = [
    ("numeric", &[]),
    ("geometry", &["numeric"]),
    ("curve", &["numeric", "geometry"]),
    ("fit", &["numeric", "geometry", "curve"]),
    ("scene", &["numeric", "geometry"]),
    ("image", &["numeric", "geometry", "scene"]),
    ("track", &["numeric", "geometry", "scene", "image"]),
    ("snap", &["numeric", "geometry", "scene", "image"]),
    ("tween", &["numeric", "geometry", "curve", "fit", "scene", "image"]),
    ("style", &["numeric", "geometry", "scene"]),
    ("reshape", &["numeric", "geometry", "curve", "scene"]),
    ("render", &["numeric", "geometry", "scene", "image"]),
    ("export", &["numeric", "geometry", "scene"]),
    ("import", &["numeric", "geometry", "scene"]),
    ("project", &["numeric", "geometry", "scene"]),
    (
        "pipeline",
        &[
            "numeric", "geometry", "curve", "fit", "scene", "image", "track", "snap", "tween", "style", "reshape",
            "render", "export", "import", "project",
        ],
    ),
];

fn sources(folder: &Path, found: &mut Vec<PathBuf>) {
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            sources(&path, found);
        } else if path.extension().is_some_and(|extension| extension == "rs") {
            found.push(path);
        }
    }
}

/// The core's modules that the source of a file uses, by `crate::` or by `super::` out of its own top module.
///
/// `module` is the module path of the file (`["track", "job"]`). Comments are ignored.
fn used_modules(source: &str, module: &[String]) -> BTreeSet<String> {
    let code: String = source.lines().map(|line| line.split("//").next().unwrap_or("").to_owned() + "\n").collect();
    let mut used = BTreeSet::new();
    for (at, _) in code.match_indices("crate::") {
        used.extend(first_names(&code[at + "crate::".len()..]));
    }
    let mut rest = code.as_str();
    while let Some(at) = rest.find("super::") {
        rest = &rest[at..];
        let mut levels = 0;
        while let Some(next) = rest.strip_prefix("super::") {
            levels += 1;
            rest = next;
        }
        // In the file of a module one level leads to its parent. In inline tests it leads to the file itself.
        if levels >= module.len() {
            used.extend(first_names(rest));
        }
    }
    used
}

/// The names right after a path: one name, or the outermost names of a braced group.
fn first_names(rest: &str) -> Vec<String> {
    let name = |text: &str| text.chars().take_while(|c| c.is_alphanumeric() || *c == '_').collect::<String>();
    let Some(group) = rest.strip_prefix('{') else { return vec![name(rest)] };
    let mut names = Vec::new();
    let (mut depth, mut start) = (0, true);
    for (at, c) in group.char_indices() {
        match c {
            '{' => depth += 1,
            '}' if depth == 0 => break,
            '}' => depth -= 1,
            ',' if depth == 0 => start = true,
            c if start && !c.is_whitespace() => {
                names.push(name(&group[at..]));
                start = false;
            }
            _ => {}
        }
    }
    names
}

fn module_path(root: &Path, file: &Path) -> Vec<String> {
    let mut path: Vec<_> = file
        .strip_prefix(root)
        .unwrap()
        .with_extension("")
        .iter()
        .map(|name| name.to_str().unwrap().to_owned())
        .collect();
    if path.last().is_some_and(|name| name == "mod") {
        path.pop();
    }
    path
}

#[test]
fn dependencies_point_one_way() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../core/src");
    let allowed: BTreeMap<_, _> = ALLOWED.into_iter().collect();
    let mut files = Vec::new();
    sources(&root, &mut files);
    files.sort();
    let mut wrong = Vec::new();
    let mut checked = 0;
    for file in &files {
        let module = module_path(&root, file);
        if module == ["lib"] {
            continue;
        }
        let Some(may_use) = allowed.get(module[0].as_str()) else {
            wrong.push(format!("{}: module {} is not in the list of modules", file.display(), module[0]));
            continue;
        };
        for used in used_modules(&fs::read_to_string(file).unwrap(), &module) {
            checked += 1;
            if allowed.contains_key(used.as_str()) && used != module[0] && !may_use.contains(&used.as_str()) {
                wrong.push(format!("{}: {} may not use {used}", file.display(), module[0]));
            }
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
    assert!(checked > files.len(), "found {checked} uses in {} files, expected more", files.len());
}

#[test]
fn uses_are_found_however_they_are_written() {
    let module = ["track".to_owned(), "job".to_owned()];
    let used = |source: &str| used_modules(source, &module).into_iter().collect::<Vec<_>>();
    assert_eq!(used("use crate::snap;"), ["snap"]);
    assert_eq!(used("use crate::{\n    geometry::{Point, polygon},\n    snap::x,\n};"), ["geometry", "snap"]);
    assert_eq!(used("let x = super::super::snap::cost();"), ["snap"]);
    assert_eq!(used("use super::tracker; // crate::snap"), Vec::<String>::new());
    assert_eq!(used_modules("use super::snap;", &["track".to_owned()]).into_iter().collect::<Vec<_>>(), ["snap"]);
}
