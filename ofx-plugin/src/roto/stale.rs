//! Tracks that were made from a source that has changed since, without the host saying so.
//!
//! They are known by a sum of their points. So undo, redo, new names and new tracks need no bookkeeping.

use rototoon::scene::Part;
use std::collections::BTreeSet;
use std::sync::Arc;

/// Sums of stale tracks.
#[derive(Clone, Debug, Default)]
pub struct Stale(Arc<BTreeSet<u64>>);

impl Stale {
    /// Adds the tracks of parts.
    pub fn add<'a>(&mut self, parts: impl IntoIterator<Item = &'a Part>) {
        Arc::make_mut(&mut self.0).extend(parts.into_iter().filter(|part| !part.tracks.is_empty()).map(sum));
    }

    /// Removes the tracks of parts.
    pub fn remove<'a>(&mut self, parts: impl IntoIterator<Item = &'a Part>) {
        if self.0.is_empty() {
            return;
        }
        let known = Arc::make_mut(&mut self.0);
        parts.into_iter().for_each(|part| {
            known.remove(&sum(part));
        });
    }

    /// Whether the tracks of a part are stale.
    pub fn has(&self, part: &Part) -> bool {
        !self.0.is_empty() && self.0.contains(&sum(part))
    }
}

/// A sum of a part's tracks. Coordinates count as documents round them.
fn sum(part: &Part) -> u64 {
    let mut sum = 0xcbf2_9ce4_8422_2325u64;
    let mut add = |value: u64| sum = (sum.rotate_left(29) ^ value).wrapping_mul(0x9e37_79b9_7f4a_7c15);
    for (frame, points) in &part.tracks {
        add(*frame as u64);
        points.iter().flat_map(|p| [p.x, p.y]).for_each(|value| add((value * 1e4).round() as i64 as u64));
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::*;
    use rototoon::geometry::Point;

    #[test]
    fn tracks_are_stale_until_they_are_others() {
        let track = |x: f64| (0..3).map(|frame| (frame, vec![Point::new(x, 1.0)])).collect();
        let part = |x: f64| Part { name: "a".into(), tracks: track(x), ..Part::default() };
        let untracked = Part { name: "b".into(), ..Part::default() };
        let mut stale = Stale::default();
        stale.add(&[part(1.0), untracked.clone()]);
        assert!(stale.has(&part(1.0)) && stale.has(&part(1.000_01)) && !stale.has(&part(1.1)));
        assert!(!stale.has(&untracked) && stale.has(&Part { name: "renamed".into(), ..part(1.0) }));
        stale.remove(&[part(2.0)]);
        assert!(stale.has(&part(1.0)));
        stale.remove(&[part(1.0)]);
        assert!(!stale.has(&part(1.0)));
    }
}
