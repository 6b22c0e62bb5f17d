//! Parts with one key that went to the place of another one are followed again.
//!
//! **Why.** Each part is followed alone, so nothing keeps two eyes from the same drawn eye: one is lost where it turns away, the search finds its
//! twin, and both are sure.
//!
//! **How.** Where two parts are [together](crate::shared::twins), one of them came there. It is the one that jumped: at the end of the stretch that looks
//! towards its own key it moved by more than [`JUMPED`] of its size, and farther than the other one, which did not move at all if its key is in the stretch. The place
//! is *taken* for the part that came. It is followed again, with the search where it would be on a place that is taken, and it is not trusted there if
//! nothing else is found. So it is lost where its drawing ends, and asks for a key.
//!
//! **Limits.** A part between two keys of its own is not followed again.

use crate::contract::tracking::Tracking;
use crate::shared::twins::together;
use rototoon_base::geometry::{Point, polygon};
use rototoon_base::scene::{FrameNumber, Scene};
use std::collections::BTreeMap;

/// Least movement of a part that came to another one's place, as a share of its size.
const JUMPED: f64 = 0.5;

/// By part: on which frames it came to the place of which other part.
pub(super) type Came = BTreeMap<usize, Vec<(FrameNumber, usize)>>;

/// The parts among the subjects, which have one key each, that came to the place of another part.
pub(super) fn came(scene: &Scene, tracking: &Tracking, subjects: &[usize]) -> Came {
    let mut came = Came::new();
    let of = |p: usize| (&scene.parts[p], &tracking.parts[p].tracks);
    for &a in subjects {
        for b in (0..scene.parts.len()).filter(|&b| b != a && (b > a || !subjects.contains(&b))) {
            for run in together(of(a), of(b)) {
                let jumps = [a, b].map(|p| jump(scene, tracking, p, run));
                let who = if jumps[0] >= jumps[1] { 0 } else { 1 };
                let (guest, host) = if who == 0 { (a, b) } else { (b, a) };
                if jumps[who] > JUMPED && jumps[who] > jumps[1 - who] && subjects.contains(&guest) {
                    came.entry(guest).or_default().extend((run[0]..=run[1]).map(|frame| (frame, host)));
                }
            }
        }
    }
    came
}

/// How far a part moved where it came to a stretch of frames, in shares of its size. 0 if a key of its own is in it, or on both sides.
fn jump(scene: &Scene, tracking: &Tracking, p: usize, [first, last]: [FrameNumber; 2]) -> f64 {
    let (keys, tracks) = (&scene.parts[p].keys, &tracking.parts[p].tracks);
    let step = |from: FrameNumber, to: FrameNumber| {
        let (Some(a), Some(b)) = (tracks.get(&from), tracks.get(&to)) else { return 0.0 };
        let size = |contour: &[Point]| polygon::signed_area(contour).abs().sqrt().max(1.0);
        polygon::center(a).distance(polygon::center(b)) / size(b)
    };
    match (keys.range(..first).next().is_some(), keys.range(first..=last).next(), keys.range(last + 1..).next()) {
        (true, None, None) => step(first - 1, first),
        (false, None, Some(_)) => step(last + 1, last),
        _ => 0.0,
    }
}
