//! The order in which a document lists its parts.

use super::scene::{Drawn, LAST, Shape, points, track};
use crate::contract::tracking::PartTrack;
use rototoon_base::geometry::Point;
use std::collections::BTreeMap;

const NAMES: [&str; 6] = ["far hind leg", "near hind leg", "far fore leg", "near fore leg", "body", "tail"];

/// An animal whose four legs look alike and swing past each other, some of them unevenly. Where parts are chosen in the order of the list, the second of the
/// orders below gives other tracks.
fn animal() -> Drawn {
    let leg = |motion: fn(f64) -> (Point, f64)| Shape {
        rest: points(&[(-6.0, -6.0), (6.0, -6.0), (6.0, 30.0), (5.0, 60.0), (-5.0, 60.0), (-6.0, 30.0)]),
        colour: [0.5, 0.5, 0.5],
        motion,
    };
    let body = Shape {
        rest: points(&[(-60.0, -25.0), (60.0, -25.0), (64.0, 8.0), (-64.0, 8.0)]),
        colour: [0.5, 0.5, 0.5],
        motion: |t| (Point::new(118.0 + t, 80.0), 0.0),
    };
    let tail = Shape {
        rest: points(&[(0.0, -5.0), (40.0, -4.0), (42.0, 0.0), (40.0, 4.0), (0.0, 5.0)]),
        colour: [0.5, 0.5, 0.5],
        motion: |t| (Point::new(176.0 + t, 64.0), -70.0 + 20.0 * t),
    };
    Drawn(vec![
        leg(|t| (Point::new(152.0 + t, 84.0), 45.0 - 15.0 * t - 2.4 * t * (6.0 - t))),
        leg(|t| (Point::new(164.0 + t, 84.0), -45.0 + 15.0 * t + 3.6 * t * (6.0 - t))),
        leg(|t| (Point::new(76.0 + t, 84.0), -40.0 + 14.0 * t)),
        leg(|t| (Point::new(88.0 + t, 84.0), 40.0 - 14.0 * t - 4.2 * t * (6.0 - t))),
        body,
        tail,
    ])
}

/// The tracks of the parts by name, where the document lists them in this order.
fn listed(order: [usize; 6]) -> BTreeMap<&'static str, PartTrack> {
    let drawn = animal();
    let parts = order.map(|k| drawn.0[k].part(NAMES[k], k as f64));
    let tracking = track(&drawn, &drawn.scene(parts.into()));
    order.into_iter().map(|k| NAMES[k]).zip(tracking.parts).collect()
}

#[test]
fn the_order_in_which_parts_are_listed_changes_nothing() {
    let first = listed([0, 1, 2, 3, 4, 5]);
    assert!(first.values().all(|part| part.tracks.len() == LAST as usize + 1));
    for order in [[5, 4, 3, 2, 1, 0], [3, 0, 5, 2, 4, 1], [2, 3, 1, 0, 5, 4]] {
        assert!(listed(order) == first, "{order:?}");
    }
}
