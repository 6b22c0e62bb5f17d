//! The order in which CPython goes through a set of small integers.
//!
//! The measure of an artist's remaining edits ([`crate::artist`]) has a reference implementation in Python. Where frames
//! are equally bad it takes them as a `set` hands them out, and which one is corrected first can change the number of
//! edits. So that figures can be held against each other to the last edit, the order is the same here.
//!
//! A CPython set (3.7 on, `Objects/setobject.c`) is an open-addressing table of a power of two, at least 8. An integer
//! is its own hash (−1 hashes to −2). A slot that is taken is followed by up to nine neighbours, as long as all nine lie
//! in the table, then by a jump that mixes in more bits of the hash. When three fifths are full, the elements move in
//! the order of their slots to a table of more than four times their number. Going through the set is going through the
//! slots. Sets of more than 50 000 elements grow otherwise; no footage here has as many frames.

/// Neighbours that are tried before a jump.
const NEIGHBOURS: usize = 9;
/// Bits of the hash that each jump uses up.
const SHIFT: u32 = 5;

/// The distinct ones of `values`, inserted in their order, as CPython goes through a set of them.
pub fn of_set(values: impl IntoIterator<Item = i32>) -> Vec<i32> {
    let mut table: Vec<Option<i32>> = vec![None; 8];
    let mut used = 0;
    for value in values {
        let slot = find(&table, value);
        if table[slot].is_some() {
            continue;
        }
        table[slot] = Some(value);
        used += 1;
        if used * 5 >= (table.len() - 1) * 3 {
            let mut larger = vec![None; (used * 4 + 1).next_power_of_two()];
            for value in table.into_iter().flatten() {
                let slot = find(&larger, value);
                larger[slot] = Some(value);
            }
            table = larger;
        }
    }
    table.into_iter().flatten().collect()
}

/// The slot that holds `value`, or the free one that it goes to.
fn find(table: &[Option<i32>], value: i32) -> usize {
    let hash = if value == -1 { -2 } else { i64::from(value) } as u64;
    let mask = table.len() as u64 - 1;
    let (mut at, mut perturb) = (hash & mask, hash);
    loop {
        let neighbours = if at as usize + NEIGHBOURS < table.len() { NEIGHBOURS } else { 0 };
        for slot in at as usize..=at as usize + neighbours {
            if table[slot].is_none_or(|held| held == value) {
                return slot;
            }
        }
        perturb >>= SHIFT;
        at = at.wrapping_mul(5).wrapping_add(1).wrapping_add(perturb) & mask;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::{any, prop, proptest};

    /// Each as CPython 3.11 printed `list({int(v) for v in values})`.
    #[test]
    fn as_cpython_does() {
        assert_eq!(of_set([3, 1, 2, 1]), [1, 2, 3]);
        assert_eq!(of_set([9, 8, 1]), [8, 9, 1]);
        assert_eq!(of_set([20, 12, 4, 28]), [4, 28, 20, 12]);
        assert_eq!(of_set([33, 1, 40, 8, 2, 65, 97]), [33, 2, 1, 65, 97, 40, 8]);
        assert_eq!(of_set([-1, -2, 5, -9]), [-9, 5, -1, -2]);
    }

    proptest! {
        #[test]
        fn each_value_comes_once(values in prop::collection::vec(any::<i32>(), 0..300)) {
            let mut order = of_set(values.iter().copied());
            let mut expected = values;
            expected.sort_unstable();
            expected.dedup();
            order.sort_unstable();
            assert_eq!(order, expected);
        }

        #[test]
        fn more_than_a_few_small_numbers_ascend(count in 5..80_i32, first in 0..40_i32) {
            // Dense and smaller than the table: every number has a slot of its own.
            let values: Vec<i32> = (0..first + count).collect();
            assert_eq!(of_set(values.iter().rev().copied()), values);
        }
    }
}
