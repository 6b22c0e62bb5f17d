//! One order from back to front for what lies on many frames.

use std::collections::{BTreeMap, BTreeSet, VecDeque};

/// All members of some lists, each once, in an order that is that of each list. Where lists disagree, the member comes next that the fewest lists have behind
/// another one that is left, and of several such the one of the earliest list.
pub(super) fn common<T: Copy + Ord>(lists: &[Vec<T>]) -> Vec<T> {
    let all: Vec<T> = lists.iter().flatten().copied().collect::<BTreeSet<T>>().into_iter().collect();
    let numbers: BTreeMap<T, usize> = all.iter().copied().zip(0..).collect();
    let distinct = |list: &Vec<T>| {
        let mut known = BTreeSet::new();
        list.iter().map(|member| numbers[member]).filter(|&k| known.insert(k)).collect::<VecDeque<usize>>()
    };
    let mut left: Vec<VecDeque<usize>> = lists.iter().map(distinct).collect();
    // In how many lists something that is left comes before a member.
    let mut waits = vec![0_usize; all.len()];
    left.iter().flat_map(|list| list.iter().skip(1)).for_each(|&k| waits[k] += 1);
    // The lists of each member, so that one that is in few of them is not looked for in all: a film has thousands of frames.
    let mut lists_of = vec![Vec::new(); all.len()];
    left.iter().enumerate().for_each(|(at, list)| list.iter().for_each(|&k| lists_of[k].push(at)));
    let mut order = Vec::with_capacity(all.len());
    while let Some(next) = left.iter().filter_map(|list| list.front().copied()).min_by_key(|&k| waits[k]) {
        order.push(all[next]);
        for &at in &lists_of[next] {
            let list = &mut left[at];
            if list.front() == Some(&next) {
                list.pop_front();
                list.front().into_iter().for_each(|&k| waits[k] -= 1);
            } else {
                list.retain(|&k| k != next);
            }
        }
    }
    order
}

#[cfg(test)]
mod tests {
    use super::common;

    #[track_caller]
    fn check(lists: &[&str], expected: &str) {
        let lists: Vec<Vec<char>> = lists.iter().map(|list| list.chars().collect()).collect();
        assert_eq!(common(&lists).into_iter().collect::<String>(), expected);
    }

    #[test]
    fn the_order_is_that_of_each_list() {
        check(&["ab", "acb"], "acb");
        check(&["ab", "cb", "ac"], "acb");
        check(&["b", "cb", "ac"], "acb");
        check(&["b", "a"], "ba");
        check(&["aba", ""], "ab");
        check(&[], "");
    }

    #[test]
    fn where_lists_disagree_the_earliest_counts_and_the_others_keep_their_places() {
        check(&["ab", "ba"], "ab");
        check(&["c", "abc", "bac"], "abc");
        check(&["cab", "bc"], "cab");
    }
}
