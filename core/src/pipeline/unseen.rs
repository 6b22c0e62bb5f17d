//! Frames on which a part can probably not be seen: nearer parts or the picture's edge hide its whole contour.
//!
//! Such a part often needs no contour there, and its track is a guess. Only the artist knows, so these frames are a
//! question. Frames on which the contour is sure are left out: then the tracker has seen enough of the part.
//!
//! Limits: the contours of the nearer parts are trusted, and only parts of the document hide. A part that its own film
//! leaves out, without anything in front of it, is not found.

use crate::geometry::{Point, polygon};
use crate::scene::{FrameNumber, Outcome, Part, Scene};

/// Share of a contour's places that must be hidden.
const HIDDEN: f64 = 0.95;

/// The frames on which a part of the scene can probably not be seen, rising.
pub fn unseen(scene: &Scene, part: usize) -> Vec<FrameNumber> {
    let Outcome { doubtful, lost, .. } = Outcome::of(&scene.parts[part]);
    let mut frames: Vec<FrameNumber> = doubtful.into_iter().chain(lost).collect();
    frames.sort_unstable();
    frames.retain(|&frame| is_hidden(scene, part, frame));
    frames
}

fn is_hidden(scene: &Scene, index: usize, frame: FrameNumber) -> bool {
    let part = &scene.parts[index];
    let Some(points) = part.tracks.get(&frame) else { return false };
    let nearer =
        |other: &&Part| other.closed && other.depth_at(frame) > part.depth_at(frame) && !other.is_absent(frame);
    let covers: Vec<Vec<Point>> = scene.parts.iter().filter(nearer).filter_map(|other| other.outline(frame)).collect();
    let (width, height) = (scene.footage.width as f64, scene.footage.height as f64);
    let hidden = |p: &Point| {
        let inside = p.x >= 0.0 && p.y >= 0.0 && p.x < width && p.y < height;
        !inside || covers.iter().any(|cover| polygon::contains(cover, *p))
    };
    let between = points.windows(2).map(|pair| pair[0].midpoint(pair[1]));
    let places: Vec<Point> = points.iter().copied().chain(between).collect();
    let count = places.iter().filter(|p| hidden(p)).count();
    !places.is_empty() && count as f64 >= HIDDEN * places.len() as f64
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::Footage;

    fn square(left: f64, side: f64) -> Vec<Point> {
        [(0.0, 0.0), (side, 0.0), (side, side), (0.0, side)].map(|(x, y)| Point::new(left + x, 10.0 + y)).to_vec()
    }

    /// A small part that goes behind a large one and out of the picture, and how sure it is on each frame.
    fn scene(confidence: [f64; 5]) -> Scene {
        let lefts = [0.0, 22.0, 24.0, 62.0, 70.0];
        let small = Part {
            name: "small".into(),
            closed: true,
            keys: [(-1, square(0.0, 6.0))].into(),
            tracks: (0..).zip(lefts.map(|left| square(left, 6.0))).collect(),
            confidence: (0..).zip(confidence.map(|c| vec![c; 4])).collect(),
            ..Part::default()
        };
        let tracks = (0..5).map(|frame| (frame, square(20.0, 30.0))).collect();
        let large = Part { name: "large".into(), closed: true, depth: 1.0, tracks, ..Part::default() };
        let footage =
            Footage { pattern: "%d.png".into(), first: 0, last: 4, fps: 24.0, width: 64, height: 48, held: false };
        Scene { footage, parts: vec![small, large] }
    }

    #[test]
    fn parts_behind_others_or_outside_are_unseen() {
        assert_eq!(unseen(&scene([0.1; 5]), 0), [1, 2, 4], "on 3 the part is half in the picture");
        assert_eq!(unseen(&scene([0.1, 1.0, 0.1, 0.1, 0.6]), 0), [2, 4], "a sure contour has been seen");
        assert!(unseen(&scene([0.1; 5]), 1).is_empty());
    }

    #[test]
    fn an_absent_part_hides_nothing() {
        let mut scene = scene([0.1; 5]);
        scene.parts[1].set_absent(0, 1);
        scene.parts[1].forget_where_absent();
        assert_eq!(unseen(&scene, 0), [2, 4]);
    }
}
