//! When the shapes of a spline are shown.
//!
//! The number of a Bézier spline goes from key to key. Between two keys its curve has two handles, each with a frame and a number; a linear key, or
//! one without a handle, has its handle a third of the way along. How far the number has come from the one key's number to the other's is how far the
//! one shape has become the other. Keys that step hold their shape until the next one.

use rototoon_base::scene::FrameNumber;

/// A key of a spline.
#[derive(Clone, Debug, Default)]
pub struct Key {
    /// When.
    pub frame: f64,
    /// The spline's number.
    pub number: f64,
    /// Whether its handles lie on the chords.
    pub linear: bool,
    /// The handle before it and the one after it: frame and number.
    pub handles: [Option<[f64; 2]>; 2],
    /// Whether the number steps before it, and after it.
    pub steps: [bool; 2],
}

/// The keys of a spline in the order of time; none for a shape that stands still.
#[derive(Clone, Debug, Default)]
pub struct Timing {
    keys: Vec<Key>,
}

/// Greatest difference to an even way that is none: it is a matter of rounding.
const EVEN: f64 = 1e-4;
/// Halvings in the search for the parameter of a frame.
const HALVINGS: usize = 50;

impl Timing {
    /// The timing of these keys.
    pub fn new(keys: Vec<Key>) -> Self {
        Self { keys }
    }

    /// The frames of the keys.
    pub fn frames(&self) -> impl Iterator<Item = f64> + '_ {
        self.keys.iter().map(|key| key.frame)
    }

    /// The whole frames within a range on which a shape needs a key beside those of the spline: all of a stretch that does not go evenly.
    pub fn between(&self, [first, last]: [FrameNumber; 2]) -> Vec<FrameNumber> {
        let mut found = Vec::new();
        for (k, pair) in self.keys.windows(2).enumerate() {
            let [from, to] = [pair[0].frame, pair[1].frame];
            let whole = |frame: f64| frame.clamp(first.into(), last.into()) as FrameNumber;
            let inner: Vec<FrameNumber> = (whole(from.ceil())..=whole(to.floor()))
                .filter(|&frame| from < frame.into() && f64::from(frame) < to)
                .collect();
            let even = |frame: &FrameNumber| (f64::from(*frame) - from) / (to - from);
            if inner.iter().any(|frame| (self.share(k, f64::from(*frame)) - even(frame)).abs() > EVEN) {
                found.extend(inner);
            }
        }
        found
    }

    /// The keys around a frame, and how far the first one's shape has become the second one's.
    pub fn at(&self, frame: f64) -> (usize, usize, f64) {
        let after = self.keys.partition_point(|key| key.frame <= frame);
        let Some(before) = after.checked_sub(1) else { return (0, 0, 0.0) };
        if after == self.keys.len() {
            return (before, before, 0.0);
        }
        (before, after, self.share(before, frame))
    }

    /// How far the number has come after a key.
    fn share(&self, k: usize, frame: f64) -> f64 {
        let [a, b] = [&self.keys[k], &self.keys[k + 1]];
        if a.steps[1] || b.steps[0] {
            return 0.0;
        }
        let (length, rise) = (b.frame - a.frame, b.number - a.number);
        let third = |t: f64| [a.frame + length * t, a.number + rise * t];
        let handle = |key: &Key, side: usize, t: f64| key.handles[side].filter(|_| !key.linear).unwrap_or(third(t));
        let (out, into) = (handle(a, 1, 1.0 / 3.0), handle(b, 0, 2.0 / 3.0));
        let within = |frame: f64| frame.clamp(a.frame, b.frame);
        let times = [a.frame, within(out[0]), within(into[0]), b.frame];
        let (mut low, mut high) = (0.0, 1.0);
        for _ in 0..HALVINGS {
            let middle = 0.5 * (low + high);
            if cubic(times, middle) < frame { low = middle } else { high = middle }
        }
        let number = cubic([a.number, out[1], into[1], b.number], 0.5 * (low + high));
        if rise == 0.0 { (frame - a.frame) / length } else { (number - a.number) / rise }
    }
}

fn cubic([a, b, c, d]: [f64; 4], t: f64) -> f64 {
    let u = 1.0 - t;
    u * u * u * a + 3.0 * u * u * t * b + 3.0 * u * t * t * c + t * t * t * d
}

#[cfg(test)]
mod tests {
    use super::*;

    fn key(frame: f64, number: f64) -> Key {
        Key { frame, number, ..Key::default() }
    }

    #[test]
    fn an_even_stretch_needs_no_keys_and_an_eased_one_one_on_each_frame() {
        let even = Timing::new(vec![key(1.0, 0.0), key(5.0, 1.0), key(9.0, 2.0)]);
        assert!(even.between([1, 9]).is_empty());
        let (before, after, share) = even.at(6.0);
        assert_eq!((before, after), (1, 2));
        assert!((share - 0.25).abs() < 1e-9, "{share}");
        assert_eq!((even.at(0.0), even.at(9.0), even.at(20.0)), ((0, 0, 0.0), (2, 2, 0.0), (2, 2, 0.0)));
        // Flat at both keys: the smooth step 3t² − 2t³.
        let flat = |frame: f64, number: f64, handles| Key { handles, ..key(frame, number) };
        let third = 4.0 / 3.0;
        let eased = Timing::new(vec![
            flat(1.0, 0.0, [None, Some([1.0 + third, 0.0])]),
            flat(5.0, 1.0, [Some([5.0 - third, 1.0]), None]),
        ]);
        assert_eq!(eased.between([1, 9]), [2, 3, 4]);
        assert_eq!(eased.between([3, 9]), [3, 4]);
        assert!((eased.at(2.0).2 - 0.15625).abs() < 1e-6, "{:?}", eased.at(2.0));
    }

    #[test]
    fn a_key_that_steps_holds_its_shape() {
        for steps in [([false, true], [false; 2]), ([false; 2], [true, false])] {
            let held =
                Timing::new(vec![Key { steps: steps.0, ..key(1.0, 0.0) }, Key { steps: steps.1, ..key(4.0, 1.0) }]);
            assert_eq!(held.between([1, 9]), [2, 3]);
            assert_eq!((held.at(3.0), held.at(4.0)), ((0, 1, 0.0), (1, 1, 0.0)));
        }
    }
}
