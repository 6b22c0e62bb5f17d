//! Animations of an SVG document that an import does not read. What moves, changes or goes by them would stand still without a word.

use super::problem::quoted;
use super::svg_animation::{problem, seconds};
use super::svg_elements::SHAPES;
use rototoon_base::scene::Footage;
use roxmltree::Node;

/// Properties of the form, and of where it is.
const FORM: [&str; 15] =
    ["d", "points", "x", "y", "width", "height", "cx", "cy", "r", "rx", "ry", "x1", "y1", "x2", "y2"];
/// Properties by which something comes and goes.
const PRESENCE: [&str; 3] = ["visibility", "opacity", "display"];
/// What is read of shapes. A group has none of it.
const READ: [&str; 3] = ["d", "visibility", "opacity"];

/// What is not read of an element's own animations, in words. `called` is the element's name.
pub(super) fn unread(node: Node, called: &str, footage: &Footage) -> Vec<String> {
    let mut seen: Vec<&str> = Vec::new();
    let mut found = Vec::new();
    for child in node.children().filter(Node::is_element) {
        let Some(property) = child.attribute("attributeName").map(str::trim) else { continue };
        let element = child.tag_name().name();
        if !["animate", "set"].contains(&element) || !(FORM.contains(&property) || PRESENCE.contains(&property)) {
            continue;
        }
        let is_first = !seen.contains(&property);
        let is_read = element == "animate" && READ.contains(&property) && SHAPES.contains(&node.tag_name().name());
        let why = if !is_read || !is_first {
            Some("which is not read".into())
        } else if PRESENCE.contains(&property) {
            problem(node, property, footage).or_else(|| late(child))
        } else {
            // Whether it can be read is told with the shape.
            late(child)
        };
        if is_read {
            seen.push(property);
        }
        found.extend(why.map(|why: String| format!("{called:?} has an `{element}` of `{property}`, {why}")));
    }
    found
}

/// Why an animation does not begin where it is taken to.
fn late(animate: Node) -> Option<String> {
    let begin = animate.attribute("begin").map(str::trim)?;
    let zero = begin.strip_suffix("ms").or_else(|| begin.strip_suffix('s')).unwrap_or(begin).parse() == Ok(0.0);
    let first = "it is taken to begin with the first frame";
    (!zero).then(|| match seconds(begin) {
        Some(_) => format!("of which begin={} is not read: {first}", quoted(Some(begin))),
        None => format!("of which begin={} cannot be read: {first}", quoted(Some(begin))),
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use roxmltree::Document;

    fn told(text: &str) -> Vec<String> {
        let footage =
            Footage { pattern: "%d".into(), first: 5, last: 14, fps: 10.0, width: 20, height: 10, held: false };
        let document = Document::parse(text).unwrap();
        unread(document.root_element(), "a", &footage)
    }

    #[test]
    fn what_is_read_is_not_told() {
        let fade = "<animate attributeName='opacity' values='0;1' dur='1s' begin='0s'/>";
        let shown = "<animate attributeName='visibility' values='hidden;visible' dur='1s'/>";
        let form = "<animate attributeName='d' values='M0 0h1;M0 0h2' dur='1s'/>";
        assert!(told(&format!("<path>{fade}{shown}{form}<title>t</title></path>")).is_empty());
        assert!(
            told("<path><animate attributeName='fill' values='red;blue'/><set attributeName='stroke'/></path>")
                .is_empty()
        );
    }

    #[test]
    fn what_is_not_read_is_told() {
        for (text, said) in [
            (
                "<path><set attributeName='visibility' to='hidden' begin='1s'/></path>",
                "`set` of `visibility`, which is not read",
            ),
            ("<path><set attributeName='d' to='M0 0h9'/></path>", "`set` of `d`, which is not read"),
            (
                "<circle><animate attributeName='cx' values='0;9' dur='1s'/></circle>",
                "`animate` of `cx`, which is not read",
            ),
            (
                "<g><animate attributeName='opacity' values='0;1' dur='1s'/></g>",
                "`animate` of `opacity`, which is not read",
            ),
            (
                "<path><animate attributeName='opacity' values='0;1' dur='indefinite'/></path>",
                "dur: found \"indefinite\"",
            ),
            ("<path><animate attributeName='visibility' dur='1s'/></path>", "values: found nothing"),
            (
                "<path><animate attributeName='d' values='M0 0;M1 0' dur='1s' begin='0.5s'/></path>",
                "of which begin=\"0.5s\" is not read",
            ),
            (
                "<path><animate attributeName='d' values='M0 0;M1 0' dur='1s' begin='a.click'/></path>",
                "begin=\"a.click\" cannot be read",
            ),
        ] {
            let found = told(text);
            assert!(
                found.len() == 1 && found[0].starts_with("\"a\" has an ") && found[0].contains(said),
                "{text}: {found:?}"
            );
        }
        let twice = "<animate attributeName='opacity' values='0;1' dur='1s'/>";
        assert_eq!(
            told(&format!("<path>{twice}{twice}</path>")),
            ["\"a\" has an `animate` of `opacity`, which is not read"]
        );
    }
}
