//! Finds the frame where the next key helps most.
//!
//! The doubt about a part on a frame is what the mean confidence of its points lacks to [`SURE`], as a share of it: a sure contour needs no look,
//! and the sum of many small doubts is no reason to draw one. Doubt comes in stretches: once the
//! tracker has lost a part, it stays lost until the next key. A key in the middle of such a stretch corrects most of
//! it. So each part's doubt is smoothed over time between its keys, and then the parts are added up. Smoothing moves the
//! maximum from a single bad frame towards the middle of a bad stretch.
//!
//! A part with one key is followed on both sides of it, and smoothed there in the same way. Where it was lost there is
//! no contour at all: the first frame beyond its track counts as one whole doubt.
//!
//! A part is named with the frame if it is not sure there, and the artist has neither keyed nor corrected it there: what was looked at is right. So a frame is
//! proposed only if such a part is on it. Frames on which such a part is lost come before all others, because an artist sees first what is lost. A part of which nearer parts hide nearly all ([`HIDDEN`]), but perhaps a tip, is not lost but doubtful, and its doubt counts little: a key there shows nothing of it. The frames beside the keys of a part are proposed for it only if there
//! are no others, because another key there would correct almost nothing.
//!
//! The kernel is the binomial 1 4 6 4 1. It is about two drawings wide for animation on twos. Beyond the keys it meets
//! zeros, because nothing is in doubt there.

use super::hidden::{covers, hidden_area, hidden_share, is_under};
use rototoon_base::scene::outcome::{LOST, SURE, Verdict, confidence};
use rototoon_base::scene::{FrameNumber, Part};
use std::collections::BTreeMap;

/// Binomial weights around a frame. Their sum is 1.
const KERNEL: [f64; 5] = [1.0 / 16.0, 4.0 / 16.0, 6.0 / 16.0, 4.0 / 16.0, 1.0 / 16.0];

/// Share of a contour, or of its inside, that is hidden if nearly all is, and what the doubt about it counts then.
const HIDDEN: f64 = 0.95;
const HARDLY: f64 = 0.25;
/// Share of a contour that is hidden if only an end of it may stick out. A part that lies on its twin is hidden inside, but not along half of its contour.
const BUT_AN_END: f64 = 0.8;

/// A frame with its doubt.
#[derive(Clone, Debug, PartialEq)]
pub struct WeakestFrame {
    /// The frame.
    pub frame: FrameNumber,
    /// Sum over the parts of their smoothed doubt: from 0, if everything is sure, to the number of parts.
    pub score: f64,
    /// Indices of the parts that are not sure there, the least sure one first.
    pub parts: Vec<usize>,
}

/// What is found about a frame.
#[derive(Default)]
struct Doubts {
    score: f64,
    /// The parts that are not sure, with their confidence, which is 0 where a part was lost without a contour.
    parts: Vec<(f64, usize)>,
}

/// Frames that may be proposed.
type Frames = BTreeMap<FrameNumber, Doubts>;

/// The frame with the most doubt, the earliest of equals. `None` if there is no tracked frame but the keys.
pub fn weakest_frame(parts: &[Part]) -> Option<WeakestFrame> {
    let (mut doubts, mut beside) = (Frames::new(), Frames::new());
    for index in 0..parts.len() {
        add_doubt(parts, index, &mut doubts, &mut beside);
    }
    let best = |frames: &Frames, least: Verdict| {
        let worst = |doubts: &Doubts| doubts.parts.iter().map(|(sure, _)| Verdict::of(*sure)).max();
        let may_be = |doubts: &Doubts| worst(doubts).unwrap_or(Verdict::Sure) >= least;
        let candidates = frames.iter().filter(|(_, doubts)| may_be(doubts));
        candidates.reduce(|best, next| if next.1.score > best.1.score { next } else { best }).map(|(&frame, found)| {
            let mut parts = found.parts.clone();
            parts.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
            WeakestFrame { frame, score: found.score, parts: parts.into_iter().map(|(_, part)| part).collect() }
        })
    };
    [Verdict::Lost, Verdict::Doubtful, Verdict::Sure]
        .into_iter()
        .find_map(|least| best(&doubts, least).or_else(|| best(&beside, least)))
}

/// Adds the smoothed doubts of a part: to `doubts`, and on the frames beside a key to `beside`.
fn add_doubt(parts: &[Part], index: usize, doubts: &mut Frames, beside: &mut Frames) {
    let part = &parts[index];
    let sure = confidence(part);
    let is_key = |frame: FrameNumber| part.keys.contains_key(&frame);
    for (&frame, &own) in &sure {
        // What is beyond the next key on either side belongs to another span.
        let reach = |step: FrameNumber| (1..=2).take_while(|k| !is_key(frame + step * k)).last().unwrap_or(0);
        let near = frame - reach(-1)..=frame + reach(1);
        let doubt = |at: FrameNumber| sure.get(&at).map_or(0.0, |confidence| (1.0 - confidence / SURE).max(0.0));
        let smoothed: f64 =
            KERNEL.iter().zip(frame - 2..).filter(|(_, at)| near.contains(at)).map(|(w, at)| w * doubt(at)).sum();
        let chosen = if is_key(frame - 1) || is_key(frame + 1) { &mut *beside } else { &mut *doubts };
        let found = chosen.entry(frame).or_default();
        let unsure = Verdict::of(own) > Verdict::Sure;
        let hidden = unsure && is_hidden(parts, index, frame);
        found.score += if hidden { HARDLY * smoothed } else { smoothed };
        let looked_at = part.pins.contains_key(&frame) || part.centers.contains_key(&frame);
        if unsure && !looked_at {
            found.parts.push((if hidden { own.max(LOST) } else { own }, index));
        }
    }
    for frame in part.wants_key.iter().filter(|frame| !sure.contains_key(frame)) {
        let found = doubts.entry(*frame).or_default();
        found.score += 1.0;
        found.parts.push((0.0, index));
    }
}

/// Whether nearer parts hide nearly all of a part's tracked contour on a frame.
fn is_hidden(parts: &[Part], index: usize, frame: FrameNumber) -> bool {
    let covers = covers(parts, index, frame);
    let points = parts[index].tracks.get(&frame).map_or(&[][..], Vec::as_slice);
    let hides = |place| is_under(&covers, place);
    let share = hidden_share(points, hides);
    share >= HIDDEN || (parts[index].closed && share >= BUT_AN_END && hidden_area(points, hides) >= HIDDEN)
}

#[cfg(test)]
mod tests {
    use super::*;
    use rototoon_base::geometry::Point;

    /// A part of one point, keyed on the first and last frame, with the given confidence from frame 0 on.
    fn part(confidence: &[f64]) -> Part {
        let last = confidence.len() as FrameNumber - 1;
        Part {
            keys: [(0, vec![Point::ZERO]), (last, vec![Point::ZERO])].into(),
            confidence: (0..).zip(confidence.iter().map(|&c| vec![c])).collect(),
            ..Part::default()
        }
    }

    #[test]
    fn one_doubt_is_smoothed_by_the_middle_of_the_kernel() {
        let found = weakest_frame(&[part(&[1.0, 1.0, 1.0, 0.0, 1.0, 1.0, 1.0])]);
        assert_eq!(found, Some(WeakestFrame { frame: 3, score: 6.0 / 16.0, parts: vec![0] }));
    }

    #[test]
    fn middle_of_a_bad_stretch_beats_a_single_worse_frame() {
        let found = weakest_frame(&[part(&[1.0, 1.0, 0.0, 1.0, 1.0, 1.0, 0.4, 0.4, 0.4, 1.0, 1.0, 1.0])]);
        assert_eq!(found.unwrap().frame, 7);
    }

    #[test]
    fn neighbours_of_keys_are_proposed_only_if_there_is_nothing_else() {
        assert_eq!(weakest_frame(&[part(&[1.0, 0.9, 0.0, 1.0])]).unwrap().frame, 2);
        assert_eq!(weakest_frame(&[part(&[1.0, 1.0])]), None);
        assert_eq!(weakest_frame(&[part(&[1.0, 0.0, 0.7, 0.0, 1.0])]).unwrap().frame, 1, "lost comes before doubtful");
        assert_eq!(weakest_frame(&[part(&[1.0, 0.7, 0.7, 0.7, 1.0])]).unwrap().frame, 2);
    }

    #[test]
    fn parts_add_up_and_the_earliest_of_equals_wins() {
        let sure = [1.0; 9];
        let early = part(&[1.0, 1.0, 1.0, 0.5, 1.0, 1.0, 1.0, 1.0, 1.0]);
        let late = part(&[1.0, 1.0, 1.0, 1.0, 1.0, 0.5, 1.0, 1.0, 1.0]);
        assert_eq!(weakest_frame(&[part(&sure), late.clone()]).unwrap().frame, 5);
        assert_eq!(weakest_frame(&[early.clone(), late.clone(), late.clone()]).unwrap().frame, 5);
        assert_eq!(weakest_frame(&[part(&sure)]).unwrap(), WeakestFrame { frame: 2, score: 0.0, parts: vec![] });
    }

    #[test]
    fn a_part_with_one_key_wants_one_where_it_was_lost() {
        let mut single = part(&[1.0, 0.6, 0.4, 0.2, 0.2]);
        single.keys.remove(&4);
        assert_eq!(weakest_frame(&[single.clone()]).unwrap().frame, 3, "the kernel meets nothing beyond the track");
        single.wants_key = vec![5];
        assert_eq!(weakest_frame(&[single]), Some(WeakestFrame { frame: 5, score: 1.0, parts: vec![0] }));
    }

    #[test]
    fn doubt_beyond_a_key_does_not_count() {
        let mut two = part(&[1.0, 1.0, 1.0, 1.0, 1.0, 0.0, 1.0, 0.5, 1.0, 1.0, 1.0]);
        two.keys.insert(6, vec![Point::ZERO]);
        assert_eq!(weakest_frame(&[two]).unwrap(), WeakestFrame { frame: 5, score: 6.0 / 16.0, parts: vec![0] });
    }

    #[test]
    fn a_lost_part_comes_before_many_doubtful_ones_and_is_named() {
        let doubtful = part(&[1.0, 1.0, 0.6, 0.6, 0.6, 0.6, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0]);
        let lost = part(&[1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 0.4, 1.0, 1.0, 1.0]);
        let all = [doubtful.clone(), doubtful.clone(), doubtful.clone(), lost];
        let found = weakest_frame(&all).unwrap();
        assert_eq!((found.frame, found.parts), (8, vec![3]));
        assert_eq!(weakest_frame(&all[..3]).unwrap().parts, [0, 1, 2]);
    }

    #[test]
    fn what_the_artist_looked_at_is_not_proposed_again() {
        let mut one = part(&[1.0, 1.0, 1.0, 0.1, 0.9, 1.0, 0.3, 1.0, 1.0, 1.0]);
        assert_eq!(weakest_frame(&[one.clone()]).unwrap().frame, 3);
        one.centers.insert(3, Point::ZERO);
        assert_eq!(weakest_frame(&[one.clone()]).unwrap().frame, 6);
        one.keys.insert(6, vec![Point::ZERO]);
        assert!(weakest_frame(&[one]).unwrap().parts.is_empty());
    }

    #[test]
    fn a_part_behind_another_one_is_not_what_a_key_helps() {
        let square = |side: f64| [(0.0, 0.0), (side, 0.0), (side, side)].map(|(x, y)| Point::new(x, y)).to_vec();
        let mut behind = part(&[1.0, 1.0, 1.0, 0.1, 0.1, 0.1, 1.0, 1.0, 1.0, 1.0]);
        behind.tracks =
            (0..10).map(|frame| (frame, square(4.0).iter().map(|p| *p + Point::new(3.0, 1.0)).collect())).collect();
        let mut front = part(&[1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 0.9, 0.7, 0.9, 1.0]);
        (front.closed, front.depth) = (true, 1.0);
        front.tracks = (0..10).map(|frame| (frame, square(20.0))).collect();
        let all = [behind, front];
        assert_eq!(weakest_frame(&all).unwrap().frame, 4, "nothing else is in doubt as much");
        let mut doubtful = part(&[1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 0.4, 0.4, 1.0, 1.0]);
        doubtful.keys.insert(9, Vec::new());
        assert_eq!(
            weakest_frame(&[all[0].clone(), all[1].clone(), doubtful]).unwrap().parts,
            [2],
            "what is seen and lost"
        );
    }

    #[test]
    fn a_part_of_which_a_tip_sticks_out_is_behind_another_one_but_its_twin_is_not() {
        let contour = |list: &[(f64, f64)]| list.iter().map(|&(x, y)| Point::new(x, y)).collect::<Vec<_>>();
        let box_of = |x: f64, y: f64| contour(&[(0.0, 0.0), (x, 0.0), (x, y), (0.0, y)]);
        let arm = |tip: f64| {
            let sides = [1.0, 3.0, 5.0, 7.0, 9.0, 11.0, 13.0, 15.0, 17.0];
            let along = |y: f64| sides.map(|x| (x, y));
            let all: Vec<(f64, f64)> =
                along(3.0).into_iter().chain([(tip, 5.0)]).chain(along(7.0).into_iter().rev()).collect();
            contour(&all)
        };
        let hides = |points: Vec<Point>, front: Vec<Point>| {
            let part = |depth: f64, points: Vec<Point>| Part {
                closed: true,
                depth,
                tracks: [(3, points)].into(),
                ..Part::default()
            };
            is_hidden(&[part(0.0, points), part(1.0, front)], 0, 3)
        };
        assert!(hides(arm(19.0), box_of(20.0, 20.0)));
        assert!(hides(arm(20.5), box_of(20.0, 20.0)), "a tip");
        assert!(!hides(arm(40.0), box_of(20.0, 20.0)), "a hand");
        assert!(!hides(box_of(20.0, 10.0), box_of(20.0, 10.0)), "its twin");
    }

    #[test]
    fn sure_contours_are_no_reason_for_a_key() {
        let sure = part(&[1.0, 1.0, 0.8, 0.8, 0.8, 0.8, 0.8, 1.0, 1.0, 1.0]);
        let doubtful = part(&[1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 0.7, 1.0, 1.0]);
        let found = weakest_frame(&[sure.clone(), sure.clone(), sure, doubtful]).unwrap();
        assert_eq!((found.frame, found.parts), (7, vec![3]));
    }

    #[test]
    fn untracked_parts_are_ignored() {
        let mut untracked = part(&[1.0; 9]);
        untracked.confidence.clear();
        assert_eq!(weakest_frame(&[untracked]), None);
        assert_eq!(weakest_frame(&[]), None);
    }
}
