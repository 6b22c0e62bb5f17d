//! How far a piece can be grown: by doubling while it fits, then by halving the gap.
//!
//! Costs a number of tries that grows with the logarithm of the length. Limits: what fits again after it did not is not
//! found.

/// The last index up to `last` that a piece from `start` reaches; the next one always counts as reached.
///
/// `step` is the first length tried, `gap(good)` the difference at which a reached and an unreached index are near
/// enough.
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
