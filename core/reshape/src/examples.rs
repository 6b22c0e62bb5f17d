//! What other drawings of a part teach about its shape: pose space deformation (Lewis, Cordner & Fong 2000).
//!
//! A mesh that bends with its limbs is a guess of how the part looks in a pose. Where the document shows the part on
//! further frames, the artist's drawing is known there. Each of these frames is an *example*: the poses of the limbs, and
//! for each point how far the drawing is from the guess. On a new frame the corrections are interpolated in the space
//! of poses. A part in a pose of an example gets the example's drawing exactly; far from all examples it keeps the
//! guess.
//!
//! **Interpolation.** A Gaussian process with zero mean (Rasmussen & Williams 2006, eq. 2.25 without noise) and the
//! covariance a exp(−d / ℓ) + b exp(−D / ℓ). d is the distance of the poses of the part's own limbs, D that of the whole
//! figure. The first term makes a knee bulge whenever it is bent; the second tells apart frames on which the own limbs
//! stand alike and only the rest differs. The exponential covariance keeps frames that are nearly alike apart, where a
//! Gaussian bell would be numerically singular.
//!
//! **Frames.** Poses and corrections are relative to the direction of the part's first limb, so an arm keeps its
//! correction when it is raised. A part with one limb has no pose of its own; only the second term counts.
//!
//! Limits: at most [`MOST`] examples are used, spread evenly. Of two frames with one pose and different drawings the
//! first counts.

use super::puppet::LimbPose;
use rototoon_base::geometry::Point;
use rototoon_base::numeric::dense::DenseCholesky;

/// Most examples of a part. The cost grows with the cube of their number.
pub const MOST: usize = 400;
/// ℓ, in torso lengths.
const LENGTH: f64 = 0.25;
/// a and b.
const OWN: f64 = 0.8;
const WHOLE: f64 = 0.2;
/// Poses nearer than this are one, in torso lengths.
const ONE: f64 = 1e-6;

/// The pose of a part: its own limbs and all limbs, in torso lengths.
#[derive(Clone, Debug, PartialEq)]
struct Pose {
    own: Vec<Point>,
    whole: Vec<Point>,
}

/// The corrections of a part.
#[derive(Clone, Debug)]
pub struct Corrections {
    limbs: Vec<usize>,
    size: f64,
    poses: Vec<Pose>,
    /// For each example the weights of the points.
    weights: Vec<Vec<Point>>,
}

/// The direction of a part's first limb; x where it has none.
fn direction(limbs: &[usize], poses: &[LimbPose]) -> Point {
    let way = limbs.first().map(|&k| poses[k].ends.1 - poses[k].ends.0);
    way.and_then(Point::try_normalize).unwrap_or(Point::X)
}

fn pose(limbs: &[usize], poses: &[LimbPose], size: f64) -> Pose {
    let back = direction(limbs, poses) * Point::new(1.0, -1.0);
    let relative = |of: &mut dyn Iterator<Item = &LimbPose>, from: Point, turn: Point| -> Vec<Point> {
        of.flat_map(|pose| [pose.ends.0, pose.ends.1]).map(|p| turn.rotate(p - from) / size).collect()
    };
    let start = |k: Option<&LimbPose>| k.map_or(Point::ZERO, |pose| pose.ends.0);
    let own = match limbs {
        [] | [_] => Vec::new(),
        [first, ..] => relative(&mut limbs.iter().map(|&k| &poses[k]), poses[*first].ends.0, back),
    };
    Pose { own, whole: relative(&mut poses.iter(), start(poses.first()), Point::X) }
}

fn apart(a: &[Point], b: &[Point]) -> f64 {
    a.iter().zip(b).map(|(p, q)| p.distance_squared(*q)).sum::<f64>().sqrt()
}

fn covariance(a: &Pose, b: &Pose) -> f64 {
    let own = if a.own.is_empty() { 0.0 } else { OWN * (-apart(&a.own, &b.own) / LENGTH).exp() };
    own + WHOLE * (-apart(&a.whole, &b.whole) / LENGTH).exp()
}

impl Corrections {
    /// Learns from examples: the poses of all limbs, and how far each point of the drawing is from the guess. `limbs` are
    /// the part's own, `size` the length of the torso. `None` without examples.
    pub fn new(limbs: Vec<usize>, size: f64, examples: &[(Vec<LimbPose>, Vec<Point>)]) -> Option<Self> {
        let step = examples.len().div_ceil(MOST).max(1);
        let (mut poses, mut corrections): (Vec<Pose>, Vec<Vec<Point>>) = (Vec::new(), Vec::new());
        for (limb_poses, off) in examples.iter().step_by(step) {
            let new = pose(&limbs, limb_poses, size);
            if poses.iter().all(|old| apart(&old.whole, &new.whole) > ONE) {
                let back = direction(&limbs, limb_poses) * Point::new(1.0, -1.0);
                poses.push(new);
                corrections.push(off.iter().map(|p| back.rotate(*p)).collect());
            }
        }
        let (n, points) = (poses.len(), corrections.first()?.len());
        let matrix: Vec<f64> = (0..n * n).map(|k| covariance(&poses[k / n], &poses[k % n])).collect();
        let mut right: Vec<f64> = corrections.iter().flatten().flat_map(|p| [p.x, p.y]).collect();
        DenseCholesky::new(n, &matrix)?.solve(&mut right, 2 * points);
        if right.iter().any(|v| !v.is_finite()) {
            return None; // poses too far apart to compute with
        }
        let row = |values: &[f64]| values.chunks_exact(2).map(|v| Point::new(v[0], v[1])).collect();
        let weights = right.chunks_exact((2 * points).max(1)).map(row).collect();
        Some(Self { limbs, size, poses, weights })
    }

    /// The corrections of the points in a pose of all limbs.
    pub fn at(&self, limbs: &[LimbPose]) -> Vec<Point> {
        let (here, turn) = (pose(&self.limbs, limbs, self.size), direction(&self.limbs, limbs));
        let mut sum = vec![Point::ZERO; self.weights.first().map_or(0, Vec::len)];
        for (pose, weights) in self.poses.iter().zip(&self.weights) {
            let near = covariance(pose, &here);
            sum.iter_mut().zip(weights).for_each(|(s, w)| *s += *w * near);
        }
        sum.into_iter().map(|p| turn.rotate(p)).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::super::limb::Bend;
    use super::*;

    fn straight(a: Point, b: Point) -> LimbPose {
        LimbPose { ends: (a, b), bend: Bend::STRAIGHT }
    }

    /// A torso, and an arm of two limbs, raised and bent.
    fn poses(raised: f64, bent: f64) -> Vec<LimbPose> {
        let elbow = Point::from_angle(raised) * 50.0;
        let wrist = elbow + Point::from_angle(raised + bent) * 50.0;
        vec![straight(Point::new(0.0, 100.0), Point::ZERO), straight(Point::ZERO, elbow), straight(elbow, wrist)]
    }

    /// The muscle bulges with the bend.
    fn bulge(raised: f64, bent: f64) -> Vec<Point> {
        vec![Point::from_angle(raised).rotate(Point::new(0.0, -6.0 * bent)), Point::ZERO]
    }

    fn arm(examples: &[(f64, f64)]) -> Corrections {
        let examples: Vec<_> = examples.iter().map(|&(r, b)| (poses(r, b), bulge(r, b))).collect();
        Corrections::new(vec![1, 2], 100.0, &examples).unwrap()
    }

    #[test]
    fn examples_are_met_exactly_and_a_raised_arm_keeps_its_correction() {
        let shown = [(0.0, 0.0), (0.1, 0.5), (0.2, 1.0), (0.2, 1.001)];
        let arm = arm(&shown);
        for (raised, bent) in shown {
            let found = arm.at(&poses(raised, bent));
            assert!(found[0].distance(bulge(raised, bent)[0]) < 1e-6, "{} at {bent}", found[0]);
        }
        for bent in [0.25, 0.7] {
            let (found, wanted) = (arm.at(&poses(0.9, bent))[0], bulge(0.9, bent)[0]);
            assert!(found.distance(wanted) < 0.5 * wanted.length(), "{found} for {wanted}");
        }
    }

    #[test]
    fn far_from_all_examples_the_guess_stays() {
        let found = arm(&[(0.0, 0.4), (0.1, 0.5)]).at(&poses(0.0, 3.0));
        assert!(found[0].length() < 0.2 * bulge(0.0, 0.45)[0].length(), "{}", found[0]);
        assert!(Corrections::new(vec![1], 100.0, &[]).is_none());
    }

    #[test]
    fn a_part_with_one_limb_is_told_apart_by_the_whole_figure() {
        let examples = [(poses(0.0, 0.0), vec![Point::X]), (poses(0.3, 0.0), vec![Point::Y])];
        let body = Corrections::new(vec![0], 100.0, &examples).unwrap();
        assert!(body.at(&examples[1].0)[0].distance(Point::Y) < 1e-9);
    }
}
