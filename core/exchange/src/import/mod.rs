//! Imports files of other programs: shapes become keys of parts, motions become skeleton clips.
//!
//! - [`bvh`]: motion capture
//! - [`svg`]: paths and basic shapes, still or animated
//! - `svg_animation`: the keys of animated paths
//! - `svg_outline`: outlines of elements
//! - `svg_style`: what is hidden or filled
//! - `svg_view`: view boxes
//! - [`silhouette`]: Silhouette shapes
//! - [`nuke`](mod@nuke): shapes of Nuke's Roto and RotoPaint nodes
//! - [`natron`](mod@natron): shapes of Natron's Roto and RotoPaint nodes
//! - [`fusion`](mod@fusion): polygon masks of Fusion
//! - [`path`](mod@path): Bézier paths as contours with one number of points
//! - [`problem`]: errors of a file, with their places
//! - `channel`: numbers that may be animated
//! - `hidden`: frames on which a shape is not shown
//! - `range`: keys beyond the footage
//! - `limits`: what a file may ask for
//! - `names`: names of shapes, each once

pub mod bvh;
mod channel;
pub mod fusion;
mod hidden;
mod limits;
mod names;
pub mod natron;
pub mod nuke;
pub mod path;
#[cfg(test)]
mod probes;
pub mod problem;
mod range;
pub mod silhouette;
pub mod svg;
mod svg_animation;
mod svg_outline;
mod svg_style;
mod svg_view;

pub use limits::too_large;
pub use problem::{ImportError, Place};

use rototoon_base::geometry::Point;
use rototoon_base::scene::{Falloff, Footage, FrameNumber, Part, Scene};
use std::collections::BTreeMap;

/// A shape as the contour of a part. Every key has the same number of points.
#[derive(Clone, Debug, PartialEq)]
pub struct Shape {
    /// Name, unique within the file.
    pub name: String,
    /// Whether the last point joins the first.
    pub closed: bool,
    /// Points by frame, in pixels of the footage.
    pub keys: BTreeMap<FrameNumber, Vec<Point>>,
    /// Frames on which the file does not show it, as the first and the last of each time.
    pub absent: Vec<[FrameNumber; 2]>,
    /// How its border falls off where it is soft.
    pub falloff: Falloff,
}

impl Shape {
    /// A shape with its keys. `hidden` are times in which the file does not show it. Says so if it is never shown.
    fn new(
        (name, closed): (String, bool),
        mut keys: BTreeMap<FrameNumber, Vec<Point>>,
        hidden: &[[f64; 2]],
        footage: &Footage,
    ) -> (Self, Option<String>) {
        let absent = hidden::hide(&mut keys, hidden, footage);
        let never =
            absent.is_none().then(|| format!("the file shows the shape {name:?} on no frame; its keys are taken"));
        (Self { name, closed, keys, absent: absent.unwrap_or_default(), falloff: Falloff::default() }, never)
    }
}

/// The shapes of a file.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Shapes {
    /// The shapes, farthest first.
    pub shapes: Vec<Shape>,
    /// Elements that were left out, with one line for each.
    pub warnings: Vec<String>,
}

/// Puts shapes into the scene. A shape replaces the part of its name: the depth and the colour stay; the keys, corrections and
/// results of the part are removed. Other shapes become new parts in their order, nearer than all present parts.
pub fn into_scene(scene: &mut Scene, shapes: Vec<Shape>) {
    let nearest = scene.parts.iter().map(|part| part.depth).fold(f64::NEG_INFINITY, f64::max);
    let mut depth = if nearest.is_finite() { nearest.floor() + 1.0 } else { 0.0 };
    let mut places: BTreeMap<String, usize> = BTreeMap::new();
    for (place, part) in scene.parts.iter().enumerate() {
        places.entry(part.name.clone()).or_insert(place);
    }
    // Files have no blanks at the ends of names.
    for (place, part) in scene.parts.iter().enumerate() {
        places.entry(part.name.trim().to_owned()).or_insert(place);
    }
    for Shape { name, closed, keys, absent, falloff } in shapes {
        if let Some(&place) = places.get(&name) {
            let part = &mut scene.parts[place];
            let (name, depth, colour) = (std::mem::take(&mut part.name), part.depth, part.colour);
            *part = Part { name, closed, keys, absent, falloff, depth, colour, ..Part::default() };
        } else {
            places.insert(name.clone(), scene.parts.len());
            scene.parts.push(Part { name, closed, keys, absent, falloff, depth, ..Part::default() });
            depth += 1.0;
        }
    }
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
            absent: Vec::new(),
            falloff: Falloff::default(),
        };
        let old = Part {
            name: "arm".into(),
            depth: 3.5,
            tracks: BTreeMap::from([(1, vec![Point::ZERO])]),
            ..Part::default()
        };
        let footage = Footage { pattern: "%d".into(), first: 0, last: 9, fps: 1.0, width: 9, height: 9, held: false };
        let mut scene = Scene { footage, parts: vec![old] };
        into_scene(&mut scene, vec![shape("leg"), shape("arm"), shape("head")]);
        let found: Vec<_> = scene.parts.iter().map(|part| (part.name.as_str(), part.depth)).collect();
        assert_eq!(found, [("arm", 3.5), ("leg", 4.0), ("head", 5.0)]);
        assert!(scene.parts[0].tracks.is_empty() && scene.parts[0].closed);
        scene.parts[2].name = "head ".into();
        into_scene(&mut scene, vec![shape("head")]);
        assert_eq!((scene.parts.len(), scene.parts[2].name.as_str()), (3, "head "));
    }
}
