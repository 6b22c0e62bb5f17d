//! The documentation's picture of the crates is drawn from what cargo says of them.
//!
//! A crate lies one row above the highest crate that it uses. Arrows that follow from two others are left out (transitive
//! reduction), so that the picture stays readable; the list below it names every one.

use rototoon_tests::golden;
use serde_json::Value;
use std::collections::{BTreeMap, BTreeSet};
use std::process::Command;

/// Each crate with the crates of the workspace that it is built from. Crates for tests and development are left out.
type Graph = BTreeMap<String, BTreeSet<String>>;

const HEAD: &str = "<!-- Generated from `cargo metadata`. Run the tests, then `cargo xtask bless`. -->

# The crates

An arrow points down to the crate that is used. Arrows that follow from others are left out of the picture; the list has all.
";
/// Size of a box and of the gaps between boxes, in units of the picture.
const BOX: [f64; 2] = [128.0, 30.0];
const GAP: [f64; 2] = [14.0, 46.0];

fn graph() -> Graph {
    let cargo = Command::new(env!("CARGO"))
        .args(["metadata", "--quiet", "--locked", "--no-deps", "--format-version", "1"])
        .current_dir(concat!(env!("CARGO_MANIFEST_DIR"), "/.."))
        .output()
        .expect("cargo starts");
    assert!(cargo.status.success(), "{}", String::from_utf8_lossy(&cargo.stderr));
    let metadata: Value = serde_json::from_slice(&cargo.stdout).expect("cargo writes JSON");
    let list = |value: &Value| value.as_array().cloned().unwrap_or_default();
    let text = |value: &Value| value.as_str().unwrap_or_default().to_owned();
    let development = ["rototoon-tests", "rototoon-ofx-host", "rototoon-features", "rototoon-fuzz"];
    let product = |name: &str| name.starts_with("rototoon") && !development.contains(&name);
    let mut graph = Graph::new();
    for package in list(&metadata["packages"]) {
        let name = text(&package["name"]);
        if !product(&name) {
            continue;
        }
        let used = list(&package["dependencies"]).into_iter().filter(|d| d["kind"].is_null() && d["path"].is_string());
        graph.insert(name, used.map(|d| text(&d["name"])).collect());
    }
    graph
}

/// The row of each crate, from 0 for those that use none.
fn rows(graph: &Graph) -> BTreeMap<&str, usize> {
    fn row<'a>(graph: &'a Graph, name: &'a str, known: &mut BTreeMap<&'a str, usize>) -> usize {
        if let Some(&row) = known.get(name) {
            return row;
        }
        let found = graph[name].iter().map(|used| row(graph, used, known) + 1).max().unwrap_or(0);
        known.insert(name, found);
        found
    }
    let mut known = BTreeMap::new();
    graph.keys().for_each(|name| {
        row(graph, name, &mut known);
    });
    known
}

/// Whether `from` reaches `to` over at least one crate between them.
fn follows(graph: &Graph, from: &str, to: &str) -> bool {
    graph[from].iter().any(|next| next != to && (graph[next].contains(to) || follows(graph, next, to)))
}

fn picture(graph: &Graph) -> String {
    let rows = rows(graph);
    let highest = rows.values().copied().max().unwrap_or(0);
    let widest = (0..=highest).map(|row| rows.values().filter(|r| **r == row).count()).max().unwrap_or(0);
    let size = |count: usize, axis: usize| count as f64 * (BOX[axis] + GAP[axis]) - GAP[axis];
    let mut places = BTreeMap::new();
    for row in 0..=highest {
        let names: Vec<&str> = rows.iter().filter(|(_, r)| **r == row).map(|(name, _)| *name).collect();
        let left = 0.5 * (size(widest, 0) - size(names.len(), 0));
        for (k, name) in names.into_iter().enumerate() {
            places.insert(name, [left + size(k + 1, 0) - BOX[0], size(highest - row + 1, 1) - BOX[1]]);
        }
    }
    let (width, height) = (size(widest, 0) + 8.0, size(highest + 1, 1) + 8.0);
    let mut svg = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"-4 -4 {width} {height}\" width=\"100%\" role=\"img\" \
         aria-label=\"The crates and which uses which\" font-family=\"sans-serif\" font-size=\"12\">\n\
         <defs><marker id=\"tip\" viewBox=\"0 0 8 8\" refX=\"8\" refY=\"4\" markerWidth=\"7\" markerHeight=\"7\" orient=\"auto\">\
         <path d=\"M0 0L8 4L0 8z\" fill=\"#777\"/></marker></defs>\n"
    );
    for (name, used) in graph {
        for other in used.iter().filter(|other| !follows(graph, name, other)) {
            let ([x, y], [to_x, to_y]) = (places[&**name], places[&**other]);
            let (x, y, to_x) = (x + 0.5 * BOX[0], y + BOX[1], to_x + 0.5 * BOX[0]);
            svg += &format!(
                "<path d=\"M{x} {y}C{x} {} {to_x} {} {to_x} {to_y}\" fill=\"none\" stroke=\"#777\" marker-end=\"url(#tip)\"/>\n",
                y + 0.7 * GAP[1],
                to_y - 0.7 * GAP[1]
            );
        }
    }
    for (name, [x, y]) in places {
        let [w, h] = BOX;
        let (middle, base) = (x + 0.5 * w, y + 0.5 * h + 4.0);
        svg += &format!(
            "<rect x=\"{x}\" y=\"{y}\" width=\"{w}\" height=\"{h}\" rx=\"6\" fill=\"#eef3fb\" stroke=\"#4a6fa5\"/>\
             <text x=\"{middle}\" y=\"{base}\" text-anchor=\"middle\" fill=\"#123\">{name}</text>\n"
        );
    }
    svg + "</svg>\n"
}

#[test]
fn the_page_of_the_crates_is_current() {
    let graph = graph();
    assert!(graph.len() > 10, "{graph:?}");
    let mut page = format!("{HEAD}\n{}\n| crate | uses |\n| --- | --- |\n", picture(&graph));
    for (name, used) in &graph {
        let used: Vec<String> = used.iter().map(|name| format!("`{name}`")).collect();
        let used = if used.is_empty() { "none of the others".to_owned() } else { used.join(", ") };
        page += &format!("| `{name}` | {used} |\n");
    }
    golden::compare_page("crates", &page).unwrap();
}

#[test]
fn arrows_that_follow_from_others_are_found() {
    let of = |list: &[&str]| list.iter().map(|name| (*name).to_owned()).collect::<BTreeSet<_>>();
    let graph = Graph::from([
        ("a".to_owned(), of(&[])),
        ("b".to_owned(), of(&["a"])),
        ("c".to_owned(), of(&["a", "b"])),
        ("d".to_owned(), of(&["a"])),
    ]);
    assert!(follows(&graph, "c", "a") && !follows(&graph, "c", "b") && !follows(&graph, "d", "a"));
    assert_eq!(rows(&graph), BTreeMap::from([("a", 0), ("b", 1), ("c", 2), ("d", 1)]));
}
