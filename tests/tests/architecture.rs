//! Which module may use which, and that no files import each other in a cycle.
//!
//! Cargo holds the arrows between the crates. Within a crate this test holds them:
//!
//! - `core/base`: `numeric ← geometry ← {curve, scene}`; `file`, `limits` and `memory` use none of them.
//! - `core/track`: `contract ← shared ← {zhou2011, rotoscope, rototoon} ← tracker`. The presets do not use each other.
//! - In every crate: no import cycle joins files of different folders, or more than two files of one folder.
//!
//! [`imports`] reads the imports, and says which of them count between a `mod.rs` and its files.

mod cycles;
mod imports;
mod tokens;

use imports::{Arrows, Sources};
use std::fs;
use std::path::{Path, PathBuf};

/// The modules at the top of a crate, each with those that it may use.
type Layers<'a> = [(&'a str, &'a [&'a str])];

const BASE: [(&str, &[&str]); 7] = [
    ("file", &[]),
    ("limits", &[]),
    ("memory", &[]),
    ("numeric", &[]),
    ("geometry", &["numeric"]),
    ("curve", &["numeric", "geometry"]),
    ("scene", &["numeric", "geometry"]),
];

const TRACK: [(&str, &[&str]); 6] = [
    ("contract", &[]),
    ("shared", &["contract"]),
    ("zhou2011", &["contract", "shared"]),
    ("rotoscope", &["contract", "shared"]),
    ("rototoon", &["contract", "shared"]),
    ("tracker", &["contract", "shared", "zhou2011", "rotoscope", "rototoon"]),
];

fn repository() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
}

/// The folders `src` of all crates that ship or build what ships.
fn crates() -> Vec<PathBuf> {
    let root = repository();
    let core = fs::read_dir(root.join("core")).unwrap().map(|entry| entry.unwrap().path());
    let mut found: Vec<PathBuf> = core.chain(["core", "ofx-plugin", "xtask"].map(|name| root.join(name))).collect();
    found.retain(|path| path.join("Cargo.toml").is_file());
    found.sort();
    found.into_iter().map(|path| path.join("src")).collect()
}

/// The arrows that layers do not allow, and the modules that are in none.
fn faults(sources: &Sources, arrows: &Arrows, layers: &Layers) -> Vec<String> {
    let layer = |file: usize| sources.files[file].module.first().map(String::as_str);
    let may_use = |name: &str| layers.iter().find(|(layer, _)| *layer == name).map(|(_, used)| *used);
    let homeless = sources.files.iter().filter(|file| file.module.first().is_some_and(|name| may_use(name).is_none()));
    let mut found: Vec<String> =
        homeless.map(|file| format!("{}: the module is in no layer", file.path.display())).collect();
    for (&(from, to), names) in arrows {
        let (Some(user), Some(used)) = (layer(from), layer(to)) else { continue };
        if user != used && !may_use(user).is_some_and(|allowed| allowed.contains(&used)) {
            let names: Vec<&str> = names.iter().map(String::as_str).collect();
            let path = sources.files[from].path.display();
            found.push(format!("{path}: {user} may not use {used}, but takes {}", names.join(", ")));
        }
    }
    found
}

fn holds(src: &str, layers: &Layers) {
    let sources = Sources::read(&repository().join(src));
    let arrows = sources.arrows();
    let faults = faults(&sources, &arrows, layers);
    assert!(faults.is_empty(), "{src}:\n{}", faults.join("\n"));
    assert!(arrows.len() > sources.files.len(), "{src}: found only {} arrows", arrows.len());
}

#[test]
fn the_modules_of_base_point_one_way() {
    holds("core/base/src", &BASE);
}

#[test]
fn the_folders_of_track_point_one_way() {
    holds("core/track/src", &TRACK);
}

#[test]
fn no_files_import_each_other_in_a_ring() {
    let (mut wrong, mut read) = (String::new(), 0);
    for src in crates() {
        let sources = Sources::read(&src);
        let arrows = sources.arrows();
        read += arrows.len();
        for cycle in cycles::cycles(&sources, &arrows).iter().filter(|cycle| !cycles::allowed(&sources, cycle)) {
            wrong += &format!("{}:\n{}", src.display(), cycles::described(&sources, &arrows, cycle));
        }
    }
    assert!(wrong.is_empty(), "{wrong}");
    assert!(read > 500, "found only {read} arrows");
}

#[test]
fn an_arrow_against_the_layers_is_found() {
    let faults = |text: &str| {
        let texts = [("lib.rs", "mod low; mod high;"), ("low.rs", text), ("high.rs", "pub struct High;")];
        let sources = Sources::of(texts.map(|(path, text)| (path.into(), text.into())));
        faults(&sources, &sources.arrows(), &[("low", &[]), ("high", &["low"])])
    };
    assert_eq!(faults("use crate::high::High;"), ["low.rs: low may not use high, but takes crate::high::High"]);
    assert_eq!(faults("fn f() {}"), [""; 0]);
}
