//! Keys with which the host's curve passes through the values that a part's setting had.
//!
//! OpenFX gives the times and values of keys, but neither reads nor sets how a host interpolates between them: held, linear or eased. Keys that
//! are put away and come back therefore come back with the host's own default. So the values of all frames are stored too, and where the
//! curve passes beside them, it gets more keys: first one on the frame before the next key, which is enough for a value that was held, and
//! where it is not, keys on all frames between the two.

use super::state::Curve;
use crate::ofx::Failure;
use std::ops::Range;

/// Rounds in which keys are added. Keys on all frames of a gap may bend the curve in the gaps beside it.
const ROUNDS: usize = 4;
/// Share of a value by which hosts may round it; of 1 for smaller values.
const ROUNDED: f64 = 1e-5;

/// Adds keys to a host's curve that has the keys of `curve`, until it has its values on all frames. `read` gives the host's value at a
/// time, `put` sets a key.
pub fn keep(
    curve: &Curve,
    read: &dyn Fn(f64) -> Result<f64, Failure>,
    put: &dyn Fn(f64, f64) -> Result<(), Failure>,
) -> Result<(), Failure> {
    let mut times: Vec<f64> = curve.keys.iter().map(|key| key[0]).collect();
    for round in 0..ROUNDS {
        times.sort_by(f64::total_cmp);
        let (off, mut done) = (beside(curve, read)?, 0);
        if off.is_empty() {
            break;
        }
        for frame in off {
            if frame < done {
                continue;
            }
            let gap = gap(curve, &times, frame);
            done = gap.end;
            for frame in if round == 0 { gap.end.saturating_sub(1).max(gap.start)..gap.end } else { gap } {
                let time = f64::from(curve.first) + frame as f64;
                put(time, curve.frames[frame])?;
                times.push(time);
            }
        }
    }
    Ok(())
}

/// The frames between the keys before and after a frame, as indices. Empty on a key.
fn gap(curve: &Curve, times: &[f64], frame: usize) -> Range<usize> {
    let (first, time) = (f64::from(curve.first), f64::from(curve.first) + frame as f64);
    let after = times.partition_point(|key| *key < time);
    if times.get(after) == Some(&time) {
        return frame + 1..frame + 1;
    }
    let end = times.get(after).map_or(curve.frames.len(), |key| (key - first).ceil() as usize);
    let start = after.checked_sub(1).map_or(0, |before| ((times[before] - first).floor() + 1.0) as usize);
    start..end.min(curve.frames.len())
}

/// The indices of the frames on which the host's curve has other values.
fn beside(curve: &Curve, read: &dyn Fn(f64) -> Result<f64, Failure>) -> Result<Vec<usize>, Failure> {
    let mut off = Vec::new();
    for (index, wanted) in curve.frames.iter().enumerate() {
        let found = read(f64::from(curve.first) + index as f64)?;
        if (found - wanted).abs() > ROUNDED * wanted.abs().max(1.0) {
            off.push(index);
        }
    }
    Ok(off)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::cell::RefCell;
    use std::collections::BTreeMap;

    /// The keys of a host whose value between two keys is `mixed` of their values and the share of the way.
    fn kept(curve: &Curve, mixed: fn(f64, f64, f64) -> f64) -> Vec<[f64; 2]> {
        let keys: RefCell<BTreeMap<i64, f64>> =
            RefCell::new(curve.keys.iter().map(|[time, value]| ((time * 10.0) as i64, *value)).collect());
        let read = |time: f64| {
            let (keys, time) = (keys.borrow(), (time * 10.0) as i64);
            let before = keys.range(..=time).next_back().or_else(|| keys.first_key_value()).unwrap();
            let after = keys.range(time..).next().or_else(|| keys.last_key_value()).unwrap();
            let share = (time - before.0) as f64 / (after.0 - before.0).max(1) as f64;
            Ok(if before.0 == after.0 { *before.1 } else { mixed(*before.1, *after.1, share) })
        };
        let put = |time: f64, value: f64| {
            assert!(keys.borrow_mut().insert((time * 10.0) as i64, value).is_none(), "a key is set twice on {time}");
            Ok(())
        };
        keep(curve, &read, &put).unwrap();
        assert_eq!(beside(curve, &read).unwrap(), [0usize; 0]);
        keys.into_inner().into_iter().map(|(time, value)| [time as f64 / 10.0, value]).collect()
    }

    fn linear(a: f64, b: f64, share: f64) -> f64 {
        a + share * (b - a)
    }

    fn curve(keys: &[[f64; 2]], first: i32, frames: &[f64]) -> Curve {
        Curve { value: 0.0, keys: keys.into(), first, frames: frames.into() }
    }

    #[test]
    fn a_value_that_was_held_gets_one_key_before_the_jump() {
        let held = curve(&[[-2.0, 1.0], [2.0, 0.0], [4.0, 0.0]], -2, &[1.0, 1.0, 1.0, 1.0, 0.0, 0.0, 0.0]);
        assert_eq!(kept(&held, linear), [[-2.0, 1.0], [1.0, 1.0], [2.0, 0.0], [4.0, 0.0]]);
        let between = curve(&[[0.5, 1.0], [3.5, 0.0]], 0, &[1.0, 1.0, 1.0, 1.0, 0.0]);
        assert_eq!(kept(&between, linear), [[0.5, 1.0], [3.0, 1.0], [3.5, 0.0]]);
    }

    #[test]
    fn an_eased_value_gets_keys_on_all_frames_of_its_gap_and_others_get_none() {
        let eased = curve(&[[0.0, 0.0], [4.0, 1.0], [8.0, 0.0]], 0, &[0.0, 0.1, 0.5, 0.9, 1.0, 0.75, 0.5, 0.25, 0.0]);
        assert_eq!(kept(&eased, linear).iter().map(|key| key[0]).collect::<Vec<_>>(), [0.0, 1.0, 2.0, 3.0, 4.0, 8.0]);
        let plain = curve(&[[0.0, 0.0], [2.0, 1.0]], 0, &[0.0, 0.5, 1.0]);
        assert_eq!(kept(&plain, linear).len(), 2);
        assert_eq!(kept(&plain, |a, b, share| linear(a, b, share * share)).len(), 3);
        assert_eq!(kept(&curve(&[[3.0, 0.4]], 3, &[0.4]), linear).len(), 1);
    }
}
