//! Selectors of style sheets.
//!
//! Read are names of elements, `*`, classes, ids, attributes, `:root`, `:first-child`, `:last-child`, and of several elements those within each
//! other (`a b`, `a > b`). What depends on a pointer or a history, such as `:hover`, fits no element of a picture. Every other
//! selector is unread, which the caller tells.
//!
//! **How.** A selector is compared from its end, with the element and then with those around it. At each step all elements are kept to which
//! the rest of the selector may belong, so a long selector on deep elements takes no more than its length times the depth. To try one after
//! the other takes exponential time, and a file may ask for that.
//!
//! Source: W3C, Selectors Level 4.

use roxmltree::Node;

/// What an element must have.
#[derive(Clone, Debug, PartialEq, Eq)]
enum Simple {
    Element(String),
    Class(String),
    Id(String),
    /// An attribute, and how its value is compared with a text.
    Attribute(String, Compared),
    Root,
    FirstChild,
    LastChild,
    /// Nothing has it.
    Never,
}

/// How the value of an attribute is compared.
#[derive(Clone, Debug, PartialEq, Eq)]
enum Compared {
    Exists,
    Is(String),
    HasWord(String),
    /// It is the text, or goes on with a dash.
    Dashed(String),
    Begins(String),
    Ends(String),
    Contains(String),
}

impl Compared {
    fn fits(&self, value: &str) -> bool {
        match self {
            Self::Exists => true,
            Self::Is(text) => value == text,
            Self::HasWord(text) => value.split_whitespace().any(|word| word == text),
            Self::Dashed(text) => value.strip_prefix(text.as_str()).is_some_and(|r| r.is_empty() || r.starts_with('-')),
            Self::Begins(text) => !text.is_empty() && value.starts_with(text.as_str()),
            Self::Ends(text) => !text.is_empty() && value.ends_with(text.as_str()),
            Self::Contains(text) => !text.is_empty() && value.contains(text.as_str()),
        }
    }
}

impl Simple {
    fn key(&self) -> Key<'_> {
        match self {
            Self::Id(name) => Key::Id(name),
            Self::Class(name) => Key::Class(name),
            Self::Element(name) => Key::Element(name),
            _ => Key::Any,
        }
    }

    fn fits(&self, node: Node) -> bool {
        match self {
            Self::Element(name) => node.tag_name().name() == name,
            Self::Class(name) => node.attribute("class").is_some_and(|own| own.split_whitespace().any(|w| w == name)),
            Self::Id(name) => node.attribute("id") == Some(name),
            Self::Attribute(name, compared) => node.attribute(name.as_str()).is_some_and(|value| compared.fits(value)),
            Self::Root => node.parent_element().is_none(),
            Self::FirstChild => node.prev_sibling_element().is_none(),
            Self::LastChild => node.next_sibling_element().is_none(),
            Self::Never => false,
        }
    }
}

/// By what the elements of a selector are found, the rarest first.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Key<'a> {
    Id(&'a str),
    Class(&'a str),
    Element(&'a str),
    Any,
}

/// What one element must have.
type Compound = Vec<Simple>;

/// A selector.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Selector {
    /// What the element must have.
    own: Compound,
    /// What elements around it must have, from the inside out. `true` means the next one out.
    around: Vec<(bool, Compound)>,
}

impl Selector {
    /// Reads a selector; `None` if it has something that is not read.
    pub fn read(text: &str) -> Option<Self> {
        let mut chars = Chars(text.trim());
        let mut all = vec![(false, chars.compound()?)];
        loop {
            let blank = chars.skip_blanks();
            let child = chars.0.starts_with('>');
            if child {
                chars.0 = &chars.0[1..];
                chars.skip_blanks();
            }
            if chars.0.is_empty() {
                break (!child).then_some(())?;
            }
            if !child && !blank {
                return None;
            }
            all.push((child, chars.compound()?));
        }
        // Each step out belongs to the compound inside of it.
        let (steps, mut compounds): (Vec<bool>, Vec<Compound>) = all.into_iter().unzip();
        let own = compounds.pop()?;
        let around = steps.into_iter().skip(1).zip(compounds).rev().collect();
        Some(Self { own, around })
    }

    /// Whether it is for an element.
    pub fn fits(&self, node: Node) -> bool {
        let has = |compound: &Compound, node: Node| compound.iter().all(|simple| simple.fits(node));
        if !has(&self.own, node) {
            return false;
        }
        if self.around.is_empty() {
            return true;
        }
        let chain: Vec<Node> = node.ancestors().filter(Node::is_element).collect();
        let mut reached = vec![false; chain.len()];
        reached[0] = true;
        for (is_parent, compound) in &self.around {
            let mut next = vec![false; chain.len()];
            let mut inside = false;
            for k in 1..chain.len() {
                inside |= reached[k - 1];
                let may = if *is_parent { reached[k - 1] } else { inside };
                next[k] = may && has(compound, chain[k]);
            }
            reached = next;
        }
        reached.contains(&true)
    }

    /// What an element must have that tells most about it.
    pub fn key(&self) -> Key<'_> {
        self.own.iter().map(Simple::key).min().unwrap_or(Key::Any)
    }

    /// How strong it is: ids, then classes and the like, then names of elements.
    pub fn strength(&self) -> [usize; 3] {
        let mut strength = [0; 3];
        for simple in self.own.iter().chain(self.around.iter().flat_map(|(_, compound)| compound)) {
            let kind = match simple {
                Simple::Id(_) => 0,
                Simple::Element(_) => 2,
                _ => 1,
            };
            strength[kind] += 1;
        }
        strength
    }
}

/// What is left of a selector.
struct Chars<'a>(&'a str);

impl Chars<'_> {
    fn skip_blanks(&mut self) -> bool {
        let before = self.0.len();
        self.0 = self.0.trim_start();
        self.0.len() < before
    }

    fn take(&mut self, wanted: char) -> Option<()> {
        self.0 = self.0.strip_prefix(wanted)?;
        Some(())
    }

    /// A name, with its escapes undone.
    fn name(&mut self) -> Option<String> {
        let mut name = String::new();
        while let Some(c) = self.0.chars().next() {
            if c == '\\' {
                self.0 = &self.0[1..];
                name.push(self.escape()?);
            } else if c.is_alphanumeric() || "-_".contains(c) || !c.is_ascii() {
                self.0 = &self.0[c.len_utf8()..];
                name.push(c);
            } else {
                break;
            }
        }
        (!name.is_empty()).then_some(name)
    }

    /// The character of an escape, behind its backslash.
    fn escape(&mut self) -> Option<char> {
        let digits = self.0.bytes().take(6).take_while(u8::is_ascii_hexdigit).count();
        if digits == 0 {
            let c = self.0.chars().next()?;
            self.0 = &self.0[c.len_utf8()..];
            return Some(c);
        }
        let code = u32::from_str_radix(&self.0[..digits], 16).ok()?;
        let rest = &self.0[digits..];
        self.0 = rest.strip_prefix([' ', '\t', '\n', '\r']).unwrap_or(rest);
        char::from_u32(code)
    }

    fn compound(&mut self) -> Option<Compound> {
        let mut found = Vec::new();
        let any = self.take('*').is_some();
        if !any && let Some(name) = self.name() {
            found.push(Simple::Element(name));
        }
        // A namespace, such as in `svg|path`: SVG is the only one here.
        if self.0.starts_with('|') && !self.0.starts_with("||") {
            self.0 = &self.0[1..];
            found.clear();
            if self.take('*').is_none() {
                found.push(Simple::Element(self.name()?));
            }
        }
        let mut next = self.simple();
        while let Some(simple) = next? {
            found.push(simple);
            next = self.simple();
        }
        (any || !found.is_empty()).then_some(found)
    }

    /// The next condition of a compound; `Some(None)` at its end.
    #[allow(clippy::option_option)]
    fn simple(&mut self) -> Option<Option<Simple>> {
        let Some(first) = self.0.chars().next().filter(|c| ".#[:".contains(*c)) else { return Some(None) };
        self.0 = &self.0[1..];
        Some(Some(match first {
            '.' => Simple::Class(self.name()?),
            '#' => Simple::Id(self.name()?),
            '[' => self.attribute()?,
            _ => match self.name()?.to_ascii_lowercase().as_str() {
                "root" => Simple::Root,
                "first-child" => Simple::FirstChild,
                "last-child" => Simple::LastChild,
                "hover" | "focus" | "active" | "visited" | "target" | "focus-within" | "focus-visible" => Simple::Never,
                _ => return None,
            },
        }))
    }

    fn attribute(&mut self) -> Option<Simple> {
        self.skip_blanks();
        let name = self.name()?;
        self.skip_blanks();
        if self.take(']').is_some() {
            return Some(Simple::Attribute(name, Compared::Exists));
        }
        let kind = self.0.chars().next()?;
        if kind != '=' {
            self.take(kind)?;
        }
        self.take('=')?;
        self.skip_blanks();
        let quote = self.0.chars().next().filter(|c| "'\"".contains(*c));
        let text = match quote {
            Some(quote) => {
                let (text, rest) = self.0[1..].split_once(quote)?;
                self.0 = rest;
                text.to_owned()
            }
            None => self.name()?,
        };
        self.skip_blanks();
        self.take(']')?;
        let compared = match kind {
            '=' => Compared::Is(text),
            '~' => Compared::HasWord(text),
            '|' => Compared::Dashed(text),
            '^' => Compared::Begins(text),
            '$' => Compared::Ends(text),
            '*' => Compared::Contains(text),
            _ => return None,
        };
        Some(Simple::Attribute(name, compared))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use roxmltree::Document;

    /// Whether a selector is for the `path` of a document.
    fn fits(selector: &str) -> Option<bool> {
        const TEXT: &str = "<svg><g id='a' class='far ref'><rect/><g class='x'><path id='1b' class='ink thin' \
            data-n='ab-c' fill='red'/></g></g></svg>";
        let document = Document::parse(TEXT).unwrap();
        let path = document.descendants().find(|node| node.has_tag_name("path")).unwrap();
        Some(Selector::read(selector)?.fits(path))
    }

    #[test]
    fn an_element_is_found_by_what_it_is_and_by_what_is_around_it() {
        for selector in [
            "path",
            "*",
            ".ink",
            "path.thin.ink",
            "#\\31 b",
            "g path",
            "svg path",
            "svg > g g path",
            "g.far  path",
            "#a>.x>path",
            "#a .ink",
            "* path",
            "[fill]",
            "path[fill=red]",
            "[class~='thin']",
            "[data-n|=\"ab\"]",
            "[data-n^=ab]",
            "[ data-n $= c ]",
            "[data-n*='b-']",
            "path:first-child",
            "path:last-child",
            ":root path",
            "svg|path",
            "*|*",
        ] {
            assert_eq!(fits(selector), Some(true), "{selector}");
        }
    }

    #[test]
    fn an_element_is_not_found_by_what_others_are() {
        for selector in [
            "rect",
            ".in",
            "#b",
            "g > rect",
            "#a > path",
            "svg > path",
            "path g",
            "path path",
            ".ref > .ink",
            "[stroke]",
            "[fill=re]",
            "[data-n^='']",
            ":root",
            "g:first-child > g:first-child path",
            "path:hover",
        ] {
            assert_eq!(fits(selector), Some(false), "{selector}");
        }
    }

    #[test]
    fn what_is_not_read_is_no_selector() {
        for selector in [
            "",
            "a + path",
            "a ~ path",
            "g >",
            "> path",
            "g > > path",
            "path::before",
            ":not(g)",
            "[a",
            "[a!=b]",
            "a!",
            "path*",
        ] {
            assert_eq!(fits(selector), None, "{selector}");
        }
    }

    #[test]
    fn the_strength_counts_ids_classes_and_names() {
        let strength = |text: &str| Selector::read(text).unwrap().strength();
        assert_eq!(strength("#a g.x > path[fill]:first-child"), [1, 3, 2]);
        assert_eq!(strength("*"), [0; 3]);
        let key = |text: &str| format!("{:?}", Selector::read(text).unwrap().key());
        let found = ["#a .b path.x#y", "#a path.x", "#a path", "#a *", "[fill]"].map(key);
        assert_eq!(found, ["Id(\"y\")", "Class(\"x\")", "Element(\"path\")", "Any", "Any"]);
    }

    #[test]
    fn a_long_selector_on_a_deep_element_is_answered_in_time() {
        let text = "<g>".repeat(200) + "<path/>" + &"</g>".repeat(200);
        let document = Document::parse(&text).unwrap();
        let path = document.descendants().find(|node| node.has_tag_name("path")).unwrap();
        let deep = |end: &str| Selector::read(&("g ".repeat(100) + end + " path")).unwrap();
        assert!(deep("g").fits(path) && !deep("a > g").fits(path));
        let mixed = "a ".to_owned() + &"g > g ".repeat(40) + "path";
        assert!(!Selector::read(&mixed).unwrap().fits(path));
    }
}
