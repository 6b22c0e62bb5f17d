//! Depths of parts in the order of a file.
//!
//! Artists move a shape before or behind another one in a list. Of the parts that the file has, as few as possible move: the longest run that lies in
//! order already stays. Each other part gets a depth between those of its neighbours in the file, or one beyond the last.
//!
//! Parts of equal depth lie in the order of the document, as exports write them. If there is no number between two neighbours, or they are equal, all
//! parts of the document get whole numbers in their order first.
//!
//! Limits: depths of single frames stay. No format of shapes has them.

use rototoon_base::scene::Part;

/// Gives parts depths for the order in which they are in `found`, farthest first. Returns the places of those that moved.
pub(super) fn put(parts: &mut [Part], found: &[usize]) -> Vec<usize> {
    let rank = ranks(parts);
    let stays = longest_rise(&found.iter().map(|&place| rank[place]).collect::<Vec<_>>());
    let moved: Vec<usize> = (0..found.len()).filter(|k| !stays.contains(k)).collect();
    if moved.is_empty() {
        return Vec::new();
    }
    if !fit(parts, found, &stays) {
        for (place, part) in parts.iter_mut().enumerate() {
            part.depth = rank[place] as f64;
        }
        fit(parts, found, &stays);
    }
    moved.into_iter().map(|k| found[k]).collect()
}

/// The place of each part in the order of all, farthest first.
fn ranks(parts: &[Part]) -> Vec<usize> {
    let mut order: Vec<usize> = (0..parts.len()).collect();
    order.sort_by(|&a, &b| parts[a].depth.total_cmp(&parts[b].depth));
    let mut rank = vec![0; parts.len()];
    order.into_iter().enumerate().for_each(|(k, place)| rank[place] = k);
    rank
}

/// Indices of a longest run of values that rise, in order.
fn longest_rise(values: &[usize]) -> Vec<usize> {
    // Length of the longest run that ends with each value, and the one before it there.
    let mut best: Vec<(usize, Option<usize>)> = Vec::with_capacity(values.len());
    for (k, value) in values.iter().enumerate() {
        let before = (0..k).filter(|&j| values[j] < *value).max_by_key(|&j| (best[j].0, std::cmp::Reverse(j)));
        best.push((before.map_or(1, |j| best[j].0 + 1), before));
    }
    let mut at = (0..values.len()).max_by_key(|&k| (best[k].0, std::cmp::Reverse(k)));
    let mut run = Vec::new();
    while let Some(k) = at {
        run.push(k);
        at = best[k].1;
    }
    run.reverse();
    run
}

/// Gives the parts that do not stay depths between those that do. Returns whether there was room for all.
fn fit(parts: &mut [Part], found: &[usize], stays: &[usize]) -> bool {
    let mut k = 0;
    while k < found.len() {
        let end = (k..found.len()).find(|j| stays.contains(j)).unwrap_or(found.len());
        let before = k.checked_sub(1).map(|j| parts[found[j]].depth);
        let after = found.get(end).map(|&place| parts[place].depth);
        let steps = (end - k + 1) as f64;
        for (step, &place) in found[k..end].iter().enumerate() {
            let step = step as f64 + 1.0;
            parts[place].depth = match (before, after) {
                (Some(a), Some(b)) => a + (b - a) * step / steps,
                (Some(a), None) => a + step,
                (None, Some(b)) => b - (steps - step),
                (None, None) => step,
            };
        }
        k = end + 1;
    }
    found.windows(2).all(|pair| parts[pair[0]].depth < parts[pair[1]].depth || stays_tied(parts, pair))
}

/// Whether two parts of equal depth lie in their order in the document, which then counts.
fn stays_tied(parts: &[Part], pair: &[usize]) -> bool {
    parts[pair[0]].depth == parts[pair[1]].depth && pair[0] < pair[1]
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn parts(depths: &[f64]) -> Vec<Part> {
        depths.iter().map(|&depth| Part { depth, ..Part::default() }).collect()
    }

    fn depths(own: &[f64], found: &[usize]) -> (Vec<f64>, Vec<usize>) {
        let mut parts = parts(own);
        let moved = put(&mut parts, found);
        (parts.iter().map(|part| part.depth).collect(), moved)
    }

    #[test]
    fn one_part_moves_between_its_neighbours() {
        let own = [0.0, 1.0, 2.0, 8.0];
        assert_eq!(depths(&own, &[0, 1, 2, 3]), (own.to_vec(), vec![]));
        assert_eq!(depths(&own, &[0, 2, 3]), (own.to_vec(), vec![]), "a file with some of the parts");
        assert_eq!(depths(&own, &[3, 0, 1, 2]), (vec![0.0, 1.0, 2.0, -1.0], vec![3]));
        assert_eq!(depths(&own, &[1, 2, 0, 3]), (vec![5.0, 1.0, 2.0, 8.0], vec![0]));
        assert_eq!(depths(&own, &[1, 2, 3, 0]), (vec![9.0, 1.0, 2.0, 8.0], vec![0]));
    }

    #[test]
    fn parts_of_equal_depth_lie_in_the_order_of_the_document() {
        assert_eq!(depths(&[4.0, 4.0, 4.0], &[0, 1, 2]), (vec![4.0; 3], vec![]));
        // Between equal depths there is no room.
        assert_eq!(depths(&[4.0; 4], &[0, 3, 1, 2]), (vec![0.0, 1.0, 2.0, 0.5], vec![3]));
    }

    proptest! {
        #[test]
        fn the_parts_lie_as_in_the_file(own in prop::collection::vec(0..4i32, 1..8), keys in prop::collection::vec(0..1000u32, 8), count in 1..8usize) {
            let mut parts = parts(&own.iter().map(|&depth| f64::from(depth)).collect::<Vec<_>>());
            let mut found: Vec<usize> = (0..parts.len()).collect();
            found.sort_by_key(|&place| (keys[place], place));
            found.truncate(count);
            let before = parts.clone();
            let moved = put(&mut parts, &found);
            let rank = ranks(&parts);
            prop_assert!(found.windows(2).all(|pair| rank[pair[0]] < rank[pair[1]]), "{:?}", parts.iter().map(|p| p.depth).collect::<Vec<_>>());
            // All others keep their order among themselves.
            let old = ranks(&before);
            for a in (0..parts.len()).filter(|place| !moved.contains(place)) {
                for b in (0..parts.len()).filter(|place| !moved.contains(place)) {
                    prop_assert_eq!(old[a] < old[b], rank[a] < rank[b]);
                }
            }
            prop_assert!(put(&mut parts, &found).is_empty());
        }
    }
}
