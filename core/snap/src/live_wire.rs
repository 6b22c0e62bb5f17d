//! The path of least cost through a grid of pixels (Dijkstra 1959), as intelligent scissors use it.
//!
//! Steps go to the eight neighbours. Costs are whole numbers, so sums are exact and ties are the same on every machine.
//! Of predecessors with equal cost the one with the smaller index is kept. So the path depends on the costs alone, not
//! on the order of the queue.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

/// The eight neighbours as (column, row) steps. They are ordered by direction from the x axis towards the y axis, an
/// eighth of a turn apart.
pub(super) const NEIGHBOURS: [(isize, isize); 8] =
    [(1, 0), (1, 1), (0, 1), (-1, 1), (-1, 0), (-1, -1), (0, -1), (1, -1)];

/// The path of least total cost from `start` to `goal` in a grid of `width` × `height` pixels, as pixel indices with
/// both ends.
///
/// `cost(from, to, k)` is the cost of the step in direction `NEIGHBOURS[k]`. A cost of 0 counts as 1. `None` forbids
/// the step. The result is `None` if the goal cannot be reached.
pub(super) fn shortest_path(
    (width, height): (usize, usize),
    start: usize,
    goal: usize,
    cost: impl Fn(usize, usize, usize) -> Option<u32>,
) -> Option<Vec<usize>> {
    let mut best = vec![u32::MAX; width * height];
    let mut parent = vec![usize::MAX; width * height];
    let mut queue = BinaryHeap::new();
    best[start] = 0;
    queue.push(Reverse((0, start)));
    while let Some(Reverse((known, from))) = queue.pop() {
        if known > best[from] {
            continue;
        }
        if from == goal {
            return Some(trace(&parent, start, goal));
        }
        for (k, &(dx, dy)) in NEIGHBOURS.iter().enumerate() {
            let (x, y) = ((from % width).wrapping_add_signed(dx), (from / width).wrapping_add_signed(dy));
            if x >= width || y >= height {
                continue;
            }
            let to = y * width + x;
            let Some(step) = cost(from, to, k) else { continue };
            let total = known.saturating_add(step.max(1));
            if total < best[to] {
                best[to] = total;
                parent[to] = from;
                queue.push(Reverse((total, to)));
            } else if total == best[to] && from < parent[to] && to != start {
                parent[to] = from;
            }
        }
    }
    None
}

fn trace(parent: &[usize], start: usize, goal: usize) -> Vec<usize> {
    let mut path = vec![goal];
    let mut at = goal;
    while at != start {
        at = parent[at];
        path.push(at);
    }
    path.reverse();
    path
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// Least costs from `start` by Bellman–Ford: every step is tried until nothing changes.
    fn naive(
        (width, height): (usize, usize),
        start: usize,
        cost: impl Fn(usize, usize, usize) -> Option<u32>,
    ) -> Vec<u32> {
        let mut best = vec![u32::MAX; width * height];
        best[start] = 0;
        loop {
            let before = best.clone();
            for from in 0..width * height {
                for (k, (dx, dy)) in NEIGHBOURS.into_iter().enumerate() {
                    let (x, y) = ((from % width) as isize + dx, (from / width) as isize + dy);
                    if best[from] == u32::MAX || x < 0 || y < 0 || x >= width as isize || y >= height as isize {
                        continue;
                    }
                    let to = y as usize * width + x as usize;
                    if let Some(step) = cost(from, to, k) {
                        best[to] = best[to].min(best[from] + step);
                    }
                }
            }
            if best == before {
                return best;
            }
        }
    }

    proptest! {
        #[test]
        fn the_path_costs_what_the_naive_search_finds(
            width in 1usize..9,
            height in 1usize..9,
            pixels in prop::collection::vec(0u32..6, 64),
            ends in (0usize..64, 0usize..64),
        ) {
            let (start, goal) = (ends.0 % (width * height), ends.1 % (width * height));
            // Pixels of value 0 are walls. Diagonal steps cost more.
            let cost = |_: usize, to: usize, k: usize| (pixels[to] > 0).then(|| pixels[to] * (2 + (k % 2) as u32));
            let expected = naive((width, height), start, cost)[goal];
            match shortest_path((width, height), start, goal, cost) {
                None => prop_assert_eq!(expected, u32::MAX),
                Some(path) => {
                    prop_assert_eq!((path[0], path[path.len() - 1]), (start, goal));
                    let mut total = 0;
                    for pair in path.windows(2) {
                        let dx = (pair[1] % width) as isize - (pair[0] % width) as isize;
                        let dy = (pair[1] / width) as isize - (pair[0] / width) as isize;
                        let k = NEIGHBOURS.iter().position(|&n| n == (dx, dy)).expect("steps go to neighbours");
                        total += cost(pair[0], pair[1], k).expect("no step into a wall");
                    }
                    prop_assert_eq!(total, expected);
                }
            }
        }
    }

    #[test]
    fn of_equal_paths_the_one_with_smaller_indices_is_taken() {
        // There are two ways around a wall in the middle of a 3 × 3 grid, with the same cost.
        let cost = |_: usize, to: usize, _: usize| (to != 4).then_some(1);
        assert_eq!(shortest_path((3, 3), 3, 5, cost), Some(vec![3, 1, 5]));
    }

    #[test]
    fn a_goal_behind_a_wall_is_not_reached() {
        assert_eq!(shortest_path((3, 1), 0, 2, |_, to, _| (to != 1).then_some(1)), None);
        assert_eq!(shortest_path((3, 1), 1, 1, |_, _, _| Some(1)), Some(vec![1]));
    }
}
