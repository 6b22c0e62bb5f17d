//! What a shape of an SVG document is called.
//!
//! Programs keep the name of a layer in places of their own: `title`, `inkscape:label` of Inkscape, `data-name` of Illustrator, `serif:id` of
//! Affinity; and all of them write an `id`. The first of these that is there counts. Of a shape without any it is that of the nearest group that
//! has one, if there is no other shape in that group: Illustrator and Affinity write a layer with one path like this.
//!
//! Some programs keep the ids of a file and drop its titles.
//!
//! - An id has no blanks. Illustrator writes each character that it cannot have by its number, `_x20_` for a blank. That is undone, unless a part has the name as it
//!   stands.
//! - An export calls the path of a part `part-3`, by the part's place in the document. If nothing else names such a path, it is that part. The
//!   document may have changed since, and then it is another one. So each of these names is told.

use super::problem::LeftOut;
use super::svg_elements::{GROUPS, SHAPES};
use roxmltree::{Attribute, Document, Node, NodeId};
use std::collections::{BTreeMap, BTreeSet, HashMap};

/// The namespace of Affinity's attributes.
const AFFINITY: &str = "serif.com";
/// What the id of a part begins with in an export.
const PART: &str = "part-";

/// The names of a document.
#[derive(Debug, Default)]
pub(super) struct Called<'a> {
    /// The names of the parts that the shapes may be.
    parts: &'a [&'a str],
    /// The titles by what they are in: to look through all children of a group for each of them takes too long.
    titles: HashMap<NodeId, String>,
    /// The names that the file itself gives.
    given: BTreeSet<String>,
    /// Names that were found by the number of a part, with the ids.
    numbered: BTreeMap<String, (usize, String)>,
}

impl<'a> Called<'a> {
    /// Prepares the names of a document whose shapes may be these parts.
    pub fn new(document: &Document, parts: &'a [&'a str]) -> Self {
        let mut called = Self { parts, ..Self::default() };
        for node in document.descendants().filter(|node| node.tag_name().name() == "title") {
            if let (Some(owner), Some(text)) = (node.parent(), node.text()) {
                called.titles.entry(owner.id()).or_insert_with(|| text.to_owned());
            }
        }
        // Without parts nobody asks.
        if !parts.is_empty() {
            let all = document.descendants().filter(Node::is_element);
            called.given = all.filter_map(|node| called.given(node)).map(ToOwned::to_owned).collect();
        }
        called
    }

    /// What a shape or a group is called; empty if it has no name.
    pub fn name(&self, node: Node) -> String {
        if let Some(own) = self.own(node) {
            return own;
        }
        let groups = node.ancestors().skip(1).filter(|node| node.parent_element().is_some());
        for group in groups.take_while(|node| GROUPS.contains(&node.tag_name().name())) {
            if let Some(own) = self.own(group) {
                let shapes = group.descendants().filter(|node| SHAPES.contains(&node.tag_name().name()));
                let is_only = SHAPES.contains(&node.tag_name().name()) && shapes.take(2).count() == 1;
                return if is_only { own } else { String::new() };
            }
        }
        String::new()
    }

    /// The name of an element itself.
    fn own(&self, node: Node) -> Option<String> {
        if let Some(given) = self.given(node) {
            return Some(given.to_owned());
        }
        let id = id(node)?;
        if self.parts.contains(&id) {
            return Some(id.to_owned());
        }
        Some(self.numbered(id).map_or_else(|| without_escapes(id), ToOwned::to_owned))
    }

    /// Notes that a shape has become a part of this name.
    pub fn took(&mut self, node: Node, name: &str) {
        let all = node.ancestors().filter_map(|node| Some((node, id(node)?)));
        let mut numbered = all.filter(|(_, id)| self.numbered(id) == Some(name) && !self.parts.contains(id));
        let found = numbered.find(|(node, _)| self.given(*node).is_none());
        if let Some((node, id)) = found {
            self.numbered.entry(id.to_owned()).or_insert_with(|| (node.range().start, name.to_owned()));
        }
    }

    /// The name that a program gives beside the id.
    fn given<'b>(&'b self, node: Node<'b, '_>) -> Option<&'b str> {
        let attribute = |is: &dyn Fn(&Attribute) -> bool| node.attributes().find(is).map(|found| found.value());
        let label = || attribute(&|a| a.name() == "label");
        let affinity =
            || attribute(&|a| a.name() == "id" && a.namespace().is_some_and(|space| space.contains(AFFINITY)));
        let title = self.titles.get(&node.id()).map(String::as_str);
        let all = [title, label(), node.attribute("data-name"), affinity()];
        all.into_iter().flatten().find(|name| !name.trim().is_empty())
    }

    /// The part whose number an id has. A part that the file names otherwise is not it.
    fn numbered(&self, id: &str) -> Option<&'a str> {
        let digits = id.strip_prefix(PART)?;
        let number: usize = digits.parse().ok()?;
        let part = *self.parts.get(number).filter(|_| number.to_string() == digits)?;
        (!self.given.contains(part)).then_some(part)
    }

    /// Tells the names that were found by numbers.
    pub fn tell(self, left_out: &mut LeftOut) {
        let Some(start) = self.numbered.values().map(|(start, _)| *start).min() else { return };
        let mut pairs: Vec<(usize, String, String)> =
            self.numbered.into_iter().map(|(id, (start, part))| (start, id, part)).collect();
        pairs.sort_unstable();
        let pairs: Vec<String> = pairs.iter().map(|(_, id, part)| format!("{id} is {part:?}")).collect();
        let told = format!(
            "parts without names are taken by their numbers in the document; look whether these are right: {}",
            pairs.join(", ")
        );
        left_out.push_at(start, told);
    }
}

fn id<'a>(node: Node<'a, '_>) -> Option<&'a str> {
    node.attribute("id").filter(|id| !id.trim().is_empty())
}

/// An id without Illustrator's escapes.
fn without_escapes(id: &str) -> String {
    let (mut out, mut rest) = (String::new(), id);
    while let Some(at) = rest.find("_x") {
        let (before, escape) = rest.split_at(at);
        let code = escape[2..].split_once('_').filter(|(digits, _)| (1..=6).contains(&digits.len()));
        let found = code.and_then(|(digits, after)| {
            let hex = digits.bytes().all(|byte| byte.is_ascii_digit() || (b'A'..=b'F').contains(&byte));
            Some((char::from_u32(u32::from_str_radix(digits, 16).ok().filter(|_| hex)?)?, after))
        });
        out += before;
        match found {
            Some((c, after)) => {
                out.push(c);
                rest = after;
            }
            None => {
                out += "_x";
                rest = &escape[2..];
            }
        }
    }
    out + rest
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The names of all shapes, and what is told.
    fn names(content: &str, parts: &[&str]) -> (Vec<String>, Vec<String>) {
        let text =
            format!("<svg id='root' xmlns:i='http://inkscape' xmlns:serif='http://www.serif.com/'>{content}</svg>");
        let document = Document::parse(&text).unwrap();
        let mut called = Called::new(&document, parts);
        let shapes = document.descendants().filter(|node| SHAPES.contains(&node.tag_name().name()));
        let found = shapes
            .map(|node| {
                let name = called.name(node);
                called.took(node, &name);
                name
            })
            .collect();
        let mut left_out = LeftOut::default();
        called.tell(&mut left_out);
        (found, left_out.lines(&text))
    }

    #[test]
    fn the_first_name_of_a_program_counts() {
        let found = names(
            "<path id='a' i:label='b' data-name='c' serif:id='d'><title>e </title></path><path id='a' i:label='b' data-name='c'/>\
             <path id='a' serif:id='d' data-name='c'/><path id='a' serif:id='d'/><path id='a'><title> </title></path><path/>",
            &[],
        );
        assert_eq!(found.0, ["e ", "b", "c", "d", "a", ""]);
    }

    #[test]
    fn a_group_names_its_only_shape() {
        let named = |content: &str| names(content, &[]).0;
        assert_eq!(named("<g id='near_x20_arm'><path/></g>"), ["near arm"]);
        assert_eq!(named("<g id='far'><g><g><title>arm</title><g><path/></g></g></g></g>"), ["arm"]);
        assert_eq!(named("<g id='a'><path id='own'/></g><g id='b'><g id='c'><path/></g><path/></g>"), ["own", "c", ""]);
        assert_eq!(named("<g id='a'><path/><defs><rect/></defs></g>")[0], "", "two shapes, as far as is asked");
        assert_eq!(named("<path/>"), [""], "the document names nothing");
    }

    #[test]
    fn escapes_are_undone_unless_a_part_has_them() {
        for (id, name) in [
            ("gro_xDF_e_x20_Hand", "große Hand"),
            ("a_x5F_b", "a_b"),
            ("_x1F98A_", "🦊"),
            ("a_x20", "a_x20"),
            ("a_x_b_x20_c", "a_x_b c"),
            ("a_xdf_", "a_xdf_"),
            ("a_xD800_b_xFFFFFFF_", "a_xD800_b_xFFFFFFF_"),
            ("_x", "_x"),
        ] {
            assert_eq!(without_escapes(id), name);
        }
        assert_eq!(names("<path id='a_x20_b'/>", &["a b", "c"]).0, ["a b"]);
        assert_eq!(names("<path id='a_x20_b'/>", &["a b", "a_x20_b"]).0, ["a_x20_b"]);
    }

    #[test]
    fn a_number_names_a_part_that_nothing_else_names() {
        let parts = ["far arm", "head", "part-1", "leg"];
        let (found, told) = names(
            "<path id='part-3'/><g id='part-0'><path/></g><path id='part-1'/><path id='part-4'/><path id='part-03'/>",
            &parts,
        );
        assert_eq!(found, ["leg", "far arm", "part-1", "part-4", "part-03"]);
        assert_eq!(told.len(), 1);
        assert!(
            told[0].ends_with("look whether these are right: part-3 is \"leg\", part-0 is \"far arm\""),
            "{told:?}"
        );
        let (found, told) = names("<path id='part-3'/><path id='x'><title>leg</title></path>", &parts);
        assert_eq!((found, told.len()), (vec!["part-3".to_owned(), "leg".to_owned()], 0));
        assert_eq!(names("<path id='part-3'/>", &[]).0, ["part-3"]);
    }
}
