//! Distances between drawn and true ink, and the sums of them that the tables print.

use rototoon::geometry::{Point, polyline};
use rototoon::tween::Stroke;
use rototoon::tween::between::Sequence;

/// Distance of the samples along the ink, in pixels.
const STEP: f64 = 4.0;
/// Distances above this count as this, in pixels: the ink is missing.
const MOST: f64 = 24.0;
/// A drawing whose ink is as near to another's shows it again, in pixels.
const SAME: f64 = 0.25;

/// Sums of the distances between drawn and true ink, in pixels.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct InkErrors {
    /// Number of frames.
    pub frames: usize,
    /// Of the earlier key, held.
    pub held: f64,
    /// Of Rototoon.
    pub ours: f64,
    /// Spans, and those on which Rototoon is farther from the truth than holding.
    pub spans: (usize, usize),
    /// Spans on which Rototoon is farther from the truth, and each drawing between shows a key again. Such a film is on twos or
    /// threes, and no in-between can be as near as a held key.
    pub repeated: usize,
    /// Spans in which Rototoon holds the earlier key itself.
    pub holding: usize,
    /// Right and wrong pairs, where they are known.
    pub pairs: (usize, usize),
}

impl InkErrors {
    /// The errors of the in-betweens of one span between two drawings. `truth` has the true ink of each frame between its keys.
    pub fn of_span(sequence: &Sequence, keys: [&[Stroke]; 2], truth: &[(i32, Vec<Point>)]) -> Self {
        let mut errors = Self::default();
        let [held, last] = keys.map(|key| ink(key.iter().map(|s| (&s.points[..], s.closed))));
        let mut repeats = 0;
        for (frame, truth) in truth {
            let between = sequence.at(*frame);
            let seen = between.iter().filter(|d| d.opacity > 0.0);
            let ours = ink(seen.map(|d| (&d.stroke.points[..], d.stroke.closed)));
            errors.frames += 1;
            let still = apart(&held, truth);
            repeats += usize::from(still.min(apart(&last, truth)) <= SAME);
            errors.held += still;
            errors.ours += apart(&ours, truth);
        }
        // Where the earlier key is held, only the rounding of sums differs.
        errors.spans = (1, usize::from(errors.ours > errors.held * (1.0 + 1e-9)));
        errors.repeated = usize::from(errors.spans.1 == 1 && repeats == truth.len());
        errors.holding = usize::from(sequence.is_held(0));
        errors
    }

    /// Adds other sums.
    pub fn add(&mut self, other: Self) {
        self.frames += other.frames;
        self.held += other.held;
        self.ours += other.ours;
        self.spans = (self.spans.0 + other.spans.0, self.spans.1 + other.spans.1);
        self.repeated += other.repeated;
        self.holding += other.holding;
        self.pairs = (self.pairs.0 + other.pairs.0, self.pairs.1 + other.pairs.1);
    }

    /// Rototoon's error divided by that of holding.
    pub fn ratio(&self) -> f64 {
        self.ours / self.held.max(f64::MIN_POSITIVE)
    }
}

/// Points at even distances along lines.
pub fn ink<'a>(lines: impl Iterator<Item = (&'a [Point], bool)>) -> Vec<Point> {
    let samples = |(points, closed): (&[Point], bool)| {
        let count = (polyline::length(points, closed) / STEP).ceil().max(2.0) as usize;
        if points.len() < 2 { points.to_vec() } else { polyline::resample(points, closed, count) }
    };
    lines.flat_map(samples).collect()
}

/// The mean distance from each of two inks to the other, in pixels.
fn apart(a: &[Point], b: &[Point]) -> f64 {
    let one_way = |a: &[Point], b: &[Point]| {
        let nearest = |p: &Point| b.iter().map(|q| p.distance_squared(*q)).fold(MOST * MOST, f64::min).sqrt();
        a.iter().map(nearest).sum::<f64>() / a.len().max(1) as f64
    };
    0.5 * (one_way(a, b) + one_way(b, a))
}

#[cfg(test)]
mod tests {
    use super::*;
    use rototoon::scene::Silent;
    use rototoon::tween::between::{GivenPegs, Key, Options};
    use rototoon::tween::matching::{self, match_strokes};

    /// A line of 90 px at a height.
    fn drawing(y: f64) -> Vec<Stroke> {
        vec![Stroke::new((0..10).map(|k| Point::new(10.0 * f64::from(k), y)).collect(), false)]
    }

    /// The errors between a line at 0 and one at 10, with the true heights of the frames between.
    fn errors(heights: &[f64]) -> InkErrors {
        let (a, b) = (drawing(0.0), drawing(10.0));
        let found = match_strokes(&a, &b, &[], &matching::Options::default(), &Silent).unwrap();
        let last = heights.len() as i32 + 1;
        let key = |frame, strokes: &Vec<Stroke>| Key { frame, strokes: strokes.clone(), ..Key::default() };
        let keys = vec![key(0, &a), key(last, &b)];
        let sequence = Sequence::new(keys, &[found], &GivenPegs::default(), &Options::default()).unwrap();
        let lines = |y: f64| ink(drawing(y).iter().map(|s| (&s.points[..], s.closed)));
        let truth: Vec<_> = (1..).zip(heights).map(|(frame, y)| (frame, lines(*y))).collect();
        InkErrors::of_span(&sequence, [&a, &b], &truth)
    }

    #[test]
    fn a_film_on_twos_repeats_its_keys() {
        let found = errors(&[0.0]);
        assert_eq!((found.spans, found.repeated), ((1, 1), 1));
        // On threes the later key comes early.
        let found = errors(&[0.1, 0.1, 0.1, 10.0]);
        assert_eq!((found.spans, found.repeated), ((1, 1), 1));
    }

    #[test]
    fn a_slow_start_is_no_repeat() {
        let found = errors(&[1.0]);
        assert_eq!((found.spans, found.repeated), ((1, 1), 0));
        // One of its three drawings is new.
        let found = errors(&[0.0, 1.0, 0.0]);
        assert_eq!((found.spans, found.repeated), ((1, 1), 0));
    }

    #[test]
    fn a_span_that_is_better_than_holding_repeats_nothing() {
        let found = errors(&[5.0]);
        assert_eq!((found.spans, found.repeated), ((1, 0), 0));
        assert!(found.ours < 0.1 && (found.held - 5.0).abs() < 0.1, "{found:?}");
    }
}
