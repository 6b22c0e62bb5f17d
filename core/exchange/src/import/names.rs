//! Names of shapes, each once in a file.

use std::collections::{BTreeMap, BTreeSet};

/// The names that shapes have so far.
#[derive(Debug, Default)]
pub(super) struct Names {
    taken: BTreeSet<String>,
    /// For each requested name the number to try next. Names are only added, so no lower number becomes free.
    next: BTreeMap<String, u64>,
}

impl Names {
    /// Takes a name that no shape has yet: the requested name, with a number if necessary. Blanks at its ends stay, since a part may differ from
    /// another one in these alone.
    pub(super) fn free(&mut self, wanted: &str) -> String {
        let wanted = if wanted.trim().is_empty() { "shape" } else { wanted };
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
    fn many_shapes_without_a_name_are_numbered() {
        let mut names = Names::default();
        let last = (0..100_000).map(|_| names.free("")).last();
        assert_eq!(last.as_deref(), Some("shape 100000"));
    }
}
