//! Where an element of an SVG document stands: its transformation about its origin.
//!
//! `transform` and `transform-origin` are attributes or declarations. A style has units, shares, and functions that an attribute lacks. Keywords and shares
//! refer to the reference box (`transform-box`): what the nearest `svg` shows (`view-box`, if nothing is said), or the element's own box without its stroke
//! (`fill-box`, `content-box`). Without an origin an element turns about 0, 0 of the units around it, as SVG says for all that has no box of
//! style sheets.
//!
//! **How.** The box of a group is that of all outlines in it, where its own units place them. So the paths are collected from the inside out, each moved
//! once for each group around it, and the box is found from their extremes and not from boxes of boxes.
//!
//! Limits: boxes with strokes, and boxes of text, pictures and `use`, are not known. Such elements are refused, since they would be in the wrong place.
//!
//! Source: W3C, CSS Transforms Module Level 1.

use super::ImportError;
use super::limits::Points;
use super::path::Path;
use super::problem::quoted;
use super::svg_elements::{GROUPS, NOT_DRAWN, WITHOUT_OUTLINE};
use super::svg_length::scaled;
use super::svg_outline::{outline, paths};
use super::svg_style::Styles;
use super::svg_view::{View, nested};
use rototoon_base::geometry::Point;
use roxmltree::Node;
use std::str::FromStr;
use svgtypes::Transform;

/// What boxes need.
pub(super) struct Places<'a> {
    pub styles: &'a Styles,
    pub points: &'a mut Points,
}

/// A reference box: its least corner and its size.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Frame {
    at: Point,
    size: Point,
}

impl Places<'_> {
    /// The transformation of an element, from its units to those around it.
    pub fn own(&mut self, node: Node, view: &View) -> Result<Transform, ImportError> {
        let Some(text) = self.styles.own(node, "transform").filter(|text| *text != "none") else {
            return Ok(Transform::default());
        };
        let wrong =
            || ImportError::at(node, format!("transform: found {}, expected transformations", quoted(Some(text))));
        let origin = self.styles.own(node, "transform-origin");
        let needs = origin.is_some() || text.contains('%');
        let frame = if needs { self.frame(node, view)? } else { Frame { at: Point::ZERO, size: Point::ZERO } };
        let own = Transform::from_str(text).ok().or_else(|| functions(text, frame.size)).ok_or_else(wrong)?;
        let Some(origin) = origin else { return finite(own).ok_or_else(wrong) };
        let offset = place(origin, frame.size).ok_or_else(|| {
            let found = quoted(Some(origin));
            ImportError::at(
                node,
                format!("transform-origin: found {found}, expected lengths, shares or words such as center"),
            )
        })?;
        let about = frame.at + offset;
        let there = Transform::new(1.0, 0.0, 0.0, 1.0, about.x, about.y);
        let back = Transform::new(1.0, 0.0, 0.0, 1.0, -about.x, -about.y);
        finite(joined(there, joined(own, back))).ok_or_else(wrong)
    }

    /// The reference box of an element.
    fn frame(&mut self, node: Node, view: &View) -> Result<Frame, ImportError> {
        match self.styles.own(node, "transform-box").unwrap_or("view-box") {
            "view-box" => Ok(Frame { at: Point::ZERO, size: Point::new(view.width, view.height) }),
            "fill-box" | "content-box" => {
                let paths = self.outlines(node, view)?;
                let ends = paths.iter().flat_map(Path::extremes);
                let (low, high) =
                    ends.fold((Point::INFINITY, Point::NEG_INFINITY), |(low, high), p| (low.min(p), high.max(p)));
                if low.x > high.x {
                    return Err(ImportError::at(
                        node,
                        "transform-box: found nothing in the element, expected outlines",
                    ));
                }
                Ok(Frame { at: low, size: high - low })
            }
            other => {
                let found = quoted(Some(other));
                Err(ImportError::at(
                    node,
                    format!("transform-box: found {found}, expected view-box, fill-box or content-box"),
                ))
            }
        }
    }

    /// The outlines of an element and of all in it, in its own units.
    fn outlines(&mut self, node: Node, view: &View) -> Result<Vec<Path>, ImportError> {
        let name = node.tag_name().name();
        if WITHOUT_OUTLINE.contains(&name) {
            return Err(ImportError::at(
                node,
                "transform-box: found an element without outline in it, expected outlines",
            ));
        }
        if let Some(text) = outline(node, self.styles, view)? {
            return paths(node, &text, self.points);
        }
        let mut found = Vec::new();
        for child in node.children().filter(Node::is_element) {
            let name = child.tag_name().name();
            let is_away = NOT_DRAWN.contains(&name) || self.styles.is_away(child);
            if is_away
                || !GROUPS.contains(&name)
                    && !WITHOUT_OUTLINE.contains(&name)
                    && outline(child, self.styles, view)?.is_none()
            {
                continue;
            }
            let (inner, within) = match name {
                "svg" => nested(child, view)?,
                _ => (*view, Transform::default()),
            };
            let mut paths = self.outlines(child, &inner)?;
            let own = joined(self.own(child, view)?, within);
            paths.iter_mut().flat_map(Path::points_mut).for_each(|p| *p = moved(*p, own));
            found.extend(paths);
        }
        Ok(found)
    }
}

fn finite(t: Transform) -> Option<Transform> {
    [t.a, t.b, t.c, t.d, t.e, t.f].iter().all(|number| number.is_finite()).then_some(t)
}

/// The transformations of a style. Shares of a way are those of a box of this size.
fn functions(text: &str, size: Point) -> Option<Transform> {
    let mut all = Transform::default();
    let mut rest = text.trim();
    while !rest.is_empty() {
        let (name, after) = rest.split_once('(')?;
        let (inner, behind) = after.split_once(')')?;
        let arguments: Vec<&str> = inner.split([',', ' ', '\t', '\n', '\r']).filter(|text| !text.is_empty()).collect();
        all = joined(all, function(name.trim(), &arguments, size)?);
        rest = behind.trim_start_matches(|c: char| c.is_whitespace() || c == ',');
    }
    Some(all)
}

fn function(name: &str, arguments: &[&str], size: Point) -> Option<Transform> {
    let number =
        |text: &&str| text.parse::<f64>().ok().or_else(|| Some(text.strip_suffix('%')?.parse::<f64>().ok()? / 100.0));
    let turned = |angle: f64| Transform::new(angle.cos(), angle.sin(), -angle.sin(), angle.cos(), 0.0, 0.0);
    let shifted = |x: f64, y: f64| Transform::new(1.0, 0.0, 0.0, 1.0, x, y);
    let scaled_by = |x: f64, y: f64| Transform::new(x, 0.0, 0.0, y, 0.0, 0.0);
    let skewed = |x: f64, y: f64| Transform::new(1.0, y.tan(), x.tan(), 1.0, 0.0, 0.0);
    Some(match (name.to_ascii_lowercase().as_str(), arguments) {
        ("matrix", [..]) => match arguments.iter().map(number).collect::<Option<Vec<f64>>>()?[..] {
            [a, b, c, d, e, f] => Transform::new(a, b, c, d, e, f),
            _ => return None,
        },
        ("translate" | "translatex", [x]) => shifted(scaled(x, size.x)?, 0.0),
        ("translatey", [y]) => shifted(0.0, scaled(y, size.y)?),
        ("translate", [x, y]) => shifted(scaled(x, size.x)?, scaled(y, size.y)?),
        ("scale", [both]) => scaled_by(number(both)?, number(both)?),
        ("scale", [x, y]) => scaled_by(number(x)?, number(y)?),
        ("scalex", [x]) => scaled_by(number(x)?, 1.0),
        ("scaley", [y]) => scaled_by(1.0, number(y)?),
        ("rotate" | "rotatez", [by]) => turned(angle(by)?),
        ("skewx" | "skew", [x]) => skewed(angle(x)?, 0.0),
        ("skewy", [y]) => skewed(0.0, angle(y)?),
        ("skew", [x, y]) => skewed(angle(x)?, angle(y)?),
        _ => return None,
    })
}

/// An angle in radians.
fn angle(text: &str) -> Option<f64> {
    let text = text.to_ascii_lowercase();
    let units = [("grad", 400.0), ("turn", 1.0), ("rad", std::f64::consts::TAU), ("deg", 360.0), ("", 360.0)];
    let (number, turn) = units.iter().find_map(|(unit, turn)| Some((text.strip_suffix(unit)?, turn)))?;
    Some(number.parse::<f64>().ok()? / turn * std::f64::consts::TAU)
}

/// The place in a box of this size that an origin says.
fn place(text: &str, size: Point) -> Option<Point> {
    let words: Vec<&str> = text.split_whitespace().collect();
    let (first, second) = match words[..] {
        [one] => (one, "center"),
        // The third is a depth.
        [first, second] | [first, second, _] => (first, second),
        _ => return None,
    };
    let is = |word: &str, names: [&str; 2]| names.iter().any(|name| word.eq_ignore_ascii_case(name));
    let swapped = is(first, ["top", "bottom"]) || is(second, ["left", "right"]);
    let (x, y) = if swapped { (second, first) } else { (first, second) };
    let along = |word: &str, [low, high]: [&str; 2], size: f64| match word.to_ascii_lowercase().as_str() {
        word if word == low => Some(0.0),
        word if word == high => Some(size),
        "center" => Some(0.5 * size),
        word => scaled(word, size),
    };
    Some(Point::new(along(x, ["left", "right"], size.x)?, along(y, ["top", "bottom"], size.y)?))
}

/// The transformation that applies `inner` first, then `outer`.
pub(super) fn joined(outer: Transform, inner: Transform) -> Transform {
    let (o, i) = (outer, inner);
    Transform::new(
        o.a * i.a + o.c * i.b,
        o.b * i.a + o.d * i.b,
        o.a * i.c + o.c * i.d,
        o.b * i.c + o.d * i.d,
        o.a * i.e + o.c * i.f + o.e,
        o.b * i.e + o.d * i.f + o.f,
    )
}

pub(super) fn moved(p: Point, t: Transform) -> Point {
    Point::new(t.a * p.x + t.c * p.y + t.e, t.b * p.x + t.d * p.y + t.f)
}

#[cfg(test)]
mod tests {
    use super::*;
    use roxmltree::Document;

    /// Where the transformation of the first element with an id puts its point 10, 20 in a view of 200 × 100.
    fn put(content: &str) -> Result<[f64; 2], String> {
        let text = format!("<svg>{content}</svg>");
        let document = Document::parse(&text).unwrap();
        let node = document.descendants().find(|node| node.has_attribute("id")).unwrap();
        let (styles, mut points) = (Styles::of(&document), Points::all());
        let own = Places { styles: &styles, points: &mut points }.own(node, &View { width: 200.0, height: 100.0 });
        let p = moved(Point::new(10.0, 20.0), own.map_err(|error| error.to_string())?);
        Ok([p.x, p.y].map(|x| (x * 1e6).round() / 1e6))
    }

    #[test]
    fn an_origin_is_a_length_a_share_or_a_word() {
        let turned = |more: &str| {
            put(&format!("<path id='a' d='M0 0H40V10C40 50 0 50 0 10Z' transform='rotate(90)' {more}/>")).unwrap()
        };
        // About x, y the point goes to x + y - 20, y - x + 10.
        let about = |x: f64, y: f64| [x + y - 20.0, y - x + 10.0];
        for (more, origin) in [
            ("", [0.0, 0.0]),
            ("transform-origin='150 20'", [150.0, 20.0]),
            ("style='transform-origin:25% 10px'", [50.0, 10.0]),
            ("style='transform-origin: center'", [100.0, 50.0]),
            ("style='transform-origin: bottom'", [100.0, 100.0]),
            ("style='transform-origin:top right 3px'", [200.0, 0.0]),
            ("style='transform-origin:1in left'", [0.0, 96.0]),
            ("style='transform-origin:50% 100%;transform-box:view-box'", [100.0, 100.0]),
            // The curve reaches three quarters of the way to its handles.
            ("style='transform-origin:center;transform-box:fill-box'", [20.0, 20.0]),
            ("style='transform-origin:100% 0;transform-box:fill-box'", [40.0, 0.0]),
        ] {
            assert_eq!(turned(more), about(origin[0], origin[1]), "{more}");
        }
    }

    #[test]
    fn the_box_of_a_group_has_all_that_is_drawn_in_it() {
        let group = "<g id='a' transform='scale(2)' style='transform-box:fill-box;transform-origin:right bottom'>\
            <rect width='10' height='10' transform='translate(20 5)'/><g transform='rotate(90)'><path d='M0 0H30V-8Z'/></g>\
            <rect width='500' height='5' display='none'/><defs><rect width='900' height='5'/></defs><title>t</title></g>";
        // The box is 0, 0 to 30, 30.
        assert_eq!(put(group), Ok([-10.0, 10.0]));
        let inner = group.replace(
            "<g transform='rotate(90)'>",
            "<g transform='rotate(90)' style='transform-origin:0 0;transform-box:fill-box'>",
        );
        // The inner group turns about 0, -8.
        assert_eq!(put(&inner), Ok([2.0 * 10.0 - 30.0, 2.0 * 20.0 - 22.0]));
        for (from, to, said) in [
            ("<title>t</title>", "<text>t</text>", "<text>: transform-box: found an element without outline"),
            ("fill-box", "stroke-box", "transform-box: found \"stroke-box\", expected view-box, fill-box"),
            ("right bottom", "right left", "transform-origin: found \"right left\", expected lengths"),
            ("scale(2)", "scale(two)", "transform: found \"scale(two)\", expected transformations"),
            ("scale(2)", "scale(1e999)", "transform: found \"scale(1e999)\""),
        ] {
            let error = put(&group.replace(from, to)).unwrap_err();
            assert!(error.contains(said), "{error}");
        }
        assert!(
            put("<g id='a' style='transform:scale(2);transform-box:fill-box;transform-origin:0 0'/>")
                .unwrap_err()
                .contains("found nothing")
        );
    }

    #[test]
    fn functions_of_a_style_have_units_and_shares() {
        let styled = |text: &str| put(&format!("<path id='a' style='transform:{text}'/>"));
        for (text, found) in [
            ("translate(50px,60px) rotate(180deg)", [40.0, 40.0]),
            ("translate(10%, 1in)", [30.0, 116.0]),
            ("translateX(5px) translateY(-1px)", [15.0, 19.0]),
            ("scale(2) scaleX(3) scaleY(50%)", [60.0, 20.0]),
            ("rotate(.25turn)", [-20.0, 10.0]),
            ("rotate(100grad)", [-20.0, 10.0]),
            ("rotate(-1.5707963267948966rad)", [20.0, -10.0]),
            ("skew(45deg, 0)", [30.0, 20.0]),
            ("skewY(45deg)", [10.0, 30.0]),
            ("matrix(1,0,0,1,5,6)", [15.0, 26.0]),
            ("none", [10.0, 20.0]),
        ] {
            assert_eq!(styled(text), Ok(found), "{text}");
        }
        for text in ["rotate3d(1,1,1,45deg)", "translate(1em)", "scale(2", "matrix(1,2)", "perspective(3px)"] {
            assert!(styled(text).unwrap_err().contains("expected transformations"), "{text}");
        }
    }
}
