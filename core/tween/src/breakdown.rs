//! The frame on which a breakdown helps most: one more drawing of the artist between two keys.
//!
//! Two drawings do not say where a breakdown helps. On 39 rows of keys over five films, with the true drawing as the
//! breakdown, each rule gains this share of what the best frame gains in the mean: the middle of any span 0.70; the frame
//! farthest from both keys 0.72; the frame where different readings of the two drawings (arcs, rigid or not, spacing)
//! differ most 0.58. The frame where the in-between is farthest from the truth gains 0.78, but only a picture shows which it
//! is. So:
//!
//! 1. Where pictures show the movement, the distance of each in-between from its picture is known. The distance of the
//!    keys from their pictures is taken off: a background that nobody drew, or the width of lines, adds the same on all
//!    frames. A breakdown mends its own frame, and the frames between it and the keys by a share that falls evenly to 0.
//!    [`suggest`] takes the frame that mends most over its span. Measured so, by the pictures alone, it gains 0.79 on the
//!    painted films, and 0.87 on 37 rows of keys on three films in pencil and airbrush. The frame that is farthest from
//!    its picture gains 0.76 and 0.79: it may lie beside a key and mend little else.
//! 2. Else it takes the middle of the span that moves most, and says so ([`Reason::Movement`]).
//!
//! **Limits.** One frame is suggested at a time. After it is drawn, the next one is found anew.

use super::ink;
use super::stroke::Stroke;
use rototoon_base::scene::FrameNumber;

/// A drawing on a frame.
#[derive(Clone, Debug, PartialEq)]
pub struct Shown {
    /// The frame.
    pub frame: FrameNumber,
    /// Whether it is a key, and not an in-between.
    pub key: bool,
    /// Its strokes.
    pub strokes: Vec<Stroke>,
    /// How far it is from the picture on its frame, in pixels, if there is one.
    pub apart: Option<f64>,
}

/// The suggested frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Breakdown {
    /// The frame.
    pub frame: FrameNumber,
    /// The frame of the key before it.
    pub first: FrameNumber,
    /// The frame of the key after it.
    pub last: FrameNumber,
    /// Why this frame.
    pub reason: Reason,
}

/// Why a frame is suggested.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Reason {
    /// The in-betweens around it are far from their pictures.
    Picture {
        /// How far its own in-between is, in pixels.
        apart: f64,
        /// How far the keys around it are from theirs, in pixels; 0 if neither has one.
        keys: f64,
    },
    /// No picture shows the movement. It is the middle of the span that moves most.
    Movement {
        /// How far the lines move from key to key, in pixels.
        path: f64,
    },
}

/// Suggests a frame for a breakdown, among the in-betweens of drawings in time order. `None` where no key with
/// in-betweens is followed by another key.
pub fn suggest(drawings: &[Shown]) -> Option<Breakdown> {
    by_pictures(drawings).or_else(|| by_movement(drawings))
}

/// The spans: a key, its in-betweens, and the next key.
fn spans(drawings: &[Shown]) -> Vec<&[Shown]> {
    let keys: Vec<usize> = (0..drawings.len()).filter(|&i| drawings[i].key).collect();
    keys.windows(2).map(|two| &drawings[two[0]..=two[1]]).filter(|span| span.len() > 2).collect()
}

fn by_pictures(drawings: &[Shown]) -> Option<Breakdown> {
    first_of_largest(spans(drawings).into_iter().flat_map(|span| {
        let (first, last) = (&span[0], &span[span.len() - 1]);
        let excess: Vec<Excess> =
            span[1..span.len() - 1].iter().filter_map(|own| Excess::of(own, first, last)).collect();
        let gains: Vec<f64> = excess.iter().map(|own| own.gain(&excess)).collect();
        let found = excess.into_iter().zip(gains).map(|(own, gain)| {
            let reason = Reason::Picture { apart: own.apart, keys: own.keys };
            (gain, Breakdown { frame: own.frame, first: first.frame, last: last.frame, reason })
        });
        found.collect::<Vec<_>>()
    }))
}

/// How far an in-between is from its picture.
struct Excess {
    frame: FrameNumber,
    /// Share of the time between the keys.
    share: f64,
    apart: f64,
    /// How far the keys are from theirs, blended by the share.
    keys: f64,
}

impl Excess {
    fn of(own: &Shown, first: &Shown, last: &Shown) -> Option<Self> {
        let share = f64::from(own.frame.abs_diff(first.frame)) / f64::from(last.frame.abs_diff(first.frame));
        let keys = match (first.apart, last.apart) {
            (Some(a), Some(b)) => a + share * (b - a),
            (one, other) => one.or(other).unwrap_or(0.0),
        };
        let apart = own.apart.filter(|apart| apart.is_finite())?;
        Some(Self { frame: own.frame, share, apart, keys })
    }

    fn over(&self) -> f64 {
        (self.apart - self.keys).max(0.0)
    }

    /// What a breakdown on this frame takes off all distances of the span: all of its own, and of others a share that
    /// falls evenly to the keys.
    fn gain(&self, span: &[Self]) -> f64 {
        let reach = |other: &Self| (other.share / self.share).min((1.0 - other.share) / (1.0 - self.share));
        span.iter().map(|other| reach(other) * other.over()).sum()
    }
}

fn by_movement(drawings: &[Shown]) -> Option<Breakdown> {
    let found = spans(drawings).into_iter().map(|span| {
        let (first, last) = (span[0].frame, span[span.len() - 1].frame);
        let twice = |frame: FrameNumber| 2 * i64::from(frame);
        let off = |own: &&Shown| (twice(own.frame) - i64::from(first) - i64::from(last)).abs();
        let path = path(span);
        let frame = span[1..span.len() - 1].iter().min_by_key(off).map_or(first, |own| own.frame);
        (path, Breakdown { frame, first, last, reason: Reason::Movement { path } })
    });
    first_of_largest(found)
}

fn first_of_largest(found: impl Iterator<Item = (f64, Breakdown)>) -> Option<Breakdown> {
    let larger = |best: (f64, Breakdown), next: (f64, Breakdown)| if next.0 > best.0 { next } else { best };
    found.filter(|(score, _)| score.is_finite()).reduce(larger).map(|(_, found)| found)
}

/// How far the lines of a span move, in pixels: the distances of neighbouring drawings, added up.
fn path(span: &[Shown]) -> f64 {
    let step = ink::step(span.iter().flat_map(|own| &own.strokes).flat_map(|stroke| &stroke.points));
    let ink = |own: &Shown| ink::places(own.strokes.iter().map(|s| (&s.points[..], s.closed)), step);
    let places: Vec<_> = span.iter().map(ink).collect();
    let fine = |two: &&[Vec<_>]| two.iter().all(|places| !places.is_empty());
    places.windows(2).filter(fine).map(|two| ink::both_ways(&two[0], &two[1])).sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use rototoon_base::geometry::Point;

    fn at(frame: FrameNumber, x: f64, key: bool, apart: Option<f64>) -> Shown {
        let bar = |i: i32| Point::new(x, 10.0 * f64::from(i));
        Shown { frame, key, strokes: vec![Stroke::new((0..6).map(bar).collect(), false)], apart }
    }

    /// Keys on 0, 6 and 10. The second span moves farther.
    fn row(apart: [Option<f64>; 11]) -> Vec<Shown> {
        let x = |frame: i32| if frame <= 6 { f64::from(frame) } else { 6.0 + 9.0 * f64::from(frame - 6) };
        (0..11).map(|f| at(f, x(f), [0, 6, 10].contains(&f), apart[f as usize])).collect()
    }

    #[test]
    fn the_worst_in_between_is_suggested() {
        let mut apart = [Some(2.0); 11];
        (apart[4], apart[8]) = (Some(7.0), Some(6.0));
        (apart[3], apart[5]) = (Some(5.0), Some(4.0));
        let found = suggest(&row(apart)).unwrap();
        let reason = Reason::Picture { apart: 7.0, keys: 2.0 };
        assert_eq!(found, Breakdown { frame: 4, first: 0, last: 6, reason });
        // The keys of the first span lie off their pictures by as much.
        (apart[0], apart[6]) = (Some(5.0), Some(5.0));
        assert_eq!(suggest(&row(apart)).unwrap().frame, 8);
    }

    #[test]
    fn a_frame_that_mends_its_neighbours_wins() {
        // The in-between beside the key is the worst, and mends no other.
        let far = [2.0, 6.6, 3.0, 5.0, 6.5, 5.0, 2.0, 2.0, 2.0, 2.0, 2.0];
        assert_eq!(suggest(&row(far.map(Some))).unwrap().frame, 4);
    }

    #[test]
    fn without_pictures_it_is_the_middle_of_the_span_that_moves_most() {
        let found = suggest(&row([None; 11])).unwrap();
        assert_eq!((found.frame, found.first, found.last), (8, 6, 10));
        let Reason::Movement { path } = found.reason else { panic!("{found:?}") };
        assert!((path - 36.0).abs() < 1.0, "{path}");
    }

    #[test]
    fn frames_without_a_picture_are_not_judged() {
        let mut apart = [None; 11];
        apart[1] = Some(0.5);
        assert_eq!(suggest(&row(apart)).unwrap().frame, 1);
        // A key's own distance suggests nothing.
        let mut keys = [None; 11];
        (keys[0], keys[6]) = (Some(9.0), Some(9.0));
        assert!(matches!(suggest(&row(keys)).unwrap().reason, Reason::Movement { .. }));
    }

    #[test]
    fn nothing_is_suggested_without_in_betweens() {
        let keys: Vec<Shown> = [0, 4, 5].map(|f| at(f, 0.0, true, Some(1.0))).into();
        assert_eq!(suggest(&keys), None);
        assert_eq!(suggest(&[]), None);
        let open = [at(0, 0.0, true, None), at(1, 4.0, false, Some(9.0))];
        assert_eq!(suggest(&open), None);
    }

    #[test]
    fn empty_drawings_and_frames_far_apart_do_no_harm() {
        let mut row = [at(i32::MIN, 0.0, true, None), at(0, 0.0, false, None), at(i32::MAX, 0.0, true, None)];
        row[1].strokes.clear();
        assert_eq!(suggest(&row).unwrap().frame, 0);
        row[1].apart = Some(f64::NAN);
        assert!(matches!(suggest(&row).unwrap().reason, Reason::Movement { .. }));
    }
}
