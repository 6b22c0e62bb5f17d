//! Reshaping of a small figure: a body, an arm, a leg, a shoe, a line on the body.

use super::*;
use crate::pipeline::{ClipJob, clip};
use crate::scene::Template;
use crate::scene::limbs::Follow;
use crate::scene::skeleton::COUNT;
use crate::scene::{Cancelled, Silent};

fn ring(x: f64, top: f64, bottom: f64, half: f64) -> String {
    let at = |k: usize| {
        let (right, step) = (k < 4, (k % 4) as f64 / 3.0);
        let y = if right { top + step * (bottom - top) } else { bottom - step * (bottom - top) };
        format!("[{}, {}]", if right { x + half } else { x - half }, y)
    };
    format!("[{}]", (0..8).map(at).collect::<Vec<_>>().join(", "))
}

fn limb(from: &str, to: &str, part: &str, places: [f64; 4], more: &str) -> String {
    let point = |at: f64| format!(r#"{{"part": "{part}", "at": {at}}}"#);
    let [a, b, c, d] = places.map(point);
    format!(
        r#"{{"from": "{from}", "to": "{to}", "start": {{"points": [{a}, {b}]}}, "end": {{"points": [{c}, {d}]}}{more}}}"#
    )
}

/// Rings have their points from the top right down and from the bottom left up: 0 and 7 are the top, 3 and 4 the
/// bottom.
pub(super) fn figure(fields: &str) -> Document {
    let part = |name: &str, depth: f64, ring: String| {
        format!(r#"{{"name": "{name}", "closed": true, "depth": {depth}, "keys": {{"0": {ring}}}}}"#)
    };
    let parts = [
        part("leg", 0.0, ring(50.0, 60.0, 100.0, 6.0)),
        part("shoe", 0.0, ring(54.0, 101.0, 107.0, 9.0)),
        part("body", 1.0, ring(50.0, 20.0, 62.0, 12.0)),
        part("arm", 2.0, ring(66.0, 22.0, 58.0, 5.0)),
        r#"{"name": "seam", "closed": false, "depth": 1, "keys": {"0": [[50, 30], [50, 50]]}}"#.to_owned(),
    ];
    let whole = [0.0, 7.0, 3.0, 4.0];
    let limbs = [
        limb("pelvis", "neck", "body", [3.0, 4.0, 0.0, 7.0], ""),
        limb("r_shoulder", "r_elbow", "arm", [0.0, 7.0, 1.5, 5.5], ""),
        limb("r_elbow", "r_wrist", "arm", [1.5, 5.5, 3.0, 4.0], ""),
        limb("r_hip", "r_ankle", "leg", whole, r#", "carries": ["leg", {"part": "shoe", "turn": 0}]"#),
    ];
    let text = format!(
        r#"{{"rototoon": 1, "footage": {{"pattern": "f_%d.png", "first": 0, "last": 9, "fps": 24, "width": 120, "height": 120}},
        "parts": [{}], "limbs": [{}]{fields}}}"#,
        parts.join(", "),
        limbs.join(", ")
    );
    Document::parse(&text, "figure").unwrap()
}

/// The figure's own posture, its arm raised by 30° a frame, its way 5 px a frame.
pub(super) fn waving(document: &Document, frames: usize) -> Clip {
    let job = ClipJob { character: "a".into(), motion: "wave".into(), frames: Some(0..=0) };
    let rest = clip(document, &job).unwrap().clips.clips[0].postures[0].clone();
    let at = |frame: usize| -> Vec<Point> {
        let turn = Point::from_angle(-(30.0 * frame as f64).to_radians());
        let mut posture = rest.clone();
        for k in [9, 10] {
            posture[k] = rest[8] + turn.rotate(rest[k] - rest[8]);
        }
        posture.iter().map(|p| 2.0 * (*p + Point::new(5.0 * frame as f64, 0.0))).collect()
    };
    Clip::of(Template::human(), "b", "wave", (0..frames).map(at).collect())
}

pub(super) fn job(clip: &Clip) -> ReshapeJob<'_> {
    ReshapeJob {
        clip,
        fps: 12.0,
        rest: None,
        over: None,
        chains: Vec::new(),
        mirror: Mirror::Auto,
        options: Options::default(),
        points: BTreeMap::new(),
    }
}

/// Adds a box without a limb.
pub(super) fn add_part(document: &mut Document, name: &str, low: Point, high: Point, depth: f64) {
    let ring = ring(0.5 * (low.x + high.x), low.y, high.y, 0.5 * (high.x - low.x));
    let points: Vec<[f64; 2]> = serde_json::from_str(&ring).unwrap();
    let keys = BTreeMap::from([(0, points.into_iter().map(Point::from).collect())]);
    document.scene.parts.push(Part { name: name.into(), closed: true, depth, keys, ..Part::default() });
}

/// Adds an open contour.
pub(super) fn add_line(document: &mut Document, name: &str, points: &[Point]) {
    let keys = BTreeMap::from([(0, points.to_vec())]);
    document.scene.parts.push(Part { name: name.into(), closed: false, keys, ..Part::default() });
}

#[test]
fn a_drawing_follows_a_clip_of_another_size() {
    let mut document = figure("");
    let motion = waving(&document, 4);
    let before = document.scene.parts.clone();
    let made = reshape(&mut document, &job(&motion), &Silent).unwrap();
    assert_eq!((made.rigid, made.given), (vec!["shoe".to_owned()], Vec::new()));
    assert_eq!((document.scene.footage.last, document.scene.footage.fps), (3, 12.0));
    assert!(document.problems().errors().next().is_none());
    for (part, rest) in document.scene.parts.iter().zip(&before) {
        assert_eq!(part.keys.keys().copied().collect::<Vec<_>>(), [0, 3]);
        assert_eq!(part.tracks.len(), 4);
        assert!(
            part.tracks[&0].iter().zip(&rest.keys[&0]).all(|(a, b)| a.distance(*b) < 1e-6),
            "at rest: {}",
            part.name
        );
    }
    let moved = |part: usize, frame: i32, k: usize| {
        let part = &document.scene.parts[part];
        part.tracks[&frame][k] - part.keys[&0][k]
    };
    // Leg, shoe, body and its line go 5 px a frame; the arm turns about the shoulder.
    for part in [0, 1, 2, 4] {
        assert!(moved(part, 3, 1).distance(Point::new(15.0, 0.0)) < 1e-6, "{part}: {}", moved(part, 3, 1));
    }
    let wrist = document.scene.parts[3].tracks[&3][3].midpoint(document.scene.parts[3].tracks[&3][4]);
    assert!(wrist.distance(Point::new(66.0 + 15.0 + 36.0, 22.0)) < 1.0, "{wrist}");
    // Captured again, it performs the clip.
    let again = ClipJob { character: "a".into(), motion: "wave".into(), frames: None };
    let again = clip(&document, &again).unwrap().clips.clips.remove(0);
    for (made, wanted) in again.postures.iter().zip(&motion.postures) {
        for k in [0, 2, 8, 9, 10, 14, 16] {
            let wanted = (wanted[k] - wanted[0]) / 2.0;
            assert!((made[k] - made[0]).distance(wanted) < 1.5, "{k}: {} {wanted}", made[k] - made[0]);
        }
    }
    assert_eq!(motion.postures[0].len(), COUNT);
}

#[test]
fn snapped_lines_of_open_contours_go_with_them() {
    let mut document = figure("");
    // A belt on the body, and a line of the ground that lies on no part.
    add_line(&mut document, "belt", &[Point::new(44.0, 50.0), Point::new(50.0, 52.0), Point::new(56.0, 50.0)]);
    add_line(&mut document, "ground", &[Point::new(5.0, 110.0), Point::new(100.0, 110.0)]);
    let mut drawn = Vec::new();
    for part in document.scene.parts.iter_mut().filter(|part| part.name == "belt" || part.name == "ground") {
        let key = part.keys[&0].clone();
        let path = |ends: &[Point]| vec![ends[0], ends[0].midpoint(ends[1]) + Point::new(0.0, 1.0), ends[1]];
        drawn.push(key.windows(2).map(path).collect::<Vec<_>>());
        part.curves.insert(0, drawn[drawn.len() - 1].clone());
    }
    let motion = waving(&document, 4);
    reshape(&mut document, &job(&motion), &Silent).unwrap();
    let lines = document.scene.parts.iter().filter(|part| part.name == "belt" || part.name == "ground");
    for (part, drawn) in lines.zip(&drawn) {
        assert_eq!(part.curves.keys().copied().collect::<Vec<_>>(), [0, 1, 2, 3], "{}", part.name);
        for (frame, paths) in &part.curves {
            let track = &part.tracks[frame];
            assert_eq!(track.len(), drawn.len() + 1);
            let shift = track[0] - drawn[0][0];
            for (path, own) in paths.iter().zip(drawn) {
                assert!(path.iter().zip(own).all(|(a, b)| a.distance(*b + shift) < 1e-6), "{} on {frame}", part.name);
            }
            assert!(paths.iter().zip(track).all(|(path, end)| path[0].distance(*end) < 1e-6));
        }
    }
    assert!(document.problems().errors().next().is_none());
}

#[test]
fn marks_order_parts_by_frame() {
    let mark =
        |front: &str, behind: &str, frames: &str| format!(r#"{{"front": "{front}", "behind": "{behind}"{frames}}}"#);
    let marks =
        [mark("arm", "body", r#", "last": 1"#), mark("body", "arm", r#", "first": 2"#), mark("leg", "body", "")];
    let mut document = figure(&format!(r#", "depth_marks": [{}]"#, marks.join(", ")));
    let motion = waving(&document, 4);
    reshape(&mut document, &job(&motion), &Silent).unwrap();
    let text = document.to_json();
    let read = Document::parse(&text, "again").unwrap();
    let depth = |part: usize, frame: i32| read.scene.parts[part].depth_at(frame);
    for frame in 0..4 {
        assert_eq!(depth(3, frame) > depth(2, frame), frame < 2);
        assert!(depth(0, frame) > depth(2, frame));
    }
    // The order of the artist stays, so the result may be reshaped again, also without the marks.
    let orders = |mut document: Document| {
        reshape(&mut document, &job(&motion), &Silent).unwrap();
        document.scene.parts.into_iter().map(|part| (part.depth, part.depths)).collect::<Vec<_>>()
    };
    assert_eq!(orders(read), document.scene.parts.iter().map(|p| (p.depth, p.depths.clone())).collect::<Vec<_>>());
    let unmarked = Document::parse(&text.replace("depth_marks", "no_marks"), "unmarked").unwrap();
    assert_eq!(orders(unmarked), orders(figure("")));
    let contrary = format!(r#", "depth_marks": [{}, {}]"#, mark("arm", "body", ""), mark("body", "arm", ""));
    let error = reshape(&mut figure(&contrary), &job(&motion), &Silent).unwrap_err().to_string();
    assert!(error.starts_with("frame 0: found marks that contradict each other: depth_marks["), "{error}");
    assert!(error.contains(r#"depth_marks[0] ("arm" in front of "body")"#), "{error}");
}

#[test]
fn strokes_of_the_drawing_go_with_the_part_that_they_lie_on() {
    let stroke = r#"{"points": [[66, 54], [66, 56]], "closed": false, "material": 3}"#;
    let mut document = figure(&format!(r#", "drawings": [{{"frame": 0, "strokes": [{stroke}]}}]"#));
    let motion = waving(&document, 4);
    reshape(&mut document, &job(&motion), &Silent).unwrap();
    let text = document.to_json();
    let value: serde_json::Value = serde_json::from_str(&text).unwrap();
    let drawn = value["in_betweens"].as_array().unwrap();
    assert_eq!(drawn.len(), 4);
    let stroke = &drawn[3]["strokes"][0];
    assert_eq!((&stroke["track"], &stroke["material"]), (&0.into(), &3.into()));
    let x = stroke["points"][0][0].as_f64().unwrap();
    assert!((x - (66.0 + 15.0 + 32.0)).abs() < 2.0, "{x}");
}

#[test]
fn feet_that_stand_stay_and_a_jump_leaves_the_ground() {
    let mut document = figure("");
    let mut motion = waving(&document, 8);
    // A foot that nearly stands while the body moves on, then leaves the ground.
    let (shift, up) = (Point::new(10.0, 0.0), Point::new(0.0, -40.0));
    for (frame, posture) in motion.postures.iter_mut().enumerate() {
        let standing = 2.0 * Point::new(50.0, 100.0) + shift * (0.01 * frame as f64);
        let jumping = if frame > 5 { up } else { Point::ZERO };
        posture.iter_mut().for_each(|p| *p = *p - shift * (0.9 * frame as f64) + jumping);
        for leg in [13, 16] {
            posture[leg] = standing + jumping;
        }
    }
    reshape(&mut document, &job(&motion), &Silent).unwrap();
    let ankle = |frame: i32| {
        let track = &document.scene.parts[0].tracks[&frame];
        track[3].midpoint(track[4])
    };
    for frame in 1..5 {
        assert!(ankle(frame).distance(ankle(1)) < 0.7, "{frame}: {} {}", ankle(frame), ankle(1));
    }
    assert!((ankle(0).y - 100.0).abs() < 1.5 && ankle(7).y < 90.0, "{} {}", ankle(0), ankle(7));
}

#[test]
fn parts_without_a_limb_are_told() {
    let mut document = figure("");
    let mut hat = document.scene.parts[2].clone();
    hat.name = "hat".into();
    hat.keys.values_mut().flatten().for_each(|p| p.y -= 45.0);
    document.scene.parts.push(hat);
    let motion = waving(&document, 2);
    let made = reshape(&mut document, &job(&motion), &Silent).unwrap();
    assert_eq!(made.given, [("hat".to_owned(), Given::Part("body".into()))]);
    let hat = &document.scene.parts[5];
    assert!((hat.tracks[&1][0] - hat.tracks[&0][0]).distance(Point::new(5.0, 0.0)) < 1e-6);
}

/// The figure tracked through frames on which its arm is raised, its body leans and its leg bulges as no mesh would.
fn tracked(frames: i32) -> Document {
    let mut document = figure("");
    for (index, part) in document.scene.parts.iter_mut().enumerate() {
        let rest = part.keys[&0].clone();
        for frame in 0..frames {
            let t = f64::from(frame);
            let lean = Point::from_angle(0.04 * t);
            let about = Point::new(50.0, 62.0);
            let moved = |(k, p): (usize, &Point)| {
                let own = match index {
                    0 => Point::new(0.6 * t * (0.2 * (p.y - 60.0)).sin(), 0.4 * t * (k % 2) as f64),
                    3 => Point::from_angle(-0.2 * t).rotate(*p - Point::new(66.0, 22.0)) + Point::new(66.0, 22.0) - *p,
                    _ => Point::ZERO,
                };
                let p = *p + own;
                (if index > 1 { about + lean.rotate(p - about) } else { p }) + Point::new(3.0 * t, (1.1 * t).sin())
            };
            part.tracks.insert(frame, rest.iter().enumerate().map(moved).collect());
        }
        part.keys.insert(frames - 1, part.tracks[&(frames - 1)].clone());
    }
    document
}

/// The greatest distance of a point of a closed part on a frame of `made` from the one on the frame `shift` later in `truth`.
fn farthest(made: &Document, truth: &Document, shift: i32) -> f64 {
    let parts = made.scene.parts.iter().zip(&truth.scene.parts).filter(|(part, _)| part.closed);
    parts
        .flat_map(|(part, other)| {
            part.tracks.iter().map(move |(frame, points)| (points, &other.tracks[&(frame + shift)]))
        })
        .flat_map(|(a, b)| a.iter().zip(b).map(|(p, q)| p.distance(*q)))
        .fold(0.0, f64::max)
}

#[test]
fn the_own_clip_on_the_own_drawing_is_the_identity() {
    let with_pelvis = |document: &mut Document| {
        let mut set = document.limbs().unwrap();
        let mut bone = set.limbs[3].clone();
        (bone.from, bone.to) = (0, 14);
        (bone.start, bone.end) = (set.limbs[0].start.clone(), set.limbs[3].start.clone());
        bone.carries.clear();
        set.limbs.push(bone);
        document.set_limbs(&set);
    };
    let without_arm = |document: &mut Document| {
        let mut set = document.limbs().unwrap();
        set.limbs.retain(|limb| !(8..11).contains(&limb.to));
        document.set_limbs(&set);
    };
    for (what, change) in [
        ("as it is", &(|_: &mut Document| {}) as &dyn Fn(&mut Document)),
        ("with a bone to the hip", &with_pelvis),
        ("without limbs of the arm", &without_arm),
    ] {
        let mut document = tracked(10);
        change(&mut document);
        for (rest, frames) in [(0, 0..=9), (4, 0..=9), (0, 3..=8)] {
            let job = ClipJob { character: "a".into(), motion: "go".into(), frames: Some(frames.clone()) };
            let own = clip(&document, &job).unwrap().clips.clips.remove(0);
            let mut made = document.clone();
            let asked = ReshapeJob { rest: Some(rest), ..self::job(&own) };
            reshape(&mut made, &asked, &Silent).unwrap();
            let off = farthest(&made, &document, *frames.start());
            assert!(off < 0.5, "{what}, at rest on {rest}, frames {frames:?}: {off} px");
        }
    }
}

#[test]
fn parts_away_from_the_figure_stay_and_shadows_follow_the_ground() {
    let mut document = figure("");
    add_part(&mut document, "shadow", Point::new(28.0, 105.0), Point::new(76.0, 109.0), 0.0);
    add_part(&mut document, "house", Point::new(-200.0, -200.0), Point::new(400.0, 200.0), 0.0);
    add_part(&mut document, "ball", Point::new(68.0, 88.0), Point::new(78.0, 98.0), 0.0);
    add_part(&mut document, "star", Point::new(300.0, 10.0), Point::new(310.0, 20.0), 0.0);
    add_part(&mut document, "button", Point::new(45.0, 30.0), Point::new(49.0, 34.0), 0.0);
    let mut motion = waving(&document, 4);
    for (frame, posture) in motion.postures.iter_mut().enumerate() {
        posture.iter_mut().for_each(|p| p.y -= 6.0 * frame as f64);
    }
    let before = document.clone();
    let made = reshape(&mut document, &job(&motion), &Silent).unwrap();
    let wanted = [
        ("shadow", Given::Contact, Point::new(15.0, 0.0)),
        ("house", Given::Nothing, Point::ZERO),
        ("ball", Given::Root, Point::new(15.0, -9.0)),
        ("star", Given::Nothing, Point::ZERO),
        ("button", Given::Part("body".into()), Point::new(15.0, -9.0)),
    ];
    for (k, (name, given, shift)) in wanted.into_iter().enumerate() {
        assert_eq!(made.given[k], (name.to_owned(), given));
        let part = &document.scene.parts[5 + k];
        let moved = part.tracks[&3][0] - part.keys[&0][0];
        assert!(moved.distance(shift) < 1e-6, "{name}: {moved}");
    }
    let mut asked = before.clone();
    let mut set = asked.limbs().unwrap();
    set.follows = vec![("shadow".into(), Follow::Nothing), ("star".into(), Follow::Part("arm".into()))];
    asked.set_limbs(&set);
    let told = reshape(&mut asked, &job(&motion), &Silent).unwrap();
    assert_eq!(told.given.iter().map(|(name, _)| name.as_str()).collect::<Vec<_>>(), ["house", "ball", "button"]);
    assert_eq!(asked.scene.parts[5].tracks[&3], before.scene.parts[5].keys[&0]);
    let mut said = |follows: Vec<(&str, &str)>| {
        set.follows = follows.into_iter().map(|(part, of)| (part.into(), Follow::Part(of.into()))).collect();
        let mut wrong = before.clone();
        wrong.set_limbs(&set);
        reshape(&mut wrong, &job(&motion), &Silent).unwrap_err().to_string()
    };
    let expected = "expected a closed part that does not itself follow \"star\"";
    assert_eq!(said(vec![("star", "seam")]), format!("follows.\"star\": found part \"seam\", {expected}"));
    let round = said(vec![("star", "ball"), ("ball", "star")]);
    assert!(round.contains("expected a closed part that does not itself follow"), "{round}");
}

#[test]
fn what_is_wrong_is_named_and_changes_nothing() {
    let document = figure("");
    let motion = waving(&document, 3);
    let said = |document: &Document, job: &ReshapeJob| {
        let mut given = document.clone();
        let error = reshape(&mut given, job, &Silent).unwrap_err().to_string();
        assert_eq!(given, *document);
        error
    };
    let mut none = document.clone();
    none.set_limbs(&LimbSet::default());
    assert_eq!(said(&none, &job(&motion)), "limbs: found none, expected at least the torso (pelvis, chest, neck)");
    assert_eq!(
        said(&document, &ReshapeJob { rest: Some(4), ..job(&motion) }),
        "rest: found frame 4 without a contour of \"leg\", expected one of every part"
    );
    let mut flat = document.clone();
    flat.scene.parts[3].keys.get_mut(&0).unwrap().fill(Point::ONE);
    assert!(said(&flat, &job(&motion)).starts_with("limbs[1] (r_shoulder to r_elbow), frame 0: found a length of 0"));
    let mut thin = document.clone();
    thin.scene.parts[1].keys.get_mut(&0).unwrap().iter_mut().for_each(|p| p.y = 101.0);
    assert_eq!(
        said(&thin, &job(&motion)),
        "part \"shoe\": outline 0: found no enclosed area (its points are on a line or at one spot), expected some"
    );
    let mut broken = motion.clone();
    broken.postures[1][5].x = f64::NAN;
    assert_eq!(
        said(&document, &job(&broken)),
        "clip (\"b\", \"wave\"), frame 1: found a coordinate that is not finite, expected finite coordinates"
    );
    struct Never;
    impl Progress for Never {
        fn report(&self, _: &str, done: f64) -> Result<(), Cancelled> {
            if done < 0.5 { Ok(()) } else { Err(Cancelled) }
        }
    }
    let mut cancelled = document.clone();
    assert!(matches!(reshape(&mut cancelled, &job(&motion), &Never), Err(PipelineError::Cancelled(_))));
    assert_eq!(cancelled, document);
}

#[test]
fn points_follow_their_part() {
    let mut document = figure("");
    let motion = waving(&document, 3);
    let ring = document.scene.parts[3].points_at(0).unwrap().clone();
    let asked = BTreeMap::from([("arm".to_owned(), ring), ("shoe".to_owned(), vec![Point::new(54.0, 104.0)])]);
    let made = reshape(&mut document, &ReshapeJob { points: asked, ..job(&motion) }, &Silent).unwrap();
    for (frame, points) in made.points["arm"].iter().enumerate() {
        let own = document.scene.parts[3].points_at(frame as FrameNumber).unwrap();
        assert!(points.iter().zip(own).all(|(a, b)| a.distance(*b) < 1e-9), "frame {frame}");
    }
    assert_eq!(made.points["shoe"].iter().map(Vec::len).collect::<Vec<_>>(), [1, 1, 1]);
    for (name, point, said) in [
        ("seam", Point::ZERO, "found part \"seam\", expected the name of a closed part"),
        (
            "arm",
            Point::new(f64::NAN, 0.0),
            "part \"arm\", point 0: found coordinates that are not finite, expected finite ones",
        ),
    ] {
        let points = BTreeMap::from([(name.to_owned(), vec![point])]);
        let error = reshape(&mut figure(""), &ReshapeJob { points, ..job(&motion) }, &Silent).unwrap_err();
        assert!(error.to_string().contains(said), "{error}");
    }
}
