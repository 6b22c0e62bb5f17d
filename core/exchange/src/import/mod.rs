//! What other programs made: shapes, as keys of parts, and motions, as skeleton clips.
//!
//! - [`bvh`]: motion capture
//! - [`svg`]: paths and basic shapes, still or animated
//! - `svg_animation`: the keys of animated paths
//! - [`silhouette`]: Silhouette shapes
//! - [`path`](mod@path): Bézier paths as contours with one number of points
//! - [`problem`]: what is wrong with a file, and where

pub mod bvh;
pub mod path;
pub mod problem;
pub mod silhouette;
pub mod svg;
mod svg_animation;

pub use problem::{ImportError, Place};

use rototoon_base::geometry::Point;
use rototoon_base::scene::{FrameNumber, Part, Scene};
use std::collections::BTreeMap;

/// A shape as a part's contour: on each key as many points.
#[derive(Clone, Debug, PartialEq)]
pub struct Shape {
    /// Name; that of no other shape of the file.
    pub name: String,
    /// Whether the last point joins the first.
    pub closed: bool,
    /// Points by frame, in pixels of the footage.
    pub keys: BTreeMap<FrameNumber, Vec<Point>>,
}

/// What a file holds.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Shapes {
    /// The shapes, the farthest first.
    pub shapes: Vec<Shape>,
    /// What has been left out, a line each.
    pub warnings: Vec<String>,
}

/// Puts shapes into the scene. A part of a shape's name becomes the shape, at its own depth: its keys, corrections and
/// results go. Other shapes become new parts, nearer than all that are there, in their order.
pub fn into_scene(scene: &mut Scene, shapes: Vec<Shape>) {
    let nearest = scene.parts.iter().map(|part| part.depth).fold(f64::NEG_INFINITY, f64::max);
    let mut depth = if nearest.is_finite() { nearest.floor() + 1.0 } else { 0.0 };
    for Shape { name, closed, keys } in shapes {
        if let Some(part) = scene.parts.iter_mut().find(|part| part.name == name) {
            *part = Part { name, closed, keys, depth: part.depth, ..Part::default() };
        } else {
            scene.parts.push(Part { name, closed, keys, depth, ..Part::default() });
            depth += 1.0;
        }
    }
}

/// A name that no shape has yet.
fn free_name(wanted: &str, shapes: &[Shape]) -> String {
    let wanted = if wanted.trim().is_empty() { "shape" } else { wanted.trim() };
    let taken = |name: &String| shapes.iter().any(|shape| shape.name == *name);
    let mut names = std::iter::once(wanted.to_owned()).chain((2u64..).map(|number| format!("{wanted} {number}")));
    names.find(|name| !taken(name)).unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::*;
    use rototoon_base::scene::Footage;

    #[test]
    fn a_part_of_the_name_becomes_the_shape_and_others_lie_in_front() {
        let shape = |name: &str| Shape {
            name: name.into(),
            closed: true,
            keys: BTreeMap::from([(2, vec![Point::ONE, Point::X, Point::Y])]),
        };
        let old = Part {
            name: "arm".into(),
            depth: 3.5,
            tracks: BTreeMap::from([(1, vec![Point::ZERO])]),
            ..Part::default()
        };
        let footage = Footage { pattern: "%d".into(), first: 0, last: 9, fps: 1.0, width: 9, height: 9 };
        let mut scene = Scene { footage, parts: vec![old] };
        into_scene(&mut scene, vec![shape("leg"), shape("arm"), shape("head")]);
        let found: Vec<_> = scene.parts.iter().map(|part| (part.name.as_str(), part.depth)).collect();
        assert_eq!(found, [("arm", 3.5), ("leg", 4.0), ("head", 5.0)]);
        assert!(scene.parts[0].tracks.is_empty() && scene.parts[0].closed);
    }
}
