//! Tests all steps of a motion: the sample cartoon's contours are tracked, their limbs give a clip, the motion is made in
//! another character's style, and a second drawn character follows it.
//!
//! The test writes `target/style/sheet.png`: the sample's drawings, the doll that follows the captured clip, and the doll that
//! follows the clip in the old man's style.

use rototoon::geometry::{Point, polygon};
use rototoon::pipeline::{self, ClipJob, ReshapeJob};
use rototoon::project::Document;
use rototoon::project::clips::Clips;
use rototoon::reshape::puppet::Options as PuppetOptions;
use rototoon::scene::proportions::Proportions;
use rototoon::scene::skeleton::{Posture, limb_lengths};
use rototoon::scene::{Clip, FrameNumber, Silent, Template};
use rototoon::style::{Options, Request};
use rototoon::track::TrackOptions;
use rototoon_tests::sample::{self, FRAMES, HEIGHT, HOLD, WIDTH, background};
use rototoon_tests::{doll, sheet};
use std::path::Path;
use std::sync::LazyLock;
use tiny_skia::Pixmap;

/// Number of frames of the sample's walk. The frames after it are the jump.
const WALK: usize = 12;

/// Further key frames in the air, because both legs swap places there within two drawings.
const IN_THE_AIR: [FrameNumber; 2] = [14, 16];

/// The sample cartoon tracked from its keys.
static TRACKED: LazyLock<Document> = LazyLock::new(|| {
    let folder = tempfile::tempdir().unwrap();
    sample::write(folder.path()).unwrap();
    let mut document = Document::load(&folder.path().join("project.json")).unwrap();
    let drawings = sample::draw().unwrap();
    for (k, part) in document.scene.parts.iter_mut().enumerate() {
        let key = |frame: FrameNumber| (frame, drawings[frame as usize / HOLD].outlines[k].points.clone());
        part.keys.extend(IN_THE_AIR.map(key));
    }
    pipeline::track(&mut document, folder.path(), &TrackOptions::default(), &Silent).unwrap();
    document
});

fn captured(document: &Document, motion: &str, frames: std::ops::RangeInclusive<FrameNumber>) -> Clip {
    let job = ClipJob { character: "boy".into(), motion: motion.into(), frames: Some(frames) };
    pipeline::clip(document, &job).unwrap().clips.clips.remove(0)
}

/// A clip of the true key points: the same limbs on the true contours.
fn true_clip(motion: &str, frames: std::ops::RangeInclusive<FrameNumber>) -> Clip {
    let mut document = TRACKED.clone();
    let drawings = sample::draw().unwrap();
    for (k, part) in document.scene.parts.iter_mut().enumerate() {
        part.tracks = (0..FRAMES).map(|f| (f as FrameNumber, drawings[f / HOLD].outlines[k].points.clone())).collect();
    }
    captured(&document, motion, frames)
}

/// An old man's version of a clip: the upper body with head and arms leans by 0.45 rad about the pelvis.
fn aged(clip: &Clip) -> Clip {
    let turned = |posture: &Posture| -> Posture {
        let lean = Point::from_angle(0.45);
        std::array::from_fn(|k| {
            let p = posture[k] - posture[0];
            posture[0] + if k < 11 { lean.rotate(p) } else { p }
        })
    };
    Clip::new("old", clip.motion.as_str(), clip.human().unwrap().iter().map(turned).collect())
}

fn reshaped(clip: &Clip, marks: bool) -> Document {
    let mut document = doll::document().unwrap();
    if !marks {
        let mut set = document.limbs().unwrap();
        set.marks.clear();
        document.set_limbs(&set);
    }
    let options = PuppetOptions::default();
    let (mirror, points) = Default::default();
    let job = ReshapeJob { clip, fps: 24.0, rest: None, over: None, chains: Vec::new(), mirror, options, points };
    let made = pipeline::reshape(&mut document, &job, &Silent).unwrap();
    assert_eq!(made.given, []);
    let rigid = |name: &String| ["mitten", "boot", "head"].iter().any(|word| name.contains(word));
    assert!(made.rigid.iter().all(rigid), "arms, legs and the body bend: {:?}", made.rigid);
    document
}

/// The mean lean of the torso to the right, in radians.
fn lean(clip: &Clip) -> f64 {
    let angle = |p: &Vec<Point>| (p[2] - p[0]).x.atan2((p[0] - p[2]).y);
    clip.postures.iter().map(angle).sum::<f64>() / clip.postures.len() as f64
}

/// The index of the nearest part at every pixel. `order` lists the parts from the farthest to the nearest.
fn topmost(document: &Document, frame: FrameNumber, order: &[usize]) -> Vec<usize> {
    let mut ids = vec![usize::MAX; (WIDTH * HEIGHT) as usize];
    for &index in order {
        let Some(points) = document.scene.parts[index].points_at(frame) else { continue };
        polygon::for_each_span(points, WIDTH as usize, HEIGHT as usize, |y, x0, x1| {
            let row = y * WIDTH as usize;
            ids[row + x0..row + x1].fill(index);
        });
    }
    ids
}

/// The number of pixels on which another part is in front than in the true order, and of pixels on which parts overlap.
fn order_errors(document: &Document) -> (usize, usize) {
    let index = |name: &str| document.scene.parts.iter().position(|part| part.name == name).unwrap();
    let truth: Vec<usize> = doll::TRUE_ORDER.iter().map(|name| index(name)).collect();
    let backwards: Vec<usize> = truth.iter().rev().copied().collect();
    let count = |a: &[usize], b: &[usize]| a.iter().zip(b).filter(|(a, b)| a != b).count();
    let footage = &document.scene.footage;
    (footage.first..=footage.last).fold((0, 0), |(wrong, crossing), frame| {
        let wanted = topmost(document, frame, &truth);
        let found = topmost(document, frame, &doll::order(document, frame));
        let overlaps = count(&wanted, &topmost(document, frame, &backwards));
        assert!(overlaps > 0, "frame {frame}: nothing overlaps, so it shows nothing");
        (wrong + count(&found, &wanted), crossing + overlaps)
    })
}

#[test]
fn a_tracked_character_s_clip_is_near_the_true_one() {
    let last = FRAMES as FrameNumber - 1;
    let (found, truth) = (captured(&TRACKED, "all", 0..=last), true_clip("all", 0..=last));
    let mut errors: Vec<f64> =
        found.postures.iter().zip(&truth.postures).flat_map(|(a, b)| (0..17).map(|k| a[k].distance(b[k]))).collect();
    errors.sort_by(f64::total_cmp);
    let torso = rototoon::scene::proportions::typical_torso(&Template::human(), &truth.postures);
    let (median, mean) = (errors[errors.len() / 2], errors.iter().sum::<f64>() / errors.len() as f64);
    println!("key points: median {median:.2} px, mean {mean:.2} px, torso {torso:.1} px");
    assert!(median < 0.005 * torso && mean < 0.06 * torso, "median {median}, mean {mean}, torso {torso}");
}

#[test]
fn a_doll_performs_a_walk_in_an_old_man_s_style() {
    let last = FRAMES as FrameNumber - 1;
    let walk = captured(&TRACKED, "walk", 0..=WALK as FrameNumber - 1);
    let jump = captured(&TRACKED, "jump", WALK as FrameNumber..=last);
    let library = Clips { clips: vec![walk.clone(), jump.clone(), aged(&jump)], fps: 24.0 };
    let request = Request { style: "old", motion: "walk", content: "boy", keys: &[] };
    // One other motion gives little information, so the most probable style is weak. A higher strength compensates for that.
    let options = Options { strength: 2.5, ..Options::default() };
    let made = pipeline::translate(&library, &request, &options, &Silent).unwrap().clips.remove(0);
    println!("lean: {:.3} as captured, {:.3} in the old man's style", lean(&walk), lean(&made));
    assert!(lean(&made) > lean(&walk) + 0.15, "{} {}", lean(&made), lean(&walk));

    let whole = captured(&TRACKED, "all", 0..=last);
    let (as_captured, in_manner) = (reshaped(&whole, true), reshaped(&made, true));
    for document in [&as_captured, &in_manner] {
        let (wrong, crossing) = order_errors(document);
        println!("{crossing} pixels on which parts cross, {wrong} in the wrong order");
        assert_eq!(wrong, 0);
        assert_eq!(document.problems().error_count(), 0);
    }
    assert!(order_errors(&reshaped(&whole, false)).0 > 1000, "without marks the order is not found");

    // The lengths of the doll's limbs are its own, times the relative changes of length in the clip.
    let performed = captured(&in_manner, "walk", 0..=WALK as FrameNumber - 1);
    let rest = captured(&doll::document().unwrap(), "rest", 0..=0);
    let (own, theirs) =
        (limb_lengths(&rest.human().unwrap()[0]), Proportions::of(&Template::human(), &made.postures).0);
    for (drawn, wanted) in performed.human().unwrap().iter().zip(&made.human().unwrap()) {
        let (drawn, wanted) = (limb_lengths(drawn), limb_lengths(wanted));
        for limb in [0, 1, 5, 6, 8, 9, 11, 12, 14, 15].map(|k: usize| k.min(15)) {
            let expected = wanted[limb] / theirs[limb] * own[limb];
            assert!((drawn[limb] / expected - 1.0).abs() < 0.25, "limb {limb}: {} {expected}", drawn[limb]);
        }
    }
    write_sheet(&as_captured, &in_manner).unwrap();
}

fn write_sheet(as_captured: &Document, in_manner: &Document) -> anyhow::Result<()> {
    let ground = background::paint(WIDTH, HEIGHT).unwrap();
    let drawings = sample::draw()?;
    let image = |pixels: &Pixmap| image::RgbaImage::from_raw(WIDTH, HEIGHT, pixels.data().to_vec()).unwrap();
    let mut cells = Vec::new();
    for document in [None, Some(as_captured), Some(in_manner)] {
        let frames = document.map_or(FRAMES, |d| d.scene.footage.last as usize + 1);
        for frame in (0..frames).step_by(if frames == FRAMES { 3 } else { 2 }) {
            let (name, picture) = match document {
                None => ("sample", drawings[frame / HOLD].picture.clone()),
                Some(document) => ("doll", doll::paint(ground.clone(), document, frame as FrameNumber)),
            };
            cells.push(sheet::captioned(&sheet::shrunk(&image(&picture)), &format!("{name} {frame}"))?);
        }
    }
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../target/style");
    std::fs::create_dir_all(&folder)?;
    // The doll is also written as a project of its own, to try the same in Blender.
    std::fs::write(folder.join("doll.json"), doll::document()?.to_json())?;
    std::fs::write(folder.join("doll_0.png"), doll::paint(ground.clone(), &doll::document()?, 0).encode_png()?)?;
    sample::write(&folder.join("sample"))?;
    std::fs::write(folder.join("sample/tracked.json"), TRACKED.to_json())?;
    Ok(sheet::arrange(&cells)?.save(folder.join("sheet.png"))?)
}
