//! A second drawn character: a jointed wooden doll, drawn once, with other proportions than the sample character.
//!
//! It has ten parts, and limbs of the same names as the sample's. All its depths are 0, so only nine marks ([`MARKS`]) decide
//! which part is in front.

use crate::sample::background;
use crate::sample::ink::Canvas;
use crate::sample::limbs::{limb, two_limbs};
use crate::sample::outline::{Outline, strip};
use crate::sample::{HEIGHT, WIDTH};
use anyhow::{Context, Result};
use rototoon::geometry::Point;
use rototoon::project::Document;
use rototoon::scene::FrameNumber;
use serde_json::{Map, Value, json};
use std::path::Path;
use tiny_skia::{Color, Pixmap};

/// Writes the doll into a folder: `doll.json`, one drawing with limbs and marks, and its footage.
pub fn write(folder: &Path) -> Result<()> {
    std::fs::create_dir_all(folder).with_context(|| format!("cannot make the folder {folder:?}"))?;
    let document = document()?;
    let ground = background::paint(WIDTH, HEIGHT).context("no ground")?;
    std::fs::write(folder.join("doll_0.png"), paint(ground, &document, 0).encode_png()?)?;
    Ok(std::fs::write(folder.join("doll.json"), document.to_json())?)
}

/// Names of the parts in the order of the document, with their colours, 0xRRGGBB.
pub const PARTS: [(&str, u32); 10] = [
    ("body", 0xd9a566),
    ("head", 0xefc48d),
    ("near arm", 0x7fb069),
    ("near mitten", 0xefc48d),
    ("far arm", 0x4f7a45),
    ("far mitten", 0xb98f5e),
    ("near leg", 0x6a8caf),
    ("near boot", 0x8c4a3c),
    ("far leg", 0x46627e),
    ("far boot", 0x5d332b),
];

/// Pairs of parts, of which the first is in front of the second.
pub const MARKS: [(&str, &str); 9] = [
    ("near mitten", "near arm"),
    ("near arm", "head"),
    ("head", "body"),
    ("body", "near boot"),
    ("near boot", "near leg"),
    ("near leg", "far boot"),
    ("far boot", "far leg"),
    ("far leg", "far mitten"),
    ("far mitten", "far arm"),
];

/// The doll's parts from the farthest to the nearest, in the order of the sample character's parts.
pub const TRUE_ORDER: [&str; 10] = [
    "far arm",
    "far mitten",
    "far leg",
    "far boot",
    "near leg",
    "near boot",
    "body",
    "head",
    "near arm",
    "near mitten",
];

fn ellipse(at: Point, size: Point, count: usize) -> Vec<Point> {
    let angle = |k: usize| std::f64::consts::TAU * k as f64 / count as f64;
    (0..count).map(|k| at + size * Point::from_angle(angle(k))).collect()
}

/// The contours at rest, in the order of [`PARTS`].
pub fn contours() -> Vec<Vec<Point>> {
    let p = Point::new;
    let pelvis = p(300.0, 318.0);
    let at = |x: f64, y: f64| pelvis + p(x, y);
    let arm = |side: f64| {
        strip([at(side, -86.0), at(1.9 * side, -38.0), at(2.1 * side, 6.0)], 5, [9.0, 2.0], |t| 12.0 - 2.0 * t)
    };
    let leg = |side: f64| {
        strip([at(side, 0.0), at(1.5 * side + 4.0, 72.0), at(1.5 * side, 138.0)], 5, [9.0, 3.0], |t| 15.0 - 4.0 * t)
    };
    let hand = |side: f64| ellipse(at(2.15 * side, 16.0), p(11.0, 13.0), 10);
    let shoe = |side: f64| ellipse(at(1.5 * side + 7.0, 146.0), p(21.0, 10.0), 12);
    vec![
        ellipse(at(0.0, -45.0), p(30.0, 58.0), 16),
        ellipse(at(0.0, -136.0), p(33.0, 37.0), 12),
        arm(-24.0),
        hand(-24.0),
        arm(24.0),
        hand(24.0),
        leg(-13.0),
        shoe(-13.0),
        leg(13.0),
        shoe(13.0),
    ]
}

/// The doll's document, with one key per part on frame 0, limbs, and marks.
pub fn document() -> Result<Document> {
    let contours = contours();
    let points = |list: &[Point]| -> Value { list.iter().map(|p| json!([p.x, p.y])).collect() };
    let parts: Vec<Value> = PARTS
        .iter()
        .zip(&contours)
        .map(|((name, _), contour)| {
            let keys: Map<String, Value> = [("0".to_owned(), points(contour))].into_iter().collect();
            json!({"name": name, "closed": true, "depth": 0, "keys": keys})
        })
        .collect();
    let marks: Vec<Value> = MARKS.iter().map(|(front, behind)| json!({"front": front, "behind": behind})).collect();
    let text = json!({
        "rototoon": 1,
        "footage": {"pattern": "doll_%d.png", "first": 0, "last": 0, "fps": 24, "width": WIDTH, "height": HEIGHT},
        "parts": parts,
        "limbs": limbs(),
        "depth_marks": marks,
    });
    Document::parse(&text.to_string(), "doll").context("the doll's own document")
}

/// The doll's limbs, in the form of documents.
pub fn limbs() -> Vec<Value> {
    let mut limbs = vec![
        limb("pelvis", "chest", [("body", 2.5, 5.5), ("body", 8.5, 15.5)], json!(["body"])),
        limb("chest", "neck", [("body", 8.5, 15.5), ("body", 11.0, 13.0)], json!(["body"])),
        limb("neck", "head", [("body", 11.0, 13.0), ("head", 0.0, 6.0)], json!(["head"])),
        limb("head", "head_top", [("head", 0.0, 6.0), ("head", 9.0, 9.0)], json!(["head"])),
    ];
    limbs.extend(two_limbs(["r_shoulder", "r_elbow", "r_wrist"], "near arm", "near mitten", 1.0));
    limbs.extend(two_limbs(["l_shoulder", "l_elbow", "l_wrist"], "far arm", "far mitten", 1.0));
    limbs.extend(two_limbs(["r_hip", "r_knee", "r_ankle"], "near leg", "near boot", 0.3));
    limbs.extend(two_limbs(["l_hip", "l_knee", "l_ankle"], "far leg", "far boot", 0.3));
    limbs
}

fn colour(rgb: u32) -> Color {
    let [_, r, g, b] = rgb.to_be_bytes();
    Color::from_rgba8(r, g, b, 255)
}

/// Indices of a document's parts from the farthest to the nearest on a frame.
pub fn order(document: &Document, frame: FrameNumber) -> Vec<usize> {
    let parts = &document.scene.parts;
    let mut order: Vec<usize> = (0..parts.len()).collect();
    order.sort_by(|&a, &b| parts[a].depth_at(frame).total_cmp(&parts[b].depth_at(frame)));
    order
}

/// Paints a doll's document on a frame over a picture, in the document's depth order.
pub fn paint(pixels: Pixmap, document: &Document, frame: FrameNumber) -> Pixmap {
    let mut canvas = Canvas { pixels };
    for index in order(document, frame) {
        let part = &document.scene.parts[index];
        let Some(points) = part.points_at(frame) else { continue };
        let mut outline = Outline::closed(points.clone());
        outline.ink.fill(3.0);
        let tone = PARTS.iter().find(|(name, _)| *name == part.name).map_or(0x808080, |(_, rgb)| *rgb);
        canvas.fill(&outline, colour(tone));
        canvas.ink(&outline, colour(0x2b1a22));
    }
    canvas.pixels
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_doll_s_document_is_valid() {
        let document = document().unwrap();
        assert_eq!(document.problems().error_count(), 0);
        assert_eq!(document.limbs().unwrap().limbs.len(), 12);
        let known = |name: &&str| PARTS.iter().any(|(part, _)| part == name);
        assert!(TRUE_ORDER.iter().all(known));
    }
}
