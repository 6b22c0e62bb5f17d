//! Long parts as limbs: how far along the limb each node of a lattice is, and poses that are folded or stretched at a joint.
//!
//! **Why.** An arm or a leg bends at its elbow or knee. From one drawing to the next the lower half may turn by a right
//! angle, which is too far for an alignment: it finds the nearest place with the same colours, often another limb.
//! Rotations of the whole part are no help either, because only one half has turned. And a cartoon's arm may be drawn
//! half as long again, with the same colour all along, so that nothing pulls its end to the new place.
//!
//! **How.** The length along the limb is the shortest way through the cells from one end. The ends are the two nodes
//! that are farthest from each other that way. So a limb that is bent at its key has its length along the bend.
//! A fold turns all nodes beyond a joint about it. Nodes within half a width of the joint turn in proportion.
//!
//! Limit: where two stretches of a limb touch at the key, the shortest way crosses there.

use super::mesh::{Binding, Mesh};
use rototoon_base::geometry::Point;

/// A part is a limb if its length, with the band at both ends, is at least this many times its mean width.
const SLENDER: f64 = 5.0;

/// Places along a limb.
#[derive(Clone, Debug)]
pub struct Limb {
    /// By node: 0 at one end, 1 at the other.
    along: Vec<f64>,
    /// Mean width as a share of the length.
    width: f64,
}

/// A joint of a limb.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Joint {
    /// Its place along the limb, 0 to 1.
    pub place: f64,
    /// Whether the half towards 1 moves, or the one towards 0.
    pub towards_end: bool,
}

impl Limb {
    /// The lattice's part as a limb. `None` if it is not slender.
    pub fn of(mesh: &Mesh) -> Option<Self> {
        let ways = ways(mesh);
        let lengths = lengths(&ways, farthest(&lengths(&ways, 0)));
        let length = lengths[farthest(&lengths)];
        let width = (mesh.size - 1.0).powi(2) / length.max(1e-9);
        let slender = length.is_finite() && width > 0.0 && length >= SLENDER * width;
        slender.then(|| Self { along: lengths.iter().map(|d| d / length).collect(), width: width / length })
    }

    /// Place of a bound point along the limb.
    pub fn place_of(&self, binding: &Binding) -> f64 {
        binding.nodes.iter().zip(binding.weights).map(|(&n, w)| self.along[n] * w).sum()
    }

    /// A pose whose half beyond a joint is turned about the joint by `angle`, in radians.
    pub fn folded(&self, nodes: &[Point], joint: Joint, angle: f64) -> Vec<Point> {
        let pivot = self.middle(nodes, joint.place);
        let turned = |(&p, &s): (&Point, &f64)| {
            let beyond = if joint.towards_end { s - joint.place } else { joint.place - s };
            let share = (beyond / self.width + 0.5).clamp(0.0, 1.0);
            pivot + Point::from_angle(angle * share).rotate(p - pivot)
        };
        nodes.iter().zip(&self.along).map(turned).collect()
    }

    /// A pose whose half beyond a joint is `factor` times as long, straight towards its end.
    pub fn stretched(&self, nodes: &[Point], joint: Joint, factor: f64) -> Vec<Point> {
        let from = self.middle(nodes, joint.place);
        let end = self.middle(nodes, if joint.towards_end { 1.0 } else { 0.0 });
        let along = (end - from).normalize_or(Point::X);
        nodes.iter().map(|&p| p + along * ((p - from).dot(along).max(0.0) * (factor - 1.0))).collect()
    }

    /// The middle of the limb at a place along it, in a pose.
    fn middle(&self, nodes: &[Point], place: f64) -> Point {
        let near = |s: f64| (1.0 - (s - place).abs() / self.width).max(0.0);
        let weights: f64 = self.along.iter().map(|&s| near(s)).sum();
        nodes.iter().zip(&self.along).map(|(&p, &s)| p * near(s)).sum::<Point>() / weights.max(1e-9)
    }
}

/// By node: the other nodes of its cells, and how far they are at the key.
fn ways(mesh: &Mesh) -> Vec<Vec<(usize, f64)>> {
    let mut ways = vec![Vec::new(); mesh.rest.len()];
    for cell in &mesh.cells {
        for &a in cell {
            let others = cell.iter().filter(|&&b| b != a);
            ways[a].extend(others.map(|&b| (b, mesh.rest[a].distance(mesh.rest[b]))));
        }
    }
    ways
}

/// Length of the shortest way from a node to each other one (Dijkstra). Infinite where there is none.
fn lengths(ways: &[Vec<(usize, f64)>], start: usize) -> Vec<f64> {
    let mut lengths = vec![f64::INFINITY; ways.len()];
    let mut open = vec![start];
    lengths[start] = 0.0;
    while let Some(k) = (0..open.len()).min_by(|&a, &b| lengths[open[a]].total_cmp(&lengths[open[b]])) {
        let node = open.swap_remove(k);
        for &(next, step) in &ways[node] {
            if lengths[node] + step < lengths[next] {
                if lengths[next].is_infinite() {
                    open.push(next);
                }
                lengths[next] = lengths[node] + step;
            }
        }
    }
    lengths
}

fn farthest(lengths: &[f64]) -> usize {
    (0..lengths.len()).max_by(|&a, &b| lengths[a].total_cmp(&lengths[b])).unwrap_or(0)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn mesh(outline: &[(f64, f64)]) -> Mesh {
        Mesh::new(&outline.iter().map(|&(x, y)| Point::new(x, y)).collect::<Vec<_>>(), true)
    }

    /// A bar of 160 × 20 working pixels.
    fn bar() -> Mesh {
        mesh(&[(100.0, 100.0), (260.0, 100.0), (260.0, 120.0), (100.0, 120.0)])
    }

    #[test]
    fn bars_are_limbs_and_squares_are_not() {
        assert!(Limb::of(&bar()).is_some());
        assert!(Limb::of(&mesh(&[(100.0, 100.0), (160.0, 100.0), (160.0, 160.0), (100.0, 160.0)])).is_none());
        assert!(Limb::of(&mesh(&[(1.0, 1.0); 4])).is_none_or(|limb| limb.along.iter().all(|s| s.is_finite())));
    }

    #[test]
    fn places_follow_a_bend() {
        let bent =
            mesh(&[(100.0, 100.0), (220.0, 100.0), (220.0, 220.0), (200.0, 220.0), (200.0, 120.0), (100.0, 120.0)]);
        let limb = Limb::of(&bent).unwrap();
        let at = |x: f64, y: f64| limb.place_of(&bent.bind(Point::new(x, y)));
        let places = [at(105.0, 110.0), at(160.0, 110.0), at(210.0, 110.0), at(210.0, 160.0), at(210.0, 215.0)];
        let rising = places.windows(2).all(|two| two[0] < two[1] - 0.05);
        let falling = places.windows(2).all(|two| two[0] > two[1] + 0.05);
        assert!(rising || falling, "{places:?}");
        assert!((places[2] - 0.5).abs() < 0.1, "{places:?}");
    }

    #[test]
    fn a_fold_turns_one_half_as_a_whole() {
        let mesh = bar();
        let limb = Limb::of(&mesh).unwrap();
        for towards_end in [false, true] {
            let joint = Joint { place: 0.5, towards_end };
            let folded = limb.folded(&mesh.rest, joint, 1.2);
            let at = |x: f64, nodes: &[Point]| mesh.bind(Point::new(x, 110.0)).at(nodes);
            let moved = |x: f64| at(x, &folded).distance(Point::new(x, 110.0));
            // Whichever end is 1: one end stays, and the other turns by the angle.
            let (still, turned) = if moved(110.0) < moved(250.0) { (110.0, 250.0) } else { (250.0, 110.0) };
            assert!(moved(still) < 1e-9);
            let inner: f64 = if turned == 250.0 { 230.0 } else { 130.0 };
            let direction = at(turned, &folded) - at(inner, &folded);
            assert!((direction.length() - 20.0).abs() < 1e-9, "{direction}");
            assert!((direction.angle_to(Point::new(turned - inner, 0.0)).abs() - 1.2).abs() < 1e-9);
        }
    }

    #[test]
    fn a_stretch_moves_the_end_alone() {
        let mesh = bar();
        let limb = Limb::of(&mesh).unwrap();
        for towards_end in [false, true] {
            let longer = limb.stretched(&mesh.rest, Joint { place: 0.5, towards_end }, 1.5);
            let at = |x: f64| mesh.bind(Point::new(x, 110.0)).at(&longer).x - x;
            let (low, high) = (at(100.0), at(260.0));
            let (still, far) = if low.abs() < high.abs() { (low, high) } else { (high, low) };
            assert!(still.abs() < 1e-9 && (far.abs() - 40.0).abs() < 5.0, "{still} {far}");
        }
    }
}
