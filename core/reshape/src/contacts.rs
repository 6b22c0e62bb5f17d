//! When the feet of a clip stand on the ground.
//!
//! Clips come with the character's way through the picture, on the spot (a treadmill), or with the pelvis fixed in one
//! place. One rule serves all of them. The ground moves by u, the median velocity of the lowest foot: 0 for a clip with
//! its way, the speed of the walk backwards for the others. A foot stands while
//!
//! - it moves nearly as the ground does, or just as the ground from the frame before or to the next: on the first and the last frame of
//!   a contact the other of these ways is that of the swing,
//! - it is about as low as the lowest of all feet, and
//! - the figure is not in the air.
//!
//! The figure is in the air where even its lowest foot is clearly above the level at which it usually is. A clip with a
//! fixed pelvis does not tell a jump from crouching: both bring the feet nearer to the pelvis. There only feet that pass
//! each other quickly, as in a run, count as in the air.
//!
//! A clip on twos repeats each posture. A frame that repeats one is no evidence of standing: of such a clip the contacts are
//! found on its drawings, each at its own time ([`Holds`]).
//!
//! Limits: the ground is level. A foot that slides on purpose does not stand.

use rototoon_base::geometry::Point;
use rototoon_base::scene::Template;
use rototoon_base::scene::holds::Holds;
use rototoon_base::scene::template::length;

/// A foot moves as the ground if the difference is below this share of the ground's speed,
const OF_GROUND: f64 = 0.35;
/// of a fast foot's speed,
const OF_SWING: f64 = 0.2;
/// or of the leg in a frame.
const OF_LEG: f64 = 0.01;
/// A foot is low if it is no more than this share of the leg above the lower one.
const LOW: f64 = 0.06;
/// The figure is in the air if its lower foot is above its usual level by this share of the leg.
const AIR: f64 = 0.12;
/// Share of the frames whose lower foot is no lower than the usual level.
const USUAL: f64 = 0.75;
/// Feet pass each other quickly if they do so at this share of their fastest speed.
const PASSING: f64 = 0.5;

/// When feet stand.
#[derive(Clone, Debug, PartialEq)]
pub struct Contacts {
    /// For each leg and each frame whether its foot stands.
    pub stands: Vec<Vec<bool>>,
    /// For each frame whether the figure is in the air.
    pub air: Vec<bool>,
    /// The ground's velocity along x in the unit of the clip a frame.
    pub ground: f64,
    /// Whether the clip has a way: its pelvis moves.
    pub way: bool,
    /// When each posture is.
    pub times: Vec<f64>,
}

impl Contacts {
    /// Finds the contacts of a clip on ones. `legs` are the key points of each leg, the last its foot. Without legs the figure
    /// is never on the ground.
    pub fn of(legs: &[&[usize]], clip: &[Vec<Point>]) -> Self {
        Self::at(legs, clip, every_frame(clip))
    }

    /// Finds the contacts of postures at these times, in frames.
    pub fn at(legs: &[&[usize]], clip: &[Vec<Point>], times: Vec<f64>) -> Self {
        let n = clip.len();
        if legs.is_empty() {
            return Self { stands: Vec::new(), air: vec![true; n], ground: 0.0, way: false, times };
        }
        let leg = leg_length(legs, clip);
        let way = clip.iter().any(|p| p[0].distance(clip[0][0]) > 1e-3 * leg);
        let foot = |leg: &&[usize]| -> Vec<Point> { clip.iter().map(|p| p[leg[leg.len() - 1]]).collect() };
        let feet: Vec<Vec<Point>> = legs.iter().map(foot).collect();
        let speeds: Vec<Vec<Point>> = feet.iter().map(|foot| velocities(foot, &times)).collect();
        let lowest = |t: usize| (1..feet.len()).fold(0, |low, k| if feet[k][t].y > feet[low][t].y { k } else { low });
        let lower: Vec<usize> = (0..n).map(lowest).collect();
        let low: Vec<f64> = (0..n).map(|t| feet[lower[t]][t].y).collect();
        let level = quantile(low.clone(), USUAL);
        let passing: Vec<f64> = (0..n).map(|t| range(speeds.iter().map(|speed| speed[t].x))).collect();
        let quick = PASSING * quantile(passing.clone(), 0.9);
        let air: Vec<bool> =
            (0..n).map(|t| low[t] < level - AIR * leg && (way || (quick > 0.0 && passing[t] > quick))).collect();
        let ground = quantile((0..n).filter(|&t| !air[t]).map(|t| speeds[lower[t]][t].x).collect(), 0.5);
        let fast = quantile(speeds.iter().flatten().map(|v| v.length()).collect(), 0.9);
        let slow = (OF_GROUND * ground.abs()).max(OF_SWING * fast).max(OF_LEG * leg);
        let stands = (0..feet.len()).map(|foot| {
            let one = |t: usize| {
                let apart = |v: Point| (v - Point::new(ground, 0.0)).length();
                let step = |a: usize| apart((feet[foot][a + 1] - feet[foot][a]) / (times[a + 1] - times[a]));
                let beside = [t.checked_sub(1), Some(t).filter(|t| t + 1 < n)];
                let held = beside.into_iter().flatten().any(|a| step(a) < OF_LEG * leg);
                let with_ground = held || apart(speeds[foot][t]) < slow;
                !air[t] && with_ground && feet[foot][t].y > low[t] - LOW * leg
            };
            steady((0..n).map(one).collect())
        });
        Self { stands: stands.collect(), air, ground, way, times }
    }

    /// Finds the contacts of a clip, on each of its frames. A clip on twos is looked at drawing by drawing.
    pub fn of_clip(template: &Template, clip: &[Vec<Point>]) -> Self {
        let legs = template.legs();
        let Some(holds) = Holds::of(template, clip) else { return Self::of(&legs, clip) };
        let found = Self::at(&legs, &holds.drawings(clip), holds.times());
        let stands = found.stands.iter().map(|foot| holds.held(foot)).collect();
        Self { stands, air: holds.held(&found.air), times: every_frame(clip), ..found }
    }

    /// Whether every foot stands on some frame. Not of a body without legs.
    pub fn all_stand(&self) -> bool {
        !self.stands.is_empty() && self.stands.iter().all(|foot| foot.contains(&true))
    }

    /// The runs of frames during which a foot stands.
    pub fn runs(&self, foot: usize) -> Vec<std::ops::Range<usize>> {
        let mut found: Vec<std::ops::Range<usize>> = Vec::new();
        for (t, _) in self.stands[foot].iter().enumerate().filter(|(_, stands)| **stands) {
            match found.last_mut() {
                Some(run) if run.end == t => run.end = t + 1,
                _ => found.push(t..t + 1),
            }
        }
        found
    }
}

/// The times of a clip on ones.
pub(crate) fn every_frame(clip: &[Vec<Point>]) -> Vec<f64> {
    (0..clip.len()).map(|t| t as f64).collect()
}

/// The length of a straight leg: the median over the frames, of the longest leg.
pub(crate) fn leg_length(legs: &[&[usize]], clip: &[Vec<Point>]) -> f64 {
    let of = |leg: &&[usize]| quantile(clip.iter().map(|p| length(p, leg)).collect(), 0.5);
    legs.iter().map(of).fold(0.0, f64::max)
}

/// The greatest difference between values.
fn range(values: impl Iterator<Item = f64>) -> f64 {
    let (low, high) = values.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), v| (low.min(v), high.max(v)));
    high - low
}

/// Velocities by central differences, one-sided at the ends.
fn velocities(points: &[Point], times: &[f64]) -> Vec<Point> {
    let last = points.len().saturating_sub(1);
    let at = |t: usize| {
        let (a, b) = (t.saturating_sub(1), (t + 1).min(last));
        if a == b { Point::ZERO } else { (points[b] - points[a]) / (times[b] - times[a]) }
    };
    (0..points.len()).map(at).collect()
}

/// Without gaps of one frame and without contacts of one frame.
fn steady(mut stands: Vec<bool>) -> Vec<bool> {
    for wanted in [true, false] {
        let before = stands.clone();
        for t in 1..stands.len().saturating_sub(1) {
            if before[t - 1] == wanted && before[t + 1] == wanted {
                stands[t] = wanted;
            }
        }
    }
    stands
}

/// The value below which the given share of the values lies; 0 without values.
pub(crate) fn quantile(mut values: Vec<f64>, share: f64) -> f64 {
    values.sort_by(f64::total_cmp);
    let at = values.len().saturating_sub(1) as f64 * share;
    let (low, high) = (at.floor() as usize, at.ceil() as usize);
    match (values.get(low), values.get(high)) {
        (Some(a), Some(b)) => a + (b - a) * (at - at.floor()),
        _ => 0.0,
    }
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;
    use rototoon_base::scene::skeleton::{COUNT, LEGS};
    use std::f64::consts::TAU;

    /// A walk of 24 frames a cycle, seen from the side: each foot stands for 14 frames and swings for ten.
    pub(crate) fn walk(frames: usize, way: bool) -> Vec<Vec<Point>> {
        let step = 4.0; // pixels a frame
        (0..frames)
            .map(|t| {
                let bob = 2.0 * (2.0 * TAU * t as f64 / 24.0).cos();
                let pelvis = Point::new(step * t as f64, -90.0 + bob);
                let mut p = [pelvis; COUNT];
                p[1] = pelvis - Point::new(0.0, 25.0);
                p[2] = pelvis - Point::new(0.0, 50.0);
                for (leg, shift) in [(LEGS[0], 0), (LEGS[1], 12)] {
                    let (cycle, phase) = ((t + shift) / 24, (t + shift) % 24);
                    let stood = step * (24.0 * cycle as f64 - shift as f64 + 7.0);
                    let (x, up) = match phase {
                        0..14 => (stood, 0.0),
                        _ => {
                            let s = (phase - 13) as f64 / 11.0;
                            (stood + 24.0 * step * (0.5 - 0.5 * (0.5 * TAU * s).cos()), 22.0 * (0.5 * TAU * s).sin())
                        }
                    };
                    p[leg[0]] = pelvis;
                    p[leg[2]] = Point::new(x, -up);
                    p[leg[1]] = p[leg[0]].midpoint(p[leg[2]]) + Point::new(12.0, 0.0);
                }
                if way { p.to_vec() } else { p.map(|q| q - pelvis).to_vec() }
            })
            .collect()
    }

    /// The contacts of a human clip.
    pub(crate) fn human(clip: &[Vec<Point>]) -> Contacts {
        Contacts::of(&Template::human().legs(), clip)
    }

    fn wrong(found: &Contacts, frames: usize) -> usize {
        let truth = |foot: usize, t: usize| (t + 12 * foot) % 24 < 14;
        (0..2)
            .flat_map(|foot| (1..frames - 1).map(move |t| (foot, t)))
            .filter(|&(f, t)| found.stands[f][t] != truth(f, t))
            .count()
    }

    #[test]
    fn a_walk_is_read_with_its_way_and_with_a_fixed_pelvis() {
        for (way, most) in [(true, 2), (false, 3)] {
            let found = human(&walk(48, way));
            assert_eq!(found.way, way);
            assert!((found.ground - if way { 0.0 } else { -4.0 }).abs() < 0.3, "{}", found.ground);
            assert!(wrong(&found, 48) <= most, "{} of 92 wrong: {found:?}", wrong(&found, 48));
            assert!(!found.air.iter().any(|air| *air));
        }
    }

    #[test]
    fn a_foot_swings_on_twos_and_on_threes() {
        // A slow step: in a hold the swinging foot does not move.
        for (count, way) in [(2, true), (2, false), (3, true), (3, false)] {
            let ones: Vec<Vec<Point>> = walk(49, way).into_iter().step_by(count).collect();
            let clip: Vec<Vec<Point>> = (0..ones.len() * count).map(|t| ones[t / count].clone()).collect();
            let holds = Holds::of(&Template::human(), &clip).unwrap();
            let found = Contacts::at(&Template::human().legs(), &holds.drawings(&clip), holds.times());
            assert_eq!(found.stands, human(&ones).stands, "{count} {way}");
            assert!((found.ground - human(&ones).ground).abs() < 1e-9);
        }
        let air = Contacts::of_clip(&Template::human(), &walk(48, true)).air;
        assert_eq!(air, human(&walk(48, true)).air);
        assert!(human(&walk(48, true)).all_stand() && !human(&[]).all_stand());
    }

    #[test]
    fn a_jump_leaves_the_ground_and_crouching_does_not() {
        let height = |t: usize| if (10..20).contains(&t) { 40.0 * (0.05 * TAU * (t - 10) as f64).sin() } else { 0.0 };
        let stand = walk(1, true).remove(0);
        let lifted = |t: usize| stand.iter().map(|p| *p - Point::new(0.0, height(t))).collect();
        let jump: Vec<Vec<Point>> = (0..30).map(lifted).collect();
        let found = human(&jump);
        assert!(found.air[15] && !found.air[5] && !found.stands[0][15] && found.stands[1][4]);
        let crouch: Vec<Vec<Point>> = (0..30)
            .map(|t| {
                let mut p: Vec<Point> = stand.iter().map(|q| *q - stand[0]).collect();
                LEGS.iter().for_each(|leg| p[leg[2]].y -= height(t));
                p
            })
            .collect();
        assert!(!human(&crouch).air.iter().any(|air| *air));
        assert_eq!(human(&[]).air, [false; 0]);
    }
}
