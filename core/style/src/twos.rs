//! A content on twos or threes: the result shows a drawing for as long as the content does.
//!
//! What is predicted moves on every frame, since a style is learned over time and not by drawings. So of each hold the result shows
//! the first frame, or the one for which a pose is drawn. Feet stand by the content's drawings ([`super::finish`]): a frame
//! that repeats a drawing is no evidence of standing.
//!
//! Limits: with the style's timing, drawings are no longer held for whole frames.

use super::finish;
use super::grid::Row;
use rototoon_base::geometry::Point;
use rototoon_base::scene::holds::Holds;
use rototoon_base::scene::skeleton::Posture;

/// Makes the frames of each hold one drawing, after its feet stand as in the content's clip, if `contacts`. `keys` are the poses
/// that are drawn.
pub(super) fn finish(
    postures: &mut [Posture],
    content: &[Posture],
    holds: &Holds,
    keys: &[(usize, Row)],
    contacts: bool,
) {
    let drawn = |frame: usize| keys.iter().any(|(at, _)| *at == frame);
    for frame in keys.iter().rev().map(|(at, _)| *at).filter(|&at| !drawn(holds.begin(at))) {
        let begin = holds.begin(frame);
        let back = postures[begin][0] - postures[frame][0];
        postures[begin] = postures[frame].map(|p| p + back);
    }
    let mut drawings = holds.drawings(postures);
    if contacts {
        finish::keep_contacts(&mut drawings, &holds.drawings(content));
    }
    let lists = |postures: &[Posture]| postures.iter().map(|p| p.to_vec()).collect::<Vec<Vec<Point>>>();
    let made = holds.postures(&lists(postures), &lists(&drawings));
    for (posture, made) in postures.iter_mut().zip(made) {
        posture.copy_from_slice(&made);
    }
}
