//! View boxes of SVG documents: from units of an element to those around it.
//!
//! Source: W3C, Scalable Vector Graphics (SVG) 2, chapter on coordinate systems, "Computing the equivalent transform of an SVG
//! viewport".

use super::ImportError;
use super::problem::quoted;
use super::svg_length::{Along, length, scaled};
use rototoon_base::scene::Footage;
use roxmltree::Node;
use std::str::FromStr;
use svgtypes::{Align, AspectRatio, Transform, ViewBox};

/// Greatest relative difference between the aspect ratios of document and footage.
const PROPORTIONS: f64 = 0.005;

/// Width and height of the part of the plane that an element shows, in its own units.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct View {
    pub width: f64,
    pub height: f64,
}

fn view_box(node: Node) -> Result<Option<ViewBox>, ImportError> {
    let read = |text: &str| {
        ViewBox::from_str(text).map_err(|error| {
            ImportError::at(node, format!("viewBox: found {}, expected four numbers ({error})", quoted(Some(text))))
        })
    };
    node.attribute("viewBox").map(read).transpose()
}

/// What a document shows, and the transformation from its units to pixels of the footage.
pub(super) fn viewed(root: Node, footage: &Footage) -> Result<(View, Transform), ImportError> {
    let view = match view_box(root)? {
        Some(view) => view,
        None => match (side(root, "width")?, side(root, "height")?) {
            (Some(width), Some(height)) => ViewBox::new(0.0, 0.0, width, height),
            _ => ViewBox::new(0.0, 0.0, footage.width as f64, footage.height as f64),
        },
    };
    let (x, y) = (footage.width as f64 / view.w, footage.height as f64 / view.h);
    if !(x > 0.0 && y > 0.0) || (x / y - 1.0).abs() > PROPORTIONS {
        let (width, height) = (footage.width, footage.height);
        let message =
            format!("found a picture of {}x{}, expected the footage's proportions, {width}x{height}", view.w, view.h);
        return Err(ImportError::at(root, message));
    }
    let shown = View { width: view.w, height: view.h };
    Ok((shown, Transform::new(x, 0.0, 0.0, y, -view.x * x, -view.y * y)))
}

/// What a nested `svg` shows, and the transformation from its units to those around it. `outer` is what is shown there.
pub(super) fn nested(node: Node, outer: &View) -> Result<(View, Transform), ImportError> {
    let place =
        |name: &str, along| node.attribute(name).map_or(Ok(0.0), |text| read(node, name, length(text, outer, along)));
    let (x, y) = (place("x", Along::X)?, place("y", Along::Y)?);
    let size = |name: &str, along| {
        let text = node.attribute(name).filter(|text| text.trim() != "auto").unwrap_or("100%");
        read(node, name, length(text, outer, along).filter(|side| *side > 0.0))
    };
    let (width, height) = (size("width", Along::X)?, size("height", Along::Y)?);
    let Some(view) = view_box(node)? else {
        return Ok((View { width, height }, Transform::new(1.0, 0.0, 0.0, 1.0, x, y)));
    };
    let AspectRatio { align, slice, .. } =
        node.attribute("preserveAspectRatio").and_then(|text| text.parse().ok()).unwrap_or_default();
    let (mut along, mut down) = (width / view.w, height / view.h);
    if align != Align::None {
        let scale = if slice { along.max(down) } else { along.min(down) };
        (along, down) = (scale, scale);
    }
    let [right, below] = shares(align);
    let (dx, dy) = (right * (width - along * view.w), below * (height - down * view.h));
    let shown = View { width: view.w, height: view.h };
    Ok((shown, Transform::new(along, 0.0, 0.0, down, x + dx - along * view.x, y + dy - down * view.y)))
}

/// Which share of the free room lies to the left of a view box, and which above it.
fn shares(align: Align) -> [f64; 2] {
    match align {
        Align::None | Align::XMinYMin => [0.0, 0.0],
        Align::XMidYMin => [0.5, 0.0],
        Align::XMaxYMin => [1.0, 0.0],
        Align::XMinYMid => [0.0, 0.5],
        Align::XMidYMid => [0.5, 0.5],
        Align::XMaxYMid => [1.0, 0.5],
        Align::XMinYMax => [0.0, 1.0],
        Align::XMidYMax => [0.5, 1.0],
        Align::XMaxYMax => [1.0, 1.0],
    }
}

/// A side of the document in pixels; `None` if the attribute is missing or a share of what is around the document.
fn side(node: Node, name: &str) -> Result<Option<f64>, ImportError> {
    let text = node.attribute(name).map(str::trim).filter(|text| *text != "auto" && !text.ends_with('%'));
    text.map(|text| read(node, name, scaled(text, 0.0).filter(|side| *side > 0.0))).transpose()
}

/// A length that was read.
fn read(node: Node, name: &str, length: Option<f64>) -> Result<f64, ImportError> {
    let found = || quoted(node.attribute(name));
    length.ok_or_else(|| {
        ImportError::at(node, format!("{name}: found {}, expected pixels or a length such as 5mm", found()))
    })
}
