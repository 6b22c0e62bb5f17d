//! Which file of a crate takes names from which other file. The sources are read as text, not compiled.
//!
//! - A name is taken from the file that defines it. The reader follows `super::Name` and `crate::Name` through every `use`
//!   that hands the name on. So the files of a folder may reach each other through its `mod.rs`.
//! - `mod name;` takes nothing. A `pub use` takes nothing either, unless the file itself names what it hands on. So a
//!   `mod.rs` that only lists and re-exports its files takes nothing from them; one that calls them does.
//! - A file takes nothing from its own parent. What a `mod.rs` defines is the common ground of the files in its folder, and
//!   it may call them as well. What a file takes from any other ancestor counts.
//! - A file that imports a module takes what it names through it: `use crate::a;` with `a::f()`.
//! - Code for tests (`#[cfg(test)]`, files and folders called `tests`) may name anything and is left out.
//!
//! Limits: the reader does not see methods and fields, nor what macros make.

use super::tokens::{tokens, without_tests};
use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};

/// The files of a crate.
pub struct Sources {
    /// In the order of their paths.
    pub files: Vec<File>,
}

/// A source file.
pub struct File {
    /// Its path from the folder `src`.
    pub path: PathBuf,
    /// Its module: `["joint", "cost"]`; empty for the root of the crate.
    pub module: Vec<String>,
    uses: Vec<Use>,
    /// All paths in the code but those of `use`; many are single names.
    named: BTreeSet<Vec<String>>,
}

/// A name that a file imports.
struct Use {
    path: Vec<String>,
    /// What it is called here; `*` where all of a module is meant.
    local: String,
    /// Whether others may import it from here.
    handed_on: bool,
}

/// What a path leads to.
enum Target {
    Module(usize),
    Item(usize),
}

/// Names taken, by the files that take them and that define them.
pub type Arrows = BTreeMap<(usize, usize), BTreeSet<String>>;

impl Sources {
    /// The files below a folder `src`.
    pub fn read(src: &Path) -> Self {
        let mut paths = Vec::new();
        collect(src, &mut paths);
        paths.sort();
        let text = |path: PathBuf| (path.strip_prefix(src).unwrap().to_owned(), fs::read_to_string(&path).unwrap());
        Self::of(paths.into_iter().map(text))
    }

    /// From paths and texts.
    pub fn of(texts: impl IntoIterator<Item = (PathBuf, String)>) -> Self {
        let files = texts.into_iter().map(|(path, text)| File::of(path, &text));
        Self { files: files.filter(|file| file.module.iter().all(|name| name != "tests")).collect() }
    }

    /// Who takes what from whom.
    pub fn arrows(&self) -> Arrows {
        let mut arrows = Arrows::new();
        for (from, file) in self.files.iter().enumerate() {
            let mut take = |to: usize, name: &[String]| {
                if to != from && !self.is_parent(to, from) {
                    arrows.entry((from, to)).or_default().insert(name.join("::"));
                }
            };
            for import in &file.uses {
                match self.resolved(from, &import.path, 0) {
                    Some(Target::Item(to)) if !import.handed_on || file.names(&import.local) => take(to, &import.path),
                    Some(Target::Module(to)) if import.local == "*" => take(to, &import.path),
                    _ => {}
                }
            }
            for path in file.named.iter().filter(|path| path.len() > 1) {
                if let Some(Target::Item(to)) = self.resolved(from, path, 0) {
                    take(to, path);
                }
            }
        }
        arrows
    }

    /// What a path in a file leads to; none where it leads out of the crate, or nowhere.
    fn resolved(&self, from: usize, path: &[String], depth: usize) -> Option<Target> {
        let file = &self.files[from];
        let (first, rest) = path.split_first()?;
        match first.as_str() {
            "crate" => self.walked(self.module(&[])?, rest, depth),
            "self" => self.walked(from, rest, depth),
            "super" => {
                let levels = path.iter().take_while(|name| *name == "super").count();
                let parent = &file.module[..file.module.len().checked_sub(levels)?];
                self.walked(self.module(parent)?, &path[levels..], depth)
            }
            _ => match self.child(from, first) {
                Some(child) => self.walked(child, rest, depth),
                None => self.through(from, first, rest, depth),
            },
        }
    }

    /// What `path` leads to from a module.
    fn walked(&self, at: usize, path: &[String], depth: usize) -> Option<Target> {
        let Some((first, rest)) = path.split_first() else { return Some(Target::Module(at)) };
        match self.child(at, first) {
            Some(child) => self.walked(child, rest, depth),
            None if self.files[at].import(first).is_some() => self.through(at, first, rest, depth),
            None => Some(Target::Item(at)),
        }
    }

    /// What a name that a file imports leads to, and `rest` from there.
    fn through(&self, at: usize, name: &str, rest: &[String], depth: usize) -> Option<Target> {
        let import = self.files[at].import(name).filter(|_| depth < 8)?;
        match self.resolved(at, &import.path, depth + 1)? {
            Target::Module(module) => self.walked(module, rest, depth + 1),
            item => Some(item),
        }
    }

    fn is_parent(&self, parent: usize, of: usize) -> bool {
        self.files[of].module.split_last().is_some_and(|(_, module)| self.files[parent].module == module)
    }

    fn child(&self, of: usize, name: &str) -> Option<usize> {
        let mut module = self.files[of].module.clone();
        module.push(name.to_owned());
        self.module(&module)
    }

    fn module(&self, module: &[String]) -> Option<usize> {
        self.files.iter().position(|file| file.module == module)
    }
}

impl File {
    fn of(path: PathBuf, text: &str) -> Self {
        let tokens = without_tests(tokens(text));
        let (mut uses, mut named) = (Vec::new(), BTreeSet::new());
        let mut at = 0;
        while at < tokens.len() {
            // `use<'a>` in a type names lifetimes.
            if tokens[at] == "use" && tokens.get(at + 1).is_some_and(|next| next != "<") {
                let handed_on = at > 0 && (tokens[at - 1] == "pub" || tokens[at - 1] == ")");
                at = read_use(&tokens, at + 1, &[], handed_on, &mut uses);
            } else {
                let end = end_of_path(&tokens, at);
                // What follows a dot is a field or a method.
                if at == 0 || tokens[at - 1] != "." {
                    named.insert(tokens[at..end].iter().filter(|token| *token != "::").cloned().collect());
                }
                at = end;
            }
        }
        Self { module: module_of(&path), path, uses, named }
    }

    /// The folder of the file. A file that has a folder of the same name beside it belongs in there, as a `mod.rs` does.
    pub fn folder(&self, all: &Sources) -> &[String] {
        let has_children =
            all.files.iter().any(|f| f.module.len() > self.module.len() && f.module.starts_with(&self.module));
        if has_children { &self.module } else { &self.module[..self.module.len().saturating_sub(1)] }
    }

    fn names(&self, name: &str) -> bool {
        self.named.iter().any(|path| path.first().is_some_and(|first| first == name))
    }

    fn import(&self, name: &str) -> Option<&Use> {
        self.uses.iter().find(|import| import.local == name)
    }
}

/// Reads what follows `use` or a `::` in it, and gives the place behind.
fn read_use(tokens: &[String], mut at: usize, prefix: &[String], handed_on: bool, into: &mut Vec<Use>) -> usize {
    let mut path = prefix.to_vec();
    loop {
        match tokens.get(at).map(String::as_str) {
            Some("::") => at += 1,
            Some("{") => {
                at += 1;
                while tokens.get(at).is_some_and(|token| token != "}") {
                    at = read_use(tokens, at, &path, handed_on, into);
                    at += usize::from(tokens.get(at).is_some_and(|token| token == ","));
                }
                return at + 1;
            }
            Some(end @ ("," | "}" | ";" | "as")) => {
                let renamed = end == "as";
                // `a::{self}` is `a`.
                if path.len() > 1 && path.last().is_some_and(|name| name == "self") {
                    path.pop();
                }
                let local = if renamed { tokens[at + 1].clone() } else { path.last().cloned().unwrap_or_default() };
                if local == "*" {
                    path.pop();
                }
                into.push(Use { path, local, handed_on });
                return at + if renamed { 2 } else { 0 };
            }
            Some(name) => {
                path.push(name.to_owned());
                at += 1;
            }
            None => return at,
        }
    }
}

/// The place behind the path that starts at `at`: behind one token where that is no name.
fn end_of_path(tokens: &[String], at: usize) -> usize {
    let name = |at: usize| {
        let first = tokens.get(at).and_then(|token| token.chars().next());
        first.is_some_and(|c| c.is_alphabetic() || c == '_')
    };
    let mut end = at + 1;
    while name(end - 1) && tokens.get(end).is_some_and(|token| token == "::") && name(end + 1) {
        end += 2;
    }
    end
}

fn module_of(path: &Path) -> Vec<String> {
    let mut module: Vec<String> =
        path.with_extension("").iter().map(|name| name.to_str().unwrap().to_owned()).collect();
    let root = module.len() == 1 && (module[0] == "lib" || module[0] == "main");
    if root || module.last().is_some_and(|name| name == "mod") {
        module.pop();
    }
    module
}

fn collect(folder: &Path, found: &mut Vec<PathBuf>) {
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            collect(&path, found);
        } else if path.extension().is_some_and(|extension| extension == "rs") {
            found.push(path);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What `user.rs` takes, as "file: names".
    fn taken(text: &str) -> Vec<String> {
        let texts = [
            ("lib.rs", "mod user; mod a; pub use a::one::One;"),
            ("a/mod.rs", "pub mod one; pub mod two; pub use two::Two as Second; pub fn own() {}"),
            ("a/one.rs", "pub struct One; pub fn one() {}"),
            ("a/two.rs", "pub struct Two; pub fn two() {}"),
            ("user.rs", text),
        ];
        let sources = Sources::of(texts.map(|(path, text)| (path.into(), text.into())));
        let arrows = sources.arrows();
        let of_user = arrows.iter().filter(|((from, _), _)| sources.files[*from].path.ends_with("user.rs"));
        let line = |((_, to), names): (&(usize, usize), &BTreeSet<String>)| {
            format!("{}: {}", sources.files[*to].path.display(), Vec::from_iter(names.iter().cloned()).join(" "))
        };
        of_user.map(line).collect()
    }

    #[test]
    fn names_are_taken_from_where_they_are_defined() {
        assert_eq!(taken("use crate::One;"), ["a/one.rs: crate::One"]);
        assert_eq!(taken("use super::a::Second;"), ["a/two.rs: super::a::Second"]);
        assert_eq!(taken("use crate::a::own;"), ["a/mod.rs: crate::a::own"]);
        assert_eq!(
            taken("use crate::{a::{one::{self, One as Eins}, two::*}};"),
            ["a/one.rs: crate::a::one::One", "a/two.rs: crate::a::two"]
        );
    }

    #[test]
    fn a_module_gives_what_is_named_through_it() {
        assert_eq!(taken("use crate::a;"), [""; 0]);
        assert_eq!(
            taken("use crate::a::{self as b, one}; fn f() { b::two::two(); one::one() }"),
            ["a/one.rs: one::one", "a/two.rs: b::two::two"]
        );
        assert_eq!(taken("fn f() { super::a::one::one(); x.one::<u8>() }"), ["a/one.rs: super::a::one::one"]);
    }

    #[test]
    fn what_is_only_handed_on_is_not_taken() {
        assert_eq!(taken("pub use crate::a::Second;"), [""; 0]);
        assert_eq!(taken("pub(crate) use crate::a::Second; fn f(x: Second) {}"), ["a/two.rs: crate::a::Second"]);
    }

    #[test]
    fn other_crates_and_comments_are_left_out() {
        assert_eq!(taken("use std::fmt; // crate::One\nfn f() -> impl Sized + use<'_> { \"crate::One\" }"), [""; 0]);
    }
}
