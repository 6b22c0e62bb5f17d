//! Steadies contours over time where a film is drawn with a wobble.
//!
//! **Why.** Lines that are drawn anew for every drawing wobble, and a contour that follows them shakes, though each of its
//! drawings is right within a pixel. A mean over time would be steady, but late: cartoons stop and start within a drawing.
//!
//! **How.** What a part does is split into three: where its centre goes, how it turns and grows, and how its shape bends
//! ([`motion`]). Each is a series with one entry a drawing.
//!
//! 1. The **noise** of a series is told from its **motion** by its second differences ([`noise`]). Noise is independent from
//!    drawing to drawing, and motion is not.
//! 2. Pose and shape are smoothed as much as this noise asks for. A change that is larger than the part's usual motion and
//!    noise is a change that was drawn, and stays ([`smooth`]).
//! 3. A centre's motion is too uneven for that. But parts of one body move evenly against each other, and turn evenly. So
//!    the centres of all parts are smoothed together first, by pairs of parts, and so are their poses ([`together`]). After
//!    that a centre's second difference that is no larger than noise is smoothed, and a larger one stays.
//!
//! If all points of a part have independent noise, its centre and its pose times its size have the same noise. So the
//! noise of poses is taken for that of centres too. Keys and corrected drawings stay. A contour moves by at most [`FARTHEST`].
//! Noise is measured where each part alone would go without corrections, so it does not depend on them. It is one for the whole
//! film, and a key that changes in one span changes it a little. So it is counted in steps: most often the other spans keep their
//! contours to the last digit.
//!
//! Below the least [`WOBBLE`] a film is clean, and above the largest its drawings jump: then nothing is changed at all. Six films
//! in pencil and double lines have a noise of 0.15 to 0.6 square pixels, fifteen clean and shaded ones at most 0.14, twelve of
//! hand-made drawings at least 3. The clean film with 0.14 has limbs that swing, and much motion. So noise has to be [`OF_MOTION`]
//! of the motion too: it is 0.5 to 2.6 of it on the six, and at most 0.2 on that film.
//!
//! **Limits.** Whether a film wobbles at all is decided by the exact noise: near these bounds a changed key may move every span. On a film of few drawings noise cannot be told from motion. Parts with a single key are not steadied.

mod motion;
mod noise;
mod smooth;
mod together;

use motion::Motion;
use noise::{Differences, Split};
use rototoon_base::geometry::Point;
use rototoon_base::scene::Span;
use serde::{Deserialize, Serialize};
use together::{Pairs, Series};

/// Farthest that a contour is moved, in working pixels: root mean square over its points.
const FARTHEST: f64 = 2.0;
/// Steadied points are on a grid of so many lines a working pixel.
const GRID: f64 = 64.0;
/// Least and largest noise of shapes that is taken for a wobble of lines: variance in square working pixels.
const WOBBLE: (f64, f64) = (0.1, 1.5);
/// Pairs of a part: by centre, and by pose.
const PAIRS: [usize; 2] = [4, 2];
/// How many standard deviations the second difference of a pose or a shape, and that of a centre, may have before it counts as
/// drawn.
const USUAL: [f64; 2] = [2.0, 1.0];
/// Noise that a centre still has after pairs were smoothed, as a share of the noise before.
const LEFT: f64 = 0.5;
/// Least noise of shapes that is taken for one, as a share of their motion.
const OF_MOTION: f64 = 1.0 / 3.0;
/// Largest noise of poses, as a multiple of that of shapes.
const OF_SHAPE: f64 = 4.0;

/// A part between two keys, as it was found.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Member {
    /// What it is remembered by.
    pub key: (String, Span),
    /// The time of each drawing: the middle of its frames in the film. At the keys their frame.
    pub times: Vec<f64>,
    /// The control points on each drawing, in working pixels.
    pub points: Vec<Vec<Point>>,
    /// By drawing: whether the artist has set it, by a key or a correction.
    pub set: Vec<bool>,
}

/// How much a film wobbles.
#[derive(Debug, Default)]
pub struct Wobble {
    pose: Split,
    shape: Split,
    /// Motion of parts of one body against each other: of their centres and of their poses.
    pairs: [Pairs; 2],
    steadies: bool,
}

impl Wobble {
    /// The wobble of the parts of a film. Each group has the parts of one stretch of time.
    pub fn measured(groups: &[Vec<Member>]) -> Self {
        let mut pose = Differences::default();
        let mut shape = Differences::default();
        let mut pairs = [Pairs::new(), Pairs::new()];
        for group in groups {
            let motions: Vec<Motion> = group.iter().map(|member| Motion::of(&member.times, &member.points)).collect();
            for (member, motion) in group.iter().zip(&motions) {
                pose.add(&member.times, &motion.poses);
                shape.add(&member.times, &motion.shapes);
            }
            let series = [centres(&motions), turns(&motions)];
            for ((pairs, series), most) in pairs.iter_mut().zip(&series).zip(PAIRS) {
                pairs.extend(together::found(group, series, most));
            }
        }
        let (mut pose, shape) = (pose.split(), shape.split());
        pose.noise = pose.noise.min(OF_SHAPE * shape.noise);
        let steadies = is_wobble(pose, shape);
        Self { pose: pose.in_steps(), shape: shape.in_steps(), pairs, steadies }
    }

    /// Whether contours are changed at all.
    pub fn steadies(&self) -> bool {
        self.steadies
    }

    /// What the parts of a stretch depend on besides themselves: noise and motion of poses and of shapes, as far as contours are changed.
    pub fn of_film(&self) -> Option<[f64; 4]> {
        let Self { pose, shape, .. } = self;
        self.steadies.then_some([pose.noise, pose.motion, shape.noise, shape.motion])
    }

    /// The control points of the parts of one stretch of time on each of their drawings, steadied.
    pub fn steadied(&self, group: &[Member]) -> Vec<Vec<Vec<Point>>> {
        if !self.steadies {
            return group.iter().map(|member| member.points.clone()).collect();
        }
        let motions: Vec<Motion> = group.iter().map(|member| Motion::of(&member.times, &member.points)).collect();
        let noise: Vec<f64> = vec![self.pose.noise; group.len()];
        let centres = together::smoothed(group, centres(&motions), &noise, &self.pairs[0]);
        let noise: Vec<f64> = motions.iter().map(|motion| self.pose.noise / (motion.size * motion.size)).collect();
        let turns = together::smoothed(group, turns(&motions), &noise, &self.pairs[1]);
        (0..group.len()).map(|m| self.by_itself(&group[m], &motions[m], &centres[m], &turns[m])).collect()
    }

    /// The points of a part on each drawing. Its centres and turns have been smoothed together with others'.
    fn by_itself(&self, member: &Member, motion: &Motion, centres: &[Vec<f64>], turns: &[Vec<f64>]) -> Vec<Vec<Point>> {
        let of = |series: &[Vec<f64>], split: Split, usual: f64| {
            smooth::smoothed(&member.times, series, &member.set, split, usual)
        };
        let poses: Vec<Vec<f64>> = turns.iter().map(|turn| turn.iter().map(|x| x * motion.size).collect()).collect();
        let rest = Split { noise: LEFT * self.pose.noise, motion: self.pose.noise };
        let new = motion.points(
            &of(centres, rest, USUAL[1]),
            &of(&poses, self.pose, USUAL[0]),
            &of(&motion.shapes, self.shape, USUAL[0]),
        );
        member.points.iter().zip(new).zip(&member.set).map(|((old, new), &set)| within_reach(old, new, set)).collect()
    }
}

/// Whether noise and motion of poses and shapes are those of a film that wobbles.
fn is_wobble(pose: Split, shape: Split) -> bool {
    shape.noise >= WOBBLE.0.max(OF_MOTION * shape.motion) && shape.noise.max(pose.noise) <= WOBBLE.1
}

fn centres(motions: &[Motion]) -> Series {
    motions.iter().map(|motion| motion.centres.clone()).collect()
}

fn turns(motions: &[Motion]) -> Series {
    motions.iter().map(Motion::turns).collect()
}

/// The new points, or points between old and new ones at most [`FARTHEST`] from the old ones. Drawings that the artist has set
/// stay, and others get coordinates on the grid.
fn within_reach(old: &[Point], new: Vec<Point>, set: bool) -> Vec<Point> {
    if set || old.is_empty() {
        return old.to_vec();
    }
    let squares: f64 = old.iter().zip(&new).map(|(a, b)| (*b - *a).length_squared()).sum();
    let moved = (squares / old.len() as f64).sqrt();
    if !moved.is_finite() {
        return old.to_vec();
    }
    let share = (FARTHEST / moved.max(FARTHEST)).min(1.0);
    let on_grid = |x: f64| (x * GRID).round() / GRID;
    let point = |(a, b): (&Point, &Point)| {
        let p = a.lerp(*b, share);
        Point::new(on_grid(p.x), on_grid(p.y))
    };
    old.iter().zip(&new).map(point).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A small generator of random numbers.
    pub struct Random(u64);

    impl Random {
        pub fn new(seed: u64) -> Self {
            Self(seed)
        }

        /// A number between 0 and 1 (Knuth's linear congruential generator MMIX).
        pub fn uniform(&mut self) -> f64 {
            self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (self.0 >> 11) as f64 / (1_u64 << 53) as f64
        }

        /// A number of the standard normal distribution, but for its far tails.
        pub fn normal(&mut self) -> f64 {
            (0..12).map(|_| self.uniform()).sum::<f64>() - 6.0
        }
    }

    /// A part that has a drawing on each frame.
    pub fn member(name: &str, points: Vec<Vec<Point>>) -> Member {
        let last = points.len() - 1;
        Member {
            key: (name.into(), Span { first: 0, last: last as i32 }),
            times: (0..=last).map(|d| d as f64).collect(),
            set: (0..=last).map(|d| d == 0 || d == last).collect(),
            points,
        }
    }

    /// Four parts of a body that goes its way, with noise on each point.
    fn film(noise: f64, way: &dyn Fn(usize) -> Point) -> Vec<Member> {
        let mut random = Random::new(21);
        let mut part = |m: usize| {
            let mut drawing = |d: usize| {
                let set = d == 0 || d == 19;
                let mut point = |k: usize| {
                    let wobble = if set { 0.0 } else { noise.sqrt() };
                    let around = Point::from_angle(k as f64) * 30.0 + Point::new(50.0 * m as f64, 0.0);
                    way(d) + around + Point::new(random.normal(), random.normal()) * wobble
                };
                (0..6).map(&mut point).collect()
            };
            member(&format!("part {m}"), (0..20).map(&mut drawing).collect())
        };
        (0..4).map(&mut part).collect()
    }

    fn nod(d: usize) -> Point {
        Point::new(4.0 * d as f64, 9.0 * ((d / 3) % 2) as f64)
    }

    /// The mean square distance from where the parts would be without noise.
    fn error(tracks: &[Vec<Vec<Point>>], way: &dyn Fn(usize) -> Point) -> f64 {
        let truth = film(0.0, way);
        let pairs = tracks.iter().zip(&truth).flat_map(|(track, member)| track.iter().zip(&member.points));
        let squares: Vec<f64> =
            pairs.flat_map(|(a, b)| a.iter().zip(b).map(|(a, b)| (*a - *b).length_squared())).collect();
        squares.iter().sum::<f64>() / squares.len() as f64
    }

    fn points(group: &[Member]) -> Vec<Vec<Vec<Point>>> {
        group.iter().map(|member| member.points.clone()).collect()
    }

    #[test]
    fn a_film_that_wobbles_is_steadied_and_keeps_its_keys() {
        let group = film(0.6, &nod);
        let steady = Wobble::measured(&[film(0.6, &nod)]).steadied(&group);
        let (before, after) = (error(&points(&group), &nod), error(&steady, &nod));
        assert!(after < 0.5 * before, "{after} of {before}");
        for (track, member) in steady.iter().zip(&group) {
            assert_eq!((&track[0], &track[19]), (&member.points[0], &member.points[19]));
        }
    }

    #[test]
    fn a_clean_film_and_one_that_jumps_stay_as_they_are() {
        for noise in [0.0, 0.02, 30.0] {
            let group = film(noise, &nod);
            let steady = Wobble::measured(&[film(noise, &nod)]).steadied(&group);
            assert!(steady == points(&group), "changed at a noise of {noise}");
        }
    }

    #[test]
    fn a_corrected_drawing_stays() {
        let mut group = film(0.6, &nod);
        group[2].set[7] = true;
        let steady = Wobble::measured(&[film(0.6, &nod)]).steadied(&group);
        assert_eq!(steady[2][7], group[2].points[7]);
        assert_ne!(steady[2][8], group[2].points[8]);
    }

    #[test]
    fn no_contour_moves_far() {
        let old = [Point::ZERO, Point::new(1.0, 0.0)];
        let shifted = |by: f64| within_reach(&old, old.iter().map(|&p| p + Point::new(by, 0.0)).collect(), false);
        assert_eq!(shifted(1.5), [Point::new(1.5, 0.0), Point::new(2.5, 0.0)]);
        assert_eq!(shifted(50.0), [Point::new(FARTHEST, 0.0), Point::new(1.0 + FARTHEST, 0.0)]);
        assert_eq!(shifted(f64::NAN), old);
    }

    #[test]
    fn parts_without_drawings_are_left_alone() {
        let empty =
            || Member { key: ("p".into(), Span { first: 0, last: 1 }), times: vec![], points: vec![], set: vec![] };
        let mut group = film(0.6, &nod);
        group.push(empty());
        assert!(Wobble::measured(&[vec![empty()]]).steadied(&[empty()])[0].is_empty());
        assert!(Wobble::measured(&[film(0.6, &nod)]).steadied(&group)[4].is_empty());
    }
}
