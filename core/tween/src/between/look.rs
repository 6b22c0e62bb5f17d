//! How a stroke looks between two keys, apart from its points: its widths, colour, material and layer.
//!
//! Colours and widths are blended by the spacing of the span, as Blender's add-on blends all that it keeps for a stroke. A
//! material or a layer cannot be blended: it is that of the earlier key. If only one key has widths, or a colour, the stroke has
//! that one's. Pieces of a stroke are not filled: they enclose nothing, or not what the stroke encloses.
//!
//! A width belongs to a place of the line. So each key's widths are taken where the track's places are on that key's stroke
//! ([`Places::blends`](super::Places::blends)), also where the counterpart has other points or runs the other way.

use super::{Sequence, Stand};
use crate::stroke::Stroke;

impl Sequence {
    /// A track in span `k` without its points; `u` is the share of the span's time.
    pub(super) fn look(&self, t: usize, k: usize, u: f64) -> Stroke {
        let on = |key: usize| self.tracks[t].at(key).map(|stand| (stand, &self.keys[key].strokes[stand.stroke]));
        let (before, after) = (on(k), on(k + 1));
        let share = self.keys[k].spacing.at(u).clamp(0.0, 1.0);
        let filled = |(stand, stroke): (&Stand, &Stroke)| stroke.fill_colour.filter(|_| !stand.part);
        let own = before.or(after).map(|(_, stroke)| stroke);
        Stroke {
            points: Vec::new(),
            closed: self.tracks[t].closed,
            widths: blended(before.and_then(widths), after.and_then(widths), share),
            colour: mixed(before.and_then(|(_, s)| s.colour), after.and_then(|(_, s)| s.colour), share),
            fill_colour: mixed(before.and_then(filled), after.and_then(filled), share),
            // Pieces of an outline are open, and enclose nothing.
            fill: self.tracks[t].closed && own.is_some_and(|s| s.fill),
            material: own.and_then(|s| s.material),
            layer: own.and_then(|s| s.layer),
            peg: None,
        }
    }
}

/// A colour between those of two keys.
fn mixed(before: Option<[f32; 3]>, after: Option<[f32; 3]>, share: f64) -> Option<[f32; 3]> {
    match (before, after) {
        (Some(a), Some(b)) => Some([0, 1, 2].map(|c| a[c] + (b[c] - a[c]) * share as f32)),
        (a, b) => a.or(b),
    }
}

/// The widths of a key's stroke at a track's places; `None` if it has none.
fn widths((stand, stroke): (&Stand, &Stroke)) -> Option<Vec<f64>> {
    let own = &stroke.widths;
    if own.is_empty() || own.len() != stroke.points.len() {
        return None;
    }
    let blends = stand.places.blends(stroke);
    Some(blends.into_iter().map(|(i, j, weight)| own[i] + (own[j] - own[i]) * weight).collect())
}

fn blended(before: Option<Vec<f64>>, after: Option<Vec<f64>>, share: f64) -> Vec<f64> {
    match (before, after) {
        (Some(a), Some(b)) => a.iter().zip(&b).map(|(a, b)| a + (b - a) * share).collect(),
        (a, b) => a.or(b).unwrap_or_default(),
    }
}

#[cfg(test)]
mod tests {
    use crate::between::{GivenPegs, Key, Options, Sequence, Spacing};
    use crate::matching::{InPieces, Matching, Pair};
    use crate::peg::Timing;
    use crate::stroke::Stroke;
    use rototoon_base::geometry::Point;

    fn stroke(xs: &[f64], widths: &[f64], grey: f32) -> Stroke {
        let points = xs.iter().map(|&x| Point::new(x, 10.0)).collect();
        Stroke { widths: widths.to_vec(), colour: Some([grey; 3]), ..Stroke::new(points, false) }
    }

    /// The middle frame between two strokes of which the second runs backwards.
    fn half_way(first: Stroke, second: Stroke, timing: Timing) -> Stroke {
        let key = |frame, stroke| Key {
            frame,
            strokes: vec![stroke],
            spacing: Spacing::Timing(timing.clone()),
            corner: false,
        };
        let pair = Pair { from: 0, to: 0, reversed: true, start: 0.0, confidence: 1.0, by_hand: true };
        let matching = Matching { pairs: vec![pair], ..Matching::default() };
        let keys = vec![key(0, first), key(2, second)];
        let sequence = Sequence::new(keys, &[matching], &GivenPegs::default(), &Options::default()).unwrap();
        sequence.at(1).remove(0).stroke
    }

    #[test]
    fn widths_stay_at_their_places() {
        // Three points at 0, 1/4 and 1 of the length become two; from the later stroke's end its width falls from 8 to 4.
        let first = || stroke(&[0.0, 10.0, 40.0], &[1.0, 2.0, 3.0], 0.0);
        let second = || stroke(&[40.0, 0.0], &[4.0, 8.0], 1.0);
        let drawn = half_way(first(), second(), Timing::Linear);
        assert_eq!((drawn.widths, drawn.colour), (vec![4.5, 4.5, 3.5], Some([0.5; 3])));
        let eased = half_way(first(), second(), Timing::EaseIn);
        assert_eq!(eased.widths, [2.75, 3.25, 3.25], "a quarter of the way");
        let held = half_way(first(), second(), Timing::Constant);
        assert_eq!((held.widths, held.colour), (vec![1.0, 2.0, 3.0], Some([0.0; 3])));
    }

    #[test]
    fn colours_of_fills_change_with_the_spacing_and_pieces_are_not_filled() {
        let filled = |xs: &[f64], grey: f32| Stroke { fill_colour: Some([1.0, grey, 0.0]), ..stroke(xs, &[], 0.0) };
        let fill = |timing: Timing| half_way(filled(&[0.0, 40.0], 0.0), filled(&[40.0, 0.0], 1.0), timing).fill_colour;
        assert_eq!(fill(Timing::Linear), Some([1.0, 0.5, 0.0]));
        assert_eq!(fill(Timing::EaseIn), Some([1.0, 0.25, 0.0]), "a quarter of the way");
        let gone = half_way(filled(&[0.0, 40.0], 0.75), stroke(&[40.0, 0.0], &[], 0.0), Timing::Linear);
        assert_eq!(gone.fill_colour, Some([1.0, 0.75, 0.0]), "only one key has a fill");
        // A stroke that falls into two pieces.
        let key = |frame, strokes| Key { frame, strokes, spacing: Spacing::default(), corner: false };
        let split = InPieces { whole: 0, pieces: vec![(0, false), (1, false)] };
        let halves = vec![stroke(&[0.0, 20.0], &[], 0.0), stroke(&[20.0, 40.0], &[], 0.0)];
        let keys = vec![key(0, vec![filled(&[0.0, 40.0], 0.0)]), key(2, halves)];
        let matching = Matching { split: vec![split], ..Matching::default() };
        let sequence = Sequence::new(keys, &[matching], &GivenPegs::default(), &Options::default()).unwrap();
        let drawn = sequence.at(1);
        assert_eq!(drawn.iter().map(|piece| piece.stroke.fill_colour).collect::<Vec<_>>(), [None, None]);
    }

    #[test]
    fn widths_of_one_key_are_kept() {
        let plain = || stroke(&[40.0, 0.0], &[], 1.0);
        let drawn = half_way(stroke(&[0.0, 10.0, 40.0], &[1.0, 2.0, 3.0], 0.0), plain(), Timing::Linear);
        assert_eq!(drawn.widths, [1.0, 2.0, 3.0]);
        let back = half_way(plain(), stroke(&[0.0, 40.0], &[1.0, 3.0], 0.0), Timing::Linear);
        assert_eq!(back.widths, [3.0, 1.0]);
        assert!(half_way(plain(), plain(), Timing::Linear).widths.is_empty());
    }
}
