//! Feet on the ground: where a figure of other proportions, or one whose pelvis is fixed, stands in the picture.
//!
//! A foot is drawn with a sole: the outline of its shoe, or of the end of the leg. From [`Contacts`] follow
//!
//! 1. **The pitch of shoes.** While a foot stands its sole lies flat, also if it is drawn tilted ([`flat`]). In the air
//!    it takes a share of the shin's turn. After a contact the heel comes off first: the foot turns about its toe as
//!    far as the ankle has risen, φ = asin(h / l), with l the way from the ankle to the toe. Before a contact the
//!    forward shin has the toe up, so the heel comes down first.
//! 2. **The height of the pelvis.** On each frame with a foot on the ground, the lowest sole touches the ground line.
//!    In the air the shift is interpolated, so a jump keeps its height. No sole is ever below the ground. A clip with a
//!    fixed pelvis gets back the rise and fall of its steps.
//! 3. **The way of the pelvis.** A standing foot moves as the ground does. The pelvis takes up what is common to the
//!    feet that stand, as in `rototoon-style`.
//! 4. **The legs.** What is left is taken up by the bones of the leg ([`super::reach`]), fading beside the contact.
//!
//! The order is 1 to 4, twice, since a leg that moves turns its shin.
//!
//! Limits: the ground is a level line. A leg that would have to be longer stays straight and hangs above the ground.

use super::contacts::{Contacts, quantile};
use super::reach::reach;
use rototoon_base::geometry::Point;
use rototoon_base::scene::Template;

/// Rounds of the four steps.
const ROUNDS: usize = 2;
/// Frames over which corrections fade beside a contact.
const FADE: usize = 3;
/// A heel comes off until the ankle has risen by this share of the way from ankle to toe.
const TOE: f64 = 0.8;
/// Points of a sole are on the ground if they are no higher than this share of the foot's size above its lowest point.
const TOUCHES: f64 = 0.06;
/// A foot is laid flatter if each radian of turn adds this share of its size to what touches the ground.
const FLATTER: f64 = 0.35;
/// A turn must gain this share of the foot's size over the foot as drawn: a drawn curve is a polygon.
const CLEARLY: f64 = 0.15;
/// Largest turn that lays a sole flat, in radians.
const MOST_TILT: f64 = 1.0;

/// A foot of a drawing at rest.
#[derive(Clone, Debug, PartialEq)]
pub struct Foot {
    /// Which of the template's legs has it.
    pub leg: usize,
    /// Points of its outline relative to the ankle, at rest.
    pub shape: Vec<Point>,
    /// The leg's last bone at rest: of a human the shin, from knee to ankle.
    pub shin: Point,
    /// For a shoe the share of the shin's turn that it takes in the air; `None` for the end of a leg, which turns with the
    /// shin.
    pub turn: Option<f64>,
}

impl Foot {
    /// The last bone's turn from rest, in radians, for a leg in a posture.
    fn shin_turn(&self, leg: &[usize], posture: &[Point]) -> f64 {
        let now = posture[foot_of(leg)] - posture[leg[leg.len() - 2]];
        if now.length_squared() > 0.0 && self.shin.length_squared() > 0.0 { self.shin.angle_to(now) } else { 0.0 }
    }

    /// The foot's turn in the air.
    pub fn swing(&self, leg: &[usize], posture: &[Point]) -> f64 {
        self.turn.unwrap_or(1.0) * self.shin_turn(leg, posture)
    }

    /// How far the foot reaches below the ankle, turned by an angle.
    fn depth(&self, turn: f64) -> f64 {
        let turn = Point::from_angle(turn);
        self.shape.iter().map(|p| turn.rotate(*p).y).fold(f64::NEG_INFINITY, f64::max)
    }

    /// The point of the sole farthest to the side to which the foot points.
    fn toe(&self, flat: f64) -> Point {
        let turn = Point::from_angle(flat);
        let touching = on_ground(&self.shape.iter().map(|p| turn.rotate(*p)).collect::<Vec<_>>());
        touching.into_iter().max_by(|a, b| a.x.abs().total_cmp(&b.x.abs())).unwrap_or(Point::X)
    }
}

/// The key point of a leg's foot: its last.
fn foot_of(leg: &[usize]) -> usize {
    leg[leg.len() - 1]
}

/// What stands on what: the legs of the body, the feet that are drawn, when they stand, and the ground line's y.
struct Ground<'a> {
    legs: &'a [&'a [usize]],
    feet: &'a [Foot],
    contacts: &'a Contacts,
    y: f64,
}

impl Ground<'_> {
    /// The key points of a foot's leg.
    fn leg(&self, foot: &Foot) -> &[usize] {
        self.legs[foot.leg]
    }

    /// How far a foot's sole is above the ground.
    fn above(&self, foot: &Foot, posture: &[Point], turn: f64) -> f64 {
        self.y - posture[foot_of(self.leg(foot))].y - foot.depth(turn)
    }
}

/// The points of a foot that touch the ground.
fn on_ground(shape: &[Point]) -> Vec<Point> {
    let low = shape.iter().map(|p| p.y).fold(f64::NEG_INFINITY, f64::max);
    let size = diameter(shape);
    shape.iter().filter(|p| p.y >= low - TOUCHES * size).copied().collect()
}

fn diameter(shape: &[Point]) -> f64 {
    shape.iter().flat_map(|p| shape.iter().map(|q| p.distance(*q))).fold(0.0, f64::max)
}

/// The turn that lays a sole flat on the ground; 0 if it is drawn flat, or has no flat side.
///
/// Of the turns that lay an edge of the lower hull level, the one with which most of the width touches the ground.
pub fn flat(shape: &[Point]) -> f64 {
    let size = diameter(shape);
    let touching = |angle: f64| {
        let turn = Point::from_angle(angle);
        let on = on_ground(&shape.iter().map(|p| turn.rotate(*p)).collect::<Vec<_>>());
        let (left, right) = on.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(l, r), p| (l.min(p.x), r.max(p.x)));
        (right - left) / size.max(f64::MIN_POSITIVE) - FLATTER * angle.abs()
    };
    let mut best = (0.0, touching(0.0));
    for (a, b) in lower_hull(shape) {
        let angle = -(b - a).to_angle();
        let gain = touching(angle);
        if angle.abs() <= MOST_TILT && gain > best.1 + if best.0 == 0.0 { CLEARLY } else { 0.0 } {
            best = (angle, gain);
        }
    }
    best.0
}

/// The edges of the convex hull's lower side (y down), from left to right (Andrew's monotone chain).
fn lower_hull(points: &[Point]) -> Vec<(Point, Point)> {
    let mut sorted = points.to_vec();
    sorted.sort_by(|a, b| a.x.total_cmp(&b.x).then(a.y.total_cmp(&b.y)));
    let mut hull: Vec<Point> = Vec::new();
    for p in sorted {
        while let [.., a, b] = hull[..] {
            if (b - a).perp_dot(p - a) < 0.0 {
                break;
            }
            hull.pop();
        }
        hull.push(p);
    }
    hull.windows(2).map(|pair| (pair[0], pair[1])).filter(|(a, b)| a.x < b.x).collect()
}

/// Puts the feet of fitted postures on the ground. `clip` is the motion in its own unit, `size` that unit in pixels,
/// `ground` the ground line's y. Returns the turn of each foot from rest on each frame, in radians.
pub fn stand(
    template: &Template,
    postures: &mut [Vec<Point>],
    (clip, size): (&[Vec<Point>], f64),
    feet: &[Foot],
    ground: f64,
) -> Vec<Vec<f64>> {
    let legs = template.legs();
    let contacts = Contacts::of(&legs, clip);
    let on = Ground { legs: &legs, feet, contacts: &contacts, y: ground };
    let flats: Vec<f64> = feet.iter().map(|foot| foot.turn.map_or(0.0, |_| flat(&foot.shape))).collect();
    let mut turns = vec![vec![0.0; postures.len()]; feet.len()];
    for _ in 0..ROUNDS {
        set_turns(&mut turns, postures, &flats, &on);
        set_heights(postures, &turns, &on);
        if contacts.way {
            set_way(postures, &on, size);
        }
        set_legs(postures, &turns, &on);
    }
    set_turns(&mut turns, postures, &flats, &on);
    clear(postures, &turns, &on);
    turns
}

/// Lifts feet that are still below the ground.
fn clear(postures: &mut [Vec<Point>], turns: &[Vec<f64>], on: &Ground) {
    for (foot, turns) in on.feet.iter().zip(turns) {
        for (posture, turn) in postures.iter_mut().zip(turns) {
            let above = on.above(foot, posture, *turn);
            reach(posture, on.leg(foot), Point::new(0.0, above.min(0.0)));
        }
    }
}

/// Step 1.
fn set_turns(turns: &mut [Vec<f64>], postures: &[Vec<Point>], flats: &[f64], on: &Ground) {
    for ((foot, turns), &flat) in on.feet.iter().zip(turns).zip(flats) {
        let leg = on.leg(foot);
        for (turn, posture) in turns.iter_mut().zip(postures) {
            *turn = foot.swing(leg, posture);
        }
        if foot.turn.is_none() {
            continue;
        }
        for run in on.contacts.runs(foot.leg) {
            turns[run.clone()].fill(flat);
            let after = postures[run.end..].iter().map(|posture| posture[foot_of(leg)].y);
            let rolled = roll(foot, flat, after, on.y);
            let end = run.end + rolled.len();
            for (turn, rolled) in turns[run.end..].iter_mut().zip(&rolled) {
                *turn = *rolled;
            }
            let last = rolled.last().copied().unwrap_or(flat);
            // The turn goes over into that in the air; before the contact likewise.
            for k in 0..FADE.min(turns.len() - end) {
                let share = (k + 1) as f64 / (FADE + 1) as f64;
                turns[end + k] = last + (turns[end + k] - last) * share;
            }
            for k in 0..(FADE - 1).min(run.start) {
                let share = (k + 1) as f64 / FADE as f64;
                let at = run.start - 1 - k;
                turns[at] = flat + (turns[at] - flat) * share;
            }
        }
    }
}

/// The turns after a contact while the toe still stands. `after` is the ankle's y on the frames after it.
fn roll(foot: &Foot, flat: f64, after: impl Iterator<Item = f64>, ground: f64) -> Vec<f64> {
    let (toe, stood) = (foot.toe(flat), ground - foot.depth(flat));
    let length = toe.x.abs();
    let mut found: Vec<f64> = Vec::new();
    let mut before = 0.0;
    for ankle in after {
        let risen = stood - ankle;
        if !(risen > before && risen < TOE * length) {
            break;
        }
        found.push(flat + toe.x.signum() * (risen / length).asin());
        before = risen;
    }
    found
}

/// Step 2.
fn set_heights(postures: &mut [Vec<Point>], turns: &[Vec<f64>], on: &Ground) {
    let n = postures.len();
    // How far the lowest sole is above the ground.
    let above = |t: usize, only: bool| {
        let of = |(foot, turns): (&Foot, &Vec<f64>)| {
            let counts = !only || on.contacts.stands[foot.leg][t];
            counts.then(|| on.above(foot, &postures[t], turns[t]))
        };
        on.feet.iter().zip(turns).filter_map(of).fold(f64::INFINITY, f64::min)
    };
    // With all feet drawn the lowest one bears the figure. Some of them do so only while they stand.
    let all = (0..on.legs.len()).all(|leg| on.feet.iter().any(|foot| foot.leg == leg));
    let known: Vec<(usize, f64)> = (0..n)
        .filter(|&t| !on.contacts.air[t])
        .map(|t| (t, above(t, !all)))
        .filter(|(_, shift)| shift.is_finite())
        .collect();
    let shifts: Vec<f64> = (0..n).map(|t| between(&known, t).min(above(t, false))).collect();
    for (posture, shift) in postures.iter_mut().zip(shifts) {
        if shift.is_finite() {
            posture.iter_mut().for_each(|p| p.y += shift);
        }
    }
}

/// A value at a frame, linear between known frames, constant beyond them; 0 without any.
fn between(known: &[(usize, f64)], t: usize) -> f64 {
    let after = known.partition_point(|(f, _)| *f < t);
    match (after.checked_sub(1).map(|k| known[k]), known.get(after)) {
        (_, Some((f, b))) if *f == t => *b,
        (Some((f, a)), Some((g, b))) => a + (b - a) * (t - f) as f64 / (g - f) as f64,
        (Some((_, a)), None) => a,
        (None, Some((_, b))) => *b,
        (None, None) => 0.0,
    }
}

/// For each contact of a drawn foot, its leg, frames, and the shift of each frame along x that makes it go with the
/// ground.
fn slips(postures: &[Vec<Point>], on: &Ground, size: f64) -> Vec<(usize, usize, Vec<f64>)> {
    let mut found = Vec::new();
    for foot in on.feet {
        let ankle = foot_of(on.leg(foot));
        for run in on.contacts.runs(foot.leg) {
            let goes = |t: usize| on.contacts.ground * size * (t - run.start) as f64;
            let at = |t: usize| postures[t][ankle].x - goes(t);
            let stood = quantile(run.clone().map(at).collect(), 0.5);
            found.push((foot.leg, run.start, run.clone().map(|t| stood - at(t)).collect()));
        }
    }
    found
}

/// Step 3.
fn set_way(postures: &mut [Vec<Point>], on: &Ground, size: f64) {
    let mut sums = vec![(0.0, 0.0); postures.len()];
    for (_, start, shifts) in slips(postures, on, size) {
        for (sum, shift) in sums[start..].iter_mut().zip(shifts) {
            *sum = (sum.0 + shift, sum.1 + 1.0);
        }
    }
    let known: Vec<(usize, f64)> =
        sums.iter().enumerate().filter(|(_, s)| s.1 > 0.0).map(|(t, s)| (t, s.0 / s.1)).collect();
    for (t, posture) in postures.iter_mut().enumerate() {
        let shift = between(&known, t);
        posture.iter_mut().for_each(|p| p.x += shift);
    }
    for (leg, start, shifts) in slips(postures, on, size) {
        let shifts: Vec<Point> = shifts.into_iter().map(|x| Point::new(x, 0.0)).collect();
        faded(postures, on.legs[leg], start, &shifts);
    }
}

/// Step 4.
fn set_legs(postures: &mut [Vec<Point>], turns: &[Vec<f64>], on: &Ground) {
    for (foot, turns) in on.feet.iter().zip(turns) {
        for run in on.contacts.runs(foot.leg) {
            let gap = |t: usize| on.above(foot, &postures[t], turns[t]);
            let shifts: Vec<Point> = run.clone().map(|t| Point::new(0.0, gap(t))).collect();
            faded(postures, on.leg(foot), run.start, &shifts);
        }
    }
}

/// Moves a foot by the shifts of a contact, and less on the frames beside it.
fn faded(postures: &mut [Vec<Point>], leg: &[usize], start: usize, shifts: &[Point]) {
    let end = start + shifts.len();
    for t in start.saturating_sub(FADE)..(end + FADE).min(postures.len()) {
        let inside = t.clamp(start, end - 1);
        let weight = 1.0 - t.abs_diff(inside) as f64 / (FADE + 1) as f64;
        reach(&mut postures[t], leg, shifts[inside - start] * weight);
    }
}

#[cfg(test)]
mod tests {
    use super::super::contacts::tests::{human, walk};
    use super::*;
    use rototoon_base::scene::skeleton::LEGS;

    fn shoe(tilt: f64) -> Vec<Point> {
        let turn = Point::from_angle(tilt);
        [(-6.0, 4.0), (-5.0, 8.0), (4.0, 8.0), (14.0, 8.0), (15.0, 5.0), (4.0, -2.0), (-4.0, -3.0)]
            .map(|(x, y)| turn.rotate(Point::new(x, y)))
            .to_vec()
    }

    fn feet(turn: Option<f64>) -> Vec<Foot> {
        (0..2).map(|leg| Foot { leg, shape: shoe(0.0), shin: Point::new(0.0, 40.0), turn }).collect()
    }

    fn soles(postures: &[Vec<Point>], feet: &[Foot], turns: &[Vec<f64>], t: usize) -> [f64; 2] {
        [0, 1].map(|k| postures[t][LEGS[feet[k].leg][2]].y + feet[k].depth(turns[k][t]))
    }

    #[test]
    fn a_tilted_sole_is_laid_flat_and_a_ball_is_left_as_drawn() {
        for tilt in [0.0, 0.5, -0.4] {
            assert!((flat(&shoe(tilt)) + tilt).abs() < 1e-9, "{tilt}: {}", flat(&shoe(tilt)));
        }
        let ball: Vec<Point> = (0..24).map(|k| Point::from_angle(0.2618 * f64::from(k)) * 9.0).collect();
        assert_eq!(flat(&ball), 0.0);
        assert_eq!(flat(&[]), 0.0);
    }

    #[test]
    fn standing_feet_are_flat_on_the_ground_through_a_walk() {
        for way in [true, false] {
            let clip = walk(72, way);
            let placed = |p: &Vec<Point>| p.iter().map(|q| *q * 1.3 + Point::new(20.0, 11.0)).collect();
            let mut made: Vec<Vec<Point>> = clip.iter().map(placed).collect();
            let feet = feet(Some(0.3));
            let turns = stand(&Template::human(), &mut made, (&clip, 1.3), &feet, 300.0);
            let contacts = human(&clip);
            let mut stood = 0;
            for t in 0..72 {
                let soles = soles(&made, &feet, &turns, t);
                assert!(soles.iter().all(|y| *y < 300.0 + 0.5), "frame {t}: a sole under the ground: {soles:?}");
                assert!((soles[0].max(soles[1]) - 300.0).abs() < 0.5, "frame {t}: nothing on the ground: {soles:?}");
                for foot in (0..2).filter(|&foot| contacts.stands[foot][t]) {
                    assert!((soles[foot] - 300.0).abs() < 0.5 && turns[foot][t] == 0.0, "frame {t}: {soles:?}");
                    stood += 1;
                }
            }
            assert!(stood > 60, "{stood}");
            for run in contacts.runs(0).into_iter().filter(|_| way) {
                let x = |t: usize| made[t][13].x - contacts.ground * 1.3 * (t - run.start) as f64;
                assert!(run.clone().all(|t| (x(t) - x(run.start)).abs() < 0.5), "the foot slips");
            }
        }
    }

    #[test]
    fn the_heel_comes_off_before_the_toe() {
        let clip = walk(48, true);
        let mut made = clip.clone();
        let feet = feet(Some(0.3));
        let turns = stand(&Template::human(), &mut made, (&clip, 1.0), &feet, 8.0);
        let contacts = human(&clip);
        let after = contacts.runs(0)[0].end;
        let corner = |k: usize, t: usize| made[t][13] + Point::from_angle(turns[0][t]).rotate(feet[0].shape[k]);
        let rolls = |t: usize| corner(3, t).y > 7.0 && corner(1, t).y < corner(3, t).y - 2.0;
        assert!((after..after + 4).any(rolls), "the toe stands and the heel is up");
        assert!(!(after - 3..after).any(rolls));
    }

    #[test]
    fn a_jump_keeps_its_height() {
        let stood = walk(1, true).remove(0);
        let height = |t: usize| if (10..20).contains(&t) { 40.0 * (0.314_16 * (t - 10) as f64).sin() } else { 0.0 };
        let lifted = |t: usize| stood.iter().map(|p| *p - Point::new(0.0, height(t))).collect();
        let clip: Vec<Vec<Point>> = (0..30).map(lifted).collect();
        let mut made = clip.clone();
        let feet = feet(Some(0.3));
        let turns = stand(&Template::human(), &mut made, (&clip, 1.0), &feet, 50.0);
        let low = |t: usize| soles(&made, &feet, &turns, t).into_iter().fold(f64::MIN, f64::max);
        assert!((low(3) - 50.0).abs() < 0.5 && (low(15) - 10.0).abs() < 2.0, "{} {}", low(3), low(15));
    }

    #[test]
    fn one_drawn_foot_or_none_is_enough() {
        let clip = walk(48, false);
        let mut made = clip.clone();
        assert_eq!(stand(&Template::human(), &mut made, (&clip, 1.0), &[], 50.0), Vec::<Vec<f64>>::new());
        assert_eq!(made, clip);
        let foot = feet(None).remove(1);
        let turns = stand(&Template::human(), &mut made, (&clip, 1.0), std::slice::from_ref(&foot), 50.0);
        let contacts = human(&clip);
        let sole = |t: usize| made[t][16].y + foot.depth(turns[0][t]);
        assert!((0..48).all(|t| sole(t) < 50.5));
        assert!(contacts.runs(1)[0].clone().all(|t| (sole(t) - 50.0).abs() < 0.8));
    }
}
