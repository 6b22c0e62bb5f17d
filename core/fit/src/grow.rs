//! The largest length to which a piece can grow: doubling while it fits, then halving the gap.
//!
//! The number of tries grows with the logarithm of the length. Limits: a length that fits again after a shorter one
//! failed is not found.

/// The last index up to `last` that a piece from `start` reaches. The index after `start` always counts as reached.
///
/// `step` is the first length tried. The search ends when a reached and an unreached index differ by at most
/// `gap(good)`.
pub(super) fn grow(
    start: usize,
    last: usize,
    mut step: usize,
    gap: impl Fn(usize) -> usize,
    fits: impl Fn(usize) -> bool,
) -> usize {
    let mut good = start + 1;
    let mut bad = loop {
        let end = (start + step).min(last);
        if end <= good {
            return last;
        }
        if !fits(end) {
            break end;
        }
        good = end;
        step *= 2;
    };
    while bad - good > gap(good) {
        let middle = (good + bad) / 2;
        if fits(middle) { good = middle } else { bad = middle }
    }
    good
}
