//! A source that gets longer after the first contour was drawn.

use crate::buttons::{drawing, keyed};
use crate::common::{FILTER, HEIGHT, OK, ROTO, WIDTH, host, kept};
use rototoon::project::Document;
use rototoon_ofx_host::{ClipSettings, Effect, Host};

const DOWN: &str = "OfxInteractActionPenDown";
const UP: &str = "OfxInteractActionPenUp";
const KEY: &str = "OfxInteractActionKeyDown";
const ENTER: i32 = 0xff0d;
/// Index of the tool Draw contour.
const CONTOUR: f64 = 1.0;

fn source(last: f64) -> ClipSettings {
    ClipSettings { x2: WIDTH as i32, y2: HEIGHT as i32, first: 1.0, last, ..ClipSettings::default() }
}

/// An instance with a source from frame 1 on.
fn node(host: &Host, last: f64) -> Effect<'_> {
    let mut effect = host.effect(ROTO, FILTER);
    effect.set_clip("Source", &source(last));
    effect.set_clip("Output", &source(last));
    (0..=12).for_each(|frame| effect.set_frame("Source", f64::from(frame), WIDTH, &drawing(frame % 5)));
    assert_eq!(effect.create(), OK);
    effect
}

fn lengthen(effect: &mut Effect, last: f64) {
    effect.set_clip("Source", &source(last));
    effect.set_clip("Output", &source(last));
    assert_eq!(effect.clip_changed("Source"), "kOfxStatReplyDefault");
}

/// Draws a triangle.
fn draw(effect: &mut Effect, time: f64) {
    effect.set("tool", &[CONTOUR]);
    for at in [[20.0, 10.0], [50.0, 12.0], [30.0, 40.0]] {
        assert_eq!(effect.overlay(DOWN, true, time, at, 0.2), OK);
        assert_eq!(effect.overlay(UP, true, time, at, 0.2), OK);
    }
    assert_eq!(effect.overlay_key(KEY, time, ENTER), OK);
}

fn footage(document: &Document) -> [i32; 2] {
    [document.scene.footage.first, document.scene.footage.last]
}

#[test]
fn a_document_of_the_node_gets_as_long_as_the_source() {
    let (host, folder) = (host(), tempfile::tempdir().unwrap());
    let mut effect = node(&host, 6.0);
    draw(&mut effect, 5.0);
    assert_eq!(footage(&kept(&effect)), [1, 6]);
    lengthen(&mut effect, 12.0);
    draw(&mut effect, 11.0);
    let document = kept(&effect);
    assert_eq!((host.messages(), footage(&document)), (Vec::<String>::new(), [1, 12]));
    assert_eq!(document.scene.parts.iter().map(|part| part.keys.len()).sum::<usize>(), 2);
    effect.undo();
    assert_eq!(footage(&kept(&effect)), [1, 6], "the frames are part of the step");
    assert_eq!(effect.press_at("newKey", 12.0), OK, "{:?}", host.messages());
    effect.undo();
    // Without an edit in between.
    let files = folder.path().join("ids_%02d.exr");
    effect.set_text("exportFile", files.to_str().unwrap());
    assert_eq!(effect.press("track"), OK, "{:?}", host.messages());
    assert_eq!(footage(&kept(&effect)), [1, 12]);
    assert_eq!(effect.press("export"), OK, "{:?}", host.messages());
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 12);
}

#[test]
fn a_project_is_widened_only_where_it_is_worked_on() {
    let (host, folder) = (host(), tempfile::tempdir().unwrap());
    let mut effect = node(&host, 12.0);
    effect.set("frameOffset", &[1.0]);
    effect.set_text("document", &keyed().to_json());
    assert_eq!(effect.press_at("newKey", 3.0), OK, "{:?}", host.messages());
    assert_eq!(footage(&kept(&effect)), footage(&keyed()));
    assert_eq!(effect.press("track"), OK, "{:?}", host.messages());
    assert_eq!(footage(&kept(&effect)), footage(&keyed()), "no part is tracked beyond its keys");
    assert_eq!(effect.press_at("newKey", 10.0), OK, "{:?}", host.messages());
    assert_eq!(footage(&kept(&effect)), [0, 9]);
    assert!(host.messages().iter().any(|text| text.contains("has the frames 0 to 9 now")));
    // A part with one key is tracked to the source's end.
    let mut document = keyed();
    document.scene.parts[0].keys.retain(|frame, _| *frame == 0);
    effect.set_text("document", &document.to_json());
    assert_eq!(effect.press("track"), OK, "{:?}", host.messages());
    let (tracked, told) = (kept(&effect), host.messages());
    let last = *tracked.scene.parts[0].tracks.last_key_value().unwrap().0;
    assert_eq!(footage(&tracked), [0, last.max(5)]);
    assert_eq!(told.iter().any(|text| text.contains("frames 0 to")), last > 5, "{last} {told:?}");
    assert_eq!(effect.press_at("newKey", 20.0), "kOfxStatFailed");
    assert!(host.messages().iter().any(|text| text.contains("frame 19 is outside")));
    // A project whose frames the source does not have has another frame offset.
    effect.set("frameOffset", &[0.0]);
    effect.set_text("document", &keyed().to_json());
    assert_eq!(effect.press_at("newKey", 9.0), "kOfxStatFailed");
    assert!(host.messages().iter().any(|text| text.contains("see Frame offset")));
    // Shapes that lie beyond the footage all the same have no file of ids.
    let mut document = keyed();
    document.scene.footage.last = 2;
    let part = &mut document.scene.parts[0];
    part.tracks = std::mem::take(&mut part.keys);
    part.keys = part.tracks.range(..1).map(|(frame, points)| (*frame, points.clone())).collect();
    effect.set_text("document", &document.to_json());
    effect.set_text("exportFile", folder.path().join("ids_%02d.exr").to_str().unwrap());
    assert_eq!(effect.press("export"), OK, "{:?}", host.messages());
    let told = host.messages();
    assert!(told.iter().any(|text| text.contains("shapes on frame") && text.contains("beyond")), "{told:?}");
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 3);
}
