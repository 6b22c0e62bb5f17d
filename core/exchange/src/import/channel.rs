//! Numbers that may be animated.

use rototoon_base::scene::Falloff;

/// A difference that comes from 32-bit floats.
const ROUNDING: f64 = 1e-6;

/// A number with its keys in the order of time.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Channel {
    keys: Vec<Key>,
    animated: bool,
}

/// A value on a frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Key {
    pub frame: f64,
    pub value: f64,
    pub way: Way,
}

/// How a number goes on from a key to the next one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Way {
    /// Evenly.
    Linear,
    /// It keeps its value until the next key.
    Held,
    /// In a way that is not known here. It is taken as even.
    Other,
}

impl Channel {
    /// A number that does not change.
    pub(super) fn constant(value: f64) -> Self {
        Self { keys: vec![Key { frame: 0.0, value, way: Way::Linear }], animated: false }
    }

    /// A number that goes evenly between frames with values, in any order; `None` without any.
    pub(super) fn keyed(keys: Vec<(f64, f64)>) -> Option<Self> {
        Self::of_keys(keys.into_iter().map(|(frame, value)| Key { frame, value, way: Way::Linear }).collect())
    }

    /// A number with keys in any order; `None` without keys.
    pub(super) fn of_keys(mut keys: Vec<Key>) -> Option<Self> {
        keys.sort_by(|a, b| a.frame.total_cmp(&b.frame));
        (!keys.is_empty()).then_some(Self { keys, animated: true })
    }

    /// The frames of the keys; none for a number that does not change.
    pub(super) fn frames(&self) -> impl Iterator<Item = f64> + '_ {
        self.keys.iter().filter(|_| self.animated).map(|key| key.frame)
    }

    /// The frames on which the number may turn to other values. One key is the same as none.
    pub(super) fn turns(&self) -> impl Iterator<Item = f64> + '_ {
        self.frames().filter(|_| self.keys.len() > 1)
    }

    /// The frames on both sides of the ends of held values: the last frame of each, and the one after it.
    pub(super) fn ends(&self) -> impl Iterator<Item = f64> + '_ {
        let held = |pair: &&[Key]| pair[0].way == Way::Held && pair[0].value != pair[1].value;
        let ends = |pair: &[Key]| [(pair[1].frame.ceil() - 1.0).max(pair[0].frame), pair[1].frame.ceil()];
        self.keys.windows(2).filter(held).flat_map(ends)
    }

    /// Whether the number changes between keys in a way that is not known.
    pub(super) fn is_uncertain(&self) -> bool {
        self.keys.windows(2).any(|pair| pair[0].way == Way::Other && pair[0].value != pair[1].value)
    }

    /// The times in which the number is 0 or less, each with its beginning and its end. A held number keeps its value until
    /// the frame before the next key; `held` says that all keys hold.
    pub(super) fn zeros(&self, held: bool) -> Vec<[f64; 2]> {
        let zero = |key: &Key| key.value <= ROUNDING;
        let mut found: Vec<[f64; 2]> = Vec::new();
        for (k, key) in self.keys.iter().enumerate().filter(|(_, key)| zero(key)) {
            let end = match self.keys.get(k + 1) {
                None => f64::INFINITY,
                Some(next) if held || key.way == Way::Held => next.frame.ceil() - 1.0,
                Some(_) => key.frame,
            };
            match found.last_mut() {
                Some(before) if zero(&self.keys[k - 1]) => before[1] = end,
                _ => found.push([if k == 0 { f64::NEG_INFINITY } else { key.frame }, end]),
            }
        }
        found
    }

    /// Whether every key has this value.
    pub(super) fn is(&self, value: f64) -> bool {
        self.keys.iter().all(|key| (key.value - value).abs() <= ROUNDING)
    }

    /// The rate of a falloff: the value of the first key.
    pub(super) fn rate(&self) -> f64 {
        self.keys.first().map_or(1.0, |key| key.value).clamp(Falloff::LEAST, Falloff::MOST)
    }

    /// The value on a frame: linear between keys, or held.
    pub(super) fn at(&self, frame: f64) -> f64 {
        let after = self.keys.partition_point(|key| key.frame < frame);
        match (after.checked_sub(1).map(|k| self.keys[k]), self.keys.get(after)) {
            (Some(a), Some(b)) if a.way == Way::Held && frame < b.frame => a.value,
            (Some(a), Some(b)) => a.value + (b.value - a.value) * (frame - a.frame) / (b.frame - a.frame),
            (Some(key), None) | (None, Some(&key)) => key.value,
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

    #[test]
    fn held_values_end_at_the_next_key() {
        let key = |frame, value, way| Key { frame, value, way };
        let channel = Channel::of_keys(vec![
            key(1.0, 5.0, Way::Held),
            key(4.5, 5.0, Way::Held),
            key(7.0, 0.0, Way::Held),
            key(8.0, 3.0, Way::Linear),
            key(10.0, 4.0, Way::Other),
        ]);
        let channel = channel.unwrap();
        assert_eq!([3.0, 6.0, 6.9, 7.0, 8.0, 9.0].map(|frame| channel.at(frame)), [5.0, 5.0, 5.0, 0.0, 3.0, 3.5]);
        assert_eq!(channel.ends().collect::<Vec<_>>(), [6.0, 7.0, 7.0, 8.0]);
        assert_eq!(channel.zeros(false), [[7.0, 7.0]]);
        assert!(!channel.is_uncertain());
        let smooth = |value| Channel::of_keys(vec![key(1.0, 5.0, Way::Other), key(4.0, value, Way::Linear)]).unwrap();
        assert!(smooth(6.0).is_uncertain() && !smooth(5.0).is_uncertain() && smooth(6.0).ends().next().is_none());
    }
}
