//! How an SVG document shows an element, as far as it matters for its outline.
//!
//! A property is, from the strongest to the weakest, a declaration in the attribute `style`, one of a style sheet of the document, or
//! an attribute of its own. Of a style sheet, rules for an element's name, a class or an id are read. `fill` and `visibility` are those of
//! the nearest element around that has one; `display` and `opacity` of an element hide all in it.
//!
//! Source: W3C, Scalable Vector Graphics (SVG) 2, chapters on styling and rendering; CSS 2.2, on specificity.

use roxmltree::{Document, Node};

/// What a rule of a style sheet is for.
#[derive(Clone, Debug, PartialEq, Eq)]
enum Selector {
    Element(String),
    Class(String),
    Id(String),
}

impl Selector {
    fn read(text: &str) -> Option<Self> {
        let text = text.trim();
        let name = text.trim_start_matches(['.', '#']);
        let plain = !name.is_empty() && name.chars().all(|c| c.is_alphanumeric() || "-_".contains(c));
        plain.then(|| match text.as_bytes()[0] {
            b'.' => Self::Class(name.to_owned()),
            b'#' => Self::Id(name.to_owned()),
            _ => Self::Element(name.to_owned()),
        })
    }

    fn fits(&self, node: Node) -> bool {
        match self {
            Self::Element(name) => node.tag_name().name() == name,
            Self::Class(name) => {
                node.attribute("class").is_some_and(|own| own.split_whitespace().any(|own| own == name))
            }
            Self::Id(name) => node.attribute("id") == Some(name),
        }
    }
}

/// The style sheets of a document.
#[derive(Debug, Default)]
pub(super) struct Styles {
    /// Selectors with a property and its value, the weakest first.
    rules: Vec<(Selector, String, String)>,
}

/// The declarations in a text: properties in small letters, and values.
fn declarations(text: &str) -> impl Iterator<Item = (String, &str)> {
    text.split(';').filter_map(|text| {
        let (name, value) = text.split_once(':')?;
        let value = value.trim();
        Some((name.trim().to_ascii_lowercase(), value.strip_suffix("!important").unwrap_or(value).trim()))
    })
}

impl Styles {
    /// Reads the style sheets of a document.
    pub fn of(document: &Document) -> Self {
        let mut rules = Vec::new();
        let sheets = document.descendants().filter(|node| node.is_element() && node.tag_name().name() == "style");
        for sheet in sheets.filter_map(|node| node.text()) {
            for rule in without_comments(sheet).split('}') {
                let Some((selectors, body)) = rule.split_once('{') else { continue };
                for selector in selectors.split(',').filter_map(Selector::read) {
                    let own = declarations(body).map(|(name, value)| (selector.clone(), name, value.to_owned()));
                    rules.extend(own);
                }
            }
        }
        // The kind of selector decides, then the place in the document.
        rules.sort_by_key(|(selector, ..)| match selector {
            Selector::Element(_) => 0,
            Selector::Class(_) => 1,
            Selector::Id(_) => 2,
        });
        Self { rules }
    }

    /// The value of a property that an element has itself.
    fn own<'a>(&'a self, node: Node<'a, '_>, property: &str) -> Option<&'a str> {
        let styled = node
            .attribute("style")
            .and_then(|text| declarations(text).filter(|(name, _)| name == property).last().map(|(_, value)| value));
        let ruled = || {
            let mut fitting = self.rules.iter().rev().filter(|(_, name, _)| name == property);
            fitting.find(|(selector, ..)| selector.fits(node)).map(|(.., value)| value.as_str())
        };
        styled.or_else(ruled).or_else(|| node.attribute(property).map(str::trim))
    }

    /// The value of a property that elements inherit.
    fn inherited<'a>(&'a self, node: Node<'a, '_>, property: &str) -> Option<&'a str> {
        node.ancestors()
            .filter(Node::is_element)
            .find_map(|node| self.own(node, property).filter(|value| *value != "inherit"))
    }

    /// Why an element and all in it is not shown: `display` or `opacity`. An opacity that changes counts as shown.
    pub fn hides(&self, node: Node) -> Option<&'static str> {
        if self.own(node, "display") == Some("none") {
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

    /// The transformations of an element as those of the attribute `transform` are written; `None` without any.
    pub fn transform(&self, node: Node) -> Option<String> {
        let own = self.own(node, "transform").filter(|text| *text != "none")?;
        // CSS has units, which the attribute lacks.
        Some(own.replace("px", "").replace("deg", ""))
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

fn without_comments(sheet: &str) -> String {
    let mut pieces = sheet.split("/*");
    let first = pieces.next().unwrap_or("").to_owned();
    pieces.fold(first, |text, piece| text + piece.split_once("*/").map_or("", |(_, after)| after))
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
        let sheet =
            "<style>/* .a{fill:none} */ path { fill: red } #b{fill:none}.a, g > p{fill:blue !important}</style>";
        let fill =
            |path: &str| asked(&format!("{sheet}{path}"), |styles, node| styles.own(node, "fill").map(str::to_owned));
        assert_eq!(fill("<path fill='none'/>").as_deref(), Some("red"));
        assert_eq!(fill("<path class='x a'/>").as_deref(), Some("blue"));
        assert_eq!(fill("<path class='a' id='b'/>").as_deref(), Some("none"));
        assert_eq!(fill("<path class='a' id='b' style='Fill : green; x'/>").as_deref(), Some("green"));
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
        let moved = asked("<path style='transform:translate(50px,60px) rotate(3deg)'/>", Styles::transform);
        assert_eq!(moved.as_deref(), Some("translate(50,60) rotate(3)"));
    }
}
