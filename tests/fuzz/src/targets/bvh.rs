//! Motion capture in BVH files.

use crate::given::{self, json_number, number};
use arbitrary::{Result, Unstructured};
use rototoon::import::bvh::{Options, seen};

/// The joints of a decoded hierarchy: those that the import needs, and a few more.
const JOINTS: [&str; 18] = [
    "Hips",
    "Spine",
    "Neck",
    "Head",
    "LeftArm",
    "LeftForeArm",
    "LeftHand",
    "RightArm",
    "RightForeArm",
    "RightHand",
    "LeftUpLeg",
    "LeftLeg",
    "LeftFoot",
    "RightUpLeg",
    "RightLeg",
    "RightFoot",
    "Tail",
    "",
];
/// The parent of each joint.
const PARENTS: [usize; 18] = [0, 0, 1, 2, 1, 4, 5, 1, 7, 8, 0, 10, 11, 0, 13, 14, 0, 16];
/// The longest motion that is resampled: with more seconds a small file becomes a million frames, as its options ask.
const MOST_SECONDS: f64 = 60.0;

/// Reads the bytes as BVH, or a hierarchy decoded from them, and looks at it from two sides.
pub fn bvh(data: &[u8]) {
    let text = given::text(data, "HIERARCHY", hierarchy);
    let plain = seen(&text, &Options::default());
    let Ok(found) = &plain else { return };
    assert!(found.postures.iter().flatten().all(|p| p.is_finite()), "a key point is not finite");
    let seconds = found.postures.len() as f64 / found.fps;
    let fps = (seconds <= MOST_SECONDS).then_some(24.0);
    let _ = seen(&text, &Options { way: true, fps, ..Options::default() });
    let _ = seen(&text, &Options { frames: Some(1..=3), ..Options::default() });
}

/// The text of a skeleton with a short motion.
fn hierarchy(u: &mut Unstructured) -> Result<String> {
    let count = if u.ratio(1u8, 8)? { u.int_in_range(1..=JOINTS.len())? } else { 16 };
    let mut channels = 0;
    let root = joint(u, 0, count, &mut channels)?;
    let frames = u.int_in_range(1..=3usize)?;
    let time = if u.ratio(1u8, 8)? { json_number(number(u)?) } else { "0.04".into() };
    let mut text = format!("HIERARCHY\n{root}MOTION\nFrames: {frames}\nFrame Time: {time}\n");
    for _ in 0..frames {
        let values = (0..channels).map(|_| Ok(json_number(number(u)?))).collect::<Result<Vec<_>>>()?;
        text += &(values.join(" ") + "\n");
    }
    Ok(text)
}

fn joint(u: &mut Unstructured, k: usize, count: usize, channels: &mut usize) -> Result<String> {
    let offset: [String; 3] = [json_number(number(u)?), json_number(number(u)?), json_number(number(u)?)];
    let kinds = if k == 0 {
        "6 Xposition Yposition Zposition Zrotation Xrotation Yrotation"
    } else {
        "3 Zrotation Xrotation Yrotation"
    };
    *channels += if k == 0 { 6 } else { 3 };
    let word = if k == 0 { "ROOT" } else { "JOINT" };
    let mut text = format!("{word} {}\n{{\nOFFSET {}\nCHANNELS {kinds}\n", JOINTS[k], offset.join(" "));
    let children: Vec<usize> = (k + 1..count).filter(|child| PARENTS[*child] == k).collect();
    if children.is_empty() {
        text += "End Site\n{\nOFFSET 0 4 0\n}\n";
    }
    for child in children {
        text += &joint(u, child, count, channels)?;
    }
    Ok(text + "}\n")
}
