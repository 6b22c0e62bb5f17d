//! Tests of the buttons Load, Save and Track.

use crate::common::{FILTER, OK, ROTO, clean, document, effect, host, kept, p};
use rototoon::geometry::{Point, polygon, polyline};
use rototoon::project::Document;
use rototoon::scene::{Footage, Part, Scene};
use rototoon_ofx_host::{ClipSettings, Effect, Host, Settings};

/// Width of the drawings.
pub const WIDTH: usize = 160;
/// Height of the drawings.
pub const HEIGHT: usize = 120;
/// The last frame of the document.
pub const LAST: i32 = 5;

fn blob(frame: i32) -> Vec<Point> {
    let turn = Point::from_angle(0.12 * f64::from(frame));
    let centre = p(50.0 + 7.0 * f64::from(frame), 60.0 + 2.0 * f64::from(frame));
    let corners = [p(-24.0, -14.0), p(0.0, -19.0), p(22.0, -10.0), p(26.0, 9.0), p(4.0, 17.0), p(-20.0, 12.0)];
    corners.iter().map(|&corner| centre + turn.rotate(corner)).collect()
}

/// A filled shape with an ink outline on paper. Rows are from the bottom.
pub fn drawing(frame: i32) -> Vec<f32> {
    let contour = blob(frame);
    let mut pixels = Vec::new();
    for row in (0..HEIGHT).rev() {
        for x in 0..WIDTH {
            let mut sum = [0.0f32; 3];
            for k in 0..9 {
                let q = p(x as f64 + (k % 3) as f64 / 3.0 + 0.17, row as f64 + (k / 3) as f64 / 3.0 + 0.17);
                let colour = if polyline::distance(q, &contour, true) <= 1.0 {
                    [0.05, 0.05, 0.05]
                } else if polygon::contains(&contour, q) {
                    [0.8, 0.35, 0.2]
                } else {
                    [0.95, 0.93, 0.9]
                };
                (0..3).for_each(|c| sum[c] += colour[c] / 9.0);
            }
            pixels.extend([sum[0], sum[1], sum[2], 1.0]);
        }
    }
    pixels
}

/// A document with a shape that has a key on the first and the last frame.
pub fn keyed() -> Document {
    let keys = [0, LAST].map(|frame| (frame, blob(frame))).into();
    with(Part { name: "blob".into(), closed: true, keys, ..Part::default() }, LAST)
}

/// A document with a part, on footage of this size from frame 0 to the last one.
pub fn with(part: Part, last: i32) -> Document {
    let footage =
        Footage { pattern: "%d.png".into(), first: 0, last, fps: 24.0, width: WIDTH, height: HEIGHT, held: false };
    Document::new(Scene { footage, parts: vec![part] })
}

/// An instance whose source begins on frame 101.
pub fn tracked<'a>(host: &'a Host, top_down: bool) -> Effect<'a> {
    let mut effect = host.effect(ROTO, FILTER);
    let source = ClipSettings {
        x2: WIDTH as i32,
        y2: HEIGHT as i32,
        first: 101.0,
        last: 101.0 + f64::from(LAST),
        top_down,
        padding: if top_down { 8 } else { 0 },
        ..ClipSettings::default()
    };
    effect.set_clip("Source", &source);
    effect.set_clip("Output", &source);
    for frame in 0..=LAST {
        effect.set_frame("Source", f64::from(101 + frame), WIDTH, &drawing(frame));
    }
    assert_eq!(effect.create(), OK);
    effect.set("frameOffset", &[101.0]);
    effect.set_text("document", &keyed().to_json());
    effect
}

#[test]
fn track_follows_the_drawing_and_keeps_the_result() {
    let host = host();
    let mut results = Vec::new();
    for top_down in [false, true] {
        let mut effect = tracked(&host, top_down);
        let before = effect.text("document");
        assert_eq!(effect.press("track"), OK, "{:?}", host.messages());
        clean(&host);
        let after = effect.text("document");
        assert_ne!(after, before);
        let found = kept(&effect);
        let part = &found.scene.parts[0];
        assert_eq!(part.tracks.keys().copied().collect::<Vec<_>>(), (0..=LAST).collect::<Vec<_>>());
        for frame in 1..LAST {
            let worst = part.tracks[&frame].iter().zip(blob(frame)).map(|(a, b)| a.distance(b)).fold(0.0, f64::max);
            assert!(worst < 3.0, "{frame}: {worst}");
        }
        assert!(host.furthest_progress() > 0.0);
        // A change by the plugin itself starts nothing.
        assert_eq!(effect.changed_by_plugin("track"), "kOfxStatReplyDefault");
        results.push(after);
    }
    assert!(results[0] == results[1], "the order of rows changes nothing");
}

#[test]
fn a_cancelled_track_changes_nothing_and_may_be_started_again() {
    let host = host();
    let mut effect = tracked(&host, false);
    let before = effect.text("document");
    host.configure(&Settings { cancel_after: 0, ..Settings::default() });
    assert_eq!(effect.press("track"), OK);
    assert_eq!(effect.text("document"), before);
    assert_eq!((host.messages().len(), host.live_images()), (0, 0));
    host.configure(&Settings::default());
    assert_eq!(effect.press("track"), OK);
    assert_ne!(effect.text("document"), before);
    clean(&host);
}

#[test]
fn a_track_that_is_cancelled_in_any_phase_changes_nothing() {
    let host = host();
    let mut effect = tracked(&host, false);
    let before = (effect.text("document"), effect.text("state"), effect.history().len());
    let mut cancelled = 0;
    // Each further update of the progress is in a later phase, at last after the end.
    for updates in 1.. {
        host.configure(&Settings { cancel_after: updates, ..Settings::default() });
        assert_eq!(effect.press("track"), OK, "{updates}");
        assert_eq!((host.messages().len(), host.live_images()), (0, 0), "{updates}");
        if effect.text("document") != before.0 {
            break;
        }
        assert!((effect.text("document"), effect.text("state"), effect.history().len()) == before, "{updates}");
        cancelled += 1;
    }
    assert!(cancelled > 2, "{cancelled}");
    clean(&host);
}

#[test]
fn tracking_errors_are_reported() {
    let host = host();
    let mut effect = tracked(&host, false);
    effect.set("firstFrame", &[102.0]);
    effect.set("lastFrame", &[104.0]);
    assert_eq!(effect.press("track"), "kOfxStatFailed");
    let messages = host.messages();
    assert!(messages.len() == 1 && messages[0].contains("no part has a key"), "{messages:?}");
    effect.set_text("document", "");
    assert_eq!(effect.press("track"), "kOfxStatFailed");
    assert!(host.messages()[0].contains("load a project"));
    let mut alone = effect_without_source(&host);
    assert_eq!(alone.press("track"), "kOfxStatFailed");
    assert!(host.messages()[0].contains("connect the footage"));
    assert_eq!(host.live_images(), 0);
}

#[test]
fn a_host_that_gives_no_other_frames_is_told_so_and_nothing_changes() {
    let host = host();
    host.configure(&Settings { temporal: false, ..Settings::default() });
    let mut effect = tracked(&host, false);
    let before = (effect.text("document"), effect.text("state"), effect.history().len());
    assert_eq!(effect.press_at("track", 102.0), "kOfxStatFailed");
    let told = host.messages().join("");
    assert!(told.contains("Source") && told.contains("no image"), "{told}");
    assert!((effect.text("document"), effect.text("state"), effect.history().len()) == before);
    assert_eq!(host.live_images(), 0);
    host.configure(&Settings::default());
}

fn effect_without_source(host: &Host) -> Effect<'_> {
    effect(host, crate::common::GENERAL, &ClipSettings { connected: false, ..ClipSettings::default() })
}

#[test]
fn load_and_save() {
    let host = host();
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("project.json");
    std::fs::write(&file, document()).unwrap();
    let mut effect = effect(&host, FILTER, &ClipSettings::default());
    effect.set_text("document", "");
    assert_eq!(effect.press("save"), "kOfxStatFailed");
    assert_eq!(effect.press("load"), "kOfxStatFailed");
    let messages = host.messages();
    assert!(messages.len() == 2 && messages.iter().all(|text| text.contains("choose a project file")), "{messages:?}");
    // Choosing a file loads it.
    effect.set_text("project", file.to_str().unwrap());
    let loaded = kept(&effect);
    assert_eq!(loaded.scene.parts, crate::common::scene().parts);
    assert!(loaded.scene.footage.pattern.starts_with(folder.path().to_str().unwrap()));
    // Saved in the footage's folder, the document has its relative pattern again.
    std::fs::remove_file(&file).unwrap();
    assert_eq!(effect.press("save"), OK);
    assert_eq!(Document::load(&file).unwrap().scene, crate::common::scene());
    assert_eq!(effect.press("save"), OK, "what was saved here is known");
    // Another program writes the file meanwhile.
    let theirs = document().replace("\"parts\"", "\"note\": \"theirs\", \"parts\"");
    assert_ne!(theirs, document());
    std::fs::write(&file, &theirs).unwrap();
    assert_eq!(effect.press("save"), "kOfxStatFailed");
    let beside = folder.path().join("project (2).json");
    let said = host.messages().pop().unwrap_or_default();
    assert!(
        said.contains("another program wrote the file meanwhile") && said.contains(beside.to_str().unwrap()),
        "{said}"
    );
    assert_eq!(std::fs::read_to_string(&file).unwrap(), theirs);
    assert_eq!(Document::load(&beside).unwrap().scene, crate::common::scene());
    // After Load the file is known as it is now.
    assert_eq!((effect.press("load"), effect.press("save")), (OK.into(), OK.into()));
    effect.set_text_silently("project", folder.path().join("none/a.json").to_str().unwrap());
    assert_eq!((effect.press("save"), effect.press("load")), ("kOfxStatFailed".into(), "kOfxStatFailed".into()));
    assert_eq!(host.messages().len(), 2);
}
