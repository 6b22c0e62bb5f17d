//! Frames on which a part can probably not be seen: nearer parts or the picture's edge hide its whole contour.
//!
//! Such a part often needs no contour there, and its track is a guess. Only the artist knows, so these frames are a
//! question. Frames on which the contour is sure are left out: then the tracker has seen enough of the part.
//!
//! A lost contour may lie behind something because it is wrong. So its place is asked a second time: the contour between the nearest keys and sure contours before
//! and after, in proportion to time, must be hidden by half too. Without such contours on both sides the track alone counts.
//!
//! Limits: the contours of the nearer parts are trusted, and only parts of the document hide. A part that its own film
//! leaves out, without anything in front of it, is not found. A part that goes behind another one and comes back between two sure contours is
//! found only where the straight way is hidden.

use crate::geometry::Point;
use crate::scene::outcome::Verdict;
use crate::scene::{FrameNumber, Outcome, Part, Scene};
use crate::track::{covers, hidden_share, is_under};

/// Share of a contour's places that must be hidden.
const HIDDEN: f64 = 0.95;
/// The same of the place where sure contours expect it, which is a rougher guess.
const EXPECTED: f64 = 0.5;

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
    let covers = covers(&scene.parts, index, frame);
    let (width, height) = (scene.footage.width as f64, scene.footage.height as f64);
    let hidden = |p: Point| {
        let inside = p.x >= 0.0 && p.y >= 0.0 && p.x < width && p.y < height;
        !inside || is_under(&covers, p)
    };
    let expected = || expected(part, frame).is_none_or(|points| hidden_share(&points, hidden) >= EXPECTED);
    hidden_share(points, hidden) >= HIDDEN && expected()
}

/// Where the keys and sure contours before and after a frame expect a part on it. `None` if they are not on both sides.
fn expected(part: &Part, frame: FrameNumber) -> Option<Vec<Point>> {
    let known = |&at: &FrameNumber| part.keys.contains_key(&at) || Verdict::on(part, at) == Some(Verdict::Sure);
    let frames = || part.keys.keys().chain(part.tracks.keys()).copied();
    let before = frames().filter(|&at| at < frame).filter(known).max()?;
    let after = frames().filter(|&at| at > frame).filter(known).min()?;
    let contour = |at: FrameNumber| part.keys.get(&at).or_else(|| part.tracks.get(&at));
    let share = f64::from(frame - before) / f64::from(after - before);
    Some(contour(before)?.iter().zip(contour(after)?).map(|(a, b)| a.lerp(*b, share)).collect())
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
    fn a_lost_contour_behind_something_is_not_unseen_where_sure_ones_beside_it_are_seen() {
        let mut scene = scene([1.0, 0.1, 0.1, 1.0, 1.0]);
        scene.parts[0].tracks.insert(3, square(8.0, 6.0));
        assert!(unseen(&scene, 0).is_empty(), "it stays left of what hides it");
        scene.parts[0].tracks.insert(3, square(32.0, 6.0));
        assert_eq!(unseen(&scene, 0), [2], "halfway on 1");
        scene.parts[0].tracks.insert(0, square(21.0, 6.0));
        assert_eq!(unseen(&scene, 0), [1, 2]);
    }

    #[test]
    fn an_absent_part_hides_nothing() {
        let mut scene = scene([0.1; 5]);
        scene.parts[1].set_absent(0, 1);
        scene.parts[1].forget_where_absent();
        assert_eq!(unseen(&scene, 0), [2, 4]);
    }
}
