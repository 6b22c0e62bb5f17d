//! Feet on the ground: where a figure of other proportions, or one whose pelvis is fixed, stands in the picture.
//!
//! A foot is drawn with a sole: the outline of its shoe, or of the end of the leg. From [`Contacts`] follow
//!
//! 1. **The pitch of shoes** (the module `pitch`).
//! 2. **The height of the pelvis.** On each frame with a foot on the ground, the lowest sole touches the ground line.
//!    In the air the shift is interpolated, so a jump keeps its height. No sole is below the ground in the end. A clip with a
//!    fixed pelvis gets back the rise and fall of its steps.
//! 3. **The way of the pelvis.** A standing foot moves as the ground does. The pelvis takes up what is common to the
//!    feet that stand, as in `rototoon-style`.
//! 4. **The legs.** What is left is taken up by the bones of the leg ([`super::reach`]), fading beside the contact.
//!
//! The order is 1 to 4, twice, since a leg that moves turns its shin.
//!
//! **Feet that stand bear the figure.** In step 2 only they count where there are some. A swinging foot whose toe would drag on the ground is
//! lifted by its leg instead: before a clip's first frame nothing is known, so the pitch of a foot that has just left the ground may be
//! wrong there, and must not lift the whole figure off its standing foot.
//!
//! **Cycles** are worked on as if they went on around ([`super::cycle`]).
//!
//! **The drawing's own motion** has its pelvis in the right place already. Steps 1 and 4, and step 3 for the legs, are made there, for shoes, on the frames that
//! the document does not show ([`stand_own`]).
//!
//! Limits: the ground is a level line. A leg that would have to be longer stays straight and hangs above the ground.

use super::contacts::{Contacts, quantile};
use super::cycle::Cycle;
use super::foot::{Foot, foot_of};
use super::pitch::{FADE, pitches};
use super::reach::reach;
use rototoon_base::geometry::Point;
use rototoon_base::scene::Template;

/// Rounds of the four steps.
const ROUNDS: usize = 2;

/// What stands on what.
struct Ground<'a> {
    /// The legs of the body.
    legs: &'a [&'a [usize]],
    /// The feet that are drawn.
    feet: &'a [Foot],
    /// When they stand.
    contacts: &'a Contacts,
    /// The ground line's y.
    y: f64,
    /// Of the drawing's own motion, for each frame the turns of the feet where the document shows them; else empty.
    drawn: &'a [Option<Vec<f64>>],
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

    /// Whether a foot may be moved on a frame. In the drawing's own motion the end of a leg is where its key points are, and
    /// nothing moves where the document shows the drawing.
    fn moves(&self, foot: &Foot, frame: usize) -> bool {
        self.drawn.get(frame).is_none_or(|drawn| drawn.is_none() && foot.turn.is_some())
    }
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
    let Some(cycle) = Cycle::of(template, clip) else {
        return stand_once(template, postures, (clip, size), feet, ground);
    };
    let before = cycle.walked(postures, size);
    let mut made = before.clone();
    let turns = stand_once(template, &mut made, (&cycle.walked(clip, 1.0), size), feet, ground);
    corrected(postures, cycle.middle(&before), cycle.middle(&made));
    turns.iter().map(|turns| cycle.middle(turns).to_vec()).collect()
}

/// Adds what was done to the postures `before`. What was not touched stays as it is to the last digit.
fn corrected(postures: &mut [Vec<Point>], before: &[Vec<Point>], made: &[Vec<Point>]) {
    let pairs = postures.iter_mut().flatten().zip(before.iter().flatten().zip(made.iter().flatten()));
    pairs.for_each(|(p, (before, made))| *p += *made - *before);
}

/// [`stand`] of a clip with ends.
fn stand_once(
    template: &Template,
    postures: &mut [Vec<Point>],
    (clip, size): (&[Vec<Point>], f64),
    feet: &[Foot],
    ground: f64,
) -> Vec<Vec<f64>> {
    let legs = template.legs();
    let contacts = Contacts::of(&legs, clip);
    let on = Ground { legs: &legs, feet, contacts: &contacts, y: ground, drawn: &[] };
    let mut turns = vec![Vec::new(); feet.len()];
    for _ in 0..ROUNDS {
        set_turns(&mut turns, postures, &on);
        set_heights(postures, &turns, &on);
        if contacts.way {
            set_way(postures, &on, size);
            stop_slips(postures, &on, size);
        }
        set_legs(postures, &turns, &on);
    }
    set_turns(&mut turns, postures, &on);
    clear(postures, &turns, &on);
    turns
}

/// The same for the drawing's own motion, whose pelvis is already where it belongs: only shoes are turned, and legs moved by what
/// is left. `drawn` has for each frame the turns of all feet, where the document shows the drawing; there nothing changes. The
/// ground is where feet stand on those frames, else where they stand in the motion; without contacts nothing is below it. Returns
/// the turns and the ground line's y.
pub fn stand_own(
    template: &Template,
    postures: &mut [Vec<Point>],
    feet: &[Foot],
    drawn: &[Option<Vec<f64>>],
) -> (Vec<Vec<f64>>, Option<f64>) {
    let Some(cycle) = Cycle::of(template, postures).filter(|_| drawn.len() == postures.len()) else {
        return own_once(template, postures, feet, drawn);
    };
    let before = cycle.walked(postures, 1.0);
    let mut made = before.clone();
    // The last frame is the first again: what the document shows of one of them, it shows of both.
    let mut round = drawn.to_vec();
    if let [first, .., last] = &mut round[..] {
        *first = first.take().or_else(|| last.clone());
    }
    let shown = cycle.repeated(&round);
    let (turns, ground) = own_once(template, &mut made, feet, &shown);
    corrected(postures, cycle.middle(&before), cycle.middle(&made));
    (turns.iter().map(|turns| cycle.middle(turns).to_vec()).collect(), ground)
}

/// [`stand_own`] of a motion with ends.
fn own_once(
    template: &Template,
    postures: &mut [Vec<Point>],
    feet: &[Foot],
    drawn: &[Option<Vec<f64>>],
) -> (Vec<Vec<f64>>, Option<f64>) {
    let legs = template.legs();
    let contacts = Contacts::of(&legs, postures);
    let found = own_ground(postures, (&legs, feet), &contacts, drawn);
    let on = Ground { legs: &legs, feet, contacts: &contacts, y: found.unwrap_or(f64::INFINITY), drawn };
    let mut turns = vec![Vec::new(); feet.len()];
    for _ in 0..ROUNDS {
        set_turns(&mut turns, postures, &on);
        stop_slips(postures, &on, 1.0);
        set_legs(postures, &turns, &on);
    }
    set_turns(&mut turns, postures, &on);
    if found.is_some() {
        clear(postures, &turns, &on);
    }
    (turns, found)
}

/// The y of the soles that stand in the drawing's own motion: their median, over the frames that the document shows if a foot
/// stands on one of them. `None` without contacts.
fn own_ground(
    postures: &[Vec<Point>],
    (legs, feet): (&[&[usize]], &[Foot]),
    contacts: &Contacts,
    drawn: &[Option<Vec<f64>>],
) -> Option<f64> {
    let (mut shown, mut all) = (Vec::new(), Vec::new());
    for (k, foot) in feet.iter().enumerate() {
        let leg = legs[foot.leg];
        for t in (0..postures.len()).filter(|&t| contacts.stands[foot.leg][t]) {
            let known = drawn.get(t).and_then(|turns| Some(turns.as_ref()?[k]));
            let otherwise = || foot.turn.map_or_else(|| foot.swing(leg, &postures[t]), |_| foot.level);
            let sole = postures[t][foot_of(leg)].y + foot.depth(known.unwrap_or_else(otherwise));
            all.push(sole);
            shown.extend(known.map(|_| sole));
        }
    }
    let of = if shown.is_empty() { all } else { shown };
    (!of.is_empty()).then(|| quantile(of, 0.5))
}

/// Lifts feet that are still below the ground.
fn clear(postures: &mut [Vec<Point>], turns: &[Vec<f64>], on: &Ground) {
    for (foot, turns) in on.feet.iter().zip(turns) {
        for (t, posture) in postures.iter_mut().enumerate().filter(|(t, _)| on.moves(foot, *t)) {
            let above = on.above(foot, posture, turns[t]);
            reach(posture, on.leg(foot), Point::new(0.0, above.min(0.0)));
        }
    }
}

/// Step 1.
fn set_turns(turns: &mut [Vec<f64>], postures: &[Vec<Point>], on: &Ground) {
    for (k, (foot, turns)) in on.feet.iter().zip(turns).enumerate() {
        let drawn: Vec<Option<f64>> = on.drawn.iter().map(|turns| Some(turns.as_ref()?[k])).collect();
        *turns = pitches(foot, on.leg(foot), postures, (&on.contacts.runs(foot.leg), on.y), &drawn);
    }
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
    // Feet that stand bear the figure. Where none does, the lowest one of all feet bears it, if all are drawn.
    let all = (0..on.legs.len()).all(|leg| on.feet.iter().any(|foot| foot.leg == leg));
    let stands = |t: usize| on.feet.iter().any(|foot| on.contacts.stands[foot.leg][t]);
    let known: Vec<(usize, f64)> = (0..n)
        .filter(|&t| !on.contacts.air[t])
        .map(|t| (t, above(t, stands(t) || !all)))
        .filter(|(_, shift)| shift.is_finite())
        .collect();
    let shifts: Vec<f64> = (0..n).map(|t| between(&known, t).min(above(t, stands(t)))).collect();
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

/// For each contact of a drawn foot, the foot, the first frame, and the shift of each frame along x that makes it go with the
/// ground: from where the document shows it, else from its median place.
fn slips<'a>(postures: &[Vec<Point>], on: &Ground<'a>, size: f64) -> Vec<(&'a Foot, usize, Vec<f64>)> {
    let mut found = Vec::new();
    for foot in on.feet {
        let ankle = foot_of(on.leg(foot));
        for run in on.contacts.runs(foot.leg) {
            let goes = |t: usize| on.contacts.ground * size * (t - run.start) as f64;
            let at = |t: usize| postures[t][ankle].x - goes(t);
            let drawn = run.clone().find(|&t| on.drawn.get(t).is_some_and(Option::is_some));
            let stood = drawn.map_or_else(|| quantile(run.clone().map(at).collect(), 0.5), at);
            found.push((foot, run.start, run.clone().map(|t| stood - at(t)).collect()));
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
}

/// What is left of step 3 for the legs.
fn stop_slips(postures: &mut [Vec<Point>], on: &Ground, size: f64) {
    for (foot, start, shifts) in slips(postures, on, size) {
        let shifts: Vec<Point> = shifts.into_iter().map(|x| Point::new(x, 0.0)).collect();
        faded(postures, on.leg(foot), start, &shifts, |t| on.moves(foot, t));
    }
}

/// Step 4.
fn set_legs(postures: &mut [Vec<Point>], turns: &[Vec<f64>], on: &Ground) {
    for (foot, turns) in on.feet.iter().zip(turns) {
        for run in on.contacts.runs(foot.leg) {
            let gap = |t: usize| on.above(foot, &postures[t], turns[t]);
            let shifts: Vec<Point> = run.clone().map(|t| Point::new(0.0, gap(t))).collect();
            faded(postures, on.leg(foot), run.start, &shifts, |t| on.moves(foot, t));
        }
    }
}

/// Moves a foot by the shifts of a contact, and less on the frames beside it, on the frames on which it `moves`.
fn faded(postures: &mut [Vec<Point>], leg: &[usize], start: usize, shifts: &[Point], moves: impl Fn(usize) -> bool) {
    let end = start + shifts.len();
    for t in (start.saturating_sub(FADE)..(end + FADE).min(postures.len())).filter(|&t| moves(t)) {
        let inside = t.clamp(start, end - 1);
        let weight = 1.0 - t.abs_diff(inside) as f64 / (FADE + 1) as f64;
        reach(&mut postures[t], leg, shifts[inside - start] * weight);
    }
}

#[cfg(test)]
mod tests {
    use super::super::contacts::tests::{human, walk};
    use super::super::foot::tests::shoe;
    use super::*;
    use rototoon_base::scene::skeleton::LEGS;

    fn feet(turn: Option<f64>) -> Vec<Foot> {
        let shin = Point::new(0.0, 40.0);
        let foot = |leg| match turn {
            Some(turn) => Foot::shoe(leg, shoe(0.0), shin, turn),
            None => Foot::end(leg, shoe(0.0), shin),
        };
        (0..2).map(foot).collect()
    }

    fn soles(postures: &[Vec<Point>], feet: &[Foot], turns: &[Vec<f64>], t: usize) -> [f64; 2] {
        [0, 1].map(|k| postures[t][LEGS[feet[k].leg][2]].y + feet[k].depth(turns[k][t]))
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
    fn a_cycle_goes_round_on_other_legs_and_its_first_foot_stands() {
        for way in [true, false] {
            let clip = walk(25, way);
            // Fitted to a figure with shorter thighs.
            let shorter = |p: &Vec<Point>| {
                let mut p = p.clone();
                for leg in LEGS {
                    let shift = (p[leg[0]] - p[leg[1]]) * 0.3;
                    leg[1..].iter().for_each(|&k| p[k] += shift);
                }
                p
            };
            let mut made: Vec<Vec<Point>> = clip.iter().map(shorter).collect();
            let feet = feet(Some(1.0));
            let turns = stand(&Template::human(), &mut made, (&clip, 1.0), &feet, 60.0);
            let step = made[24][0] - made[0][0];
            assert!(step.y.abs() < 1e-9, "the body rises by {} px at the seam", step.y);
            for (k, (a, b)) in made[0].iter().zip(&made[24]).enumerate() {
                assert!((*a + step).distance(*b) < 1e-6, "key point {k}: {a} {b}");
            }
            assert!(turns.iter().all(|turns| (turns[0] - turns[24]).abs() < 1e-9), "{turns:?}");
            let stands = |t: usize| soles(&made, &feet, &turns, t);
            assert!(
                (0..8).all(|t| stands(t).iter().any(|y| (y - 60.0).abs() < 0.5)),
                "a foot stands from the first frame on"
            );
        }
    }

    #[test]
    fn a_dragging_toe_does_not_lift_the_figure_off_its_standing_foot() {
        // The right foot has just left the ground when the clip begins.
        let clip: Vec<Vec<Point>> = walk(60, true)[3..].to_vec();
        let mut made = clip.clone();
        let feet = feet(Some(1.0));
        let turns = stand(&Template::human(), &mut made, (&clip, 1.0), &feet, 8.0);
        let contacts = human(&clip);
        for (t, _) in contacts.stands[0].iter().enumerate().filter(|(_, stands)| **stands) {
            let sole = soles(&made, &feet, &turns, t)[0];
            assert!((sole - 8.0).abs() < 0.5, "frame {t}: the standing foot is {} px above the ground", 8.0 - sole);
        }
        assert!(contacts.stands[0][0] && !contacts.stands[1][0]);
    }

    #[test]
    fn the_own_cycle_goes_round() {
        let clip = walk(25, true);
        let mut drawn: Vec<Option<Vec<f64>>> = vec![None; 25];
        drawn[24] = Some(vec![0.0, -0.4]);
        let (mut made, feet) = (clip.clone(), feet(Some(1.0)));
        let (turns, _) = stand_own(&Template::human(), &mut made, &feet, &drawn);
        assert_eq!((&made[24], turns[1][24]), (&clip[24], -0.4), "what is shown stays");
        let step = clip[24][0] - clip[0][0];
        assert!(made[0].iter().zip(&made[24]).all(|(a, b)| (*a + step).distance(*b) < 1e-6));
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
    fn the_own_motion_keeps_its_pelvis_and_the_frames_that_are_shown() {
        let clip = walk(48, true);
        let contacts = human(&clip);
        let first = contacts.runs(0)[0].start + 4; // while the other foot swings
        let mut drawn: Vec<Option<Vec<f64>>> = vec![None; 48];
        drawn[first] = Some(vec![0.0, -0.4]);
        let (mut made, feet) = (clip.clone(), feet(Some(1.0)));
        let (turns, ground) = stand_own(&Template::human(), &mut made, &feet, &drawn);
        let ground = ground.unwrap();
        assert!((ground - clip[first][13].y - 8.0).abs() < 1e-9, "the foot that is drawn stands on it: {ground}");
        assert_eq!((&made[first], turns[0][first], turns[1][first]), (&clip[first], 0.0, -0.4));
        for (t, (made, clip)) in made.iter().zip(&clip).enumerate() {
            assert!((0..12).all(|k| made[k] == clip[k]), "frame {t}: only legs move");
            for foot in 0..2 {
                let sole = made[LEGS[foot][2]].y + feet[foot].depth(turns[foot][t]);
                assert!(t == first || sole < ground + 0.5, "frame {t}: a sole under the ground");
                if contacts.stands[foot][t] && t != first {
                    assert!((sole - ground).abs() < 0.5 && turns[foot][t] == 0.0, "frame {t}: {sole} {ground}");
                }
            }
        }
        // What a document shows of every frame stays, and so do legs without shoes.
        let all = vec![Some(vec![0.3, 0.2]); 48];
        let mut same = clip.clone();
        let (turns, _) = stand_own(&Template::human(), &mut same, &feet, &all);
        assert_eq!((same, turns), (clip.clone(), vec![vec![0.3; 48], vec![0.2; 48]]));
        let mut same = clip.clone();
        stand_own(&Template::human(), &mut same, &self::feet(None), &vec![None; 48]);
        assert_eq!(same, clip);
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
