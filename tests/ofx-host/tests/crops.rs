//! Tests of sources that do not say what the picture is: cropped to their drawing, or with frames without end.

use crate::common::{FILTER, GENERAL, MATTE, OK, ROTO, clean, host, kept, p, part, rendered};
use rototoon::project::Document;
use rototoon::scene::{Footage, Scene};
use rototoon_ofx_host::{Bounds, ClipSettings, Effect, Host, Settings};

/// The format of the project.
const FORMAT: Bounds = Bounds { x1: 0, y1: 0, x2: 192, y2: 108 };
const DOWN: &str = "OfxInteractActionPenDown";
const UP: &str = "OfxInteractActionPenUp";
/// The tool Draw contour.
const DRAW: f64 = 1.0;

/// A source whose region is another one on each frame, in a project of a format.
fn cropped<'a>(host: &'a Host, source: &ClipSettings) -> Effect<'a> {
    let mut effect = host.effect(ROTO, FILTER);
    effect.set_clip("Source", source);
    effect.set_clip("Output", &ClipSettings { x1: 0, y1: 0, x2: FORMAT.x2, y2: FORMAT.y2, ..source.clone() });
    for frame in 0..=4 {
        let x = 10 + 8 * frame;
        effect.set_region("Source", f64::from(frame), Bounds { x1: x, y1: 15, x2: x + 60 + 2 * frame, y2: 100 });
    }
    assert_eq!(effect.create(), OK);
    effect.set("output", &[MATTE]);
    effect
}

fn crop() -> ClipSettings {
    ClipSettings { x1: 10, y1: 15, x2: 70, y2: 100, last: 4.0, ..ClipSettings::default() }
}

/// Draws a triangle in the viewer, in canonical coordinates.
fn draw(effect: &mut Effect, time: f64) {
    effect.set("tool", &[DRAW]);
    for at in [[20.0, 30.0], [50.0, 30.0], [50.0, 90.0], [20.0, 30.0]] {
        for action in [DOWN, UP] {
            assert_eq!(effect.overlay(action, true, time, at, 0.1), OK);
        }
    }
}

fn defined(effect: &mut Effect, time: f64) -> [f64; 4] {
    let region = effect.region_of_definition(time, 1.0);
    [region.x1, region.y1, region.x2, region.y2]
}

#[test]
fn shapes_stay_where_a_source_is_cropped_to_its_drawing() {
    let host = host();
    for natron in [false, true] {
        let mut effect = cropped(&host, &crop());
        if natron {
            effect.set_format("Source", Bounds { x2: 200, ..FORMAT });
        }
        draw(&mut effect, 0.0);
        let footage = kept(&effect).scene.footage;
        assert_eq!((footage.width, footage.height), (if natron { 200 } else { 192 }, 108));
        assert_eq!(effect.press_at("newKey", 4.0), OK, "{:?}", host.messages());
        let _ = host.messages();
        for time in [0.0, 4.0] {
            assert_eq!(defined(&mut effect, time), [20.0, 30.0, 50.0, 90.0], "{natron} {time}");
            rendered(&host, &mut effect, time, FORMAT);
        }
        let told = host.messages().join("");
        assert!(!told.contains("stretched"), "{told}");
    }
    clean(&host);
}

#[test]
fn a_crop_that_stays_is_the_picture_and_old_footage_of_a_first_crop_lies_on_it() {
    let host = host();
    let mut still = host.effect(ROTO, FILTER);
    still.set_clip("Source", &crop());
    still.set_clip("Output", &ClipSettings { x1: 0, y1: 0, x2: FORMAT.x2, y2: FORMAT.y2, ..crop() });
    assert_eq!(still.create(), OK);
    draw(&mut still, 2.0);
    let document = kept(&still);
    assert_eq!((document.scene.footage.width, document.scene.footage.height), (60, 85));
    let mut effect = cropped(&host, &crop());
    effect.set_text("document", &document.to_json());
    assert_eq!(effect.press_at("newKey", 4.0), OK);
    for time in [2.0, 4.0] {
        assert_eq!(defined(&mut effect, time), [20.0, 30.0, 50.0, 90.0], "{time}");
    }
    clean(&host);
}

#[test]
fn footage_of_another_size_is_stretched_over_the_format_and_not_over_a_crop() {
    let host = host();
    let mut effect = cropped(&host, &crop());
    let contour = |_| vec![p(10.0, 9.0), p(25.0, 9.0), p(25.0, 39.0)];
    let footage =
        Footage { pattern: "%d.png".into(), first: 0, last: 4, fps: 24.0, width: 96, height: 54, held: false };
    let scene = Scene { footage, parts: vec![part("a", 0.0, true, contour)] };
    effect.set_text("document", &Document::new(scene).to_json());
    for time in [0.0, 4.0] {
        assert_eq!(defined(&mut effect, time), [20.0, 30.0, 50.0, 90.0], "{time}");
    }
    clean(&host);
}

fn endless() -> ClipSettings {
    let (first, last) = (f64::from(i32::MIN), f64::from(i32::MAX));
    ClipSettings { x2: FORMAT.x2, y2: FORMAT.y2, first, last, ..ClipSettings::default() }
}

#[test]
fn a_source_without_end_has_the_frames_of_the_timeline_or_those_around() {
    let mut host = host();
    // Without the suite of the timeline the output's range is known, and if it has no end either, the range of Track.
    let missing = |suite: &str| Settings { missing_suites: vec![suite.into()], ..Settings::default() };
    let no_timeline = missing("OfxTimeLineSuite");
    for (settings, output, chosen, wanted) in [
        (Settings::default(), endless(), [0.0, 0.0], [0, 100]),
        (no_timeline.clone(), ClipSettings { first: 3.0, last: 80.0, ..endless() }, [0.0, 0.0], [3, 80]),
        (no_timeline.clone(), endless(), [5.0, 30.0], [5, 30]),
        (no_timeline, endless(), [0.0, 0.0], [-480, 520]),
    ] {
        host.configure(&settings);
        host.reload(crate::common::bundles());
        let mut effect = host.effect(ROTO, FILTER);
        effect.set_clip("Source", &endless());
        effect.set_clip("Output", &output);
        assert_eq!(effect.create(), OK);
        effect.set("firstFrame", &chosen[..1]);
        effect.set("lastFrame", &chosen[1..]);
        draw(&mut effect, 20.0);
        let footage = kept(&effect).scene.footage;
        assert_eq!([footage.first, footage.last], wanted, "{settings:?}");
    }
    host.configure(&Settings::default());
    host.reload(crate::common::bundles());
}

#[test]
fn a_source_without_end_is_tracked_as_far_as_the_document_goes() {
    let host = host();
    let mut effect = host.effect(ROTO, FILTER);
    let source = ClipSettings { x2: 64, y2: 48, ..endless() };
    effect.set_clip("Source", &source);
    effect.set_clip("Output", &source);
    for frame in 0..=4 {
        effect.set_frame("Source", f64::from(frame), 64, &crate::common::pattern(0));
    }
    assert_eq!(effect.create(), OK);
    let mut document = Document::new(crate::common::scene());
    document.scene.parts.truncate(1);
    document.scene.parts[0].tracks.clear();
    document.scene.parts[0].keys.retain(|frame, _| *frame == 0);
    effect.set_text("document", &document.to_json());
    assert_eq!(effect.press("track"), OK, "{:?}", host.messages());
    let found = kept(&effect);
    let tracks: Vec<i32> = found.scene.parts[0].tracks.keys().copied().collect();
    assert!(tracks.len() > 1 && tracks.iter().all(|frame| (0..=4).contains(frame)), "{tracks:?}");
    clean(&host);
}

#[test]
fn a_contour_that_cannot_be_begun_is_told_where_the_pen_begins_it() {
    let host = host();
    let mut effect = host.effect(ROTO, GENERAL);
    effect.set_clip("Source", &ClipSettings { connected: false, ..ClipSettings::default() });
    assert_eq!(effect.create(), OK);
    let mut down = |tool: f64| {
        effect.set("tool", &[tool]);
        effect.overlay("OfxInteractActionDraw", true, 1.0, [0.0; 2], 0.1);
        effect.overlay(DOWN, true, 1.0, [5.0; 2], 0.1);
        host.messages()
    };
    assert_eq!(down(0.0), [""; 0]);
    let told = down(DRAW);
    assert!(told.len() == 1 && told[0].contains("connect the footage"), "{told:?}");
}
