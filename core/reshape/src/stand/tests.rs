//! Figures that are put on the ground, with and without a way, on ones and on twos.

use super::*;
use crate::contacts::tests::{human, walk};
use crate::foot::tests::shoe;
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

/// A walk on twos or threes, and the same drawings on ones.
fn held(count: usize, way: bool, noise: f64) -> (Vec<Vec<Point>>, Vec<Vec<Point>>) {
    let ones: Vec<Vec<Point>> = walk(49, way).into_iter().step_by(count).collect();
    let shaken = |t: usize| {
        let shake = |(k, p): (usize, &Point)| {
            *p + noise * Point::new((7.1 * t as f64 + k as f64).sin(), (3.7 * (t * k) as f64).cos())
        };
        ones[t / count].iter().enumerate().map(shake).collect()
    };
    ((0..ones.len() * count).map(shaken).collect(), ones)
}

#[test]
fn a_hold_stays_one_drawing_and_stands_where_it_stands_on_ones() {
    let human = Template::human();
    for (count, way, noise) in
        [(2, true, 0.0), (2, false, 0.0), (3, true, 0.0), (3, false, 0.0), (2, true, 0.1), (2, false, 0.1)]
    {
        let (clip, ones) = held(count, way, noise);
        let feet = feet(Some(1.0));
        let (mut made, mut wanted) = (clip.clone(), ones.clone());
        let turns = stand(&human, &mut made, (&clip, 1.0), &feet, 8.0);
        let drawn = stand(&human, &mut wanted, (&ones, 1.0), &feet, 8.0);
        for t in 0..clip.len() {
            assert_eq!(made[t], made[t - t % count], "{count} {way} {noise}: frame {t} is the drawing of its hold");
            let off = made[t].iter().zip(&wanted[t / count]).map(|(a, b)| a.distance(*b)).fold(0.0, f64::max);
            assert!(off <= 40.0 * noise + 1e-9, "{count} {way} {noise}: frame {t} is off by {off}");
            assert!((0..2).all(|k| turns[k][t] == turns[k][t - t % count]));
            assert!(noise > 0.0 || (0..2).all(|k| (turns[k][t] - drawn[k][t / count]).abs() < 1e-9));
        }
    }
}

#[test]
fn the_own_motion_on_twos_is_that_on_ones() {
    let human = Template::human();
    for way in [true, false] {
        let ((clip, ones), feet) = (held(2, way, 0.0), feet(Some(1.0)));
        let (mut made, mut wanted) = (clip.clone(), ones.clone());
        stand_own(&human, &mut made, &feet, &vec![None; clip.len()]);
        stand_own(&human, &mut wanted, &feet, &vec![None; ones.len()]);
        assert!((0..clip.len()).all(|t| made[t] == wanted[t / 2]));
    }
}

#[test]
fn a_contact_that_is_corrected_leaves_the_foot_s_other_contact_alone() {
    let (template, feet) = (Template::human(), feet(Some(1.0)));
    let legs = template.legs();
    // The first foot stands up to frame 5 and from frame 8 on.
    let contacts = Contacts {
        stands: vec![(0..14).map(|t| !(6..8).contains(&t)).collect(), vec![false; 14]],
        air: vec![false; 14],
        ground: 0.0,
        way: true,
        times: (0..14).map(f64::from).collect(),
    };
    let on = Ground { legs: &legs, feet: &feet, contacts: &contacts, y: 0.0, drawn: &[] };
    let before = walk(14, true);
    let mut made = before.clone();
    faded(&mut made, &on, &feet[0], (8, &[Point::new(0.0, -6.0); 6]));
    let lifted = |t: usize| before[t][LEGS[0][2]].y - made[t][LEGS[0][2]].y;
    assert!((0..6).all(|t| lifted(t) == 0.0) && (8..14).all(|t| (lifted(t) - 6.0).abs() < 1e-9));
    assert!((lifted(6) - 2.0).abs() < 1e-9 && (lifted(7) - 4.0).abs() < 1e-9, "{} {}", lifted(6), lifted(7));
}
