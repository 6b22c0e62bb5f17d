//! Frames on which a file does not show a shape, as frames on which its part is absent.
//!
//! Programs say this in numbers: an opacity or an activity of 0. Here they become times, and the times become `absent`.
//!
//! - A part is there on each of its keys. So keys on hidden frames go. The shape gets a key on the shown frames beside them
//!   instead, with the form that it has there: linear between keys, held outside.
//! - A part is tracked between its first and its last key. What is hidden before and after says nothing, and is left out.
//! - A part with one key is followed outward, so hidden frames before and after its key count. If the key's frame is the
//!   only one shown, they say nothing about others: exports write a single key like this.

use crate::between::{Keys, form};
use rototoon_base::scene::{Footage, FrameNumber};

/// Takes the keys on hidden frames away, and returns the frames on which the part is absent. `times` are the first and the last
/// of each time in which the shape is hidden. `None` if it is hidden on all frames of the footage; its keys are kept then.
pub(super) fn hide(keys: &mut Keys, times: &[[f64; 2]], footage: &Footage) -> Option<Vec<[FrameNumber; 2]>> {
    let mut hidden = joined(times, footage);
    if hidden == [[footage.first, footage.last]] {
        return None;
    }
    let all = keys.clone();
    for &[first, last] in &hidden {
        let gone: Vec<FrameNumber> = all.range(first..=last).map(|(frame, _)| *frame).collect();
        if gone.is_empty() {
            continue;
        }
        let beside = [first.checked_sub(1), last.checked_add(1)].into_iter().flatten();
        for frame in beside.filter(|frame| (footage.first..=footage.last).contains(frame)) {
            keys.entry(frame).or_insert_with(|| form(&all, frame));
        }
        gone.iter().for_each(|frame| drop(keys.remove(frame)));
    }
    let (begin, end) = (*keys.keys().next()?, *keys.keys().next_back()?);
    if begin < end {
        hidden.retain(|[first, last]| begin < *first && *last < end);
    } else if hidden.iter().map(|[first, last]| i64::from(*last) - i64::from(*first) + 1).sum::<i64>()
        == i64::from(footage.last) - i64::from(footage.first)
    {
        hidden.clear();
    }
    Some(hidden)
}

/// The whole frames of times, in order, within the footage. Those that touch are one.
pub(super) fn joined(times: &[[f64; 2]], footage: &Footage) -> Vec<[FrameNumber; 2]> {
    let (first, last) = (f64::from(footage.first), f64::from(footage.last));
    let whole = times.iter().map(|[from, to]| [from.ceil().max(first), to.floor().min(last)]);
    let mut whole: Vec<[f64; 2]> = whole.filter(|[from, to]| from <= to).collect();
    whole.sort_by(|a, b| a[0].total_cmp(&b[0]));
    let mut found: Vec<[FrameNumber; 2]> = Vec::new();
    for [from, to] in whole {
        match found.last_mut() {
            Some(before) if from <= f64::from(before[1]) + 1.0 => before[1] = before[1].max(to as FrameNumber),
            _ => found.push([from as FrameNumber, to as FrameNumber]),
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;
    use rototoon_base::geometry::Point;

    /// Keys with the x of their point, which is the frame at first.
    type Found = (Vec<(FrameNumber, f64)>, Vec<[FrameNumber; 2]>);

    fn hidden(frames: &[FrameNumber], times: &[[f64; 2]]) -> Option<Found> {
        let footage = Footage { pattern: "%d".into(), first: 1, last: 20, fps: 1.0, width: 9, height: 9, held: false };
        let mut keys: Keys = frames.iter().map(|&frame| (frame, vec![Point::new(f64::from(frame), 0.0)])).collect();
        let absent = hide(&mut keys, times, &footage)?;
        Some((keys.into_iter().map(|(frame, points)| (frame, points[0].x)).collect(), absent))
    }

    #[test]
    fn only_what_is_hidden_between_keys_counts() {
        let far = f64::INFINITY;
        let at = |frames: &[FrameNumber]| frames.iter().map(|&f| (f, f64::from(f))).collect::<Vec<_>>();
        assert_eq!(hidden(&[3, 9], &[]), Some((at(&[3, 9]), vec![])));
        assert_eq!(hidden(&[3, 9], &[[-far, 2.0], [5.0, 6.0], [9.5, far]]), Some((at(&[3, 9]), vec![[5, 6]])));
        assert_eq!(hidden(&[3, 9], &[[6.2, 7.9], [4.0, 5.0], [6.0, 6.0]]), Some((at(&[3, 9]), vec![[4, 7]])));
        assert_eq!(hidden(&[3, 9], &[[-far, 8.0], [7.0, far]]), None);
        // One key is followed outward.
        assert_eq!(hidden(&[5], &[[-far, 3.0], [9.0, far]]), Some((at(&[5]), vec![[1, 3], [9, 20]])));
        assert_eq!(hidden(&[5], &[[-far, 4.0], [6.0, far]]), Some((at(&[5]), vec![])));
    }

    #[test]
    fn keys_on_hidden_frames_move_to_the_shown_ones_beside_them() {
        assert_eq!(
            hidden(&[3, 6, 9], &[[5.0, 7.0]]),
            Some((vec![(3, 3.0), (4, 4.0), (8, 8.0), (9, 9.0)], vec![[5, 7]]))
        );
        // Before the first key its form is held.
        assert_eq!(hidden(&[2], &[[1.0, 4.0], [8.0, 20.0]]), Some((vec![(5, 2.0)], vec![[1, 4], [8, 20]])));
    }
}
