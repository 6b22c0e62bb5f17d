//! A clip's postures in a drawing's proportions and place.
//!
//! **Lengths.** A limb is scaled by the ratio of its typical lengths in the drawing and in the clip
//! ([`Proportions::to`]). Typical is the median over all frames on which the document shows the drawing, not
//! the length on the frame at rest: a noodle leg that is drawn bent there, or a foreshortened arm, would count as
//! short.
//!
//! **Shoulders and hips.** Legs and limbs hang on the body where they are drawn. A skeleton may have its hips beside or
//! below the pelvis, a drawing may have them above it. And a body that turns towards the viewer shows its shoulders
//! several times as far apart as in profile, but a drawing does not turn. Therefore shoulders and hips keep their drawn
//! place relative to the body. Of the clip they take how they move about their own mean place, up to half of the drawn
//! distance.
//!
//! **The drawing's own motion.** Where a posture of the clip is a posture of the drawing, up to place and size, the
//! clip has the drawing's proportions. Then all limbs get one scale, and the clip goes through the drawing where it was
//! drawn. A character's own clip on its own drawing therefore is the identity, whichever frames the clip has and
//! whichever frame is at rest. Two different figures do not share a posture by chance: with five or more key points
//! within a hundredth of the torso, they also share their proportions.
//!
//! **Direction.** The clip looks to the side to which the drawing looks: [`super::facing`].
//!
//! **Place.** Otherwise the root (a human's pelvis) begins where it is drawn, and its way is scaled by the lengths of the legs (of the
//! torso, if no leg is drawn). [`super::stand`] puts the feet on the ground.
//!
//! Coordinates are pixels, x right, y down.

use rototoon_base::geometry::Point;
use rototoon_base::scene::Template;
use rototoon_base::scene::proportions::Proportions;
use std::sync::Arc;

/// Two postures are one if their key points are this near, as a root mean square in torso lengths.
const ONE_POSTURE: f64 = 0.01;
/// Shoulders and hips move about their place by at most this share of their drawn distance.
const SWAY: f64 = 0.5;
/// With fewer key points than this a posture could be met by chance.
const LEAST_POINTS: usize = 5;

/// What the document shows of the drawing.
#[derive(Clone, Debug, PartialEq)]
pub struct Shown {
    /// Its body.
    pub template: Arc<Template>,
    /// Its posture at rest.
    pub rest: Vec<Point>,
    /// Its postures on all frames that show it, the one at rest among them.
    pub postures: Vec<Vec<Point>>,
    /// Which key points its contours determine.
    pub told: Vec<bool>,
}

/// A clip's postures on a drawing.
#[derive(Clone, Debug, PartialEq)]
pub struct Fitted {
    /// A posture for each frame of the clip, in the drawing's pixels.
    pub postures: Vec<Vec<Point>>,
    /// The clip's unit in pixels.
    pub size: f64,
    /// Whether the clip is a motion of the drawing itself.
    pub own: bool,
}

/// Whether a clip of the drawing's body is a motion of the drawing itself.
pub fn is_own(shown: &Shown, clip: &[Vec<Point>]) -> bool {
    own(shown, clip).is_some()
}

/// Fits a clip of the drawing's body to the drawing; `None` if the clip's torso has no length.
pub fn fit(shown: &Shown, clip: &[Vec<Point>]) -> Option<Fitted> {
    if let Some((size, shift)) = own(shown, clip) {
        let postures = clip.iter().map(|p| p.iter().map(|q| *q * size + shift).collect()).collect();
        return Some(Fitted { postures, size, own: true });
    }
    let template = shown.template.as_ref();
    let (own, theirs) = (Proportions::of(template, &shown.postures), Proportions::of(template, clip));
    if theirs.torso(template) <= 0.0 {
        return None;
    }
    let size = scale(shown, &own, &theirs);
    let first = clip.first()?[0];
    let joints: Vec<Joint> = template.hanging().iter().map(|c| Joint::new(shown, clip, c[0])).collect();
    let place = |p: &Vec<Point>| {
        let root = shown.rest[0] + (p[0] - first) * size;
        let mut made: Vec<Point> = theirs.to(template, &own, p).iter().map(|q| *q - p[0] + root).collect();
        for joint in &joints {
            let k = joint.point;
            let moved = (hangs(template, p, k) - joint.mean) * size;
            let way = joint.drawn + moved.clamp_length_max(SWAY * joint.drawn.length());
            let shift = made[template.parent(k)] + body(template, &made, k).rotate(way) - made[k];
            joint.carries.iter().for_each(|&q| made[q] += shift);
        }
        made
    };
    Some(Fitted { postures: clip.iter().map(place).collect(), size, own: false })
}

/// A joint on which a leg or a limb hangs.
struct Joint {
    point: usize,
    /// Where it hangs on average in the drawing, and in the clip.
    drawn: Point,
    mean: Point,
    /// The key points that move with it.
    carries: Vec<usize>,
}

impl Joint {
    fn new(shown: &Shown, clip: &[Vec<Point>], point: usize) -> Self {
        let template = shown.template.as_ref();
        let mean = |postures: &[Vec<Point>]| {
            postures.iter().map(|p| hangs(template, p, point)).sum::<Point>() / postures.len().max(1) as f64
        };
        let carries = (point..template.len()).filter(|&k| template.hangs_on(k, point)).collect();
        Self { point, drawn: mean(&shown.postures), mean: mean(clip), carries }
    }
}

/// The direction of the body at a joint: of a human neck from chest at a shoulder, chest from pelvis at a hip.
fn body(template: &Template, posture: &[Point], joint: usize) -> Point {
    let (from, to) = template.body_at(template.parent(joint));
    (posture[to] - posture[from]).normalize_or(-Point::Y)
}

/// Where a joint hangs, relative to the body's direction.
fn hangs(template: &Template, posture: &[Point], joint: usize) -> Point {
    let back = body(template, posture, joint) * Point::new(1.0, -1.0);
    back.rotate(posture[joint] - posture[template.parent(joint)])
}

/// Pixels of the drawing for a unit of the clip: from the legs that are drawn, else from the torso.
fn scale(shown: &Shown, own: &Proportions, theirs: &Proportions) -> f64 {
    let legs = shown.template.legs();
    let drawn = |leg: &&&[usize]| leg.iter().all(|&k| shown.told[k]);
    let along = |p: &Proportions| legs.iter().filter(drawn).map(|leg| p.along(leg)).sum::<f64>();
    match (along(own), along(theirs)) {
        (a, b) if a > 0.0 && b > 0.0 => a / b,
        _ => own.torso(&shown.template) / theirs.torso(&shown.template),
    }
}

/// Scale and shift of the clip if a posture of it is one of the drawing.
fn own(shown: &Shown, clip: &[Vec<Point>]) -> Option<(f64, Point)> {
    let points: Vec<usize> = (0..shown.told.len()).filter(|&k| shown.told[k]).collect();
    if points.len() < LEAST_POINTS {
        return None;
    }
    let mut best: Option<(f64, f64, Point)> = None;
    for drawn in &shown.postures {
        for posture in clip {
            let (size, shift, off) = similarity(&points, posture, drawn);
            let off = off / shown.template.torso_length(drawn).max(f64::MIN_POSITIVE);
            if size > 0.0 && off <= ONE_POSTURE && best.is_none_or(|(least, ..)| off < least) {
                best = Some((off, size, shift));
            }
        }
    }
    best.map(|(_, size, shift)| (size, shift))
}

/// Scale and shift that bring key points of one posture nearest to those of another, and the root mean square of what
/// is left.
fn similarity(points: &[usize], from: &[Point], to: &[Point]) -> (f64, Point, f64) {
    let n = points.len() as f64;
    let middle = |p: &[Point]| points.iter().map(|&k| p[k]).sum::<Point>() / n;
    let (a, b) = (middle(from), middle(to));
    let (mut product, mut square) = (0.0, 0.0);
    for &k in points {
        product += (from[k] - a).dot(to[k] - b);
        square += (from[k] - a).length_squared();
    }
    let size = if square > 0.0 { product / square } else { 0.0 };
    let shift = b - a * size;
    let left: f64 = points.iter().map(|&k| (from[k] * size + shift).distance_squared(to[k])).sum();
    (size, shift, (left / n).sqrt())
}

#[cfg(test)]
mod tests {
    use super::*;
    use rototoon_base::scene::skeleton::{COUNT, LEGS};

    /// A figure whose left leg is bent by an angle.
    fn figure(bend: f64) -> Vec<Point> {
        let v = Point::new;
        let mut p = vec![Point::ZERO; COUNT];
        for (k, at) in [(1, v(0.0, -20.0)), (2, v(0.0, -40.0)), (3, v(1.0, -50.0)), (4, v(2.0, -66.0))] {
            p[k] = at;
        }
        for (k, side) in [(5, -8.0), (8, 8.0)] {
            p[k] = v(side, -38.0);
            p[k + 1] = v(2.0 * side, -20.0);
            p[k + 2] = v(2.0 * side, 0.0);
        }
        for (leg, side, turn) in [(LEGS[0], -5.0, bend), (LEGS[1], 5.0, 0.0)] {
            p[leg[0]] = v(side, 2.0);
            p[leg[1]] = p[leg[0]] + Point::from_angle(turn).rotate(v(0.0, 30.0));
            p[leg[2]] = p[leg[1]] + Point::from_angle(-turn).rotate(v(0.0, 30.0)) * turn.cos();
        }
        p
    }

    fn each(posture: &[Point], map: impl Fn(Point) -> Point) -> Vec<Point> {
        posture.iter().map(|p| map(*p)).collect()
    }

    fn clip(first: usize) -> Vec<Vec<Point>> {
        let at = |frame: usize| each(&figure(0.1 * frame as f64), |p| 3.0 * p + Point::new(7.0 * frame as f64, 5.0));
        (first..first + 8).map(at).collect()
    }

    fn shown(postures: Vec<Vec<Point>>, rest: usize) -> Shown {
        Shown { template: Template::human(), rest: postures[rest].clone(), postures, told: vec![true; COUNT] }
    }

    #[test]
    fn the_own_motion_is_the_identity_from_any_rest_and_for_any_frames() {
        let all: Vec<Vec<Point>> = clip(0).iter().map(|p| each(p, |q| q / 3.0)).collect();
        for rest in [0, 5] {
            for (frames, scale) in [(0..8, 3.0), (4..8, 1.0), (4..8, 3.0)] {
                let given: Vec<Vec<Point>> = all[frames.clone()].iter().map(|p| each(p, |q| q * scale)).collect();
                let found = fit(&shown(all.clone(), rest), &given).unwrap();
                assert!(found.own && is_own(&shown(all.clone(), rest), &given));
                for (made, wanted) in found.postures.iter().zip(&all[frames]) {
                    assert!(made.iter().zip(wanted).all(|(a, b)| a.distance(*b) < 1e-9));
                }
            }
            // The drawing at rest alone, and a clip that shows it.
            let alone = fit(&shown(vec![all[rest].clone()], 0), &all).unwrap();
            assert!(
                alone.own
                    && alone.postures.iter().flatten().zip(all.iter().flatten()).all(|(a, b)| a.distance(*b) < 1e-9)
            );
        }
    }

    #[test]
    fn lengths_are_measured_over_all_frames() {
        // At rest the shin is drawn foreshortened; most frames show it longer.
        let mut drawn: Vec<Vec<Point>> = (0..5).map(|_| figure(0.0)).collect();
        drawn[0] = figure(1.2);
        let mut longer = vec![figure(0.3), figure(0.35), figure(0.4)];
        longer.iter_mut().for_each(|p| p[4] -= Point::new(0.0, 30.0));
        let found = fit(&shown(drawn, 0), &longer).unwrap();
        assert!(!found.own, "another figure");
        let shin = |p: &[Point]| p[13].distance(p[12]);
        assert!((shin(&found.postures[1]) - 30.0).abs() < 1e-9, "{}", shin(&found.postures[1]));
    }

    #[test]
    fn arms_and_legs_hang_on_the_body_where_they_are_drawn() {
        // Drawn with hips above the pelvis; in the clip they are below it, and a shoulder swings far out.
        let mut drawn = figure(0.0);
        LEGS.iter().for_each(|leg| leg.iter().for_each(|&k| drawn[k].y -= 9.0));
        let lean = Point::from_angle(0.5);
        let mut turned: Vec<Vec<Point>> =
            (0..6).map(|t| each(&figure(0.3 + 0.1 * f64::from(t)), |p| lean.rotate(p))).collect();
        turned[3][5] -= Point::new(60.0, 0.0);
        let found = fit(&shown(vec![drawn.clone()], 0), &turned).unwrap();
        for (made, clip) in found.postures.iter().zip(&turned) {
            for hip in [11, 14] {
                let wanted = lean.rotate(drawn[hip] - drawn[0]);
                assert!((made[hip] - made[0]).distance(wanted) < 1e-6, "{}", made[hip] - made[0]);
                assert!(((made[hip + 2] - made[hip]).length() - (clip[hip + 2] - clip[hip]).length()).abs() < 8.0);
            }
            assert!(made[5].distance(made[2]) < 1.6 * drawn[5].distance(drawn[2]), "a shoulder stays on its body");
        }
    }

    #[test]
    fn few_key_points_are_no_proof() {
        let mut few = shown(vec![figure(0.2)], 0);
        few.told = (0..COUNT).map(|k| k < 3).collect();
        assert!(!fit(&few, &clip(0)).unwrap().own);
        assert_eq!(fit(&few, &[vec![Point::ZERO; COUNT]]), None);
    }
}
