//! Numbers that may be animated.

use rototoon_base::scene::Falloff;

/// A difference that comes from 32-bit floats.
const ROUNDING: f64 = 1e-6;

/// A number with its keys in the order of time: frames and values.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Channel {
    keys: Vec<(f64, f64)>,
    animated: bool,
}

impl Channel {
    /// A number that does not change.
    pub(super) fn constant(value: f64) -> Self {
        Self { keys: vec![(0.0, value)], animated: false }
    }

    /// A number with keys in any order; `None` without keys.
    pub(super) fn keyed(mut keys: Vec<(f64, f64)>) -> Option<Self> {
        keys.sort_by(|a, b| a.0.total_cmp(&b.0));
        (!keys.is_empty()).then_some(Self { keys, animated: true })
    }

    /// The frames of the keys; none for a number that does not change.
    pub(super) fn frames(&self) -> impl Iterator<Item = f64> + '_ {
        self.keys.iter().filter(|_| self.animated).map(|key| key.0)
    }

    /// The frames on which the number may turn to other values. One key is the same as none.
    pub(super) fn turns(&self) -> impl Iterator<Item = f64> + '_ {
        self.frames().filter(|_| self.keys.len() > 1)
    }

    /// The times in which the number is 0 or less, each with its beginning and its end. A held number keeps its value until
    /// the frame before the next key.
    pub(super) fn zeros(&self, held: bool) -> Vec<[f64; 2]> {
        let zero = |key: &(f64, f64)| key.1 <= ROUNDING;
        let mut found: Vec<[f64; 2]> = Vec::new();
        for (k, key) in self.keys.iter().enumerate().filter(|(_, key)| zero(key)) {
            let end = match self.keys.get(k + 1) {
                None => f64::INFINITY,
                Some(next) if held => next.0.ceil() - 1.0,
                Some(_) => key.0,
            };
            match found.last_mut() {
                Some(before) if zero(&self.keys[k - 1]) => before[1] = end,
                _ => found.push([if k == 0 { f64::NEG_INFINITY } else { key.0 }, end]),
            }
        }
        found
    }

    /// Whether every key has this value.
    pub(super) fn is(&self, value: f64) -> bool {
        self.keys.iter().all(|key| (key.1 - value).abs() <= ROUNDING)
    }

    /// The rate of a falloff: the value of the first key.
    pub(super) fn rate(&self) -> f64 {
        self.keys.first().map_or(1.0, |key| key.1).clamp(Falloff::LEAST, Falloff::MOST)
    }

    /// The value on a frame: linear between keys.
    pub(super) fn at(&self, frame: f64) -> f64 {
        let after = self.keys.partition_point(|key| key.0 < frame);
        match (after.checked_sub(1).map(|k| self.keys[k]), self.keys.get(after)) {
            (Some(a), Some(b)) => a.1 + (b.1 - a.1) * (frame - a.0) / (b.0 - a.0),
            (Some(key), None) | (None, Some(&key)) => key.1,
            (None, None) => 0.0,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn zeros_are_held_or_end_at_their_keys() {
        let far = f64::INFINITY;
        let keys = vec![(1.0, 0.0), (3.0, 5.0), (4.0, 0.0), (6.0, 0.0), (8.0, 5.0), (9.0, 0.0)];
        let channel = Channel::keyed(keys).unwrap();
        assert_eq!(channel.zeros(false), [[-far, 1.0], [4.0, 6.0], [9.0, far]]);
        assert_eq!(channel.zeros(true), [[-far, 2.0], [4.0, 7.0], [9.0, far]]);
    }

    #[test]
    fn values_are_linear_between_keys_and_held_outside() {
        let channel = Channel::keyed(vec![(6.0, 30.0), (2.0, 10.0)]).unwrap();
        assert_eq!([0.0, 2.0, 3.0, 6.0, 9.0].map(|frame| channel.at(frame)), [10.0, 10.0, 15.0, 30.0, 30.0]);
        assert_eq!(channel.turns().collect::<Vec<_>>(), [2.0, 6.0]);
        let still = Channel::keyed(vec![(4.0, 1.0)]).unwrap();
        assert!(still.is(1.0) && still.turns().next().is_none() && still.frames().eq([4.0]));
        assert!(Channel::constant(3.0).zeros(false).is_empty());
        assert_eq!(Channel::constant(0.0).zeros(true), [[f64::NEG_INFINITY, f64::INFINITY]]);
        assert!(Channel::constant(3.0).frames().next().is_none() && Channel::keyed(Vec::new()).is_none());
    }
}
