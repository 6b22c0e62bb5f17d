//! *Live*: edits that are tracked at once, on the frames that the last Track has left in memory.

use crate::buttons::{HEIGHT, LAST, WIDTH, drawing, tracked};
use crate::common::{MATTE, OK, clean, host, kept, p};
use rototoon::geometry::Point;
use rototoon_ofx_host::{Bounds, ClipSettings, Effect, Host, Meanwhile, Settings};

const DOWN: &str = "OfxInteractActionPenDown";
const MOVE: &str = "OfxInteractActionPenMotion";
const UP: &str = "OfxInteractActionPenUp";
/// The symbol of the left Shift key.
const SHIFT: i32 = 0xffe1;
const WHOLE: Bounds = Bounds { x1: 0, y1: 0, x2: WIDTH as i32, y2: HEIGHT as i32 };

fn place(p: Point) -> [f64; 2] {
    [p.x, HEIGHT as f64 - p.y]
}

/// Drags a point of a frame. On tracked frames this makes a pin, on a key frame it changes the key.
fn drag(effect: &mut Effect, frame: i32, point: usize, by: Point) {
    let from = kept(effect).scene.parts[0].tracks[&frame][point];
    for (action, at) in [(DOWN, from), (MOVE, from + by), (UP, from + by)] {
        assert_eq!(effect.overlay(action, true, f64::from(101 + frame), place(at), 0.1), OK);
    }
}

/// Drags the second point of frame 2 by a few pixels.
fn correct(effect: &mut Effect) {
    drag(effect, 2, 1, p(3.0, 2.0));
}

/// Whether the overlay says that tracks are old.
fn is_old(effect: &mut Effect) -> bool {
    assert_eq!(effect.overlay("OfxInteractActionDraw", true, 103.0, [0.0; 2], 0.1), OK);
    effect.texts().iter().any(|text| text.contains("track again"))
}

/// An instance with Live on, tracked once.
fn live(host: &Host) -> Effect<'_> {
    let mut effect = tracked(host, false);
    effect.set("live", &[1.0]);
    assert_eq!(effect.press("track"), OK, "{:?}", host.messages());
    assert!(!is_old(&mut effect));
    effect
}

/// Whether a correction is followed at once.
fn follows(effect: &mut Effect) -> bool {
    correct(effect);
    !is_old(effect)
}

#[test]
fn an_edit_is_followed_at_once_without_asking_for_images() {
    let host = host();
    let mut results = Vec::new();
    for live in [false, true] {
        let mut effect = tracked(&host, false);
        effect.set("live", &[f64::from(u8::from(live))]);
        assert_eq!(effect.press("track"), OK, "{:?}", host.messages());
        let (before, steps) = ((effect.text("document"), effect.text("state")), effect.history().len());
        host.configure(&Settings { no_images: true, ..Settings::default() });
        correct(&mut effect);
        assert_eq!(is_old(&mut effect), !live);
        host.configure(&Settings::default());
        if live {
            // The drag is one step, or two with the choice of the part.
            let labels = effect.history();
            assert_eq!(labels[steps..].iter().filter(|label| *label == "Move points").count(), 1, "{labels:?}");
            assert!(!labels[steps..].iter().any(|label| label == "Track"), "{labels:?}");
            results.push(effect.text("document"));
            while effect.history().len() > steps {
                effect.undo();
            }
            assert!((effect.text("document"), effect.text("state")) == before);
            // A cancelled one keeps the edit, and says that the tracks are old.
            host.configure(&Settings { cancel_after: 0, ..Settings::default() });
            correct(&mut effect);
            assert!(kept(&effect).scene.parts[0].pins.contains_key(&2) && is_old(&mut effect));
            host.configure(&Settings::default());
            // Without frames in memory nothing is followed.
            assert_eq!((effect.press("track").as_str(), effect.action("OfxActionPurgeCaches").as_str()), (OK, OK));
            assert!(!follows(&mut effect));
        } else {
            assert_eq!(effect.press("track"), OK);
            results.push(effect.text("document"));
        }
        clean(&host);
    }
    assert!(results[0] == results[1], "the tracks are those of Track");
}

#[test]
fn a_row_of_edits_gives_the_tracks_of_a_complete_track_and_undo_gives_back_each() {
    let host = host();
    let mut effect = live(&host);
    let mut documents = vec![(effect.history().len(), effect.text("document"), effect.text("state"))];
    // A pin, another one on the same frame, a key that changes, a new key, and a point that goes back.
    let edits: [&dyn Fn(&mut Effect); 5] = [
        &|effect| drag(effect, 2, 1, p(3.0, 2.0)),
        &|effect| drag(effect, 2, 4, p(-2.0, 3.0)),
        &|effect| drag(effect, LAST, 0, p(1.0, -2.0)),
        &|effect| assert_eq!(effect.press_at("newKey", 104.0), OK),
        &|effect| drag(effect, 1, 3, p(2.0, 2.0)),
    ];
    host.configure(&Settings { no_images: true, ..Settings::default() });
    for edit in edits {
        edit(&mut effect);
        assert!(!is_old(&mut effect), "{:?}", host.messages());
        documents.push((effect.history().len(), effect.text("document"), effect.text("state")));
    }
    host.configure(&Settings::default());
    let (_, last, _) = documents.pop().unwrap();
    for (steps, document, state) in documents.iter().rev() {
        while effect.history().len() > *steps {
            effect.undo();
        }
        assert!((effect.text("document"), effect.text("state")) == (document.clone(), state.clone()), "{steps}");
        assert!(!is_old(&mut effect));
    }
    drop(effect);
    for followed in documents.into_iter().map(|(_, document, _)| document).chain([last]) {
        let mut other = tracked(&host, false);
        other.set_text("document", &followed);
        assert_eq!(other.press("track"), OK, "{:?}", host.messages());
        assert!(other.text("document") == followed, "the tracks are those of Track");
    }
    clean(&host);
}

/// A drawing of which one pixel inside the shape has another colour.
fn touched_up(frame: i32) -> Vec<f32> {
    let mut pixels = drawing(frame);
    pixels[4 * (HEIGHT / 2 * WIDTH + WIDTH / 2 - 20)] += 0.01;
    pixels
}

fn render(effect: &mut Effect, time: f64, window: Bounds, scale: f64, rows: i32) {
    assert_eq!(effect.render(time, window, scale, 1, rows), OK);
}

#[test]
fn a_source_that_has_changed_without_a_word_is_noticed_where_it_is_drawn() {
    let host = host();
    // All rows at once, tiles of rows, and a tile around the change.
    for (window, rows) in [(WHOLE, 0), (WHOLE, 7), (Bounds { x1: 30, y1: 50, x2: 70, y2: 70 }, 0)] {
        let mut effect = live(&host);
        // What has not changed, is smaller, or is not drawn with the source is no reason.
        (0..=LAST).for_each(|frame| render(&mut effect, f64::from(101 + frame), window, 1.0, rows));
        assert!(follows(&mut effect), "{:?}", host.messages());
        effect.set_frame("Source", 102.0, WIDTH, &touched_up(1));
        render(&mut effect, 102.0, Bounds { x1: 0, y1: 0, x2: WIDTH as i32 / 2, y2: HEIGHT as i32 / 2 }, 0.5, 0);
        effect.set("output", &[MATTE]);
        render(&mut effect, 102.0, WHOLE, 1.0, 0);
        effect.set("output", &[0.0]);
        render(&mut effect, 103.0, WHOLE, 1.0, 0);
        assert!(!is_old(&mut effect) && host.messages().is_empty());
        let fresh = (effect.history().len(), effect.text("document"));

        render(&mut effect, 102.0, window, 1.0, rows);
        assert!(is_old(&mut effect));
        let told = host.messages();
        assert!(told.len() == 1 && told[0].contains("frame 102 of Source has changed"), "{told:?}");
        assert!(!follows(&mut effect), "the frames were dropped");
        while effect.history().len() > fresh.0 {
            effect.undo();
        }
        assert!(
            effect.text("document") == fresh.1 && is_old(&mut effect),
            "its tracks are still those of the old source"
        );

        assert_eq!(effect.press("track"), OK);
        assert!(!is_old(&mut effect));
        (0..=LAST).for_each(|frame| render(&mut effect, f64::from(101 + frame), window, 1.0, rows));
        assert!(follows(&mut effect), "{:?}", host.messages());
        clean(&host);
    }
}

#[test]
fn that_the_source_has_changed_is_kept_with_the_next_edit() {
    let host = host();
    let mut effect = live(&host);
    effect.set_frame("Source", 102.0, WIDTH, &touched_up(1));
    render(&mut effect, 102.0, WHOLE, 1.0, 0);
    assert_eq!(effect.press_at("newPart", 103.0), OK);
    correct(&mut effect);
    let saved = (effect.text("document"), effect.text("state"));
    drop(effect);
    let mut opened = tracked(&host, false);
    opened.set_text_silently("document", &saved.0);
    opened.set_text_silently("state", &saved.1);
    assert!(is_old(&mut opened));
    // Without the correction there is still the source.
    let mut document = kept(&opened);
    document.scene.parts[0].pins.clear();
    opened.set_text_silently("document", &document.to_json());
    assert!(is_old(&mut opened));
    clean(&host);
}

#[test]
fn a_source_in_another_format_is_not_compared() {
    let host = host();
    let mut effect = live(&host);
    let bytes = ClipSettings {
        depth: "OfxBitDepthByte".into(),
        x2: WIDTH as i32,
        y2: HEIGHT as i32,
        first: 101.0,
        last: 101.0 + f64::from(LAST),
        ..ClipSettings::default()
    };
    effect.set_clip("Source", &bytes);
    effect.set_clip("Output", &bytes);
    effect.preferences();
    effect.set_frame("Source", 102.0, WIDTH, &touched_up(1));
    render(&mut effect, 102.0, WHOLE, 1.0, 0);
    assert!(!is_old(&mut effect) && follows(&mut effect), "{:?}", host.messages());
    clean(&host);
}

#[test]
fn a_source_that_changes_while_an_edit_is_followed_is_noticed() {
    let host = host();
    for told in [false, true] {
        let mut effect = live(&host);
        let pixels = touched_up(1);
        if told {
            effect.meanwhile(Meanwhile::Clip("Source"));
        } else {
            effect.meanwhile(Meanwhile::Frame("Source", 102.0, WIDTH, &pixels));
            effect.meanwhile(Meanwhile::Render(102.0, WHOLE));
        }
        correct(&mut effect);
        assert_eq!(effect.meanwhile_statuses().len(), if told { 1 } else { 2 });
        assert!(kept(&effect).scene.parts[0].pins.contains_key(&2) && is_old(&mut effect), "{told}");
        clean(&host);
    }
}

#[test]
fn events_while_an_edit_is_followed_lose_nothing() {
    let host = host();
    let mut effect = live(&host);
    effect.set_text("part", "blob");
    effect.overlay_key("OfxInteractActionKeyDown", 104.0, SHIFT);
    let at = place(kept(&effect).scene.parts[0].tracks[&2][4]);
    // The pen draws, presses buttons and changes numbers while the progress is shown.
    for event in [
        Meanwhile::Pen(DOWN, 103.0, at, 0.1),
        Meanwhile::Pen(UP, 103.0, at, 0.1),
        Meanwhile::Key("OfxInteractActionKeyUp", 103.0, SHIFT),
        Meanwhile::Press("track"),
        Meanwhile::Press("newKey"),
        Meanwhile::Press("load"),
        Meanwhile::Set("partOpacity", &[0.25]),
        Meanwhile::Set("feather", &[3.0]),
    ] {
        effect.meanwhile(event);
    }
    assert_eq!(effect.press_at("newKey", 104.0), OK);
    let statuses = effect.meanwhile_statuses();
    let refused = statuses.iter().filter(|status| *status == "kOfxStatFailed").count();
    assert_eq!((statuses.len(), refused), (8, 3), "{statuses:?}");
    let told = host.messages();
    assert!(told.len() == 3 && told.iter().all(|text| text.contains("the node is tracking")), "{told:?}");
    let _ = host.errors();

    assert!(!is_old(&mut effect), "the edit was followed all the same");
    let part = &kept(&effect).scene.parts[0];
    assert!(part.pins.is_empty() && part.keys.len() == 3, "the pen and the buttons changed no shape");
    assert_eq!(effect.get("feather", 0.0), [3.0]);
    // The part's opacity has been put away with the part.
    effect.set_text("part", "");
    effect.set_text("part", "blob");
    assert_eq!(effect.get("partOpacity", 0.0), [0.25]);
    // Shift was released: with it, the pen would only add to the selection.
    correct(&mut effect);
    assert_eq!(kept(&effect).scene.parts[0].pins[&2].len(), 1);
    clean(&host);
}

#[test]
fn shapes_that_change_while_they_are_tracked_are_not_overwritten() {
    let host = host();
    let mut effect = tracked(&host, false);
    let mut other = crate::buttons::keyed();
    other.scene.parts[0].name = "other".into();
    let text = other.to_json();
    effect.meanwhile(Meanwhile::Press("newKey"));
    effect.meanwhile(Meanwhile::Text("document", &text));
    assert_eq!(effect.press_at("track", 101.0), "kOfxStatFailed");
    assert!(effect.text("document") == text);
    let told = host.messages();
    assert!(told.len() == 2 && told[0].contains("is tracking") && told[1].contains("track again"), "{told:?}");
    let _ = host.errors();
    assert_eq!(effect.press("track"), OK);
    clean(&host);
}

#[test]
fn a_source_that_changes_while_it_is_tracked_leaves_no_frames() {
    let host = host();
    let mut effect = tracked(&host, false);
    effect.set("live", &[1.0]);
    effect.meanwhile(Meanwhile::Clip("Source"));
    assert_eq!(effect.press("track"), OK);
    assert!(!follows(&mut effect));
    assert_eq!(effect.press("track"), OK);
    assert!(follows(&mut effect));
    clean(&host);
}

#[test]
fn frames_that_need_more_memory_than_allowed_do_not_stay() {
    let host = host();
    let frames = f64::from(LAST + 1);
    let needed = frames * (WIDTH * HEIGHT * 12) as f64 / f64::from(1 << 30);
    for (memory, stays) in [(0.0, false), (0.999 * needed, false), (needed, true), (1.0, true)] {
        let mut effect = tracked(&host, false);
        effect.set("live", &[1.0]);
        effect.set("liveMemory", &[memory]);
        assert_eq!(effect.press("track"), OK);
        assert_eq!(follows(&mut effect), stays, "{memory}");
        clean(&host);
    }
}

#[test]
fn without_a_progress_display_edits_wait_for_track() {
    let host = host();
    let settings = Settings { missing_suites: vec!["OfxProgressSuite".into()], ..Settings::default() };
    host.configure(&settings);
    let mut host = host;
    host.reload(crate::common::bundles());
    let mut effect = live(&host);
    assert!(!follows(&mut effect), "nobody could cancel it");
    assert_eq!(effect.press("track"), OK);
    assert!(!is_old(&mut effect));
    drop(effect);
    host.configure(&Settings::default());
    host.reload(crate::common::bundles());
    let mut effect = live(&host);
    assert!(follows(&mut effect));
    clean(&host);
}
