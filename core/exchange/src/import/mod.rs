//! Imports files of other programs: shapes become keys of parts, motions become skeleton clips.
//!
//! - [`bvh`]: motion capture
//! - [`svg`]: paths and basic shapes, still or animated
//! - `svg_elements`: kinds of elements
//! - `svg_animation`: the keys of animated paths
//! - `svg_edited`: what a drawing program has changed in an animated path
//! - `svg_holes`: holes of paths
//! - `svg_length`: lengths with units
//! - `svg_lost`: holes, clips and masks that are lost
//! - `svg_names`: what shapes are called
//! - `svg_outline`: outlines of elements
//! - `svg_selector`: which elements a rule of a style sheet is for
//! - `svg_sheet`: style sheets
//! - `svg_style`: what is hidden or filled
//! - `svg_transform`: where elements stand
//! - `svg_unread`: animations that are not read
//! - `svg_view`: view boxes
//! - [`silhouette`]: Silhouette shapes
//! - [`nuke`](mod@nuke): shapes of Nuke's Roto and RotoPaint nodes
//! - [`natron`](mod@natron): shapes of Natron's Roto and RotoPaint nodes
//! - [`fusion`](mod@fusion): polygon masks of Fusion
//! - [`path`](mod@path): Bézier paths as contours with one number of points
//! - [`problem`]: errors of a file, with their places
//! - `channel`: numbers that may be animated
//! - `extent`: of which frames a file speaks
//! - `hidden`: frames on which a shape is not shown
//! - `merge`: shapes into a scene, without a change where nothing was changed
//! - `range`: keys beyond the footage
//! - `picture`: files of another picture size
//! - `limits`: what a file may ask for
//! - `names`: names of shapes, each once
//! - `way`: shapes that do not go straight from key to key

pub mod bvh;
mod channel;
mod extent;
pub mod fusion;
mod hidden;
mod limits;
mod merge;
mod names;
pub mod natron;
pub mod nuke;
pub mod path;
mod picture;
#[cfg(test)]
mod probes;
pub mod problem;
mod range;
pub mod silhouette;
pub mod svg;
mod svg_animation;
mod svg_edited;
mod svg_elements;
mod svg_holes;
mod svg_length;
mod svg_lost;
mod svg_names;
mod svg_outline;
mod svg_selector;
mod svg_sheet;
mod svg_style;
mod svg_transform;
mod svg_unread;
mod svg_view;
mod way;

pub use extent::Extent;
pub use limits::too_large;
pub use merge::{Change, Merged, Taken, into_scene};
pub use problem::{ImportError, Place};

use rototoon_base::geometry::Point;
use rototoon_base::scene::{Falloff, Footage, FrameNumber};
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
    /// How its border falls off where it is soft, if the file says so.
    pub falloff: Option<Falloff>,
    /// Of which frames the file speaks.
    pub extent: Extent,
}

impl Shape {
    /// A shape with its keys. `hidden` are times in which the file does not show it. Says so if it is never shown.
    fn new(
        (name, closed): (String, bool),
        mut keys: BTreeMap<FrameNumber, Vec<Point>>,
        hidden: &[[f64; 2]],
        footage: &Footage,
    ) -> (Self, Option<String>) {
        let ends = |keys: &BTreeMap<FrameNumber, Vec<Point>>| {
            let ends = [keys.first_key_value(), keys.last_key_value()];
            ends.map(|key| key.map_or(footage.first, |(frame, _)| *frame))
        };
        let in_file = ends(&keys);
        let absent = hidden::hide(&mut keys, hidden, footage);
        // The frame of a key alone may be none that the file names: a shape that stands still has none.
        let extent = Extent::new(if in_file[0] == in_file[1] { ends(&keys) } else { in_file }, hidden, footage);
        let never =
            absent.is_none().then(|| format!("the file shows the shape {name:?} on no frame; its keys are taken"));
        (Self { name, closed, keys, absent: absent.unwrap_or_default(), falloff: None, extent }, never)
    }

    /// Moves the shape in time by a number of frames.
    pub fn move_by(&mut self, frames: FrameNumber) {
        let keys = std::mem::take(&mut self.keys).into_iter();
        self.keys = keys.map(|(frame, points)| (frame.saturating_add(frames), points)).collect();
        self.absent.iter_mut().flatten().for_each(|frame| *frame = frame.saturating_add(frames));
        self.extent.move_by(frames);
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

#[cfg(test)]
mod tests {
    use super::*;
    use rototoon_base::scene::{Footage, Part, Scene};

    #[test]
    fn a_part_of_the_name_becomes_the_shape_and_others_lie_in_front() {
        let footage = Footage { pattern: "%d".into(), first: 0, last: 9, fps: 1.0, width: 9, height: 9, held: false };
        let shape = |name: &str| Shape {
            name: name.into(),
            closed: true,
            keys: BTreeMap::from([(2, vec![Point::ONE, Point::X, Point::Y])]),
            absent: Vec::new(),
            falloff: None,
            extent: Extent::new([2, 2], &[], &footage),
        };
        let old = Part {
            name: "arm".into(),
            depth: 3.5,
            tracks: BTreeMap::from([(1, vec![Point::ZERO])]),
            ..Part::default()
        };
        let mut scene = Scene { footage: footage.clone(), parts: vec![old] };
        into_scene(&mut scene, vec![shape("leg"), shape("arm"), shape("head")]).unwrap();
        let found: Vec<_> = scene.parts.iter().map(|part| (part.name.as_str(), part.depth)).collect();
        assert_eq!(found, [("arm", 3.5), ("leg", 4.0), ("head", 5.0)]);
        assert!(scene.parts[0].keys.contains_key(&2) && scene.parts[0].closed);
        scene.parts[2].name = "head ".into();
        into_scene(&mut scene, vec![shape("head")]).unwrap();
        assert_eq!((scene.parts.len(), scene.parts[2].name.as_str()), (3, "head "));
    }
}
