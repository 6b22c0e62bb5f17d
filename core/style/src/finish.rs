//! Finishing of a translated clip: limb lengths and standing feet.
//!
//! **Limb lengths.** Averages of swinging limbs are too short. A Gaussian model of coordinates does not know that a
//! thigh has a fixed length. In the picture a limb that points towards the viewer does look shorter. Therefore each
//! limb keeps within the range of lengths that the character's own clips show. In each frame this takes the smallest
//! total move of all key points, by Gauss–Newton on the constraints, Δ = Jᵀ(JJᵀ)⁻¹ c, with the pelvis fixed. Bender et
//! al. ("A Survey on Position-Based Simulation", 2014) solve the same constraints one by one.
//!
//! **Contacts.** Where an ankle of the content's clip hardly moves in the picture, the ankle of the result must not
//! move either. First the pelvis takes up the common motion of the standing feet; between contacts its shift is
//! interpolated linearly. The leg takes up the rest by inverse kinematics of its two limbs (law of cosines). This
//! correction fades in and out beside the contact, but not into another contact of the foot.
//!
//! Limits: a clip whose pelvis stays in one place has no ground to stand on. For such a clip nothing is done.

use rototoon_base::geometry::Point;
use rototoon_base::numeric::dense::DenseCholesky;
use rototoon_base::scene::clip::resample;
use rototoon_base::scene::skeleton::{COUNT, LEGS, LIMBS, PARENTS, Posture, limb_lengths, torso};
use std::ops::Range;

/// Greatest number of rounds for the limb constraints. For long limbs little remains after the second; short limbs need
/// a few more.
const ROUNDS: usize = 12;
/// A foot stands if it moves by less than this between two frames, in torso lengths.
const STANDING: f64 = 0.015;
/// A contact lasts at least this many frames.
const LEAST_FRAMES: usize = 3;
/// Frames over which a correction fades before and after a contact.
const FADE: usize = 4;

/// Keeps limbs within the range of lengths that the postures `own` show. The frames in `held` stay unchanged.
pub fn keep_lengths(postures: &mut [Posture], own: &[Posture], held: &[usize]) {
    let Some(range) = ranges(own) else { return };
    for (frame, posture) in postures.iter_mut().enumerate() {
        if !held.contains(&frame) {
            (0..ROUNDS).for_each(|_| constrain(posture, &range));
        }
    }
}

/// Gives limbs lengths within the range that the postures `own` show. Each keeps its direction, and the pelvis stays.
pub fn take_lengths(postures: &mut [Posture], own: &[Posture]) {
    let Some(range) = ranges(own) else { return };
    for posture in postures {
        let before = *posture;
        for k in 1..COUNT {
            let way = before[k] - before[PARENTS[k]];
            let (least, most) = range[k - 1];
            posture[k] = posture[PARENTS[k]] + way.normalize_or_zero() * way.length().clamp(least, most);
        }
    }
}

/// The range of each limb's lengths in postures; `None` without any. Places too far apart for a number have no length: a limb without one may have any.
fn ranges(own: &[Posture]) -> Option<[(f64, f64); LIMBS]> {
    let mut range = [(f64::INFINITY, 0.0f64); LIMBS];
    for posture in own {
        for (range, length) in range.iter_mut().zip(limb_lengths(posture)) {
            *range = (range.0.min(length), range.1.max(length));
        }
    }
    let any = |range: (f64, f64)| if range.0 <= range.1 { range } else { (0.0, f64::INFINITY) };
    (!own.is_empty()).then_some(range.map(any))
}

/// One Gauss–Newton step towards limbs within their ranges.
fn constrain(posture: &mut Posture, range: &[(f64, f64); LIMBS]) {
    let lengths = limb_lengths(posture);
    let active: Vec<(usize, f64)> = (0..LIMBS)
        .filter_map(|limb| {
            let wanted = lengths[limb].clamp(range[limb].0, range[limb].1) - lengths[limb];
            (wanted.abs() > 1e-12 && lengths[limb] > 1e-9).then_some((limb, wanted))
        })
        .collect();
    let n = active.len();
    let ends = |limb: usize| (limb + 1, PARENTS[limb + 1]);
    let direction = |limb: usize| (posture[limb + 1] - posture[PARENTS[limb + 1]]) / lengths[limb];
    // A row of J: +d at the child, −d at the parent unless the parent is the pelvis.
    let along = |limb: usize, point: usize| match ends(limb) {
        (child, _) if child == point => direction(limb),
        (_, parent) if parent == point && point != 0 => -direction(limb),
        _ => Point::ZERO,
    };
    let mut products = vec![0.0; n * n];
    for (i, (a, _)) in active.iter().enumerate() {
        for (j, (b, _)) in active.iter().enumerate() {
            let shared = [ends(*a).0, ends(*a).1];
            products[i * n + j] = shared.iter().map(|&p| along(*a, p).dot(along(*b, p))).sum();
        }
    }
    let Some(factor) = DenseCholesky::new(n, &products) else { return };
    let mut forces: Vec<f64> = active.iter().map(|(_, wanted)| *wanted).collect();
    factor.solve(&mut forces, 1);
    let mut moved = [Point::ZERO; COUNT];
    for ((limb, _), force) in active.iter().zip(forces) {
        let (child, parent) = ends(*limb);
        moved[child] += along(*limb, child) * force;
        moved[parent] += along(*limb, parent) * force;
    }
    posture.iter_mut().zip(moved).for_each(|(p, d)| *p += d);
}

/// Ranges of frames during which an ankle stands.
pub fn contacts(postures: &[Posture], ankle: usize) -> Vec<Range<usize>> {
    let size = postures.iter().map(torso).sum::<f64>() / postures.len().max(1) as f64;
    let still: Vec<bool> =
        postures.windows(2).map(|pair| pair[0][ankle].distance(pair[1][ankle]) < STANDING * size).collect();
    let mut found = Vec::new();
    let mut start = None;
    for (k, is) in still.iter().chain(std::iter::once(&false)).enumerate() {
        match (start, is) {
            (None, true) => start = Some(k),
            (Some(from), false) => {
                found.extend((k + 1 - from >= LEAST_FRAMES).then_some(from..k + 1));
                start = None;
            }
            _ => {}
        }
    }
    found
}

/// Makes the feet of a translated clip stand wherever they stand in the content's clip.
pub fn keep_contacts(postures: &mut [Posture], content: &[Posture]) {
    let content = resample(content, postures.len());
    let size = content.iter().map(torso).sum::<f64>() / content.len().max(1) as f64;
    if content.iter().all(|p| p[0].distance(content[0][0]) < 1e-6 * size) {
        return;
    }
    let standing = LEGS.map(|leg| contacts(&content, leg[2]));
    let shifts = |postures: &[Posture]| -> Vec<(usize, Range<usize>, Vec<Point>)> {
        LEGS.iter()
            .zip(&standing)
            .enumerate()
            .flat_map(|(leg, (points, ranges))| ranges.iter().map(move |range| (leg, points[2], range.clone())))
            .map(|(leg, ankle, range)| {
                let middle = range.clone().map(|f| postures[f][ankle]).sum::<Point>() / range.len() as f64;
                let shift = range.clone().map(|f| middle - postures[f][ankle]).collect();
                (leg, range, shift)
            })
            .collect()
    };
    let mut common: Vec<(Point, f64)> = vec![(Point::ZERO, 0.0); postures.len()];
    for (_, range, shift) in shifts(postures) {
        for (frame, shift) in range.zip(shift) {
            common[frame].0 += shift;
            common[frame].1 += 1.0;
        }
    }
    let known: Vec<(usize, Point)> =
        common.iter().enumerate().filter(|(_, c)| c.1 > 0.0).map(|(f, c)| (f, c.0 / c.1)).collect();
    for (frame, posture) in postures.iter_mut().enumerate() {
        let shift = between_known(&known, frame);
        posture.iter_mut().for_each(|p| *p += shift);
    }
    for (leg, range, shift) in shifts(postures) {
        let [before, after] = room(&range, &standing[leg]);
        let first = range.start.saturating_sub(before);
        for frame in first..(range.end + after).min(postures.len()) {
            let inside = frame.clamp(range.start, range.end - 1);
            let room = if frame < range.start { before } else { after };
            let weight = 1.0 - frame.abs_diff(inside) as f64 / (room + 1) as f64;
            reach(&mut postures[frame], &LEGS[leg], shift[inside - range.start] * weight);
        }
    }
}

/// Frames before and after a contact on which its correction fades: [`FADE`], or those up to the foot's next contact, which must not move with
/// this one.
fn room(range: &Range<usize>, contacts: &[Range<usize>]) -> [usize; 2] {
    let least = |gaps: &mut dyn Iterator<Item = usize>| gaps.min().unwrap_or(FADE).min(FADE);
    let before = least(&mut contacts.iter().filter_map(|other| range.start.checked_sub(other.end)));
    let after = least(&mut contacts.iter().filter_map(|other| other.start.checked_sub(range.end)));
    [before, after]
}

fn between_known(known: &[(usize, Point)], frame: usize) -> Point {
    let after = known.partition_point(|(f, _)| *f < frame);
    match (after.checked_sub(1).and_then(|k| known.get(k)), known.get(after)) {
        (Some((f, a)), Some((g, b))) => a.lerp(*b, (frame - f) as f64 / (g - f) as f64),
        (Some((_, a)), None) | (None, Some((_, a))) => *a,
        (None, None) => Point::ZERO,
    }
}

/// Moves an ankle by `shift`. The knee follows: both limbs keep their lengths, and the knee stays on its side.
fn reach(posture: &mut Posture, [hip, knee, ankle]: &[usize; 3], shift: Point) {
    let (h, k, a) = (posture[*hip], posture[*knee], posture[*ankle]);
    let (upper, lower) = (h.distance(k), k.distance(a));
    let target = a + shift;
    let way = target - h;
    let distance = way.length().clamp((upper - lower).abs(), upper + lower);
    if distance < 1e-9 || way.length() < 1e-9 {
        return;
    }
    let direction = way.normalize();
    let along = (distance * distance + upper * upper - lower * lower) / (2.0 * distance);
    let across = (upper * upper - along * along).max(0.0).sqrt();
    let side = if (a - h).perp_dot(k - h) >= 0.0 { 1.0 } else { -1.0 };
    posture[*knee] = h + direction * along + direction.perp() * (side * across);
    posture[*ankle] = h + direction * distance;
}

#[cfg(test)]
mod tests {
    use super::*;

    fn standing(x: f64) -> Posture {
        let mut p = [Point::ZERO; COUNT];
        for (k, y) in [(0, 0.0), (1, -0.6), (2, -1.0), (3, -1.2), (4, -1.5), (5, -0.9), (6, -0.5), (7, -0.1)] {
            p[k] = Point::new(0.05 * k as f64, y);
        }
        for k in 8..11 {
            p[k] = p[k - 3] + Point::new(0.1, 0.02);
        }
        for (leg, side) in LEGS.iter().zip([-0.1, 0.1]) {
            p[leg[0]] = Point::new(side, 0.05);
            p[leg[1]] = Point::new(side + 0.15, 1.0);
            p[leg[2]] = Point::new(side, 1.9);
        }
        p.map(|q| q + Point::new(x, 0.0))
    }

    #[test]
    fn limbs_come_back_to_their_lengths_and_the_pelvis_stays() {
        let own = [standing(0.0)];
        let mut shrunk = [own[0].map(|p| p * 0.93)];
        keep_lengths(&mut shrunk, &own, &[]);
        for (a, b) in limb_lengths(&shrunk[0]).iter().zip(limb_lengths(&own[0])) {
            assert!((a - b).abs() < 1e-6, "{a} {b}");
        }
        assert_eq!(shrunk[0][0], Point::ZERO);
        let mut held = [own[0].map(|p| p * 0.93)];
        keep_lengths(&mut held, &own, &[0]);
        assert_eq!(held[0], own[0].map(|p| p * 0.93));
    }

    #[test]
    fn a_limb_without_length_is_left_alone() {
        let own = [standing(0.0)];
        let mut flat = [own[0]];
        flat[0][7] = flat[0][6];
        keep_lengths(&mut flat, &own, &[]);
        assert!(flat[0].iter().all(|p| p.is_finite()));
    }

    #[test]
    fn a_foot_that_stands_stays_and_legs_keep_their_lengths() {
        // The content's left foot stands while the body moves on. In the translated clip it slides.
        let frames = 12;
        let content: Vec<Posture> = (0..frames)
            .map(|f| {
                let mut p = standing(0.03 * f as f64);
                p[13] = Point::new(0.0, 1.9);
                p
            })
            .collect();
        assert_eq!(contacts(&content, 13), vec![0..frames]);
        assert!(contacts(&content, 16).is_empty());
        let mut made: Vec<Posture> = (0..frames)
            .map(|f| {
                let mut p = content[f];
                p[13] += Point::new(0.01 * f as f64, 0.01 * (f % 3) as f64);
                p
            })
            .collect();
        let before: Vec<[f64; 2]> = made.iter().map(|p| [p[11].distance(p[12]), p[12].distance(p[13])]).collect();
        keep_contacts(&mut made, &content);
        for (p, before) in made.iter().zip(before) {
            assert!(p[13].distance(made[0][13]) < 1e-9);
            assert!((p[11].distance(p[12]) - before[0]).abs() < 1e-9);
            assert!((p[12].distance(p[13]) - before[1]).abs() < 1e-9);
        }
    }

    #[test]
    fn a_foot_that_steps_at_once_stands_on_both_places() {
        // From one frame to the next, or over a few, the left foot is put half a torso further.
        for between in 0..6 {
            let frames = 12 + between;
            let along = |f: usize| (f.saturating_sub(5) as f64 / (between + 1) as f64).min(1.0) * 0.5;
            let content: Vec<Posture> = (0..frames)
                .map(|f| {
                    let mut p = standing(0.03 * f as f64);
                    p[13] = Point::new(along(f), 1.9);
                    p[16] = Point::new(0.2, 1.9);
                    [12, 15].into_iter().for_each(|knee| p[knee].x += 0.5);
                    p
                })
                .collect();
            assert_eq!(contacts(&content, 13), [0..6, 6 + between..frames]);
            assert_eq!(contacts(&content, 16), vec![0..frames]);
            let mut made = content.clone();
            for (f, p) in made.iter_mut().enumerate() {
                p[13] += Point::new(0.0, -0.02 * (f % 4) as f64);
            }
            keep_contacts(&mut made, &content);
            for stood in [0..6, 6 + between..frames] {
                let off = stood.clone().map(|f| made[f][13].distance(made[stood.start][13])).fold(0.0, f64::max);
                assert!(off < 1e-9, "{between} frames between: the foot slides by {off} torsos");
            }
        }
    }

    #[test]
    fn without_a_way_there_is_no_ground() {
        let content: Vec<Posture> = (0..5).map(|_| standing(0.0)).collect();
        let mut made: Vec<Posture> =
            content.iter().enumerate().map(|(f, p)| p.map(|q| q * (1.0 + 0.01 * f as f64))).collect();
        let before = made.clone();
        keep_contacts(&mut made, &content);
        assert_eq!(made, before);
    }
}
