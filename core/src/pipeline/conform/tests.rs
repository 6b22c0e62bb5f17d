//! A shot that is delivered again.

use super::*;
use crate::render::{Format, encode};
use crate::scene::{Part, Raster, Scene, Silent};

/// A ring with a stick that moves over paper, seen at a scale and from a border away.
fn drawing(step: i32, scale: f64, border: f64) -> Raster<[f32; 3]> {
    let size = |side: f64| (side * scale + 2.0 * border) as usize;
    let centre = Point::new(40.0 + 5.0 * f64::from(step), 36.0);
    Raster::from_fn(size(128.0), size(72.0), |x, y| {
        let p = (Point::new(x as f64 + 0.5, y as f64 + 0.5) - Point::splat(border)) / scale;
        let ring = (p.distance(centre) - 14.0).abs();
        let stick = if p.y > 50.0 && p.y < 66.0 { (p.x - centre.x - 0.2 * (p.y - 50.0)).abs() } else { 99.0 };
        let wall = if p.x > 2.0 && p.x < 126.0 { (p.y - 68.0).abs() } else { 99.0 };
        [if ring.min(stick).min(wall) < 1.3 { 0.1 } else { 0.9 }; 3]
    })
}

fn deliver(folder: &Path, first: FrameNumber, steps: &[i32], scale: f64, border: f64) {
    std::fs::create_dir_all(folder).unwrap();
    for (frame, &step) in (first..).zip(steps) {
        let picture = encode::colours(&drawing(step, scale, border), Format::Png).unwrap();
        std::fs::write(folder.join(format!("{frame:04}.png")), picture).unwrap();
    }
}

/// A document of frames 1 to 6 with a part whose points are the ring's centre.
fn document() -> Document {
    let footage =
        Footage { pattern: "old/%04d.png".into(), first: 1, last: 6, fps: 12.0, width: 128, height: 72, held: false };
    let at = |frame: FrameNumber| vec![Point::new(35.0 + 5.0 * f64::from(frame), 36.0)];
    let keys = [1, 6].map(|frame| (frame, at(frame))).into();
    let tracks = (1..=6).map(|frame| (frame, at(frame))).collect();
    let part = Part { name: "ring".into(), keys, tracks, ..Part::default() };
    Document::new(Scene { footage, parts: vec![part] })
}

fn new(folder: &Path) -> NewFootage {
    NewFootage {
        pattern: "new/%04d.png".into(),
        folder: folder.to_owned(),
        frames: None,
        fps: None,
        given: Given::default(),
        offset: None,
        held: None,
    }
}

#[test]
fn contours_follow_the_pictures_to_a_larger_plate_with_handles_and_a_lost_drawing() {
    let folder = tempfile::tempdir().unwrap();
    deliver(&folder.path().join("old"), 1, &[0, 1, 2, 3, 4, 5], 1.0, 0.0);
    // Two handles before, drawing 3 gone, drawing 4 twice.
    deliver(&folder.path().join("new"), 1001, &[-3, -2, 0, 1, 3, 3, 4, 5], 2.0, 16.0);
    let conformed = conform(&document(), folder.path(), &new(folder.path()), &Silent).unwrap();
    let footage = &conformed.document.scene.footage;
    assert_eq!((footage.first, footage.last, footage.width, footage.height), (1001, 1008, 288, 176));
    assert_eq!(conformed.conform.placement, Placement { scale: 2.0, shift: Point::new(16.0, 16.0) });
    let part = &conformed.document.scene.parts[0];
    let expected: Vec<_> = [(1003, 0), (1004, 1), (1005, 3), (1006, 3), (1007, 4), (1008, 5)].into();
    let x: Vec<_> = part.tracks.iter().map(|(frame, points)| (*frame, points[0].x)).collect();
    assert_eq!(x, expected.iter().map(|(frame, step)| (*frame, 96.0 + 10.0 * f64::from(*step))).collect::<Vec<_>>());
    assert_eq!(part.keys.keys().copied().collect::<Vec<_>>(), [1003, 1008]);
    assert_eq!(
        conformed.told(),
        [
            "the old picture is scaled by 2.000000 and moved by 16.00, 16.00 px",
            "6 of 8 frames show a drawing of the old footage",
            "new: 1001-1002",
            "gone from the old footage: 3",
        ]
    );
    let report = conformed.report();
    assert_eq!((&report["frames"]["1002"], &report["frames"]["1006"]), (&json!({"new": true}), &json!({"same": 4})));
    assert_eq!(report["went"], json!({"1": 1003, "2": 1004, "4": 1005, "5": 1007, "6": 1008}));
    assert_eq!((&report["gone"], &report["shift"]), (&json!([3]), &json!([16.0, 16.0])));
}

#[test]
fn an_offset_needs_no_old_pictures() {
    let folder = tempfile::tempdir().unwrap();
    deliver(&folder.path().join("new"), 101, &[0, 1, 2, 3, 4, 5], 1.5, 0.0);
    let asked = NewFootage { offset: Some(100), fps: Some(25.0), ..new(folder.path()) };
    let conformed = conform(&document(), folder.path(), &asked, &Silent).unwrap();
    let scene = &conformed.document.scene;
    assert_eq!((scene.footage.fps, scene.parts[0].keys[&106][0]), (25.0, Point::new(97.5, 54.0)));
    // It compared nothing, so nothing is said of what pictures show.
    let size = "the old picture is scaled by 1.500000 and moved by 0.00, 0.00 px";
    let added = "100 is added to the numbers of frames; no pictures were compared";
    assert_eq!(conformed.told(), [added, size, "6 of 6 frames are frames of the old footage"]);
    let asked = NewFootage { offset: Some(99), frames: Some(101..=106), ..new(folder.path()) };
    let asked = NewFootage { given: Given { scale: Some(1.0), shift: None }, ..asked };
    let told = conform(&document(), folder.path(), &asked, &Silent).unwrap().told();
    let expected = [
        "99 is added to the numbers of frames; no pictures were compared",
        "5 of 6 frames are frames of the old footage",
        "not in the old footage: 106",
        "not in the new footage, by the old numbers: 1",
    ];
    assert_eq!(told, expected);
    // The other sign leaves nothing.
    let asked = NewFootage { offset: Some(-100), ..new(folder.path()) };
    let error = conform(&document(), folder.path(), &asked, &Silent).unwrap_err();
    let told = "frame offset -100: none of the old frames, 1 to 6, is among the new ones, 101 to 106";
    assert_eq!(error.to_string(), told);
    let error = conform(&document(), folder.path(), &new(folder.path()), &Silent).unwrap_err();
    assert!(matches!(error, PipelineError::Footage { which: "old", .. }), "{error}");
}

#[test]
fn footage_that_is_not_there_or_shows_something_else_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let told = || conform(&document(), folder.path(), &new(folder.path()), &Silent).unwrap_err().to_string();
    assert_eq!(told(), "new/%04d.png: found no file of this name");
    deliver(&folder.path().join("old"), 1, &[0, 1, 2, 3, 4, 5], 1.0, 0.0);
    let stripes = Raster::from_fn(128, 72, |x, y| if (3 * x + y) % 13 < 5 { [0.2; 3] } else { [0.8; 3] });
    std::fs::create_dir_all(folder.path().join("new")).unwrap();
    std::fs::write(folder.path().join("new/0001.png"), encode::colours(&stripes, Format::Png).unwrap()).unwrap();
    assert_eq!(told(), "no frame of the new footage shows a drawing of the old one");
}
