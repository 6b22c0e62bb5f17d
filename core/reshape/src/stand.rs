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
//! **Clips on twos** are worked on drawing by drawing, and each frame of a hold gets its drawing ([`Holds`]): a frame that repeats
//! a drawing does not show that a foot stands, and on a treadmill the ground goes on with the drawings.
//!
//! **The drawing's own motion** has its pelvis in the right place already. Steps 1 and 4, and step 3 for the legs, are made there, for shoes, on the frames that
//! the document does not show ([`stand_own`]).
//!
//! Limits: the ground is a level line. A leg that would have to be longer stays straight and hangs above the ground.

use super::contacts::{Contacts, every_frame, quantile};
use super::cycle::Cycle;
use super::foot::{Foot, foot_of};
use super::pitch::{FADE, pitches};
use super::reach::reach;
use rototoon_base::geometry::Point;
use rototoon_base::scene::Template;
use rototoon_base::scene::holds::Holds;

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
    let Some(holds) = Holds::of(template, clip) else {
        return stand_at(template, postures, (clip, size), (feet, ground), every_frame(clip));
    };
    let before = postures.to_vec();
    let mut made = holds.drawings(postures);
    let drawings = holds.drawings(clip);
    let turns = stand_at(template, &mut made, (&drawings, size), (feet, ground), holds.times());
    postures.clone_from_slice(&holds.postures(&before, &made));
    turns.iter().map(|turns| holds.held(turns)).collect()
}

/// [`stand`] of postures at these times.
fn stand_at(
    template: &Template,
    postures: &mut [Vec<Point>],
    (clip, size): (&[Vec<Point>], f64),
    on: (&[Foot], f64),
    times: Vec<f64>,
) -> Vec<Vec<f64>> {
    let Some(cycle) = Cycle::of(template, clip) else {
        return stand_once(template, postures, (clip, size), on, times);
    };
    let before = cycle.walked(postures, size);
    let mut made = before.clone();
    let turns = stand_once(template, &mut made, (&cycle.walked(clip, 1.0), size), on, cycle.timed(&times));
    corrected(postures, cycle.middle(&before), cycle.middle(&made));
    turns.iter().map(|turns| cycle.middle(turns).to_vec()).collect()
}

/// Adds what was done to the postures `before`. What was not touched stays as it is to the last digit.
fn corrected(postures: &mut [Vec<Point>], before: &[Vec<Point>], made: &[Vec<Point>]) {
    let pairs = postures.iter_mut().flatten().zip(before.iter().flatten().zip(made.iter().flatten()));
    pairs.for_each(|(p, (before, made))| *p += *made - *before);
}

/// [`stand_at`] of a clip with ends.
fn stand_once(
    template: &Template,
    postures: &mut [Vec<Point>],
    (clip, size): (&[Vec<Point>], f64),
    (feet, ground): (&[Foot], f64),
    times: Vec<f64>,
) -> Vec<Vec<f64>> {
    let legs = template.legs();
    let contacts = Contacts::at(&legs, clip, times);
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
    let whole = drawn.len() == postures.len();
    let Some(holds) = Holds::of(template, postures).filter(|_| whole) else {
        let times = every_frame(postures);
        return own_at(template, postures, feet, (drawn, times));
    };
    let before = postures.to_vec();
    let mut made = holds.drawings(postures);
    let (turns, ground) = own_at(template, &mut made, feet, (&holds.drawings(drawn), holds.times()));
    postures.clone_from_slice(&holds.postures(&before, &made));
    (turns.iter().map(|turns| holds.held(turns)).collect(), ground)
}

/// [`stand_own`] of postures at these times.
fn own_at(
    template: &Template,
    postures: &mut [Vec<Point>],
    feet: &[Foot],
    (drawn, times): (&[Option<Vec<f64>>], Vec<f64>),
) -> (Vec<Vec<f64>>, Option<f64>) {
    let Some(cycle) = Cycle::of(template, postures).filter(|_| drawn.len() == postures.len()) else {
        return own_once(template, postures, feet, (drawn, times));
    };
    let before = cycle.walked(postures, 1.0);
    let mut made = before.clone();
    // The last frame is the first again: what the document shows of one of them, it shows of both.
    let mut round = drawn.to_vec();
    if let [first, .., last] = &mut round[..] {
        *first = first.take().or_else(|| last.clone());
    }
    let shown = cycle.repeated(&round);
    let (turns, ground) = own_once(template, &mut made, feet, (&shown, cycle.timed(&times)));
    corrected(postures, cycle.middle(&before), cycle.middle(&made));
    (turns.iter().map(|turns| cycle.middle(turns).to_vec()).collect(), ground)
}

/// [`own_at`] of a motion with ends.
fn own_once(
    template: &Template,
    postures: &mut [Vec<Point>],
    feet: &[Foot],
    (drawn, times): (&[Option<Vec<f64>>], Vec<f64>),
) -> (Vec<Vec<f64>>, Option<f64>) {
    let legs = template.legs();
    let contacts = Contacts::at(&legs, postures, times);
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
    let shifts: Vec<f64> = (0..n).map(|t| between(&known, t, &on.contacts.times).min(above(t, stands(t)))).collect();
    for (posture, shift) in postures.iter_mut().zip(shifts) {
        if shift.is_finite() {
            posture.iter_mut().for_each(|p| p.y += shift);
        }
    }
}

/// A value at a frame, linear over time between known frames, constant beyond them; 0 without any.
fn between(known: &[(usize, f64)], t: usize, times: &[f64]) -> f64 {
    let after = known.partition_point(|(f, _)| *f < t);
    match (after.checked_sub(1).map(|k| known[k]), known.get(after)) {
        (_, Some((f, b))) if *f == t => *b,
        (Some((f, a)), Some((g, b))) => a + (b - a) * (times[t] - times[f]) / (times[*g] - times[f]),
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
            let times = &on.contacts.times;
            let goes = |t: usize| on.contacts.ground * size * (times[t] - times[run.start]);
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
        let shift = between(&known, t, &on.contacts.times);
        posture.iter_mut().for_each(|p| p.x += shift);
    }
}

/// What is left of step 3 for the legs.
fn stop_slips(postures: &mut [Vec<Point>], on: &Ground, size: f64) {
    for (foot, start, shifts) in slips(postures, on, size) {
        let shifts: Vec<Point> = shifts.into_iter().map(|x| Point::new(x, 0.0)).collect();
        faded(postures, on, foot, (start, &shifts));
    }
}

/// Step 4.
fn set_legs(postures: &mut [Vec<Point>], turns: &[Vec<f64>], on: &Ground) {
    for (foot, turns) in on.feet.iter().zip(turns) {
        for run in on.contacts.runs(foot.leg) {
            let gap = |t: usize| on.above(foot, &postures[t], turns[t]);
            let shifts: Vec<Point> = run.clone().map(|t| Point::new(0.0, gap(t))).collect();
            faded(postures, on, foot, (run.start, &shifts));
        }
    }
}

/// Moves a foot by the shifts of a contact that begins at `start`, and less on the frames beside it, where it may be moved. Another contact of the
/// foot stays as it is.
fn faded(postures: &mut [Vec<Point>], on: &Ground, foot: &Foot, (start, shifts): (usize, &[Point])) {
    let end = start + shifts.len();
    let runs = on.contacts.runs(foot.leg);
    let before = runs.iter().filter_map(|run| start.checked_sub(run.end)).min().unwrap_or(FADE).min(FADE);
    let after = runs.iter().filter_map(|run| run.start.checked_sub(end)).min().unwrap_or(FADE).min(FADE);
    let frames = start.saturating_sub(before)..(end + after).min(postures.len());
    for t in frames.filter(|&t| on.moves(foot, t)) {
        let inside = t.clamp(start, end - 1);
        let room = if t < start { before } else { after };
        let weight = 1.0 - t.abs_diff(inside) as f64 / (room + 1) as f64;
        reach(&mut postures[t], on.leg(foot), shifts[inside - start] * weight);
    }
}

#[cfg(test)]
mod tests;
