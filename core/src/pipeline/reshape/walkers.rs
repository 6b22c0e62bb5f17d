//! Humans in shoes that are drawn by a rule in profile: one drawing of a walk, reshaped by the walk itself and by other clips.

use super::animals::{Drawn, film, own_clip};
use super::*;
use crate::scene::limbs::Carried;
use crate::scene::skeleton::LEGS;
use crate::scene::template::Template;
use crate::scene::{Part, Silent};

const FRAMES: usize = 24;
/// The ground's y.
const GROUND: f64 = 300.0;
/// Height of the ankle of a flat foot.
const ANKLE: f64 = 8.0;

const HUMAN: [Drawn; 5] = [
    ("body", 12.0, &["pelvis", "chest", "neck"]),
    ("near arm", 4.0, &["r_shoulder", "r_elbow", "r_wrist"]),
    ("far arm", 4.0, &["l_shoulder", "l_elbow", "l_wrist"]),
    ("far leg", 5.0, &["l_hip", "l_knee", "l_ankle"]),
    ("near leg", 5.0, &["r_hip", "r_knee", "r_ankle"]),
];
/// The shoes by leg.
const SHOES: [&str; 2] = ["far shoe", "near shoe"];

/// A posture: the pelvis, and where the ankles are. Knees bend forward, to the right, and elbows back.
fn posture(pelvis: Point, ankles: [Point; 2]) -> Vec<Point> {
    let mut p = Template::human().typical().iter().map(|p| *p * 60.0 + pelvis).collect::<Vec<_>>();
    for side in [5, 8] {
        p[side + 1] = p[side] + Point::new(-9.0, 28.0);
        p[side + 2] = p[side + 1] + Point::new(12.0, 25.0);
    }
    for (leg, ankle) in LEGS.iter().zip(ankles) {
        let (way, bone) = (ankle - pelvis, 46.0f64);
        let across = (bone * bone - 0.25 * way.length_squared()).max(0.0).sqrt();
        p[leg[1]] = pelvis + way * 0.5 - way.normalize().perp() * across;
        p[leg[2]] = ankle;
    }
    p
}

/// A walk to the right of 4 px a frame, 24 frames a cycle, and the pitch of both feet: flat on the ground, turned in the air.
fn walk() -> Vec<(Vec<Point>, [f64; 2])> {
    let foot = |t: usize, shift: usize| {
        let (phase, start) = ((t + shift) % FRAMES, 4.0 * (t as f64 - ((t + shift) % FRAMES) as f64));
        if phase < 14 {
            return (Point::new(start + 28.0, GROUND - ANKLE), 0.0);
        }
        let s = (phase - 13) as f64 / 11.0;
        let on = 0.5 - 0.5 * (std::f64::consts::PI * s).cos();
        let up = (std::f64::consts::PI * s).sin();
        (Point::new(start + 28.0 + 96.0 * on, GROUND - ANKLE - 16.0 * up), 0.5 * up)
    };
    let at = |t: usize| {
        let feet = [foot(t, 12), foot(t, 0)];
        let pelvis = Point::new(4.0 * t as f64, GROUND - ANKLE - 86.0);
        (posture(pelvis, [feet[0].0, feet[1].0]), [feet[0].1, feet[1].1])
    };
    (0..FRAMES).map(at).collect()
}

fn shoe(ankle: Point, pitch: f64) -> Vec<Point> {
    let turn = Point::from_angle(pitch);
    let outline = [(-8.0, 2.0), (-7.0, 8.0), (4.0, 8.0), (20.0, 8.0), (21.0, 4.0), (6.0, -3.0), (-5.0, -4.0)];
    outline.map(|(x, y)| ankle + turn.rotate(Point::new(x, y))).to_vec()
}

/// A film of the walker, with or without shoes.
fn drawn(walk: &[(Vec<Point>, [f64; 2])], shod: bool) -> Document {
    let postures: Vec<Vec<Point>> = walk.iter().map(|(p, _)| p.clone()).collect();
    let mut document = film(&Template::human(), &HUMAN, &postures);
    if !shod {
        return document;
    }
    let mut set = document.limbs().unwrap();
    for (side, name) in SHOES.iter().enumerate() {
        let ankle = LEGS[side][2];
        let key = |(t, (p, pitch)): (usize, &(Vec<Point>, [f64; 2]))| (t as FrameNumber, shoe(p[ankle], pitch[side]));
        let keys = walk.iter().enumerate().map(key).collect();
        document.scene.parts.push(Part { name: (*name).into(), closed: true, keys, ..Part::default() });
        let shin = set.limbs.iter_mut().find(|limb| limb.to == ankle).unwrap();
        shin.carries.push(Carried { part: (*name).into(), turn: 1.0 });
    }
    document.set_limbs(&set);
    document
}

/// The same drawings, left for right.
fn flipped(document: &Document) -> Document {
    let mut other = document.clone();
    let points = other.scene.parts.iter_mut().flat_map(|part| part.keys.values_mut()).flatten();
    points.for_each(|p| p.x = 400.0 - p.x);
    other
}

fn on(drawing: &Document, clip: &Clip, mirror: Mirror) -> (Document, Reshaped) {
    let mut document = drawing.clone();
    let (options, points) = (Options::default(), BTreeMap::new());
    let job = ReshapeJob { clip, fps: 24.0, rest: Some(0), over: None, chains: Vec::new(), mirror, options, points };
    let made = reshape(&mut document, &job, &Silent).unwrap();
    (document, made)
}

fn part<'a>(document: &'a Document, name: &str, frame: usize) -> &'a [Point] {
    let part = document.scene.parts.iter().find(|part| part.name == name).unwrap();
    part.points_at(frame as FrameNumber).unwrap()
}

/// The pitch of a shoe in radians, 0 if its sole is level.
fn pitch(shoe: &[Point]) -> f64 {
    (shoe[3] - shoe[1]).y.atan2((shoe[3] - shoe[1]).x.abs())
}

fn sole(shoe: &[Point]) -> f64 {
    shoe.iter().map(|p| p.y).fold(f64::MIN, f64::max)
}

#[test]
fn one_drawing_of_a_walk_stands_on_its_ground_by_the_whole_walk() {
    let walk = walk();
    let film = drawn(&walk, true);
    let clip = own_clip(&film);
    for rest in [0, 7, 18] {
        let mut still = drawn(&walk[rest..=rest], true);
        still.scene.footage.last = 0;
        let (made, report) = on(&still, &clip, Mirror::Auto);
        assert!(!report.mirrored && report.sides.is_none(), "a motion of the drawing itself");
        let mut stood = 0;
        for (t, (posture, truth)) in walk.iter().enumerate() {
            for (side, name) in SHOES.iter().enumerate() {
                let shoe = part(&made, name, t);
                assert!(sole(shoe) < GROUND + 0.5, "at rest on {rest}, frame {t}: {name} at {}", sole(shoe));
                if truth[side] == 0.0 && posture[LEGS[side][2]].y == GROUND - ANKLE {
                    let at = (sole(shoe) - GROUND, pitch(shoe));
                    // Contacts are found in the clip; their ends may be a frame off.
                    stood += usize::from(at.0.abs() < 0.5 && at.1.abs() < 0.01);
                }
            }
            let body = part(&made, "body", t).iter().zip(part(&film, "body", t));
            assert!(body.into_iter().all(|(a, b)| a.distance(*b) < 0.5), "frame {t}: the body goes its way");
        }
        assert!(stood >= 24, "at rest on {rest}: {stood} of 28 standing shoes are flat on the ground");
        for name in SHOES {
            let same = part(&made, name, rest).iter().zip(part(&film, name, rest));
            assert!(same.into_iter().all(|(a, b)| a.distance(*b) < 1e-3), "frame {rest} is as drawn: {name}");
        }
    }
    // All drawings together are the walk.
    let (made, _) = on(&film, &clip, Mirror::Auto);
    for (t, name) in (0..FRAMES).flat_map(|t| SHOES.map(|name| (t, name))) {
        let same = part(&made, name, t).iter().zip(part(&film, name, t));
        assert!(same.into_iter().all(|(a, b)| a.distance(*b) < 0.01), "frame {t}: {name}");
    }
}

/// The walk of a figure with other proportions, so that it is no motion of the drawing.
pub(super) fn others_walk() -> Clip {
    let mut clip = own_clip(&drawn(&walk(), true));
    for posture in &mut clip.postures {
        for k in 1..5 {
            posture[k] = posture[0] + (posture[k] - posture[0]) * 1.3;
        }
    }
    clip
}

#[test]
fn a_human_drawing_that_looks_left_goes_left() {
    let (walk, clip) = (walk(), others_walk());
    for shod in [true, false] {
        let right = drawn(&walk[..1], shod);
        let left = flipped(&right);
        let (made, report) = on(&left, &clip, Mirror::Auto);
        let sides = Sides { drawing: Some(Side::Left), clip: Some(Side::Right) };
        assert_eq!((report.mirrored, report.sides), (true, Some(sides)), "shoes: {shod}");
        // It is the mirror image of what the drawing that looks right does.
        let (other, report) = on(&right, &clip, Mirror::Auto);
        assert_eq!((report.mirrored, report.sides.unwrap().drawing), (false, Some(Side::Right)));
        for (a, b) in flipped_tracks(&other).iter().zip(tracks(&made)) {
            // A mesh and that of the mirror image have other triangles.
            assert!(a.distance(b) < 3.0, "{a} {b}");
        }
        let way = |document: &Document| part(document, "body", FRAMES - 1)[0].x - part(document, "body", 0)[0].x;
        assert!(way(&made) < -40.0);
        // The option decides it by hand.
        let (forced, report) = on(&left, &clip, Mirror::Off);
        assert_eq!((report.mirrored, report.sides), (false, None));
        assert!(way(&forced) > 40.0);
        let (forced, report) = on(&right, &clip, Mirror::On);
        assert!(report.mirrored && way(&forced) < -40.0);
    }
}

fn tracks(document: &Document) -> Vec<Point> {
    document.scene.parts.iter().flat_map(|part| part.tracks.values()).flatten().copied().collect()
}

fn flipped_tracks(document: &Document) -> Vec<Point> {
    tracks(document).iter().map(|p| Point::new(400.0 - p.x, p.y)).collect()
}

#[test]
fn where_the_side_cannot_be_told_nothing_is_mirrored() {
    // A drawing from the front: its knees are straight, and it has no shoes.
    let mut front = walk()[..1].to_vec();
    for k in [6, 7, 9, 10, 12, 13, 15, 16] {
        front[0].0[k].x = front[0].0[0].x + if k < 8 || k == 12 || k == 13 { -15.0 } else { 15.0 };
    }
    let drawing = drawn(&front, false);
    let (_, report) = on(&drawing, &others_walk(), Mirror::Auto);
    let sides = Sides { drawing: None, clip: Some(Side::Right) };
    assert_eq!((report.mirrored, report.sides), (false, Some(sides)));
}

#[test]
fn in_the_air_both_shoes_have_the_pitch_of_their_shins() {
    // A jump with both legs alike, on a drawing of a stride: its shins lie differently.
    let hop = |t: usize| {
        let up = 60.0 * (std::f64::consts::PI * t as f64 / 15.0).sin().max(0.0);
        let pelvis = Point::new(0.0, GROUND - ANKLE - 80.0 - up);
        let ankle = Point::new(-6.0, GROUND - ANKLE - 1.2 * up);
        let mut p = posture(pelvis, [ankle; 2]);
        p[4].y -= 20.0;
        p
    };
    let clip = Clip::of(Template::human(), "b", "hop", (0..16).map(hop).collect());
    let stride = drawn(&walk()[..1], true);
    let (made, _) = on(&stride, &clip, Mirror::Auto);
    let mut flew = 0;
    for t in 0..16 {
        let [far, near] = SHOES.map(|name| part(&made, name, t));
        assert!((pitch(far) - pitch(near)).abs() < 0.03, "frame {t}: {} {}", pitch(far), pitch(near));
        if sole(near) < GROUND - 25.0 {
            let (shin, share) = (clip.postures[t][16] - clip.postures[t][15], pitch(near));
            let turn = Point::Y.angle_to(shin);
            assert!((share - turn).abs() < 0.2, "frame {t}: {share} {turn}");
            flew += 1;
        }
    }
    assert!(flew > 4, "{flew}");
}
