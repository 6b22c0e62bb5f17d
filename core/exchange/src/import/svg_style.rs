//! How an SVG document shows an element, as far as it matters for its outline.
//!
//! A property is, from the strongest to the weakest, an important declaration in the attribute `style` or in a style sheet of the document
//! (`svg_sheet`), another one in `style`, another one of a sheet, or an attribute of its own. `fill` and `visibility` are those of
//! the nearest element around that has one; `display` and `opacity` of an element hide all in it.
//!
//! Source: W3C, Scalable Vector Graphics (SVG) 2, chapters on styling and rendering; CSS Cascading and Inheritance Level 4.

use super::problem::{LeftOut, listed};
use super::svg_selector::{Key, Selector};
use super::svg_sheet::{READ, Sheet, declarations};
use roxmltree::{Document, Node};
use std::collections::{BTreeMap, HashMap};

/// Properties that move an element and are not read. Attributes of these names mean something else.
const MOVING: [&str; 6] = ["translate", "rotate", "scale", "offset-path", "animation", "animation-name"];
/// Media of a sheet for pictures.
const MEDIA: [&str; 3] = ["", "all", "screen"];

/// A declaration of a style sheet.
#[derive(Debug)]
struct Declared {
    selector: Selector,
    value: String,
    important: bool,
}

/// The declarations of a property.
#[derive(Debug, Default)]
struct Ruled {
    /// The weakest first.
    all: Vec<Declared>,
    /// Those whose selectors name an id, a class or an element, by that name with a sign before it. A file may have as many classes as paths.
    keyed: HashMap<String, Vec<usize>>,
    /// The others.
    rest: Vec<usize>,
}

impl Ruled {
    fn add(&mut self, declared: Declared) {
        let name = match declared.selector.key() {
            Key::Id(name) => Some(format!("#{name}")),
            Key::Class(name) => Some(format!(".{name}")),
            Key::Element(name) => Some(name.to_owned()),
            Key::Any => None,
        };
        name.map_or(&mut self.rest, |name| self.keyed.entry(name).or_default()).push(self.all.len());
        self.all.push(declared);
    }

    /// The strongest declaration for an element among the important ones, or among the others.
    fn strongest(&self, node: Node, important: bool) -> Option<&Declared> {
        let keyed = |sign: &str, name: &str| self.keyed.get(&format!("{sign}{name}"));
        let classes = node.attribute("class").unwrap_or("").split_whitespace().filter_map(|name| keyed(".", name));
        let id = node.attribute("id").and_then(|name| keyed("#", name));
        let lists = classes.chain(id).chain(keyed("", node.tag_name().name())).chain([&self.rest]);
        let mut best: Option<usize> = None;
        for list in lists {
            let mut stronger = list.iter().rev().copied().take_while(|k| best.is_none_or(|best| *k > best));
            let fits = |k: &usize| self.all[*k].important == important && self.all[*k].selector.fits(node);
            best = stronger.find(fits).or(best);
        }
        best.map(|k| &self.all[k])
    }
}

/// The style sheets of a document.
#[derive(Debug, Default)]
pub(super) struct Styles {
    sheets: BTreeMap<&'static str, Ruled>,
    /// What is not read of them.
    pub unread: LeftOut,
}

impl Styles {
    /// Reads the style sheets of a document.
    pub fn of(document: &Document) -> Self {
        let (mut rules, mut unread) = (Vec::new(), LeftOut::default());
        for node in document.descendants() {
            if node.is_element() && node.tag_name().name() == "style" {
                let sheet = sheet(node);
                rules.extend(sheet.rules);
                if !sheet.unread.is_empty() {
                    unread.push(node, format!("not read of the style sheet: {}", listed(&sheet.unread)));
                }
            } else if node.pi().is_some_and(|pi| pi.target == "xml-stylesheet") {
                unread.push(node, "the style sheet in another file is not read".to_owned());
            }
        }
        // The strength of the selector decides, then the place in the document.
        rules.sort_by_key(|rule| rule.selector.strength());
        let mut sheets: BTreeMap<&'static str, Ruled> = BTreeMap::new();
        for rule in rules {
            let declared = Declared { selector: rule.selector, value: rule.value, important: rule.important };
            sheets.entry(rule.property).or_default().add(declared);
        }
        Self { sheets, unread }
    }

    /// The value of a property that an element has by its style, and not by an attribute.
    fn styled<'a>(&'a self, node: Node<'a, '_>, property: &str) -> Option<&'a str> {
        let inline =
            || node.attribute("style").into_iter().flat_map(declarations).filter(|(name, ..)| name == property);
        let own = |important| inline().filter(|(.., is)| *is == important).last().map(|(_, value, _)| value);
        let sheet = self.sheets.get(property);
        let ruled = |important| sheet?.strongest(node, important).map(|found| found.value.as_str());
        own(true).or_else(|| ruled(true)).or_else(|| own(false)).or_else(|| ruled(false))
    }

    /// The value of a property that an element has itself.
    pub fn own<'a>(&'a self, node: Node<'a, '_>, property: &str) -> Option<&'a str> {
        debug_assert!(READ.contains(&property), "{property}");
        self.styled(node, property).or_else(|| node.attribute(property).map(str::trim))
    }

    /// The value of a property that elements inherit.
    pub fn inherited<'a>(&'a self, node: Node<'a, '_>, property: &str) -> Option<&'a str> {
        node.ancestors()
            .filter(Node::is_element)
            .find_map(|node| self.own(node, property).filter(|value| *value != "inherit"))
    }

    /// The property of its style by which an element moves and which is not read.
    pub fn moving(&self, node: Node) -> Option<&'static str> {
        MOVING.into_iter().find(|property| self.styled(node, property).is_some_and(|value| value != "none"))
    }

    /// Whether an element and all in it takes no room.
    pub fn is_away(&self, node: Node) -> bool {
        self.own(node, "display").is_some_and(|value| value.eq_ignore_ascii_case("none"))
    }

    /// Why an element and all in it is not shown: `display` or `opacity`. An opacity that changes counts as shown.
    pub fn hides(&self, node: Node) -> Option<&'static str> {
        if self.is_away(node) {
            return Some("display: none");
        }
        let transparent = self.own(node, "opacity").is_some_and(|text| number(text) == Some(0.0));
        (transparent && !is_animated(node, "opacity")).then_some("opacity: 0")
    }

    /// Whether an element is invisible by its own `visibility` or that of one around it. One that changes counts as visible.
    pub fn is_invisible(&self, node: Node) -> bool {
        let hidden = matches!(self.inherited(node, "visibility"), Some("hidden" | "collapse"));
        hidden && !node.ancestors().any(|node| is_animated(node, "visibility"))
    }

    /// Whether an element is filled. Without a `fill` it is, with black.
    pub fn is_filled(&self, node: Node) -> bool {
        let opaque = self.inherited(node, "fill-opacity").and_then(number) != Some(0.0);
        opaque && !matches!(self.inherited(node, "fill"), Some("none" | "transparent"))
    }
}

fn number(text: &str) -> Option<f64> {
    text.strip_suffix('%').unwrap_or(text).parse().ok()
}

/// Whether an element has an animation of an attribute.
fn is_animated(node: Node, attribute: &str) -> bool {
    node.children().any(|child| {
        matches!(child.tag_name().name(), "animate" | "set") && child.attribute("attributeName") == Some(attribute)
    })
}

/// The sheet in an element. What is for print alone says nothing here.
fn sheet(node: Node) -> Sheet {
    let kind = node.attribute("type").unwrap_or("").trim();
    let media = node.attribute("media").unwrap_or("").trim();
    if !kind.is_empty() && !kind.eq_ignore_ascii_case("text/css") {
        return Sheet { unread: vec![format!("type='{kind}'")], ..Sheet::default() };
    }
    if media == "print" {
        return Sheet::default();
    }
    if !media.split(',').any(|media| MEDIA.contains(&media.trim())) {
        return Sheet { unread: vec![format!("media='{media}'")], ..Sheet::default() };
    }
    let texts: String = node.children().filter_map(|child| child.text()).collect();
    Sheet::read(&texts)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn asked<T>(content: &str, ask: impl Fn(&Styles, Node) -> T) -> T {
        let text = format!("<svg>{content}</svg>");
        let document = Document::parse(&text).unwrap();
        let node = document.descendants().find(|node| node.tag_name().name() == "path").unwrap();
        ask(&Styles::of(&document), node)
    }

    #[test]
    fn the_strongest_declaration_counts() {
        let sheet = "<style>/* .a{fill:none} */ path { fill: red } #b{fill:none}.a, g > p{fill:blue}</style>";
        let fill =
            |path: &str| asked(&format!("{sheet}{path}"), |styles, node| styles.own(node, "fill").map(str::to_owned));
        assert_eq!(fill("<path fill='none'/>").as_deref(), Some("red"));
        assert_eq!(fill("<path class='x a'/>").as_deref(), Some("blue"));
        assert_eq!(fill("<path class='a' id='b'/>").as_deref(), Some("none"));
        assert_eq!(fill("<path class='a' id='b' style='Fill : green; x'/>").as_deref(), Some("green"));
        let important = "<style>.i{fill:one !important;fill:two} path.i{fill:three} #b{fill:four!important}</style>";
        let fill = |path: &str| {
            asked(&format!("{important}{path}"), |styles, node| styles.own(node, "fill").map(str::to_owned))
        };
        assert_eq!(fill("<path class='i' style='fill:own'/>").as_deref(), Some("one"));
        assert_eq!(fill("<path class='i' style='fill:own !important;fill:none'/>").as_deref(), Some("own"));
        assert_eq!(fill("<path class='i' id='b'/>").as_deref(), Some("four"));
        // Of equal ones the later counts, by whatever it is found.
        let equal = "<style>.p.q{fill:one}.q.p{fill:two}[class].q{fill:three}.r{fill:four}.s{fill:five}</style>";
        let fill =
            |path: &str| asked(&format!("{equal}{path}"), |styles, node| styles.own(node, "fill").map(str::to_owned));
        assert_eq!(fill("<path class='q p'/>").as_deref(), Some("three"));
        assert_eq!(fill("<path class='s r'/>").as_deref(), Some("five"));
        assert_eq!(fill("<path class='r t'/>").as_deref(), Some("four"));
    }

    #[test]
    fn what_is_not_read_is_told_with_its_place() {
        let text = "<?xml-stylesheet href='a.css'?><svg><style>a + b{fill:none}</style>\n<style media='print'/><style media='tv'/><style type='text/less'/></svg>";
        let told = Styles::of(&Document::parse(text).unwrap()).unread.lines(text);
        assert_eq!(
            told,
            [
                "line 1, column 1: the style sheet in another file is not read",
                "line 1, column 37: not read of the style sheet: \"a + b\"",
                "line 2, column 23: not read of the style sheet: \"media='tv'\"",
                "line 2, column 42: not read of the style sheet: \"type='text/less'\"",
            ]
        );
        let many: Vec<String> = (0..7).map(|k| k.to_string()).collect();
        assert_eq!(listed(&many), "\"0\", \"1\", \"2\", \"3\", \"4\" and 2 more");
        let moving = asked("<path style='rotate:3deg' rotate='4'/>", Styles::moving);
        assert_eq!((moving, asked("<path rotate='4'/>", Styles::moving)), (Some("rotate"), None));
    }

    #[test]
    fn what_is_hidden_filled_and_moved() {
        let hides = |content: &str| asked(content, Styles::hides);
        assert_eq!(hides("<style>.h{display:none}</style><path class='h'/>"), Some("display: none"));
        assert_eq!(hides("<path opacity='0'/>"), Some("opacity: 0"));
        assert_eq!(hides("<path opacity='0'><animate attributeName='opacity'/></path>"), None);
        assert_eq!(hides("<path opacity='0.01'/>"), None);
        let invisible = |content: &str| asked(content, Styles::is_invisible);
        assert!(invisible("<g visibility='hidden'><path/></g>"));
        assert!(!invisible("<g visibility='hidden'><path style='visibility:visible'/></g>"));
        assert!(!invisible("<path visibility='hidden'><animate attributeName='visibility'/></path>"));
        let filled = |content: &str| asked(content, Styles::is_filled);
        assert!(filled("<path/>") && filled("<g fill='none'><path fill='#f00'/></g>"));
        assert!(!filled("<g fill='none'><path fill='inherit'/></g>") && !filled("<path fill-opacity='0'/>"));
    }
}
