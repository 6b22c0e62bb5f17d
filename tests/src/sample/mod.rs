//! The sample cartoon: 24 frames of a character that this code draws, with exact truth.
//!
//! A boy in cap and scarf walks along a path, crouches, jumps, turns round in the air, lands and goes back. The cartoon is
//! drawn on twos (each drawing is held for two frames) over a still, painted background. It has the difficulties of contour
//! capture in cartoons: limbs cross in front of the body and behind it, and they move by more than their width from drawing
//! to drawing.
//!
//! - [`pose`]: the poses of the twelve drawings
//! - [`rig`]: makes the outlines of the sixteen parts from a pose
//! - [`limbs`]: the character's limbs on its contours
//! - [`outline`]: the curve through control points, with corners and ink
//! - [`character`]: colours, face and other details
//! - [`ink`]: paints an outline
//! - [`background`]: sky, hills and trees
//! - [`truth`]: finds the control points that are visible
//!
//! Every run gives the same bytes.

pub mod background;
pub mod character;
pub mod ink;
pub mod limbs;
pub mod outline;
pub mod pose;
pub mod rig;
pub mod truth;

use anyhow::{Context, Result, anyhow};
use character::PARTS;
use ink::Canvas;
use outline::Outline;
use pose::DRAWINGS;
use rayon::prelude::{IndexedParallelIterator, IntoParallelRefIterator, ParallelIterator};
use rig::Rig;
use rototoon::geometry::Point;
use serde_json::{Map, Value, json};
use std::path::Path;
use tiny_skia::Pixmap;

/// Width of a frame in pixels.
pub const WIDTH: u32 = 960;
/// Height of a frame in pixels.
pub const HEIGHT: u32 = 540;
/// Number of frames; the first is frame 0.
pub const FRAMES: usize = 24;
/// Number of frames that each drawing is held.
pub const HOLD: usize = 2;
/// Frames on which the artist has keyed the body: start, crouch, landing and end.
const BODY_KEYS: [usize; 4] = [0, 12, 18, 23];
/// Frames on which the artist has keyed swinging parts: those of the body, and the other contact of the walk.
const LIMB_KEYS: [usize; 5] = [0, 6, 12, 18, 23];

/// One drawing: its picture and its outlines.
#[derive(Clone, Debug)]
pub struct Drawn {
    /// The picture.
    pub picture: Pixmap,
    /// The outlines of the parts, in the order of [`PARTS`]: from the farthest to the nearest.
    pub outlines: Vec<Outline>,
    /// For each part and control point whether the picture shows it.
    pub scored: Vec<Vec<bool>>,
}

/// Draws the twelve drawings.
pub fn draw() -> Result<Vec<Drawn>> {
    let background =
        background::paint(WIDTH, HEIGHT).ok_or_else(|| anyhow!("no picture of {WIDTH}x{HEIGHT} pixels"))?;
    Ok(DRAWINGS
        .par_iter()
        .map(|pose| {
            let rig = Rig::new(pose);
            let mut canvas = Canvas { pixels: background.clone() };
            character::draw(&mut canvas, &rig);
            let scored = truth::scored(&rig.outlines, &canvas.pixels);
            Drawn { picture: canvas.pixels, outlines: rig.outlines, scored }
        })
        .collect())
}

/// Writes `frames/frame_000.png` to `frames/frame_023.png`, `project.json` (key frames only) and `truth.json` into
/// `folder`, and makes the folder if needed.
pub fn write(folder: &Path) -> Result<()> {
    write_keyed(folder, key_frames)
}

/// Writes the same files with keys on other frames.
pub fn write_keyed(folder: &Path, key_frames: KeyFrames) -> Result<()> {
    let drawings = draw()?;
    let frames = folder.join("frames");
    std::fs::create_dir_all(&frames).with_context(|| format!("cannot make the folder {frames:?}"))?;
    drawings.par_iter().enumerate().try_for_each(|(i, drawing)| {
        let png = drawing.picture.encode_png()?;
        (HOLD * i..HOLD * (i + 1)).try_for_each(|frame| write_file(&frames.join(format!("frame_{frame:03}.png")), &png))
    })?;
    write_file(&folder.join("project.json"), serde_json::to_string(&project(&drawings, key_frames))?.as_bytes())?;
    write_file(&folder.join("truth.json"), serde_json::to_string(&truth_document(&drawings))?.as_bytes())
}

fn write_file(path: &Path, bytes: &[u8]) -> Result<()> {
    std::fs::write(path, bytes).with_context(|| format!("cannot write {path:?}"))
}

/// Frames on which the artist has keyed a part.
pub fn key_frames(part: &str) -> &'static [usize] {
    let swings = ["arm", "mitten", "leg", "boot", "tail", "hat", "bobble"];
    if swings.iter().any(|word| part.contains(word)) { &LIMB_KEYS } else { &BODY_KEYS }
}

/// Fewer key frames than an artist would set: the first, the crouching and the last frame, for every part.
pub fn far_key_frames(_part: &str) -> &'static [usize] {
    &[0, 12, 23]
}

/// Gives the key frames of a part by its name.
pub type KeyFrames = fn(&str) -> &'static [usize];

/// The project document with the artist's keys only.
pub fn project(drawings: &[Drawn], key_frames: KeyFrames) -> Value {
    let parts: Vec<Value> = PARTS
        .iter()
        .enumerate()
        .map(|(k, paint)| {
            let keys =
                key_frames(paint.name).iter().map(|&f| (f.to_string(), points(&drawings[f / HOLD].outlines[k].points)));
            json!({"name": paint.name, "closed": true, "depth": k, "keys": keys.collect::<Map<_, _>>()})
        })
        .collect();
    json!({
        "rototoon": 1,
        "footage": {
            "pattern": "frames/frame_%03d.png", "first": 0, "last": FRAMES - 1, "fps": 24, "width": WIDTH, "height": HEIGHT,
        },
        "parts": parts,
        "limbs": limbs::limbs(),
    })
}

/// The truth on every frame: control points, dense contour, and which points are scored.
pub fn truth_document(drawings: &[Drawn]) -> Value {
    let every = |value: &dyn Fn(&Drawn) -> Value| -> Value {
        (0..FRAMES).map(|f| (f.to_string(), value(&drawings[f / HOLD]))).collect::<Map<_, _>>().into()
    };
    let parts: Vec<Value> = PARTS
        .iter()
        .enumerate()
        .map(|(k, paint)| {
            let marks = |d: &Drawn| d.scored[k].iter().map(|&s| if s { '1' } else { '0' }).collect::<String>().into();
            json!({
                "name": paint.name,
                "points": every(&|d| points(&d.outlines[k].points)),
                "contour": every(&|d| points(&d.outlines[k].line())),
                "scored": every(&marks),
            })
        })
        .collect();
    json!({"source": "drawn by Rototoon's own code", "licence": "Apache-2.0", "parts": parts})
}

/// Points as JSON, rounded to a thousandth of a pixel.
fn points(points: &[Point]) -> Value {
    let round = |v: f64| (1000.0 * v).round() / 1000.0;
    points.iter().map(|p| json!([round(p.x), round(p.y)])).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::golden;
    use rototoon::geometry::polyline;
    use std::collections::BTreeMap;
    use std::sync::LazyLock;

    static DRAWN: LazyLock<Vec<Drawn>> = LazyLock::new(|| draw().unwrap());

    fn files(folder: &Path) -> BTreeMap<String, Vec<u8>> {
        let mut found = BTreeMap::new();
        for sub in ["", "frames"] {
            for entry in std::fs::read_dir(folder.join(sub)).unwrap().flatten().filter(|e| e.path().is_file()) {
                found.insert(
                    format!("{sub}/{}", entry.file_name().to_string_lossy()),
                    std::fs::read(entry.path()).unwrap(),
                );
            }
        }
        found
    }

    #[test]
    fn two_writes_give_the_same_bytes() {
        let (one, two) = (tempfile::tempdir().unwrap(), tempfile::tempdir().unwrap());
        write(one.path()).unwrap();
        write(&two.path().join("made")).unwrap();
        let (one, two) = (files(one.path()), files(&two.path().join("made")));
        assert_eq!(one.keys().collect::<Vec<_>>(), two.keys().collect::<Vec<_>>());
        assert_eq!(one.len(), FRAMES + 2);
        assert!(one == two);
    }

    #[test]
    fn an_unwritable_folder_is_named() {
        let folder = tempfile::tempdir().unwrap();
        std::fs::write(folder.path().join("taken"), "").unwrap();
        let error = format!("{:#}", write(&folder.path().join("taken")).unwrap_err());
        assert!(error.contains("taken"), "{error}");
    }

    #[test]
    fn control_points_are_on_the_contour_and_keep_their_number() {
        for drawing in DRAWN.iter() {
            assert_eq!(drawing.outlines.len(), PARTS.len());
            for (k, outline) in drawing.outlines.iter().enumerate() {
                assert_eq!(outline.points.len(), DRAWN[0].outlines[k].points.len());
                assert!((8..=24).contains(&outline.points.len()));
                let line = outline.line();
                assert!(outline.points.iter().all(|&p| polyline::distance(p, &line, true) < 1e-9));
            }
        }
    }

    #[test]
    fn scored_points_are_on_ink() {
        let luma = |p: &Pixmap, at: Point| {
            let c = p.pixel(at.x as u32, at.y as u32).unwrap();
            u32::from(c.red()) + u32::from(c.green()) + u32::from(c.blue())
        };
        for drawing in DRAWN.iter() {
            for (outline, scored) in drawing.outlines.iter().zip(&drawing.scored) {
                for (i, at) in outline.points.iter().enumerate().filter(|&(i, _)| scored[i] && outline.ink[i] > 2.0) {
                    assert!(luma(&drawing.picture, *at) < 330, "{at}: {}", luma(&drawing.picture, *at));
                    assert!(truth::changes(outline, i, &drawing.picture));
                }
            }
        }
    }

    #[test]
    fn most_points_are_scored_and_hidden_ones_are_not() {
        let count = |scored: &[bool]| scored.iter().filter(|&&s| s).count();
        let all: usize = DRAWN.iter().flat_map(|d| &d.scored).map(Vec::len).sum();
        let seen: usize = DRAWN.iter().flat_map(|d| &d.scored).map(|s| count(s)).sum();
        assert!((0.55..0.9).contains(&(seen as f64 / all as f64)), "{seen} of {all}");
        let hat = PARTS.iter().position(|p| p.name == "hat").unwrap();
        for drawing in DRAWN.iter() {
            // This point is under the brim.
            assert!(!drawing.scored[hat][13]);
        }
    }

    #[test]
    fn jumps_are_larger_than_a_limb_is_wide() {
        let boot = PARTS.iter().position(|p| p.name == "near boot").unwrap();
        let jump = |i: usize| DRAWN[i].outlines[boot].points[0].distance(DRAWN[i + 1].outlines[boot].points[0]);
        assert!((0..DRAWN.len() - 1).filter(|&i| jump(i) > 40.0).count() >= 4);
    }

    #[test]
    fn keys_are_the_truth_at_their_frames() {
        let (project, truth) = (project(&DRAWN, key_frames), truth_document(&DRAWN));
        for (part, truth) in project["parts"].as_array().unwrap().iter().zip(truth["parts"].as_array().unwrap()) {
            let keys = part["keys"].as_object().unwrap();
            assert!(keys.contains_key("0") && keys.contains_key("23"));
            for (frame, points) in keys {
                assert_eq!(points, &truth["points"][frame]);
            }
        }
    }

    #[test]
    fn drawings_look_as_accepted() {
        let drawn = [("sample_walk", 0), ("sample_crouch", 6), ("sample_jump", 8)];
        let compared = drawn.map(|(name, drawing)| golden::compare(name, &DRAWN[drawing].picture));
        compared.into_iter().for_each(|result| result.unwrap());
    }

    #[test]
    fn every_part_is_keyed_on_the_given_frames() {
        let document = project(&DRAWN, far_key_frames);
        for part in document["parts"].as_array().unwrap() {
            let keys: Vec<_> = part["keys"].as_object().unwrap().keys().cloned().collect();
            assert_eq!(keys, ["0", "12", "23"], "{}", part["name"]);
        }
    }
}
