//! A whole figure, from text to picture.

use super::*;
use rototoon_base::geometry::Point;
use rototoon_base::scene::skeleton::PARENTS;

/// A figure in the T pose, y up, facing z, its left along x: where each key point stands.
const STANDING: [[f64; 3]; COUNT] = [
    [0.0, 10.0, 0.0],
    [0.0, 12.0, 0.0],
    [0.0, 14.0, 0.0],
    [0.0, 15.0, 0.5],
    [0.0, 16.5, 0.5],
    [2.0, 14.0, 0.0],
    [4.0, 14.0, 0.0],
    [6.0, 14.0, 0.0],
    [-2.0, 14.0, 0.0],
    [-4.0, 14.0, 0.0],
    [-6.0, 14.0, 0.0],
    [1.0, 10.0, 0.0],
    [1.0, 5.0, 0.0],
    [1.0, 1.0, 0.0],
    [-1.0, 10.0, 0.0],
    [-1.0, 5.0, 0.0],
    [-1.0, 1.0, 0.0],
];

/// CMU's and Mixamo's names of the key points; the top of the head is the end of its chain.
const USUAL: [&str; COUNT] = [
    "mixamorig:Hips",
    "mixamorig:Spine1",
    "mixamorig:Neck",
    "mixamorig:Head",
    "End Site",
    "mixamorig:LeftArm",
    "mixamorig:LeftForeArm",
    "mixamorig:LeftHand",
    "mixamorig:RightArm",
    "mixamorig:RightForeArm",
    "mixamorig:RightHand",
    "mixamorig:LeftUpLeg",
    "mixamorig:LeftLeg",
    "mixamorig:LeftFoot",
    "mixamorig:RightUpLeg",
    "mixamorig:RightLeg",
    "mixamorig:RightFoot",
];

/// A file of the standing figure; the root has positions and a turn about y, every other joint a turn about z.
fn file(names: &[&str; COUNT], standing: &[[f64; 3]; COUNT], frames: &[[f64; 4]]) -> String {
    let turns = vec!["0"; names.iter().filter(|name| **name != "End Site").count() - 1].join(" ");
    let lines: String = frames.iter().map(|[x, y, z, turn]| format!("{x} {y} {z} {turn} {turns}\n")).collect();
    format!("HIERARCHY\n{}MOTION\nFrames: {}\nFrame Time: 0.1\n{lines}", joint(0, names, standing), frames.len())
}

fn joint(k: usize, names: &[&str; COUNT], standing: &[[f64; 3]; COUNT]) -> String {
    let from = if k == 0 { [0.0; 3] } else { standing[PARENTS[k]] };
    let [x, y, z] = std::array::from_fn(|axis| standing[k][axis] - from[axis]);
    let offset = format!("OFFSET {x} {y} {z}\n");
    if names[k] == "End Site" {
        return format!("End Site\n{{\n{offset}}}\n");
    }
    let (kind, channels) = match k {
        0 => ("ROOT", "CHANNELS 4 Xposition Yposition Zposition Yrotation"),
        _ => ("JOINT", "CHANNELS 1 Zrotation"),
    };
    let children: String = (1..COUNT).filter(|c| PARENTS[*c] == k).map(|c| joint(c, names, standing)).collect();
    format!("{kind} {}\n{{\n{offset}{channels}\n{children}}}\n", names[k])
}

/// The standing figure as it is seen: horizontal and vertical by functions of place, in torso lengths of 4.
fn expected(across: impl Fn([f64; 3]) -> f64) -> Posture {
    STANDING.map(|p| Point::new(across(p), 10.0 - p[1]) / 4.0)
}

fn near(found: &Posture, expected: &Posture) {
    assert!(found.iter().zip(expected).all(|(a, b)| a.distance(*b) < 1e-12), "{found:?}\n{expected:?}");
}

fn with(view: View) -> Options {
    Options { view, ..Options::default() }
}

#[test]
fn a_standing_figure_is_seen_from_all_sides() {
    let text = file(&USUAL, &STANDING, &[[3.0, 10.0, 5.0, 0.0]]);
    let half = std::f64::consts::FRAC_1_SQRT_2;
    near(&seen(&text, &with(View::Front)).unwrap().postures[0], &expected(|[x, _, _]| x));
    near(&seen(&text, &with(View::Side)).unwrap().postures[0], &expected(|[_, _, z]| z));
    near(&seen(&text, &with(View::Yaw(-90.0))).unwrap().postures[0], &expected(|[_, _, z]| -z));
    near(&seen(&text, &with(View::Yaw(180.0))).unwrap().postures[0], &expected(|[x, _, _]| -x));
    near(&seen(&text, &with(View::ThreeQuarter)).unwrap().postures[0], &expected(|[x, _, z]| (x + z) * half));
    let still = seen(&text, &with(View::Auto)).unwrap();
    assert_eq!((still.yaw, still.fps), (90.0, 10.0));
}

#[test]
fn a_figure_that_faces_elsewhere_is_seen_alike() {
    let turned = file(&USUAL, &STANDING, &[[3.0, 10.0, 5.0, 50.0], [3.0, 10.0, 5.0, 50.0]]);
    near(&seen(&turned, &with(View::Front)).unwrap().postures[1], &expected(|[x, _, _]| x));
    let up = STANDING.map(|[x, y, z]| [x, -z, y]);
    let text = file(&USUAL, &up, &[[3.0, 5.0, 10.0, 0.0]]);
    near(&seen(&text, &with(View::Front)).unwrap().postures[0], &expected(|[x, _, _]| x));
    let flat = seen(&text, &Options { up: Up::Y, ..with(View::Front) }).unwrap();
    assert!(flat.postures[0][13].y.abs() < 1e-12, "with y up it lies");
}

#[test]
fn the_pelvis_stays_or_goes_its_way() {
    let frames = [[0.0, 10.0, 0.0, 0.0], [0.0, 10.0, 2.0, 0.0], [0.0, 11.0, 4.0, 0.0]];
    let text = file(&USUAL, &STANDING, &frames);
    let still = seen(&text, &with(View::Side)).unwrap();
    assert!(still.postures.iter().all(|p| p[0] == Point::ZERO));
    let going = seen(&text, &Options { way: true, ..with(View::Side) }).unwrap();
    let way: Vec<_> = going.postures.iter().map(|p| p[0]).collect();
    assert_eq!(way, [Point::ZERO, Point::new(0.5, 0.0), Point::new(1.0, -0.25)]);
    let twice = seen(&text, &Options { fps: Some(20.0), way: true, ..with(View::Side) }).unwrap();
    assert_eq!((twice.postures.len(), twice.fps), (5, 20.0));
    assert!(twice.postures[3][0].distance(Point::new(0.75, -0.125)) < 1e-12);
    let half = seen(&text, &Options { fps: Some(5.0), way: true, ..with(View::Side) }).unwrap();
    assert_eq!(half.postures, [going.postures[0], going.postures[2]]);
    let part = seen(&text, &Options { frames: Some(1..=1), ..with(View::Side) }).unwrap();
    assert_eq!(part.postures.len(), 1);
}

#[test]
fn the_view_by_itself_shows_most_of_the_motion() {
    let yaw = |axis: usize, size: f64| {
        let mut text = file(&USUAL, &STANDING, &[[0.0, 10.0, 0.0, 0.0]; 2]);
        // Of the last frame: every joint's turn about z, and once the whole leg swung in depth.
        text = text.replace("CHANNELS 1 Zrotation", &format!("CHANNELS 1 {}rotation", ["X", "Y", "Z"][axis]));
        let last = text.trim_end().rfind('\n').unwrap() + 1;
        let numbers: Vec<String> = text[last..].split_whitespace().map(str::to_owned).collect();
        let turned = numbers.iter().enumerate().map(|(k, n)| if k > 12 { size.to_string() } else { n.clone() });
        let line = turned.collect::<Vec<_>>().join(" ");
        seen(&format!("{}{line}\n", &text[..last]), &with(View::Auto)).unwrap().yaw
    };
    assert!((yaw(0, 30.0) - 90.0).abs() < 1.0, "legs swing forward: in profile, {}", yaw(0, 30.0));
    assert!(yaw(2, 30.0).abs() < 1.0, "legs swing sideways: from the front, {}", yaw(2, 30.0));
}

#[test]
fn names_of_other_programs_are_known() {
    let sides = |middle: [&'static str; 5], limbs: [&str; 6], left: &str, right: &str, after: bool| {
        let named = |side: &str, k: usize| -> &'static str {
            let name = if after { format!("{}{side}", limbs[k]) } else { format!("{side}{}", limbs[k]) };
            Box::leak(name.into_boxed_str())
        };
        let mut all = [""; COUNT];
        all[..5].copy_from_slice(&middle);
        for k in 0..3 {
            (all[5 + k], all[8 + k]) = (named(left, k), named(right, k));
            (all[11 + k], all[14 + k]) = (named(left, 3 + k), named(right, 3 + k));
        }
        all
    };
    let joints = ["Shoulder", "Elbow", "Wrist", "Hip", "Knee", "Ankle"];
    let parts = ["UpperArm", "LowerArm", "Hand", "UpperLeg", "LowerLeg", "Foot"];
    let biped = ["UpperArm", "Forearm", "Hand", "Thigh", "Calf", "Foot"];
    let poser = ["Shldr", "ForeArm", "Hand", "Thigh", "Shin", "Foot"];
    let rigify = ["upper_arm", "forearm", "hand", "thigh", "shin", "foot"];
    for names in [
        sides(["Hips", "Chest", "Neck", "Head", "End Site"], joints, "Left", "Right", false),
        sides(["Hips", "Chest", "Neck", "Head", "End Site"], parts, "_L", "_R", true),
        sides(
            ["Bip01 Pelvis", "Bip01 Spine1", "Bip01 Neck", "Bip01 Head", "End Site"],
            biped,
            "Bip01 L ",
            "Bip01 R ",
            false,
        ),
        sides(["hip", "abdomen", "neck", "head", "End Site"], poser, "l", "r", false),
        sides(["spine", "spine.002", "spine.004", "spine.006", "End Site"], rigify, ".L", ".R", true),
        sides(
            ["ORG-spine", "ORG-spine.002", "ORG-spine.004", "ORG-spine.006", "End Site"],
            rigify.map(|name| Box::leak(format!("ORG-{name}").into_boxed_str()) as &str),
            ".L",
            ".R",
            true,
        ),
        sides(
            ["CC_Base_Hip", "CC_Base_Spine01", "CC_Base_NeckTwist01", "CC_Base_Head", "End Site"],
            biped,
            "CC_Base_L_",
            "CC_Base_R_",
            false,
        ),
        sides(
            ["J_Bip_C_Hips", "J_Bip_C_Spine", "J_Bip_C_Neck", "J_Bip_C_Head", "End Site"],
            parts,
            "J_Bip_L_",
            "J_Bip_R_",
            false,
        ),
        sides(
            ["my Cat Hips", "my Cat Spine", "my Cat Neck", "my Cat Head", "End Site"],
            parts,
            "my Cat L ",
            "my Cat R ",
            false,
        ),
        sides(["SpineBase", "SpineMid", "Neck", "Head", "End Site"], joints, "", "Right", true).map(sided),
        sides(["pelvis", "spine_02", "neck_01", "head", "head_end"], biped, "", "_r", true).map(|name| name),
    ] {
        let text = file(&names, &STANDING, &[[0.0, 10.0, 0.0, 0.0]]);
        match seen(&text, &with(View::Front)) {
            Ok(found) => near(&found.postures[0], &expected(|[x, _, _]| x)),
            // Without a mark on the left the left is missing.
            Err(error) => assert!(names[3] == "head" && error.to_string().contains("l_shoulder, l_elbow"), "{error}"),
        }
    }
}

/// Kinect writes the side behind the name: `ElbowLeft`, `ElbowRight`.
fn sided(name: &'static str) -> &'static str {
    let limb = ["Shoulder", "Elbow", "Wrist", "Hip", "Knee", "Ankle"].contains(&name);
    if limb { Box::leak(format!("{name}Left").into_boxed_str()) } else { name }
}

#[test]
fn the_ankle_counts_beside_a_foot_and_the_wrist_beside_a_hand() {
    // As in files of SMPL and Kinect: the foot hangs on the ankle, and the hand on the wrist.
    let joints = ["Shoulder", "Elbow", "Wrist", "Hip", "Knee", "Ankle"];
    let mut names = USUAL;
    for (k, joint) in joints.into_iter().enumerate() {
        for (side, first) in [("L_", [5, 11]), ("R_", [8, 14])] {
            names[first[k / 3] + k % 3] = Box::leak(format!("{side}{joint}").into_boxed_str());
        }
    }
    let mut text = file(&names, &STANDING, &[[0.0, 10.0, 0.0, 0.0]]).trim_end().to_owned() + " 0 0 0 0\n";
    for (at, more) in [("L_Wrist", "L_Hand"), ("R_Wrist", "R_Hand"), ("L_Ankle", "L_Foot"), ("R_Ankle", "R_Foot")] {
        let (before, after) = text.split_once(at).unwrap();
        let (own, rest) = after.split_once("CHANNELS 1 Zrotation\n").unwrap();
        text = format!(
            "{before}{at}{own}CHANNELS 1 Zrotation\nJOINT {more}\n{{\nOFFSET 0 -1 1\nCHANNELS 1 Zrotation\n}}\n{rest}"
        );
    }
    near(&seen(&text, &with(View::Front)).unwrap().postures[0], &expected(|[x, _, _]| x));
}

#[test]
fn joints_that_names_do_not_tell_are_asked_for_and_taken_from_a_map() {
    let mut names = USUAL;
    (names[7], names[1]) = ("paw", "s1");
    let text = file(&names, &STANDING, &[[0.0, 10.0, 0.0, 0.0]]);
    let error = seen(&text, &Options::default()).unwrap_err().to_string();
    assert!(error.starts_with("found no joint for l_wrist, expected one for each key point"), "{error}");
    assert!(error.contains("mixamorig:Hips, s1, mixamorig:Neck"), "{error}");
    let mapped = |map: &str| {
        let joints = JointMap::parse(map).unwrap();
        seen(&text, &Options { joints, ..with(View::Front) })
    };
    near(&mapped(r#"{"l_wrist": "PAW"}"#).unwrap().postures[0], &expected(|[x, _, _]| x));
    let mean = mapped(r#"{"l_wrist": ["paw", "mixamorig:RightHand"], "chest": "mixamorig:Head/end"}"#).unwrap();
    assert!((mean.postures[0][7].x - mean.postures[0][0].x).abs() < 1e-12);
    let error = mapped(r#"{"l_wrist": "hoof"}"#).unwrap_err().to_string();
    assert!(error.starts_with(r#"joints, l_wrist: found no joint "hoof" in the file, expected one of"#), "{error}");
}

#[test]
fn heads_and_chests_are_found_by_place() {
    let mut names = USUAL;
    names[4] = "mixamorig:HeadTop_End";
    let text = file(&names, &STANDING, &[[0.0, 10.0, 0.0, 0.0]]);
    near(&seen(&text, &with(View::Front)).unwrap().postures[0], &expected(|[x, _, _]| x));
    // A head without an end, and one without a joint.
    let cut = text.replace("JOINT mixamorig:HeadTop_End", "JOINT x");
    let top = seen(&cut, &with(View::Front)).unwrap().postures[0];
    assert!(top[4].distance(top[2] + (top[3] - top[2]) * 2.5) < 1e-12);
    let one = "JOINT mixamorig:Neck\n{\nOFFSET 0 2 0\nCHANNELS 1 Zrotation\nEnd Site\n{\nOFFSET 0 2.5 0\n}\n}\n";
    let mut arms = USUAL;
    (arms[2], arms[3], arms[4]) = ("upper", "x", "y");
    let text = file(&arms, &STANDING, &[[0.0, 10.0, 0.0, 0.0]]);
    let text = text.replacen("JOINT upper", &format!("{one}JOINT upper"), 1).replace("0 0 0\n", "0 0 0 0\n");
    let found = seen(&text, &with(View::Front)).unwrap().postures[0];
    assert!(found[2].distance(Point::new(0.0, -1.0)) < 1e-12 && found[4].distance(Point::new(0.0, -1.625)) < 1e-12);
    assert!(found[3].distance(Point::new(0.0, -1.25)) < 1e-12, "{}", found[3]);
    // No spine between pelvis and neck: the template's share.
    let mut far = STANDING;
    far[1] = [0.0, 10.5, 0.0];
    let text = file(&USUAL, &far, &[[0.0, 10.0, 0.0, 0.0]]);
    assert!((seen(&text, &with(View::Front)).unwrap().postures[0][1].y + 0.55).abs() < 1e-12);
}

#[test]
fn what_cannot_be_seen_is_told() {
    let frames = [[0.0, 10.0, 0.0, 0.0]; 3];
    let text = file(&USUAL, &STANDING, &frames);
    let error = |text: &str, options: &Options| seen(text, options).unwrap_err().to_string();
    let out = Options { frames: Some(1..=3), ..Options::default() };
    assert_eq!(error(&text, &out), "frames: found 1 to 3, expected frames of the file, 0 to 2");
    for fps in [0.0, -1.0, f64::NAN, f64::INFINITY, 1e9, 0.0004] {
        assert!(error(&text, &Options { fps: Some(fps), ..Options::default() }).starts_with("frames a second: found"));
    }
    let rate = error(&text, &Options { fps: Some(1e300), ..Options::default() });
    assert!(rate.starts_with("frames a second: found 1e300, expected"), "{rate}");
    let point = file(&USUAL, &[[0.0; 3]; COUNT], &frames);
    assert!(error(&point, &Options::default()).starts_with("torso (pelvis to chest to neck): found length 0"));
    let far = text.replace("OFFSET 0 2 0", "OFFSET 0 1e308 0");
    assert_eq!(
        error(&far, &Options::default()),
        "frame 0: found neck at a position that is not finite, expected finite coordinates"
    );
    assert!(error("HIERARCHY", &Options::default()).starts_with("line 1: found the end of the file"));
}

#[test]
fn the_pelvis_is_where_the_thighs_hang_whatever_it_is_called() {
    let mut names = USUAL;
    (names[0], names[1]) = ("COG", "Spine");
    let text = file(&names, &STANDING, &[[0.0, 10.0, 0.0, 0.0], [0.0, 10.0, 4.0, 0.0]]);
    let found = seen(&text, &with(View::Front)).unwrap();
    near(&found.postures[0], &expected(|[x, _, _]| x));
    assert_eq!(found.notes, [r#"the pelvis is "COG", on which both thighs hang, not "Spine""#]);
    // A root on the floor, before which the figure goes its way.
    let root = "ROOT Root\n{\nOFFSET 0 0 0\nCHANNELS 1 Xposition\nJOINT COG";
    let floor = text.replacen("ROOT COG", root, 1).replacen("MOTION", "}\nMOTION", 1);
    let floor = floor.replace("\n0 10", "\n0 0 10");
    let found = seen(&floor, &Options { way: true, ..with(View::Side) }).unwrap();
    near(&found.postures[0], &expected(|[_, _, z]| z));
    assert_eq!(found.postures[1][0], Point::new(1.0, 0.0));
    assert_eq!(found.notes, [r#"the pelvis is "COG", on which both thighs hang, not "Root""#]);
    // What the map says counts.
    let joints = JointMap::parse(r#"{"pelvis": "Spine"}"#).unwrap();
    let found = seen(&text, &Options { joints, ..with(View::Front) }).unwrap();
    assert!(found.notes.is_empty() && found.postures[0][11].y < 0.0 || found.postures[0][11].y > 0.5);
    // A joint that lies a little below a pelvis of the usual name, as in files of Daz.
    let below = "JOINT low\n{\nOFFSET 0 -0.2 0\nCHANNELS 1 Zrotation\nJOINT mixamorig:LeftUpLeg";
    let daz = file(&USUAL, &STANDING, &[[0.0, 10.0, 0.0, 0.0]]);
    let daz = daz.replacen("JOINT mixamorig:LeftUpLeg", below, 1).replacen("MOTION", "}\nMOTION", 1);
    let daz = daz.trim_end().to_owned() + " 0\n";
    let found = seen(&daz, &with(View::Front)).unwrap();
    assert!(found.notes.is_empty(), "{:?}", found.notes);
    assert!((found.postures[0][2].y + 1.0).abs() < 1e-12);
}

#[test]
fn thighs_that_hang_on_a_root_on_the_floor_do_not_make_it_the_pelvis() {
    let text = file(&USUAL, &STANDING, &[[0.0, 10.0, 0.0, 0.0]]);
    let [left, right] = [11, 14].map(|k| joint(k, &USUAL, &STANDING));
    let bare = text.replacen(&left, "", 1).replacen(&right, "", 1);
    let root = "ROOT Root\n{\nOFFSET 0 0 0\nCHANNELS 1 Xposition\nJOINT mixamorig:Hips";
    let legs =
        [left.replacen("OFFSET 1 0 0", "OFFSET 1 10 0", 1), right.replacen("OFFSET -1 0 0", "OFFSET -1 10 0", 1)];
    let legs = legs.concat();
    let floor = bare.replacen("ROOT mixamorig:Hips", root, 1).replacen("MOTION", &format!("{legs}}}\nMOTION"), 1);
    let found = seen(&floor.replace("\n0 10", "\n0 0 10"), &with(View::Front)).unwrap();
    near(&found.postures[0], &expected(|[x, _, _]| x));
    assert!(found.notes.is_empty(), "{:?}", found.notes);
}

#[test]
fn a_head_nods_though_its_end_has_no_length_or_is_missing() {
    let text = file(&USUAL, &STANDING, &[[0.0, 10.0, 0.0, 0.0]]);
    let before = text.split("JOINT mixamorig:Head").next().unwrap().matches("JOINT ").count();
    let start = text.rfind("\n0 10 0 0").unwrap();
    let mut numbers: Vec<&str> = text[start..].split_whitespace().collect();
    numbers[4 + before] = "90";
    let nod = format!("{}\n{}\n", &text[..start], numbers.join(" "));
    let end = "End Site\n{\nOFFSET 0 1.5 0\n}\n";
    assert!(nod.contains(end));
    let eye = "JOINT eye\n{\nOFFSET 0 0.5 1\nEnd Site\n{\nOFFSET 0 0 1\n}\n}\n";
    for (other, length) in [(end, 1.5), ("End Site\n{\nOFFSET 0 0 0\n}\n", 0.0), ("", 0.0), (eye, 0.0)] {
        let posture = |text: &str| seen(&text.replacen(end, other, 1), &with(View::Front)).unwrap().postures[0];
        let (still, nodding) = (posture(&text), posture(&nod));
        let up = |posture: &Posture| (posture[4] - posture[3]) * 4.0;
        // Without an end the top goes on from the neck over the head, as far as in the template.
        let long = if length > 0.0 { length } else { 1.5 };
        assert!(up(&still).distance(Point::new(0.0, -long)) < 1e-12, "{other}: {}", up(&still));
        assert!((up(&nodding).length() - up(&still).length()).abs() < 0.5, "{other}");
        assert!(up(&nodding).distance(Point::new(-long, 0.0)) < 1e-12, "{other}: {}", up(&nodding));
    }
}
