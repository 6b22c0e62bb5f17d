//! Files that import each other in a cycle.

use super::imports::{Arrows, Sources};
use std::collections::BTreeSet;

/// Each cycle of more than one file, as indices of files.
pub fn cycles(sources: &Sources, arrows: &Arrows) -> Vec<BTreeSet<usize>> {
    let reached: Vec<BTreeSet<usize>> = (0..sources.files.len()).map(|file| reached(file, arrows)).collect();
    let cycle = |file: usize| -> BTreeSet<usize> {
        reached[file].iter().copied().filter(|&other| reached[other].contains(&file)).collect()
    };
    let all: BTreeSet<BTreeSet<usize>> = (0..sources.files.len()).map(cycle).collect();
    all.into_iter().filter(|cycle| cycle.len() > 1).collect()
}

/// The files that a file needs, directly or by others.
fn reached(file: usize, arrows: &Arrows) -> BTreeSet<usize> {
    let (mut found, mut open) = (BTreeSet::new(), vec![file]);
    while let Some(from) = open.pop() {
        let next = arrows.range((from, 0)..=(from, usize::MAX)).map(|((_, to), _)| *to);
        open.extend(next.filter(|&to| found.insert(to)));
    }
    found
}

/// Whether a cycle is allowed: two files of one folder may need each other.
pub fn allowed(sources: &Sources, cycle: &BTreeSet<usize>) -> bool {
    let folders: BTreeSet<&[String]> = cycle.iter().map(|&file| sources.files[file].folder(sources)).collect();
    cycle.len() == 2 && folders.len() == 1
}

/// The arrows of a cycle, one a line.
pub fn described(sources: &Sources, arrows: &Arrows, cycle: &BTreeSet<usize>) -> String {
    let path = |file: usize| sources.files[file].path.display();
    let inside = arrows.iter().filter(|((from, to), _)| cycle.contains(from) && cycle.contains(to));
    inside
        .map(|(&(from, to), names)| {
            let names: Vec<&str> = names.iter().map(String::as_str).collect();
            format!("  {} takes from {}: {}\n", path(from), path(to), names.join(", "))
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The cycles of some files, and whether each is allowed.
    fn found(files: &[(&str, &str)]) -> Vec<(Vec<String>, bool)> {
        let sources = Sources::of(files.iter().map(|(path, text)| (path.into(), (*text).to_owned())));
        let paths =
            |cycle: &BTreeSet<usize>| cycle.iter().map(|&f| sources.files[f].path.display().to_string()).collect();
        let cycles = cycles(&sources, &sources.arrows());
        cycles.iter().map(|cycle| (paths(cycle), allowed(&sources, cycle))).collect()
    }

    fn cycle(files: &[&str], allowed: bool) -> Vec<(Vec<String>, bool)> {
        vec![(files.iter().map(|&file| file.to_owned()).collect(), allowed)]
    }

    #[test]
    fn a_ring_across_folders_is_found() {
        let files = [
            ("lib.rs", "mod a; mod b;"),
            ("a/mod.rs", "pub mod one;"),
            ("a/one.rs", "use crate::b::two::Two; pub struct One;"),
            ("b/mod.rs", "pub mod two;"),
            ("b/two.rs", "pub struct Two; fn f() { crate::a::one::One; }"),
        ];
        assert_eq!(found(&files), cycle(&["a/one.rs", "b/two.rs"], false));
    }

    #[test]
    fn two_files_of_a_folder_may_make_a_ring_and_three_may_not() {
        let two = [("lib.rs", "mod a; mod b;"), ("a.rs", "use super::b::B;"), ("b.rs", "use crate::a::A;")];
        assert_eq!(found(&two), cycle(&["a.rs", "b.rs"], true));
        let three =
            [("a.rs", "use super::b::B;"), ("b.rs", "use crate::c::C;"), ("c.rs", "use super::a; type A = a::A;")];
        let files: Vec<_> = [("lib.rs", "mod a; mod b; mod c;")].into_iter().chain(three).collect();
        assert_eq!(found(&files), cycle(&["a.rs", "b.rs", "c.rs"], false));
    }

    #[test]
    fn a_file_beside_its_folder_is_of_that_folder() {
        let files = [
            ("lib.rs", "mod a; mod b;"),
            ("a.rs", "mod in_a; use crate::b::B; pub struct A;"),
            ("a/in_a.rs", ""),
            ("b.rs", "use crate::a::A; pub struct B;"),
        ];
        assert_eq!(found(&files), cycle(&["a.rs", "b.rs"], false));
    }

    #[test]
    fn a_mod_that_hands_names_on_or_is_the_parent_makes_no_ring() {
        let handed = [
            ("lib.rs", "mod a; mod user;"),
            ("a/mod.rs", "mod one; mod two; pub use one::One; pub use two::Two;"),
            ("a/one.rs", "use super::Two; pub struct One;"),
            ("a/two.rs", "pub struct Two;"),
            ("user.rs", "use crate::a::{One, Two};"),
        ];
        assert_eq!(found(&handed), []);
        let parent = [
            ("lib.rs", "mod a;"),
            ("a/mod.rs", "mod one; pub struct Common; fn f() { one::f() }"),
            ("a/one.rs", "use super::Common; pub fn f() {}"),
        ];
        assert_eq!(found(&parent), []);
    }

    #[test]
    fn tests_make_no_ring() {
        let text = "pub struct A; #[cfg(test)] mod tests { use crate::b::B; }";
        assert_eq!(found(&[("lib.rs", "mod a; mod b;"), ("a.rs", text), ("b.rs", "use crate::a::A;")]), []);
    }
}
