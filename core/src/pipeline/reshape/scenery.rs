//! Lines and parts that no limb carries: what they follow, beside a small figure.

use super::tests::{add_line, add_part, figure, job, waving};
use super::*;
use crate::scene::Silent;
use crate::scene::limbs::Follow;

/// The figure waves, goes 5 px a frame, and is lifted by 3 px a frame.
fn lifted(document: &Document) -> Clip {
    let mut motion = waving(document, 4);
    for (frame, posture) in motion.postures.iter_mut().enumerate() {
        posture.iter_mut().for_each(|p| p.y -= 6.0 * frame as f64);
    }
    motion
}

/// How far a part's points have moved on the last frame, if all moved as far.
fn shift(document: &Document, name: &str) -> Point {
    let part = document.scene.parts.iter().find(|part| part.name == name).unwrap();
    let ways: Vec<Point> = part.tracks[&3].iter().zip(&part.keys[&0]).map(|(a, b)| *a - *b).collect();
    assert!(ways.iter().all(|way| way.distance(ways[0]) < 1e-6), "{name} turns: {ways:?}");
    ways[0]
}

#[test]
fn open_lines_that_lie_on_nothing_stay_and_are_told() {
    let mut document = figure("");
    let v = Point::new;
    add_line(&mut document, "ground line", &[v(-200.0, 107.0), v(400.0, 107.0)]);
    add_line(&mut document, "horizon", &[v(-200.0, 40.0), v(400.0, 38.0)]);
    add_line(&mut document, "sun", &[v(300.0, 10.0), v(310.0, 5.0), v(320.0, 10.0)]);
    add_line(&mut document, "shade", &[v(28.0, 109.0), v(76.0, 109.0)]);
    add_line(&mut document, "fly", &[v(75.0, 85.0), v(80.0, 86.0)]);
    add_line(&mut document, "hair", &[v(50.0, 24.0), v(46.0, 12.0)]);
    let motion = lifted(&document);
    let before = document.clone();
    let made = reshape(&mut document, &job(&motion), &Silent).unwrap();
    let told = [
        ("ground line", Given::Nothing),
        ("horizon", Given::Nothing),
        ("sun", Given::Nothing),
        ("shade", Given::Contact),
        ("fly", Given::Root),
    ];
    assert_eq!(made.given, told.map(|(name, given)| (name.to_owned(), given)));
    let root = v(15.0, -9.0);
    let ways = [Point::ZERO, Point::ZERO, Point::ZERO, v(15.0, 0.0), root, root];
    for (name, way) in ["ground line", "horizon", "sun", "shade", "fly", "hair"].into_iter().zip(ways) {
        assert!(shift(&document, name).distance(way) < 1e-6, "{name}: {}", shift(&document, name));
    }
    // What the document says counts for lines too, and is not told.
    let mut asked = before;
    let mut set = asked.limbs().unwrap();
    let follow = |name: &str, what| (name.to_owned(), what);
    set.follows = vec![
        follow("seam", Follow::Nothing),
        follow("sun", Follow::Root),
        follow("fly", Follow::Contact),
        follow("shade", Follow::Part("body".into())),
    ];
    asked.set_limbs(&set);
    let made = reshape(&mut asked, &job(&motion), &Silent).unwrap();
    assert_eq!(made.given.iter().map(|(name, _)| name.as_str()).collect::<Vec<_>>(), ["ground line", "horizon"]);
    for (name, way) in [("seam", Point::ZERO), ("sun", root), ("fly", v(15.0, 0.0)), ("shade", root)] {
        assert!(shift(&asked, name).distance(way) < 1e-6, "{name}: {}", shift(&asked, name));
    }
}

#[test]
fn strokes_that_lie_on_nothing_are_told_by_number() {
    let stroke = |points: &str| format!(r#"{{"points": [{points}], "closed": false}}"#);
    let strokes = [stroke("[50, 30], [50, 40]"), stroke("[-200, 107], [400, 107]")].join(", ");
    let mut document = figure(&format!(r#", "drawings": [{{"frame": 0, "strokes": [{strokes}]}}]"#));
    let motion = lifted(&document);
    let made = reshape(&mut document, &job(&motion), &Silent).unwrap();
    assert_eq!(made.strokes, [(1, Given::Nothing)]);
    assert_eq!(made.notes, ["stroke 1 of the drawing: it lies on no part, so it stays where it is drawn"]);
    let value: serde_json::Value = serde_json::from_str(&document.to_json()).unwrap();
    let drawn = &value["in_betweens"][3]["strokes"];
    assert_eq!((drawn[1]["points"][0][0].as_f64(), drawn[1]["points"][1][0].as_f64()), (Some(-200.0), Some(400.0)));
    assert!((drawn[0]["points"][0][0].as_f64().unwrap() - 65.0).abs() < 1e-3);
}

#[test]
fn a_ground_as_wide_as_the_picture_is_no_shadow() {
    let mut document = figure("");
    add_part(&mut document, "strip", Point::new(-200.0, 105.0), Point::new(400.0, 109.0), 0.0);
    add_part(&mut document, "sofa", Point::new(55.0, 30.0), Point::new(255.0, 90.0), -1.0);
    let motion = lifted(&document);
    let made = reshape(&mut document, &job(&motion), &Silent).unwrap();
    assert_eq!(made.given, [("strip".to_owned(), Given::Nothing), ("sofa".to_owned(), Given::Nothing)]);
    assert_eq!((shift(&document, "strip"), shift(&document, "sofa")), (Point::ZERO, Point::ZERO));
}

#[test]
fn a_part_on_a_part_without_a_limb_goes_with_it() {
    let mut document = figure("");
    // An eye on a head on the body; a far hand at the end of a far arm, behind the leg and half covered by it.
    add_part(&mut document, "eye", Point::new(52.0, 4.0), Point::new(56.0, 8.0), 3.0);
    add_part(&mut document, "head", Point::new(40.0, 0.0), Point::new(60.0, 19.0), 2.0);
    add_part(&mut document, "far hand", Point::new(42.0, 84.0), Point::new(52.0, 92.0), -1.0);
    add_part(&mut document, "far arm", Point::new(38.0, 24.0), Point::new(47.0, 85.0), -2.0);
    let mut motion = waving(&document, 4);
    // The leg swings about the hip, and the body leans about the pelvis.
    for (frame, posture) in motion.postures.iter_mut().enumerate() {
        let (hip, root) = (posture[14], posture[0]);
        for k in [15, 16] {
            posture[k] = hip + Point::from_angle(0.1 * frame as f64).rotate(posture[k] - hip);
        }
        for k in 1..11 {
            posture[k] = root + Point::from_angle(0.05 * frame as f64).rotate(posture[k] - root);
        }
    }
    let made = reshape(&mut document, &job(&motion), &Silent).unwrap();
    let follows = |name: &str| made.given.iter().find(|(part, _)| part == name).map(|(_, given)| given.clone());
    let part = |name: &str| Some(Given::Part(name.to_owned()));
    assert_eq!((follows("eye"), follows("head")), (part("head"), part("body")));
    assert_eq!((follows("far hand"), follows("far arm")), (part("far arm"), part("body")));
    let at = |name: &str| &document.scene.parts.iter().find(|part| part.name == name).unwrap().tracks[&3];
    let middle = |name: &str| crate::geometry::polygon::center(at(name));
    let apart = |a: &str, b: &str| middle(a).distance(middle(b));
    assert!((apart("eye", "head") - Point::new(50.0, 9.5).distance(Point::new(54.0, 6.0))).abs() < 0.1);
    assert!((apart("far hand", "far arm") - Point::new(42.5, 54.5).distance(Point::new(47.0, 88.0))).abs() < 0.5);
}

#[test]
fn a_body_that_goes_through_the_ground_is_told() {
    let mut document = figure("");
    let mut motion = waving(&document, 10);
    motion.postures.remove(0); // which would make it the drawing's own motion
    let upright = motion.clone();
    for posture in &mut motion.postures[5..] {
        let ankles = [posture[13], posture[16]];
        posture.iter_mut().for_each(|p| p.y += 2.0 * 55.0);
        (posture[13], posture[16]) = (ankles[0], ankles[1]);
    }
    let made = reshape(&mut document, &job(&motion), &Silent).unwrap();
    let told: Vec<&String> = made.notes.iter().filter(|note| note.contains("\"body\"")).collect();
    let [told] = told[..] else { panic!("{:?}", made.notes) };
    assert!(
        told.starts_with("part \"body\": up to ") && told.ends_with(" px below the ground on frames 5-8"),
        "{told}"
    );
    let made = reshape(&mut figure(""), &job(&upright), &Silent).unwrap();
    assert_eq!(made.notes, Vec::<String>::new());
}

#[test]
fn a_clip_of_the_document_s_rate_stays_and_another_one_lasts_as_long() {
    let document = figure("");
    let clip = waving(&document, 5);
    let footage = &document.scene.footage;
    assert_eq!(crate::pipeline::at_rate_of(footage, &clip, 24.0), (clip.clone(), None));
    let (made, said) = crate::pipeline::at_rate_of(footage, &clip, 120.0);
    assert_eq!((made.postures.len(), &made.postures[0]), (1, &clip.postures[0]));
    let said = said.unwrap();
    assert_eq!(said, "the clip has 120 frames a second and the document 24, so its 5 frames become 1");
}
