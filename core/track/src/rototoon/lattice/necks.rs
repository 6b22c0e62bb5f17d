//! Necks of a part: places where what is behind may turn about them, such as the arms of a silhouette or the fingers of a hand.
//!
//! **Why.** A figure that is drawn with one contour moves its arms and legs by themselves. An arm that turns by a right angle is
//! too far away for an alignment, and the rest of the figure holds the lattice where it is. [`Limb`](super::limb::Limb) folds a
//! part that is one limb; it knows no branches.
//!
//! **How.** A neck is a pair of control points that are near to each other but far apart along the contour. What is
//! behind it, on the side with less area, has half of the contour between them as its length, and its area divided by that length
//! as its thickness. It is a *branch* if the rest of the part is much thicker. Otherwise it is a piece of the same limb. Each
//! node belongs to the piece of the contour that is nearest to it at the key. The nodes behind the neck turn about its middle; those
//! within half its width turn in proportion.
//!
//! **Limits.** A neck is found at the key. An arm that lies on the body there has none unless the contour runs around it.
//! Arms without a body, like a star's, are no branches. Of a contour with more control points, about [`MOST_POINTS`] are asked.

use super::mesh::{Binding, Mesh};
use rototoon_base::geometry::{Point, polyline};

/// What is behind a neck is at least this many times as long as the neck is wide.
const SLENDER: f64 = 1.5;
/// What is behind a neck is at most this share of the part's area.
const LARGEST: f64 = 0.5;
/// The rest of the part is at least this many times as thick as a branch.
const THICKER: f64 = 1.5;
/// A branch is at least this many times as long as the part's size. Alignment finds the tips of shorter ones.
const SHORTEST: f64 = 0.3;
/// Most necks of each kind.
const MOST: usize = 16;
/// Approximate number of control points of which each pair may be a neck.
const MOST_POINTS: usize = 80;
/// Fewest control points between the ends of a neck, on either side.
const FEWEST_BEHIND: usize = 2;

/// The necks of a part, the most slender ones first.
#[derive(Clone, Debug, Default)]
pub struct Necks {
    /// Those with a branch behind them.
    pub branches: Vec<Neck>,
    /// Those within a limb.
    pub others: Vec<Neck>,
}

/// A neck.
#[derive(Clone, Debug)]
pub struct Neck {
    ends: [Binding; 2],
    /// By node: how far it turns with what is behind the neck, 0 to 1.
    share: Vec<f64>,
}

/// A pair of control points, the contour behind which runs from the first to the second.
#[derive(Clone, Copy)]
struct Pair {
    ends: [usize; 2],
    width: f64,
    /// Length of what is behind, as a multiple of the width.
    ratio: f64,
    branch: bool,
}

impl Necks {
    /// The necks of a closed part.
    pub fn of(mesh: &Mesh) -> Self {
        let outline = Outline::new(mesh);
        let mut pairs = outline.pairs(mesh.size);
        pairs.sort_by(|a, b| b.ratio.total_cmp(&a.ratio));
        let nearest: Vec<f64> = mesh.rest.iter().map(|&p| outline.nearest(p)).collect();
        let of_kind = |branch: bool| -> Vec<Neck> {
            let pairs = pairs.iter().filter(|pair| pair.branch == branch);
            let neck = |pair: &Pair| Neck {
                ends: pair.ends.map(|k| mesh.control[k]),
                share: nearest.iter().map(|&at| outline.share(pair, at, mesh.side)).collect(),
            };
            outline.distinct(pairs).iter().map(neck).collect()
        };
        Self { branches: of_kind(true), others: of_kind(false) }
    }

    /// Whether there is none.
    pub fn is_empty(&self) -> bool {
        self.branches.is_empty() && self.others.is_empty()
    }
}

impl Neck {
    /// A pose in which what is behind the neck is turned about it by `angle`, in radians.
    pub fn turned(&self, nodes: &[Point], angle: f64) -> Vec<Point> {
        let middle = 0.5 * (self.ends[0].at(nodes) + self.ends[1].at(nodes));
        let turned = |(&p, &s): (&Point, &f64)| middle + Point::from_angle(angle * s).rotate(p - middle);
        nodes.iter().zip(&self.share).map(turned).collect()
    }
}

/// The contour at the key.
struct Outline {
    points: Vec<Point>,
    /// Length of the contour up to each control point, and at last the whole.
    along: Vec<f64>,
    /// Sum of the cross products of neighbours up to each control point, and at last of all.
    turned: Vec<f64>,
    /// Every so many control points may end a neck.
    step: usize,
}

impl Outline {
    fn new(mesh: &Mesh) -> Self {
        let points = mesh.control_points(&mesh.rest);
        let (mut along, mut turned) = (vec![0.0], vec![0.0]);
        for (k, (a, b)) in polyline::segments(&points, true).enumerate() {
            along.push(along[k] + a.distance(b));
            turned.push(turned[k] + a.perp_dot(b));
        }
        let step = points.len().div_ceil(MOST_POINTS).max(1);
        Self { points, along, turned, step }
    }

    fn length(&self) -> f64 {
        *self.along.last().unwrap_or(&0.0)
    }

    /// Length of the contour from one control point to another.
    fn between(&self, [i, j]: [usize; 2]) -> f64 {
        self.along[j] - self.along[i] + if j < i { self.length() } else { 0.0 }
    }

    /// All necks.
    fn pairs(&self, size: f64) -> Vec<Pair> {
        let n = self.points.len();
        let ends = || (0..n).step_by(self.step);
        let apart = |i: usize, j: usize| (j + n - i) % n > FEWEST_BEHIND && (i + n - j) % n > FEWEST_BEHIND;
        let pairs = ends().flat_map(|i| ends().filter(move |&j| i != j).map(move |j| [i, j]));
        pairs.filter(|&[i, j]| apart(i, j)).filter_map(|ends| self.pair(ends, size)).collect()
    }

    fn pair(&self, [i, j]: [usize; 2], size: f64) -> Option<Pair> {
        let (a, b) = (self.points[i], self.points[j]);
        let whole = *self.turned.last()?;
        let area = self.turned[j] - self.turned[i] + if j < i { whole } else { 0.0 } + b.perp_dot(a);
        let share = area / whole;
        let width = a.distance(b).max(1e-6);
        let length = 0.5 * (self.between([i, j]) - width);
        let behind = share > 0.0 && share <= LARGEST && length >= SLENDER * width;
        let rest = 0.5 * (self.length() - 2.0 * length);
        let thicker = (1.0 - share) / rest >= THICKER * share / length;
        behind.then(|| Pair {
            ends: [i, j],
            width,
            ratio: length / width,
            branch: thicker && length >= SHORTEST * size,
        })
    }

    /// The first necks of some, without those whose ends are both next to those of an earlier one.
    fn distinct<'a>(&self, pairs: impl Iterator<Item = &'a Pair>) -> Vec<Pair> {
        let n = self.points.len();
        let next = |a: usize, b: usize| a.abs_diff(b).min(n - a.abs_diff(b)) <= self.step;
        let mut kept: Vec<Pair> = Vec::new();
        for pair in pairs {
            let known = |k: &Pair| next(k.ends[0], pair.ends[0]) && next(k.ends[1], pair.ends[1]);
            if kept.len() < MOST && !kept.iter().any(known) {
                kept.push(*pair);
            }
        }
        kept
    }

    /// Length of the contour up to its point that is nearest to `p`.
    fn nearest(&self, p: Point) -> f64 {
        let on = polyline::segments(&self.points, true).map(|(a, b)| (polyline::nearest_on_segment(p, a, b), a));
        let nearest =
            on.enumerate().min_by(|(_, (a, _)), (_, (b, _))| a.distance_squared(p).total_cmp(&b.distance_squared(p)));
        nearest.map_or(0.0, |(k, (place, start))| self.along[k] + start.distance(place))
    }

    /// How far a node turns with what is behind a neck, whose nearest place of the contour is `at`. `least` is the smallest
    /// width over which that changes.
    fn share(&self, pair: &Pair, at: f64, least: f64) -> f64 {
        let from = (at - self.along[pair.ends[0]]).rem_euclid(self.length());
        let to = self.between(pair.ends) - from;
        (2.0 * from.min(to) / pair.width.max(least)).clamp(0.0, 1.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn mesh(outline: &[(f64, f64)]) -> Mesh {
        Mesh::new(&outline.iter().map(|&(x, y)| Point::new(x, y)).collect::<Vec<_>>(), true)
    }

    /// A body of 100 × 120 with an arm of 100 × 16 at its right side, from y = 40 on.
    fn armed() -> Mesh {
        mesh(&[
            (100.0, 100.0),
            (150.0, 100.0),
            (200.0, 100.0),
            (200.0, 140.0),
            (250.0, 140.0),
            (300.0, 140.0),
            (300.0, 156.0),
            (250.0, 156.0),
            (200.0, 156.0),
            (200.0, 220.0),
            (150.0, 220.0),
            (100.0, 220.0),
            (100.0, 160.0),
        ])
    }

    #[test]
    fn an_arm_is_a_branch_of_a_body_in_either_direction_of_the_contour() {
        let forwards = armed();
        let mut points = forwards.control_points(&forwards.rest);
        points.reverse();
        for mesh in [forwards, Mesh::new(&points, true)] {
            let necks = Necks::of(&mesh);
            assert!(!necks.branches.is_empty());
            let at = |place: (f64, f64), nodes: &[Point]| mesh.bind(Point::new(place.0, place.1)).at(nodes);
            let moved = |neck: &Neck, place: (f64, f64)| {
                at(place, &neck.turned(&mesh.rest, 1.0)).distance(Point::new(place.0, place.1))
            };
            // Each branch moves the hand and leaves the body. One turns the whole arm.
            assert!(
                necks
                    .branches
                    .iter()
                    .all(|neck| moved(neck, (295.0, 148.0)) > 20.0 && moved(neck, (130.0, 180.0)) < 1e-9)
            );
            let whole = |neck: &&Neck| (moved(neck, (290.0, 148.0)) - 2.0 * 90.0 * 0.5f64.sin()).abs() < 8.0;
            assert!(necks.branches.iter().any(|neck| whole(&neck)));
        }
    }

    #[test]
    fn a_turn_by_nothing_changes_nothing() {
        let mesh = armed();
        let necks = Necks::of(&mesh);
        for neck in necks.branches.iter().chain(&necks.others) {
            let same = neck.turned(&mesh.rest, 0.0);
            assert!(same.iter().zip(&mesh.rest).all(|(a, b)| a.distance(*b) < 1e-9));
        }
    }

    #[test]
    fn a_bar_has_necks_but_no_branches_and_a_square_has_neither() {
        let bar = Necks::of(&mesh(&[
            (100.0, 100.0),
            (150.0, 100.0),
            (200.0, 100.0),
            (260.0, 100.0),
            (260.0, 120.0),
            (200.0, 120.0),
            (150.0, 120.0),
            (100.0, 120.0),
        ]));
        assert!(bar.branches.is_empty() && !bar.others.is_empty());
        let square = Necks::of(&mesh(&[
            (100.0, 100.0),
            (130.0, 100.0),
            (160.0, 100.0),
            (160.0, 160.0),
            (130.0, 160.0),
            (100.0, 160.0),
        ]));
        assert!(square.branches.is_empty() && square.others.is_empty());
    }

    #[test]
    fn necks_of_contours_without_a_shape_are_finite() {
        for outline in [
            vec![(5.0, 5.0)],
            vec![(5.0, 5.0); 9],
            vec![(0.0, 0.0), (50.0, 0.0), (90.0, 0.0), (50.0, 0.0), (20.0, 0.0), (10.0, 0.0)],
        ] {
            let necks = Necks::of(&mesh(&outline));
            let finite = |neck: &Neck| neck.share.iter().all(|s| s.is_finite());
            assert!(necks.branches.iter().chain(&necks.others).all(finite));
        }
    }

    #[test]
    fn contours_of_many_points_have_few_necks() {
        let point = |k: usize| {
            let angle = std::f64::consts::TAU * k as f64 / 2000.0;
            let radius = 60.0 + 40.0 * (5.0 * angle).cos();
            (200.0 + radius * angle.cos(), 200.0 + radius * angle.sin())
        };
        let necks = Necks::of(&mesh(&(0..2000).map(point).collect::<Vec<_>>()));
        // A star has no body, so its arms are no branches.
        assert!(necks.branches.is_empty() && !necks.others.is_empty() && necks.others.len() <= MOST);
    }
}
