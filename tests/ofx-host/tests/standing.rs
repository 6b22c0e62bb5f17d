//! Tests of lost, doubtful and hidden parts: in the viewer, in the host's timeline, and the buttons that go to them.

use crate::common::{FILTER, HEIGHT, OK, bundles, clean, effect, host, kept, lay_lines, scene};
use rototoon::geometry::Point;
use rototoon::project::Document;
use rototoon_ofx_host::{ClipSettings, Effect, Host, Settings};
use std::path::Path;
use tiny_skia::{Color, Pixmap};

const DRAW: &str = "OfxInteractActionDraw";
const FAILED: &str = "kOfxStatFailed";
const RED: [f32; 3] = [1.0, 0.0, 0.1];
const AMBER: [f32; 3] = [1.0, 0.65, 0.0];

/// The test scene: the star is lost on 1 and 2, the drop doubtful on 2, and the ground line hidden on 2 and 3.
fn document() -> Document {
    let mut scene = scene();
    for (part, shares) in [(0, [1.0, 0.2, 0.3, 0.9, 1.0]), (1, [1.0, 0.9, 0.6, 0.9, 1.0])] {
        let part = &mut scene.parts[part];
        let count = part.point_count();
        part.confidence = (0..).zip(shares.map(|share| vec![share; count])).collect();
    }
    scene.parts[2].set_absent(2, 3);
    scene.parts[2].forget_where_absent();
    Document::new(scene)
}

/// An instance that has loaded the document from a file, as a user does.
fn node<'a>(host: &'a Host, document: &Document) -> Effect<'a> {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("project.json");
    document.save(&path).unwrap();
    let mut effect = effect(host, FILTER, &ClipSettings::default());
    effect.set_text("document", "");
    effect.set_text("project", path.to_str().unwrap());
    assert!(!effect.text("document").is_empty(), "{:?}", host.messages());
    effect
}

/// The marks of a parameter: time and number of parts.
fn marks(effect: &Effect, name: &str) -> Vec<(f64, f64)> {
    effect.keys(name).into_iter().map(|(time, value)| (time, value[0])).collect()
}

fn all_marks(effect: &Effect) -> [Vec<(f64, f64)>; 4] {
    ["keyMarks", "lostMarks", "doubtfulMarks", "hiddenMarks"].map(|name| marks(effect, name))
}

/// Draws the overlay's lines, letters included, into a picture in the folder of the tests' files, to look at.
fn photograph(effect: &mut Effect, time: f64, name: &str) {
    const ZOOM: f32 = 12.0;
    assert_eq!(effect.overlay(DRAW, false, time, [0.0; 2], 1.0 / f64::from(ZOOM)), OK);
    let mut shown = Pixmap::new(64 * ZOOM as u32, HEIGHT as u32 * ZOOM as u32).unwrap();
    shown.fill(Color::WHITE);
    lay_lines(effect, &mut shown, ZOOM);
    shown.save_png(Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("standing-{name}.png"))).unwrap();
}

#[test]
fn lost_doubtful_and_hidden_parts_are_marked_and_named_in_the_viewer() {
    let host = host();
    let mut effect = node(&host, &document());
    photograph(&mut effect, 2.0, "frame");
    for draw_suite in [false, true] {
        assert_eq!(effect.overlay(DRAW, draw_suite, 2.0, [0.0; 2], 0.1), OK);
        let (lines, colours) = (effect.drawn(), effect.drawn_colours());
        let outline = |part: usize| {
            let points: Vec<Point> = kept(&effect).scene.parts[part].points_at(2).cloned().unwrap_or_default();
            points.into_iter().map(|p| [p.x, HEIGHT as f64 - p.y]).collect::<Vec<_>>()
        };
        let of = |part: usize| {
            let wanted = outline(part);
            let same = |points: &[[f64; 2]]| {
                points.len() == wanted.len()
                    && points.iter().zip(&wanted).all(|(a, b)| (a[0] - b[0]).hypot(a[1] - b[1]) < 1e-3)
            };
            let own = lines.iter().zip(&colours).filter(|((_, points), _)| same(points));
            own.map(|(_, [r, g, b, _, width])| ([*r, *g, *b], *width)).collect::<Vec<_>>()
        };
        let (star, drop) = (of(0), of(1));
        assert!(star[0].0 == [0.0; 3] && star[1].0 == RED && star[0].1 > star[1].1, "{star:?}");
        assert!(drop[1].0 == AMBER && drop[2].0 != AMBER && drop[1].1 > drop[2].1, "{drop:?}");
        assert_eq!(of(2).len(), 0, "a hidden part has no contour");
    }
    let texts = effect.texts();
    for text in [
        "Lost: star",
        "Doubtful: drop",
        "Hidden: ground line",
        "star (lost)",
        "drop (doubtful)",
        "ground line (hidden)",
    ] {
        assert!(texts.iter().any(|own| own == text), "{text}: {texts:?}");
    }
    // On a key nothing is in doubt.
    assert_eq!(effect.overlay(DRAW, true, 4.0, [0.0; 2], 0.1), OK);
    assert!(effect.texts().iter().all(|text| !text.contains("ost") && !text.contains("idden")), "{:?}", effect.texts());
    clean(&host);
}

#[test]
fn a_part_that_was_lost_beyond_its_only_key_is_named_where_it_has_no_shape() {
    let host = host();
    let mut document = document();
    let star = &mut document.scene.parts[0];
    star.keys.remove(&4);
    star.tracks.retain(|frame, _| *frame < 3);
    star.confidence.clear();
    star.wants_key = vec![3];
    let mut effect = node(&host, &document);
    assert_eq!(effect.overlay(DRAW, true, 4.0, [0.0; 2], 0.1), OK);
    assert!(effect.texts().iter().any(|text| text == "Lost: star"), "{:?}", effect.texts());
    assert!(effect.drawn_colours().iter().filter(|line| line[..3] == RED).count() > 20, "dashes of the nearest key");
    assert_eq!(marks(&effect, "lostMarks"), [(2.0, 0.0), (3.0, 1.0), (4.0, 1.0), (5.0, 0.0)]);
    clean(&host);
}

#[test]
fn the_timeline_has_keys_on_key_frames_and_at_the_borders_of_stretches() {
    let host = host();
    let mut effect = node(&host, &document());
    let expected = [
        vec![(0.0, 3.0), (4.0, 3.0)],
        vec![(0.0, 0.0), (1.0, 1.0), (2.0, 1.0), (3.0, 0.0)],
        vec![(1.0, 0.0), (2.0, 1.0), (3.0, 0.0)],
        vec![(1.0, 0.0), (2.0, 1.0), (3.0, 1.0), (4.0, 0.0)],
    ];
    assert_eq!(all_marks(&effect), expected);
    // A picture does not depend on them, and users see them.
    for (property, value) in [("OfxParamPropEvaluateOnChange", "0"), ("OfxParamPropSecret", "0")] {
        assert_eq!(effect.parameter_property("lostMarks", property, 0), value, "{property}");
    }
    // They belong to the edits: one step of the host's undo takes a key and its marks back.
    let document = effect.text("document");
    effect.set_text("part", "star");
    let selected = effect.history().len();
    assert_eq!(effect.press_at("newKey", 2.0), OK, "{:?}", host.messages());
    assert_eq!(effect.history().len(), selected + 1);
    assert_eq!(marks(&effect, "keyMarks"), [(0.0, 3.0), (2.0, 1.0), (4.0, 3.0)]);
    assert_eq!(marks(&effect, "lostMarks"), [(0.0, 0.0), (1.0, 1.0), (2.0, 0.0)]);
    effect.undo();
    assert!(effect.text("document") == document && all_marks(&effect) == expected);
    // They move with the frame offset, and wrong ones are put right by the next edit.
    effect.set("frameOffset", &[1000.0]);
    assert_eq!(marks(&effect, "keyMarks"), [(1000.0, 3.0), (1004.0, 3.0)]);
    effect.set_at("keyMarks", 1002.0, &[7.0]);
    assert_eq!(effect.press_at("newKey", 1001.0), OK, "{:?}", host.messages());
    assert_eq!(marks(&effect, "keyMarks"), [(1000.0, 3.0), (1001.0, 1.0), (1004.0, 3.0)]);
    clean(&host);
}

#[test]
fn buttons_go_to_lost_frames_and_to_the_weakest() {
    let mut host = host();
    let mut effect = node(&host, &document());
    effect.set("frameOffset", &[100.0]);
    assert_eq!((effect.gone_to(), effect.press_at("nextLost", 100.0)), (None, OK.into()));
    assert_eq!(effect.gone_to(), Some(101.0));
    assert_eq!((effect.press_at("previousLost", 104.0), effect.gone_to()), (OK.into(), Some(101.0)));
    assert_eq!((effect.press_at("weakest", 104.0), effect.gone_to()), (OK.into(), Some(102.0)));
    assert_eq!(effect.press_at("nextLost", 101.0), FAILED);
    assert!(host.messages().iter().any(|text| text.contains("no part begins to be lost after frame 101")));
    // Parts that are not among Parts are not visited.
    effect.set_text("parts", "drop");
    assert_eq!(effect.press_at("nextLost", 100.0), FAILED);
    let _ = (host.messages(), host.errors());
    drop(effect);
    // A host without the suite is told where to go.
    host.configure(&Settings { missing_suites: vec!["OfxTimeLineSuite".into()], ..Settings::default() });
    host.reload(bundles());
    let mut effect = node(&host, &document());
    assert_eq!(effect.press_at("nextLost", 0.0), FAILED);
    assert!(host.messages().iter().any(|text| text.contains("the frame is 1: this host")));
}

#[test]
fn parts_are_hidden_and_shown_again_with_a_button() {
    let host = host();
    let mut effect = node(&host, &document());
    effect.set_text("part", "star");
    let before = effect.text("document");
    assert_eq!(effect.press_at("hideStretch", 2.0), OK, "{:?}", host.messages());
    assert_eq!(kept(&effect).scene.parts[0].absent, [[1, 2]]);
    assert!(marks(&effect, "lostMarks").is_empty() && marks(&effect, "hiddenMarks").contains(&(2.0, 2.0)));
    assert_eq!(effect.press_at("hideHere", 2.0), OK);
    assert_eq!(kept(&effect).scene.parts[0].absent, [[1, 1]]);
    assert_eq!((effect.press_at("hideHere", 4.0), effect.press_at("hideStretch", 3.0)), (FAILED.into(), FAILED.into()));
    let told = host.messages().join("\n");
    assert!(told.contains("has a key on frame 4") && told.contains("neither lost nor hidden"), "{told}");
    effect.undo();
    effect.undo();
    assert!(effect.text("document") == before);
}
