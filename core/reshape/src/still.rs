//! What nothing moves keeps its drawn shape.
//!
//! A clip of another body moves some chains of the drawing's. A bone that no chain of the clip moves, such as a dog's tail under a
//! human's clip, keeps the angle to its parent and the length that it has in the drawing:
//!
//! - What hangs on the torso turns with the body there.
//! - Anything else turns with the bone on which it hangs.
//!
//! Where legs and limbs hang on the body is [`super::fit`]'s.

use super::fit::Shown;
use rototoon_base::geometry::Point;
use rototoon_base::scene::Template;

/// Puts the key points whose bones nothing moves where they are drawn, relative to what they hang on. `moved` says for each key
/// point whether the clip moves the bone that ends in it. `postures` are those of the drawing, in its pixels.
pub fn keep_still(shown: &Shown, moved: &[bool], postures: &mut [Vec<Point>]) {
    let template = shown.template.as_ref();
    let hung: Vec<usize> = template.hanging().iter().map(|chain| chain[0]).collect();
    let stays = |k: usize| k > 0 && !moved[k] && !hung.contains(&k);
    for posture in postures {
        let mut made = posture.clone();
        for k in 1..template.len() {
            let parent = template.parent(k);
            let way = if stays(k) {
                turn(template, &shown.rest, &made, parent).rotate(shown.rest[k] - shown.rest[parent])
            } else {
                posture[k] - posture[parent]
            };
            made[k] = made[parent] + way;
        }
        *posture = made;
    }
}

/// The rotation of what a key point belongs to, from the drawing at rest to a posture: of the body at a point of the torso,
/// else of the bone that ends in it.
fn turn(template: &Template, rest: &[Point], posture: &[Point], point: usize) -> Point {
    let mut bone = match template.torso().contains(&point) {
        true => template.body_at(point),
        false => (template.parent(point), point),
    };
    // A key point that lies on its parent has no direction; then the one above it counts.
    while rest[bone.0] == rest[bone.1] && bone.0 != 0 {
        bone = (template.parent(bone.0), bone.0);
    }
    let (before, now) = (rest[bone.1] - rest[bone.0], posture[bone.1] - posture[bone.0]);
    if before == Point::ZERO || now == Point::ZERO { Point::X } else { Point::from_angle(before.angle_to(now)) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_still_tail_keeps_its_drawn_angle_to_the_body() {
        let cat = Template::quadruped();
        let index = |name: &str| cat.index(name).unwrap();
        let (tip, middle, base) = (index("tail_tip"), index("tail_middle"), index("tail_base"));
        // Drawn with the tail up, which is not typical.
        let mut rest: Vec<Point> = cat.typical().iter().map(|p| *p * 80.0).collect();
        rest[middle] = rest[base] + Point::new(-6.0, -20.0);
        rest[tip] = rest[middle] + Point::new(5.0, -18.0);
        let shown = Shown {
            template: cat.clone(),
            rest: rest.clone(),
            postures: vec![rest.clone()],
            told: vec![true; cat.len()],
        };
        let lean = Point::from_angle(0.4);
        let mut posture: Vec<Point> =
            cat.typical().iter().map(|p| lean.rotate(*p) * 80.0 + Point::new(9.0, 3.0)).collect();
        let before = posture.clone();
        let moved: Vec<bool> =
            (0..cat.len()).map(|k| !["tail_base", "tail_middle", "tail_tip"].contains(&cat.point_name(k))).collect();
        keep_still(&shown, &moved, std::slice::from_mut(&mut posture));
        for k in [base, middle, tip] {
            let wanted = lean.rotate(rest[k] - rest[0]);
            assert!((posture[k] - posture[0]).distance(wanted) < 1e-9, "{}", cat.point_name(k));
        }
        let others = (0..cat.len()).filter(|k| moved[*k]);
        assert!(others.into_iter().all(|k| posture[k].distance(before[k]) < 1e-9));
    }

    #[test]
    fn what_hangs_on_a_moved_bone_turns_with_it() {
        let cat = Template::quadruped();
        let index = |name: &str| cat.index(name).unwrap();
        let (paw, wrist, elbow) = (index("l_forepaw"), index("l_wrist"), index("l_elbow"));
        let rest = cat.typical();
        let shown = Shown {
            template: cat.clone(),
            rest: rest.clone(),
            postures: vec![rest.clone()],
            told: vec![true; cat.len()],
        };
        let mut posture = rest.clone();
        posture[wrist] = rest[elbow] + Point::from_angle(-0.5).rotate(rest[wrist] - rest[elbow]);
        let moved: Vec<bool> = (0..cat.len()).map(|k| k != paw).collect();
        keep_still(&shown, &moved, std::slice::from_mut(&mut posture));
        let wanted = Point::from_angle(-0.5).rotate(rest[paw] - rest[wrist]);
        assert!((posture[paw] - posture[wrist]).distance(wanted) < 1e-9);
    }
}
