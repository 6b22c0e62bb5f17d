//! Limbs of the sample character on its contours, as an artist would mark them once.
//!
//! Sleeves and trouser legs are strips of twelve points ([`super::outline::strip`]). Points 0 to 4 run down one side, 6 to 10
//! up the other, so the pairs (0, 10), (2, 8) and (4, 6) are across shoulder, elbow and wrist. The near limbs are the right
//! ones, because the character first walks to the right. After it has turned round, the same limbs are still drawn near, as
//! in a mirror, so left and right never swap.

use serde_json::{Value, json};

/// The depth order of the sample's parts that matter to limbs: pairs of a part in front and a part behind.
pub const IN_FRONT: [(&str, &str); 6] = [
    ("near arm", "coat"),
    ("near mitten", "near arm"),
    ("coat", "near leg"),
    ("near leg", "far leg"),
    ("far leg", "far arm"),
    ("head", "coat"),
];

/// A limb in the form of documents. Each of its ends is a pair of places on a part.
pub fn limb(from: &str, to: &str, ends: [(&str, f64, f64); 2], carries: Value) -> Value {
    let end = |(part, a, b): (&str, f64, f64)| json!({"points": [{"part": part, "at": a}, {"part": part, "at": b}]});
    json!({"from": from, "to": to, "start": end(ends[0]), "end": end(ends[1]), "carries": carries})
}

/// Both limbs of an arm or a leg on a strip. The part `hanging` is at its end and takes the share `turn` of the turn.
pub fn two_limbs(joints: [&str; 3], part: &str, hanging: &str, turn: f64) -> [Value; 2] {
    let across = [(part, 0.0, 10.0), (part, 2.0, 8.0), (part, 4.0, 6.0)];
    [
        limb(joints[0], joints[1], [across[0], across[1]], json!([part])),
        limb(joints[1], joints[2], [across[1], across[2]], json!([part, {"part": hanging, "turn": turn}])),
    ]
}

/// The limbs of the sample character.
pub fn limbs() -> Vec<Value> {
    let mut limbs = vec![
        limb("pelvis", "chest", [("coat", 5.64, 10.36), ("coat", 3.5, 12.5)], json!(["coat"])),
        limb("chest", "neck", [("coat", 3.5, 12.5), ("coat", 1.0, 15.0)], json!(["coat", "scarf", "scarf tail"])),
        limb("neck", "head", [("coat", 1.0, 15.0), ("head", 0.0, 8.0)], json!(["head", "hair"])),
        limb("head", "head_top", [("head", 0.0, 8.0), ("head", 12.0, 12.0)], json!(["head", "hat", "brim", "bobble"])),
    ];
    limbs.extend(two_limbs(["r_shoulder", "r_elbow", "r_wrist"], "near arm", "near mitten", 1.0));
    limbs.extend(two_limbs(["l_shoulder", "l_elbow", "l_wrist"], "far arm", "far mitten", 1.0));
    limbs.extend(two_limbs(["r_hip", "r_knee", "r_ankle"], "near leg", "near boot", 0.3));
    limbs.extend(two_limbs(["l_hip", "l_knee", "l_ankle"], "far leg", "far boot", 0.3));
    limbs
}
