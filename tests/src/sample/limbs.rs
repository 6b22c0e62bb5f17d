//! Limbs of the sample character on its contours: what an artist would mark once.
//!
//! Sleeves and trouser legs are strips of twelve points ([`super::outline::strip`]): 0 to 4 run down one side, 10 to 6 up the other,
//! so that (0, 10), (2, 8) and (4, 6) lie across shoulder, elbow and wrist. The near limbs are the right ones: the character first
//! walks to the right. It goes on being drawn near when the character has turned round, as if seen in a mirror; so its sides do
//! not change places.

use serde_json::{Value, json};

/// Depth order of the sample's parts that matter to limbs, said by "in front" and "behind".
pub const IN_FRONT: [(&str, &str); 6] = [
    ("near arm", "coat"),
    ("near mitten", "near arm"),
    ("coat", "near leg"),
    ("near leg", "far leg"),
    ("far leg", "far arm"),
    ("head", "coat"),
];

/// A limb between two pairs of places on one part, as documents write it.
pub fn limb(from: &str, to: &str, ends: [(&str, f64, f64); 2], carries: Value) -> Value {
    let end = |(part, a, b): (&str, f64, f64)| json!({"points": [{"part": part, "at": a}, {"part": part, "at": b}]});
    json!({"from": from, "to": to, "start": end(ends[0]), "end": end(ends[1]), "carries": carries})
}

/// Both limbs of an arm or a leg on a strip, with what hangs on its end and the share of the turn that this takes.
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
