//! View boxes of SVG documents: from units of an element to those around it.
//!
//! Source: W3C, Scalable Vector Graphics (SVG) 2, chapter on coordinate systems, "Computing the equivalent transform of an SVG
//! viewport".

use super::ImportError;
use super::problem::quoted;
use rototoon_base::scene::Footage;
use roxmltree::Node;
use std::str::FromStr;
use svgtypes::{Align, AspectRatio, Transform, ViewBox};

/// Greatest relative difference between the aspect ratios of document and footage.
const PROPORTIONS: f64 = 0.005;

/// Width and height of the part of the plane that an element shows, in its own units.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct View {
    width: f64,
    height: f64,
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
        None => match (pixels(root, "width")?, pixels(root, "height")?) {
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
    let place = |name: &str| Ok::<_, ImportError>(super::problem::number(node, name)?.unwrap_or_default());
    let (x, y) = (place("x")?, place("y")?);
    let width = pixels(node, "width")?.unwrap_or(outer.width);
    let height = pixels(node, "height")?.unwrap_or(outer.height);
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

/// A length in pixels; `None` if the attribute is missing or a percentage.
fn pixels(node: Node, name: &str) -> Result<Option<f64>, ImportError> {
    let Some(text) = node.attribute(name) else { return Ok(None) };
    let text = text.trim();
    let plain = text.strip_suffix("px").unwrap_or(text);
    match plain.parse::<f64>() {
        Ok(value) if value.is_finite() && value > 0.0 => Ok(Some(value)),
        _ if text.ends_with('%') => Ok(None),
        _ => Err(ImportError::at(node, format!("{name}: found {text:?}, expected pixels"))),
    }
}
