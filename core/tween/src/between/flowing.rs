//! Spans whose strokes are not carried from counterpart to counterpart, but flow with the ink.
//!
//! Where few strokes are matched surely (tracing cut the lines anew on each drawing), the movement of the matched strokes is
//! compared with the flow of the ink ([`crate::flow`]). Each is believed or not by its drawing half way ([`credible`]). If both
//! are believed, the movement whose drawing is nearer to both keys is taken. If neither is, the earlier key is held. So it is where
//! the flow brings little ink to ink: then the drawings have nothing in common, and strokes that look alike are alike by chance.
//!
//! Two drawings of one stroke each, which are a pair, are not judged: a ball may come near from far away. Nor are drawings of the same
//! strokes: nearly all are paired one to one and look like their counterparts, and of many strokes those that lie together stay
//! together. A person drew them again, and where a face turns or a sack is squashed, each stroke goes its own way; the ink of one
//! may come to lie on that of others, and says nothing.
//!
//! In a span that flows, the strokes of the earlier key flow ahead and are exchanged half way for those of the later key, which
//! have flowed back until then. Pairs that agree with the flow, and pairs made by hand, are not exchanged: their strokes go
//! from one shape to the other. Strokes that a person left without counterpart vanish and appear as asked. Strokes on given pegs go with their pegs.

use super::super::flow::Flow;
use super::super::grid::Grid;
use super::super::matching::{Matching, Pair};
use super::super::stroke::Stroke;
use super::correspond::Places;
use super::credible::{self, Half, Lines, Passing};
use super::join::{Asked, Ends, Run, runs};
use super::{Captured, GivenPegs, Key, Options, Sequence, Spacing};
use crate::ink;
use crate::peg::Timing;
use rototoon_base::geometry::{Point, polygon, polyline};
use std::sync::Arc;

/// The share of the ink that must meet, by the flow by which most ink meets. Where less meets, the drawings are taken to have nothing
/// in common: so it is for 180 of 198 pairs of drawings of different films, and for 20 of 249 pairs of one film.
const MEETS: f64 = 0.5;
/// Largest share of the still ink that a believed flow bares, divided by the share of the ink that meets.
const STILL: f64 = 0.6;
/// Where this share of the ink meets, ink lies on ink by chance: a figure that moves as a whole crosses itself. Then it may be bared.
const NEARLY_ALL: f64 = 0.8;
/// A flow is taken in place of matched strokes that can be believed if its drawing half way is at most this much as far from the keys.
const NEARER: f64 = 0.98;
/// Drawings are of the same strokes if this share of both drawings' strokes is paired one to one, counterparts look like each other by
/// this likeness, and this share of the ink is told apart.
const PAIRED: f64 = 0.95;
const ALIKE: f64 = 0.75;
const TOLD_APART: f64 = 0.75;
/// From this number of strokes on, what lies together must stay together by this share. Then less ink need be told apart, and the likeness may be
/// less if all strokes are paired. Drawings that a rig drew twice have 0.75 or more, but for letters that move apart and a sack that is squashed entirely; 24 pairs
/// of drawings of ten and twenty equal bars at random have 0.68 or less.
const MANY: usize = 12;
const TOGETHER: f64 = 0.7;
const HALF_TOLD_APART: f64 = 0.5;
const FAINTLY_ALIKE: f64 = 0.5;
/// Number of nearest strokes that should stay together with one.
const NEIGHBOURS: usize = 3;
/// A pair agrees with the flow if its places end within this share of the drawing's size from their counterparts in the mean.
const AGREES: f64 = 0.01;
/// A pair shows where a flow may go from this confidence on.
const EVIDENT: f64 = 0.6;
/// Number of places by which a pair is judged.
const SAMPLES: usize = 16;

/// How the drawings of a span come about.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) enum Way {
    /// Strokes go to their counterparts.
    #[default]
    Matched,
    /// The ink flows, with this progress.
    Flows(Box<Flow>, Run),
    /// No movement can be believed, so the earlier key is held.
    Held,
}

/// A sequence whose strokes are all carried to their counterparts, and what it was made with beside.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Alternative {
    sequence: Sequence,
    pegs: GivenPegs,
    base: Option<usize>,
}

/// The way of a span of unsurely matched drawings. `half` is the drawing half way by the matched strokes.
pub(super) fn chosen(first: &[Stroke], second: &[Stroke], matching: &Matching, half: &Half, run: Run) -> Way {
    let matched = Passing::of(first, second, half);
    let flow = Flow::find(first, second, &known(first, second, matching));
    let strangers = flow.as_ref().is_some_and(|flow| flow.meets < MEETS);
    let nearly_all = flow.as_ref().is_some_and(|flow| flow.meets >= NEARLY_ALL);
    let flowed = flow.as_ref().and_then(|flow| {
        let ahead = |stroke: &Stroke| (flow.ahead(&stroke.points, 0.5), stroke.closed);
        let back = |stroke: &Stroke| (flow.back(&stroke.points, 0.5), stroke.closed);
        let of = |lines: Lines| Passing::of(first, second, &lines.into());
        let passing = of(first.iter().map(ahead).collect())?.mean(of(second.iter().map(back).collect())?);
        let bared = if nearly_all { 1.0 } else { STILL * flow.meets };
        (!strangers && passing.is_believed(bared)).then_some(passing)
    });
    let bared = if nearly_all { 1.0 } else { credible::BARED };
    let believed = matched.is_none_or(|matched| !strangers && matched.is_believed(bared));
    match (flow, flowed) {
        (Some(flow), Some(flowed))
            if !believed || matched.is_none_or(|matched| flowed.apart < NEARER * matched.apart) =>
        {
            Way::Flows(Box::new(flow), run)
        }
        _ if believed => Way::Matched,
        _ => Way::Held,
    }
}

/// Whether each of the drawings is one stroke, and the two are a pair: neither could be mistaken for another one.
fn beyond_doubt(matching: &Matching, first: &[Stroke], second: &[Stroke]) -> bool {
    first.len() == 1 && second.len() == 1 && matching.pairs.len() == 1
}

/// Whether the drawings are of the same strokes. So it is where a person drew them again; tracing cuts lines anew.
fn is_whole(matching: &Matching, first: &[Stroke], second: &[Stroke]) -> bool {
    let (paired, most) = (matching.pairs.len(), first.len().max(second.len()));
    if (paired as f64) < PAIRED * most as f64 {
        return false;
    }
    let (alike, sure) = (matching.likeness(first, second), matching.sureness(first, second));
    if most < MANY {
        return alike >= ALIKE && sure >= TOLD_APART;
    }
    let all = paired == first.len() && paired == second.len();
    let least = if all { FAINTLY_ALIKE } else { ALIKE };
    alike >= least && sure >= HALF_TOLD_APART && together(matching, first, second) >= TOGETHER
}

/// How much strokes that lie together stay together, 0 to 1: the mean ratio of the distances on both drawings between each stroke and its
/// nearest ones, those of either drawing. A turn changes nothing.
fn together(matching: &Matching, first: &[Stroke], second: &[Stroke]) -> f64 {
    let middles = |strokes: &[Stroke], of: fn(&Pair) -> usize| -> Vec<Point> {
        matching.pairs.iter().map(|pair| polygon::center(&strokes[of(pair)].points)).collect()
    };
    let on = [middles(first, |pair| pair.from), middles(second, |pair| pair.to)];
    let (mut sum, mut count) = (0.0, 0usize);
    for middles in &on {
        let grid = Grid::new(middles);
        for (i, middle) in middles.iter().enumerate() {
            for j in grid.nearest(*middle, NEIGHBOURS + 1).into_iter().filter(|&j| j != i) {
                let [a, b] = [0, 1].map(|k: usize| on[k][i].distance(on[k][j]));
                sum += (a.min(b) + f64::MIN_POSITIVE) / (a.max(b) + f64::MIN_POSITIVE);
                count += 1;
            }
        }
    }
    if count > 0 { sum / count as f64 } else { 1.0 }
}

/// Places on the first drawing with their counterparts, from pairs that are evident.
fn known(first: &[Stroke], second: &[Stroke], matching: &Matching) -> Vec<(Point, Point)> {
    let evident = matching.pairs.iter().filter(|pair| pair.by_hand || pair.confidence >= EVIDENT);
    evident.flat_map(|pair| sampled(&first[pair.from], &second[pair.to], pair)).collect()
}

/// Places of a stroke with their counterparts.
fn sampled(a: &Stroke, b: &Stroke, pair: &Pair) -> Vec<(Point, Point)> {
    if [a, b].iter().any(|stroke| stroke.points.len() < 2 || stroke.length() <= 0.0) {
        return Vec::new();
    }
    let resampled = Stroke::new(polyline::resample(&a.points, a.closed, SAMPLES), a.closed);
    let places = Places::all(&resampled);
    let there = places.on(&resampled, b, pair).points;
    resampled.points.into_iter().zip(there).collect()
}

/// A matching with only those pairs that agree with a flow or are made by hand. All other strokes are exchanged, but for those that a person
/// left without counterpart.
pub(super) fn kept(
    first: &[Stroke],
    second: &[Stroke],
    matching: &Matching,
    flow: &Flow,
) -> (Matching, [Vec<usize>; 2]) {
    let size = ink::size(first.iter().chain(second).flat_map(|s| &s.points));
    let agrees = |pair: &&Pair| {
        let (from, to): (Vec<Point>, Vec<Point>) =
            sampled(&first[pair.from], &second[pair.to], pair).into_iter().unzip();
        let off = |(p, q): (&Point, &Point)| p.distance(*q);
        let sum: f64 = flow.ahead(&from, 1.0).iter().zip(&to).map(off).sum();
        pair.by_hand || sum <= AGREES * size * to.len() as f64
    };
    let pairs: Vec<Pair> = matching.pairs.iter().filter(agrees).copied().collect();
    let without = |count: usize, of: fn(&Pair) -> usize| {
        let mut there = vec![true; count];
        pairs.iter().for_each(|pair| there[of(pair)] = false);
        (0..count).filter(|&k| there[k]).collect::<Vec<_>>()
    };
    let mut exchanged = [without(first.len(), |pair| pair.from), without(second.len(), |pair| pair.to)];
    let [vanished, appeared] = exchanged.clone();
    for (exchanged, alone) in exchanged.iter_mut().zip(&matching.alone) {
        exchanged.retain(|stroke| !alone.contains(stroke));
    }
    let alone = matching.alone.clone();
    (Matching { pairs, vanished, appeared, alone, ..Matching::default() }, exchanged)
}

/// The progress of flows: one speed through all keys.
pub(super) fn progress(asked: &Asked) -> Vec<Run> {
    let ends = || Some(Ends { start: vec![1.0], end: vec![1.0] });
    runs(&asked.durations.iter().map(|_| ends()).collect::<Vec<_>>(), asked)
}

impl Sequence {
    /// Chooses the way of each span that is not matched surely: of span `base` only, if there is one.
    pub(super) fn by_their_ways(self, given: &[Matching], pegs: &GivenPegs, base: Option<usize>) -> Self {
        let mut ways = vec![Way::Matched; given.len()];
        for k in (0..given.len()).filter(|k| base.is_none_or(|base| base == *k)) {
            let (first, second) = (&self.keys[k].strokes, &self.keys[k + 1].strokes);
            let doubted = given[k].sureness(first, second) < credible::SURE && !is_whole(&given[k], first, second);
            if doubted && !beyond_doubt(&given[k], first, second) {
                ways[k] = chosen(first, second, &given[k], &self.judged(k, pegs), self.progress[k].clone());
            }
        }
        if !ways.iter().any(|way| matches!(way, Way::Flows(..))) {
            return Self { ways, ..self };
        }
        let (mut matchings, mut exchanged) = (self.matchings.clone(), self.exchanged.clone());
        for (k, way) in ways.iter().enumerate() {
            if let Way::Flows(flow, _) = way {
                let (first, second) = (&self.keys[k].strokes, &self.keys[k + 1].strokes);
                (matchings[k], exchanged[k]) = kept(first, second, &given[k], flow);
            }
        }
        let flowing = Self::carried(self.keys.clone(), matchings, exchanged, pegs, &self.options, base);
        let matched = Alternative { sequence: self, pegs: pegs.clone(), base };
        Self { ways, matched: Some(Box::new(matched)), ..flowing }
    }

    /// Carries strokes to their counterparts in the spans that flow and in which a captured part shows the movement: there a flow need not
    /// guess it. All other spans stay as they are.
    pub(super) fn matched_where_seen(self, matched: Alternative, captured: &Arc<[Captured]>) -> Self {
        let followed = matched.sequence.clone().following(captured.clone()).followed;
        let seen = |k: usize| followed.iter().any(|spans| spans[k].is_some());
        let seen: Vec<usize> =
            (0..self.ways.len()).filter(|&k| matches!(self.ways[k], Way::Flows(..)) && seen(k)).collect();
        if seen.is_empty() {
            return self;
        }
        let Self { keys, mut matchings, mut exchanged, mut ways, options, .. } = self;
        for k in seen {
            matchings[k].clone_from(&matched.sequence.matchings[k]);
            exchanged[k].clone_from(&matched.sequence.exchanged[k]);
            ways[k] = Way::Matched;
        }
        Self { ways, ..Self::carried(keys, matchings, exchanged, &matched.pegs, &options, matched.base) }
    }

    /// The points of a track in a span that flows, and its opacity.
    pub(super) fn flowed(&self, t: usize, k: usize, flow: &Flow, share: f64) -> (Vec<Point>, f64) {
        let ahead = self.tracks[t].points(k).map(|points| flow.ahead(points, share));
        let back = self.tracks[t].points(k + 1).map(|points| flow.back(points, share));
        match (ahead, back) {
            (Some(ahead), Some(back)) => (ahead.iter().zip(&back).map(|(p, q)| p.lerp(*q, share)).collect(), 1.0),
            (Some(ahead), None) if self.is_exchanged(t, k) => (ahead, f64::from(u8::from(share < 0.5))),
            (None, Some(back)) if self.is_exchanged(t, k) => (back, f64::from(u8::from(share >= 0.5))),
            (Some(ahead), None) => self.options.leaving.drawn(ahead, 1.0 - share),
            (None, Some(back)) => self.options.leaving.drawn(back, share),
            (None, None) => (Vec::new(), 0.0),
        }
    }

    /// The number of strokes that are exchanged half way between key `k` and the next one, of the drawing that has more of them: those of the
    /// one drawing go, and others come in their place.
    pub fn exchanged_strokes(&self, k: usize) -> usize {
        self.exchanged[k].iter().map(Vec::len).max().unwrap_or_default()
    }

    /// The drawing half way between key `k` and the next one by which their movement is judged. It is that of the two drawings alone and half
    /// way along every path: spacing and other keys say when something moves, not whether the movement can be believed.
    fn judged(&self, k: usize, pegs: &GivenPegs) -> Half {
        let linear = |key: &Key| Key { spacing: Spacing::Timing(Timing::Linear), ..key.clone() };
        let keys = self.keys[k..k + 2].iter().map(linear).collect();
        let of = (k..k + 2).map(|key| pegs.of.get(key).cloned().unwrap_or_default()).collect();
        let pegs = GivenPegs { tree: pegs.tree.clone(), of };
        let options = Options { contacts: false, ..self.options };
        let (matchings, exchanged) = (vec![self.matchings[k].clone()], vec![self.exchanged[k].clone()]);
        Self::carried(keys, matchings, exchanged, &pegs, &options, Some(0)).half_way(0)
    }

    /// The drawing half way between key `k` and the next one by the matched strokes.
    fn half_way(&self, k: usize) -> Half {
        let (from, to): (&Key, &Key) = (&self.keys[k], &self.keys[k + 1]);
        let maps = self.motion.maps(k, 0.5, 0.5 * (f64::from(from.frame) + f64::from(to.frame)));
        let moves = |t: &usize| {
            let stands = [self.tracks[*t].at(k), self.tracks[*t].at(k + 1)];
            stands.iter().all(Option::is_some) || self.is_exchanged(*t, k)
        };
        let moved = |t: usize| {
            let (points, opacity) = self.moved(t, k, 0.5, &self.motion.of_track(t, &maps));
            (opacity > 0.0).then_some((points, self.tracks[t].closed))
        };
        let stands = |t: usize| {
            let points = self.tracks[t].points(k).or(self.tracks[t].points(k + 1))?;
            Some((points.clone(), self.tracks[t].closed))
        };
        let (moving, leaving): (Vec<usize>, Vec<usize>) = self.present(k).into_iter().partition(moves);
        Half {
            moving: moving.into_iter().filter_map(moved).collect(),
            leaving: leaving.into_iter().filter_map(stands).collect(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::flow::tests::{cut, figure, moved};
    use crate::peg::{Peg, PegKey, PegTree};
    use rototoon_base::geometry::similarity::Similarity;

    /// A figure that moves, cut anew on each key, and nothing is matched but given pairs.
    fn moving(pairs: Vec<Pair>, pegs: &GivenPegs) -> Sequence {
        let first = cut(&figure(0.0), 47.0, &Similarity::IDENTITY);
        let second = cut(&figure(0.0), 31.0, &by(1.0));
        let (vanished, appeared) = ((0..first.len()).collect(), (0..second.len()).collect());
        let key = |frame, strokes| Key { frame, strokes, ..Key::default() };
        let matching = Matching { pairs, vanished, appeared, ..Matching::default() };
        Sequence::new(vec![key(0, first), key(8, second)], &[matching], pegs, &Options::default()).unwrap()
    }

    fn by(share: f64) -> Similarity {
        moved(0.2 * share, Point::new(60.0, -15.0) * share)
    }

    fn visible(sequence: &Sequence, frame: i32) -> Vec<Stroke> {
        sequence.at(frame).into_iter().filter(|drawn| drawn.opacity > 0.0).map(|drawn| drawn.stroke).collect()
    }

    fn off(a: &[Stroke], b: &[Stroke]) -> f64 {
        let places = |strokes: &[Stroke]| ink::places(strokes.iter().map(|s| (&s.points[..], s.closed)), 2.0);
        ink::both_ways(&places(a), &places(b))
    }

    #[test]
    fn a_drawing_that_is_cut_anew_flows_and_is_drawn_once() {
        let sequence = moving(Vec::new(), &GivenPegs::default());
        assert!(matches!(sequence.ways[..], [Way::Flows(..)]));
        for frame in 1..8 {
            let share = sequence.progress[0].share(f64::from(frame) / 8.0);
            let truth = cut(&figure(0.0), 47.0, &by(share));
            let drawn = visible(&sequence, frame);
            assert!(off(&drawn, &truth) < 1.5, "frame {frame}: {} px off", off(&drawn, &truth));
            let ink = |strokes: &[Stroke]| strokes.iter().map(Stroke::length).sum::<f64>();
            assert!((ink(&drawn) / ink(&truth) - 1.0).abs() < 0.1, "frame {frame}: no ink is drawn twice");
        }
        assert_eq!(visible(&sequence, 0), sequence.keys[0].strokes);
        assert_eq!(visible(&sequence, 8), sequence.keys[1].strokes);
    }

    #[test]
    fn pairs_by_hand_stay_and_strokes_on_given_pegs_go_with_them() {
        let pair = Pair { from: 1, to: 2, reversed: false, start: 0.0, confidence: 1.0, by_hand: true };
        let by_hand = moving(vec![pair], &GivenPegs::default());
        assert!(matches!(by_hand.ways[..], [Way::Flows(..)]));
        let both = by_hand.tracks.iter().filter(|track| track.at(0).is_some() && track.at(1).is_some());
        assert_eq!(both.map(|track| track.stands[0].stroke).collect::<Vec<_>>(), [1]);
        let keys = vec![PegKey::rest(0), PegKey { shift: Point::new(0.0, 90.0), ..PegKey::rest(8) }];
        let tree = PegTree::new(vec![Peg { name: "own".into(), parent: None, pivot: Point::ZERO, keys }]).unwrap();
        let on_peg = moving(Vec::new(), &GivenPegs { tree, of: vec![vec![Some(0)]] });
        let stroke = &on_peg.at(2).into_iter().find(|drawn| drawn.track == 0).unwrap().stroke;
        let down = stroke.points[0].y - on_peg.keys[0].strokes[0].points[0].y;
        assert!(down > 10.0, "the peg goes down, the stroke {down} px");
    }

    #[test]
    fn footage_that_shows_the_movement_is_followed_instead() {
        let pair = Pair { from: 1, to: 2, reversed: false, start: 0.0, confidence: 1.0, by_hand: true };
        let sequence = moving(vec![pair], &GivenPegs::default());
        let flows = |last| matches!(sequence.clone().following(vec![captured(last)].into()).ways[..], [Way::Flows(..)]);
        assert!(flows(3) && !flows(8));
    }

    /// The figure's first line as a part that was tracked up to a frame.
    fn captured(last: i32) -> Captured {
        let contour =
            |frame: i32| (frame, figure(0.0)[0].0.iter().map(|p| by(f64::from(frame) / 8.0).apply(*p)).collect());
        Captured { closed: true, contours: (0..=last).map(contour).collect() }
    }

    #[test]
    fn footage_of_one_span_changes_no_other_span() {
        let drawings = [
            cut(&figure(0.0), 47.0, &Similarity::IDENTITY),
            cut(&figure(0.0), 31.0, &by(1.0)),
            cut(&figure(0.0), 41.0, &by(2.0)),
            (0..12).map(strange).collect(),
        ];
        let matchings: Vec<Matching> = drawings
            .windows(2)
            .map(|two| Matching {
                vanished: (0..two[0].len()).collect(),
                appeared: (0..two[1].len()).collect(),
                ..Matching::default()
            })
            .collect();
        let key = |(k, strokes)| Key { frame: 8 * k, strokes, ..Key::default() };
        let keys: Vec<Key> = (0..).zip(drawings).map(key).collect();
        let pair = Pair { from: 1, to: 2, reversed: false, start: 0.0, confidence: 1.0, by_hand: true };
        let first = Matching { pairs: vec![pair], ..matchings[0].clone() };
        let matchings = [&[first], &matchings[1..]].concat();
        let mut sequence = Sequence::new(keys, &matchings, &GivenPegs::default(), &Options::default()).unwrap();
        sequence.ways[2] = Way::Held;
        let ways = |sequence: &Sequence| {
            let flows = |way: &Way| if matches!(way, Way::Flows(..)) { "flows" } else { "matched" };
            sequence.ways.iter().map(|way| if *way == Way::Held { "held" } else { flows(way) }).collect::<Vec<_>>()
        };
        assert_eq!(ways(&sequence), ["flows", "flows", "held"]);
        let followed = sequence.clone().following(vec![captured(8)].into());
        assert_eq!(ways(&followed), ["matched", "flows", "held"]);
        for frame in [10, 14, 20] {
            let drawn = |sequence: &Sequence| visible(sequence, frame);
            assert_eq!(drawn(&followed), drawn(&sequence), "frame {frame}");
        }
    }

    /// A body that stays and an arm that moves. The strokes are paired in such a way that the body goes away.
    #[test]
    fn a_movement_that_takes_still_ink_away_is_not_taken() {
        let drawing = |arm: f64| {
            let bar =
                |x: f64, y: f64| Stroke::new((0..9).map(|i| Point::new(x + 5.0 * f64::from(i), y)).collect(), false);
            let mut strokes: Vec<Stroke> = (0..6).map(|k| bar(0.0, 20.0 * f64::from(k))).collect();
            strokes.push(bar(60.0, arm));
            strokes
        };
        let (first, second) = (drawing(0.0), drawing(30.0));
        let run = moving(Vec::new(), &GivenPegs::default()).progress.remove(0);
        let lines = |by: f64| {
            let line = |s: &Stroke| (s.points.iter().map(|p| *p + Point::new(0.0, by)).collect(), s.closed);
            let (body, arm) = first.split_at(6);
            let up = |s: &Stroke| (s.points.iter().map(|p| *p + Point::new(0.0, 15.0)).collect(), s.closed);
            Half::from(body.iter().map(line).chain(arm.iter().map(up)).collect::<Lines>())
        };
        let way = |half: &Half| chosen(&first, &second, &Matching::default(), half, run.clone());
        assert_ne!(way(&lines(9.0)), Way::Matched, "the body is taken away");
        assert!(
            Passing::of(&first, &second, &lines(0.0)).is_some_and(|true_way| true_way.is_believed(credible::BARED))
        );
        let sequence = moving(Vec::new(), &GivenPegs::default());
        assert!(matches!(sequence.ways[..], [Way::Flows(..)]), "a figure that moves as a whole is not still");
    }

    /// Lines that become longer look less alike.
    #[test]
    fn a_drawing_of_the_same_strokes_moves_though_they_are_not_sure() {
        let lines = |wide: f64| -> Vec<Stroke> {
            let line = |k: i32| {
                let at = |i: i32| Point::new(wide * f64::from(i - 6) / 12.0, 15.0 * f64::from(k));
                Stroke::new((0..=12).map(at).collect(), false)
            };
            (0..12).map(line).collect()
        };
        let pair = |k| Pair { from: k, to: k, reversed: false, start: 0.0, confidence: 0.6, by_hand: false };
        let pairs = |count: usize| (0..count).map(pair).collect();
        let way = |count: usize| {
            let (first, second) = (&lines(80.0)[..count], &lines(145.0)[..count]);
            let matching = Matching { pairs: pairs(count), ..Matching::default() };
            (matching.likeness(first, second), is_whole(&matching, first, second))
        };
        let ((likeness, many), (_, few)) = (way(12), way(6));
        assert!((FAINTLY_ALIKE..ALIKE).contains(&likeness) && many && !few, "{likeness} {many} {few}");
        let (first, mut second) = (lines(80.0), lines(80.0));
        second.sort_by_key(|stroke| (stroke.points[0].y as i64 * 37) % 101);
        let matching = Matching { pairs: pairs(12), ..Matching::default() };
        assert!(!is_whole(&matching, &first, &second), "what lay together is scattered");
    }

    #[test]
    fn spacing_and_other_keys_do_not_decide_what_is_believed() {
        let judged = |spacing: Spacing, keys: usize| {
            let at = |k: usize| cut(&figure(0.0), 400.0, &by(k as f64));
            let key = |k: usize| Key { frame: 8 * k as i32, strokes: at(k), spacing: spacing.clone(), corner: false };
            let pair = |k| Pair { from: k, to: k, reversed: false, start: 0.0, confidence: 0.5, by_hand: false };
            let pairs = (0..at(0).len()).map(pair).collect();
            let matchings = vec![Matching { pairs, ..Matching::default() }; keys - 1];
            let keys = (0..keys).map(key).collect();
            let sequence = Sequence::new(keys, &matchings, &GivenPegs::default(), &Options::default()).unwrap();
            sequence.judged(0, &GivenPegs::default())
        };
        let linear = judged(Spacing::Timing(Timing::Linear), 2);
        assert!(!linear.moving.is_empty());
        for spacing in [Spacing::Smooth, Spacing::Timing(Timing::EaseIn), Spacing::Chart(vec![0.9; 7])] {
            assert_eq!(judged(spacing.clone(), 2), linear, "{spacing:?}");
            assert_eq!(judged(spacing.clone(), 3), linear, "{spacing:?}");
        }
    }

    /// A line at random.
    fn strange(k: u32) -> Stroke {
        let number = |k: u32| f64::from((k.wrapping_mul(2_654_435_761) >> 8) % 1000) / 5.0;
        let (at, way) = (Point::new(number(3 * k), number(3 * k + 1)), Point::from_angle(number(3 * k + 2)));
        Stroke::new((0..12).map(|i| at + way * (4.0 * f64::from(i))).collect(), false)
    }

    #[test]
    fn drawings_that_have_nothing_in_common_do_not_flow() {
        let (first, second): (Vec<Stroke>, Vec<Stroke>) =
            ((0..12).map(strange).collect(), (70..82).map(strange).collect());
        let (matching, nothing) = (Matching::default(), Half::default());
        let run = moving(Vec::new(), &GivenPegs::default()).progress.remove(0);
        let far = vec![(vec![Point::splat(900.0), Point::splat(990.0)], false)].into();
        assert_eq!(chosen(&first, &second, &matching, &far, run.clone()), Way::Held);
        assert_eq!(chosen(&first, &[], &matching, &nothing, run), Way::Matched, "there is nothing to compare");
    }
}
