//! Checks that dependencies have the same features in every set of packages that is built. Otherwise Cargo compiles them
//! again in every run of `cargo xtask test`, with all packages that depend on them.

use std::collections::{BTreeMap, BTreeSet};
use std::process::Command;

/// The sets of features with which each dependency is compiled for the packages that `selection` selects.
fn features(selection: &[&str]) -> BTreeMap<String, BTreeSet<String>> {
    let tree = Command::new(env!("CARGO"))
        .args(["tree", "--quiet", "--locked", "--prefix", "none", "--no-dedupe", "--format", "{p}|{f}"])
        .args(selection)
        .current_dir(concat!(env!("CARGO_MANIFEST_DIR"), "/.."))
        .output()
        .expect("cargo starts");
    assert!(tree.status.success(), "{}", String::from_utf8_lossy(&tree.stderr));
    let mut sets: BTreeMap<String, BTreeSet<String>> = BTreeMap::new();
    let tree = String::from_utf8(tree.stdout).expect("names are UTF-8");
    for line in tree.lines().filter(|line| !line.is_empty()) {
        let (package, features) = line.split_once('|').expect("the lines have the given format");
        sets.entry(package.to_owned()).or_default().insert(features.to_owned());
    }
    sets
}

/// The dependencies that `selection` compiles with other features than `all`.
fn compiled_again(all: &BTreeMap<String, BTreeSet<String>>, selection: &[&str]) -> Vec<String> {
    let again = |(package, sets): (String, BTreeSet<String>)| {
        let there = all.get(&package)?;
        (!sets.is_subset(there)).then(|| format!("{package}: {sets:?}, in the workspace {there:?}"))
    };
    features(selection).into_iter().filter_map(again).collect()
}

#[test]
fn no_dependency_is_compiled_again_for_the_commands_or_the_host() {
    let all = features(&["--workspace", "--exclude", "rototoon-ofx-host", "--edges", "normal,build,dev"]);
    assert!(all.len() > 100, "{} dependencies", all.len());
    let (programs, tests) = ("normal,build", "normal,build,dev");
    let others: [(&[&str], &str); 3] = [
        (&["--package", "xtask"], programs),
        (&["--workspace", "--exclude", "rototoon-ofx-host"], programs),
        (&["--package", "rototoon-ofx-host"], tests),
    ];
    for (selection, edges) in others {
        let again = compiled_again(&all, &[selection, &["--edges", edges]].concat());
        assert!(again.is_empty(), "add to tests/features/Cargo.toml, for {selection:?}: {again:#?}");
    }
}
