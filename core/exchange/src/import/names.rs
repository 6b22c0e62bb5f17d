//! Names of shapes, each once in a file.
//!
//! The first shape of a name has it. Later ones of the same name get numbers, and a shape that is called so in the file goes before them, wherever it stands. So
//! a doubled "arm" is never taken for the part "arm 2".

use super::Shape;
use std::collections::{BTreeMap, BTreeSet};

/// The names that shapes have so far.
#[derive(Debug, Default)]
pub(super) struct Names {
    taken: BTreeSet<String>,
    /// For each requested name the number to try next. Names are only added, so no lower number becomes free.
    next: BTreeMap<String, u64>,
    /// The requested name of each shape, and the one that it has until all are known.
    all: Vec<[String; 2]>,
}

impl Names {
    /// Takes a name that no shape has yet: the requested name, with a number if necessary. Blanks at its ends stay, since a part may differ from
    /// another one in these alone. [`Names::settle`] gives the final ones.
    pub(super) fn free(&mut self, wanted: &str) -> String {
        let wanted = if wanted.trim().is_empty() { "shape" } else { wanted };
        let name = self.first_free(wanted);
        self.all.push([wanted.to_owned(), name.clone()]);
        name
    }

    fn first_free(&mut self, wanted: &str) -> String {
        if self.taken.insert(wanted.to_owned()) {
            return wanted.to_owned();
        }
        let next = self.next.entry(wanted.to_owned()).or_insert(2);
        loop {
            let name = format!("{wanted} {next}");
            *next += 1;
            if self.taken.insert(name.clone()) {
                return name;
            }
        }
    }

    /// Gives all shapes of a file their final names, when all are known.
    pub(super) fn settle(self, shapes: &mut [Shape]) {
        let mut own = Self::default();
        let (mut settled, mut doubled) = (BTreeMap::new(), Vec::new());
        for [wanted, name] in self.all {
            match own.taken.insert(wanted.clone()) {
                true => drop(settled.insert(name, wanted)),
                false => doubled.push([wanted, name]),
            }
        }
        for [wanted, name] in doubled {
            settled.insert(name, own.first_free(&wanted));
        }
        for shape in shapes {
            if let Some(name) = settled.get(&shape.name) {
                shape.name.clone_from(name);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_get_the_first_number_that_is_free() {
        let mut names = Names::default();
        let found = ["arm", " ", "arm 2", "arm ", "", "arm", "arm 2", "arm "].map(|wanted| names.free(wanted));
        assert_eq!(found, ["arm", "shape", "arm 2", "arm ", "shape 2", "arm 3", "arm 2 2", "arm  2"]);
    }

    #[test]
    fn a_name_of_the_file_goes_before_a_number() {
        let shape = |name: String| Shape {
            name,
            closed: true,
            keys: BTreeMap::new(),
            absent: Vec::new(),
            falloff: None,
            extent: super::super::Extent::default(),
        };
        let mut names = Names::default();
        let mut shapes = ["arm", "arm", "", "arm 2", "shape", "arm"].map(|wanted| shape(names.free(wanted)));
        names.settle(&mut shapes);
        assert_eq!(shapes.map(|shape| shape.name), ["arm", "arm 3", "shape", "arm 2", "shape 2", "arm 4"]);
    }

    #[test]
    fn many_shapes_without_a_name_are_numbered() {
        let mut names = Names::default();
        let last = (0..100_000).map(|_| names.free("")).last();
        assert_eq!(last.as_deref(), Some("shape 100000"));
    }
}
