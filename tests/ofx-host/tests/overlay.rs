//! Tests of the pen in the viewer: drawing, selecting, correcting, and the host's undo.

use crate::common::{FILTER, HEIGHT, OK, bundles, clean, effect, host, kept, scene};
use rototoon::geometry::Point;
use rototoon::project::Document;
use rototoon_ofx_host::{ClipSettings, Effect, Settings};

const DRAW: &str = "OfxInteractActionDraw";
const DOWN: &str = "OfxInteractActionPenDown";
const MOVE: &str = "OfxInteractActionPenMotion";
const UP: &str = "OfxInteractActionPenUp";
const KEY: &str = "OfxInteractActionKeyDown";
const NOT_OURS: &str = "kOfxStatReplyDefault";
/// Indices of the parameter Tool.
const CONTOUR: f64 = 1.0;
const FREEHAND: f64 = 2.0;
const OFF: f64 = 3.0;
const DELETE: i32 = 0xffff;
const ENTER: i32 = 0xff0d;
const BACK: i32 = 0xff08;

fn shown(p: Point) -> [f64; 2] {
    [p.x, HEIGHT as f64 - p.y]
}

fn near(a: [f64; 2], b: [f64; 2]) -> bool {
    (a[0] - b[0]).abs() + (a[1] - b[1]).abs() < 1e-6
}

/// The drawn lines without those that letters are made of: single horizontal ones.
fn without_letters(effect: &Effect) -> Vec<(bool, Vec<[f64; 2]>)> {
    let mut lines = effect.drawn();
    lines.retain(|(_, points)| points.len() != 2 || points[0][1] != points[1][1]);
    lines
}

/// Presses the pen at a place and lets it go at another one.
fn drag(effect: &mut Effect, time: f64, from: Point, to: Point) -> [String; 3] {
    let [from, to] = [shown(from), shown(to)];
    [
        effect.overlay(DOWN, true, time, from, 0.1),
        effect.overlay(MOVE, true, time, to, 0.1),
        effect.overlay(UP, true, time, to, 0.1),
    ]
}

#[test]
fn contours_and_points_are_drawn_where_they_are() {
    let host = host();
    let mut effect = effect(&host, FILTER, &ClipSettings::default());
    let scene = scene();
    for draw_suite in [false, true] {
        assert_eq!(effect.overlay(DRAW, draw_suite, 2.0, [0.0; 2], 0.5), OK);
        let lines = without_letters(&effect);
        // Each part has an outline and a square for each of its points, the farthest part first.
        let points: usize = scene.parts.iter().map(|part| part.tracks[&2].len()).sum();
        assert_eq!(lines.len(), 3 + points, "{draw_suite}");
        let ground: Vec<[f64; 2]> = scene.parts[2].tracks[&2].iter().map(|&p| shown(p)).collect();
        assert!(!lines[0].0 && lines[0].1.iter().zip(&ground).all(|(a, b)| near(*a, *b)), "{:?}", lines[0]);
        assert!(lines[1].0 && near(lines[1].1[0], [ground[0][0] - 1.5, ground[0][1] - 1.5]));
        // Each name has a dark copy behind it. OpenGL has no text: there the letters are lines.
        assert_eq!(effect.texts().len(), if draw_suite { 6 } else { 0 });
        assert_eq!(effect.drawn().len() > lines.len() + 100, !draw_suite);
        // A time that is rounded is its frame.
        assert_eq!(effect.overlay(DRAW, draw_suite, 2.000000001, [0.0; 2], 0.5), OK);
        assert_eq!(without_letters(&effect), lines);
        // Between frames there are contours, but no control points.
        assert_eq!(effect.overlay(DRAW, draw_suite, 2.5, [0.0; 2], 0.5), OK);
        assert_eq!(without_letters(&effect).len(), 3);
        // Where a part has no shape, its nearest key is shown, pale.
        assert_eq!(effect.overlay(DRAW, draw_suite, 40.0, [0.0; 2], 0.5), OK);
        assert_eq!(without_letters(&effect).len(), 3);
        assert!(effect.drawn_colours().iter().all(|line| line[3] < 0.5));
    }
    clean(&host);
}

#[test]
fn a_drag_moves_a_key_or_makes_a_pin_or_a_centre_and_undo_gives_back_the_bytes() {
    let host = host();
    let mut effect = effect(&host, FILTER, &ClipSettings::default());
    let before = scene();
    let to = Point::new(60.0, 10.0);
    let mut texts = vec![(effect.text("document"), effect.text("state"))];
    for frame in [4, 2] {
        let from = before.parts[1].tracks[&frame][1];
        assert_eq!(drag(&mut effect, f64::from(frame), from, to), [OK; 3], "{:?}", host.messages());
        texts.push((effect.text("document"), effect.text("state")));
    }
    let after = kept(&effect).scene;
    let (part, was) = (&after.parts[1], &before.parts[1]);
    assert_eq!((part.keys[&4][1], part.tracks[&4][1], part.keys[&4][0]), (to, to, was.keys[&4][0]));
    assert_eq!((part.pins[&2][&1], part.tracks[&2][1], part.pins.len()), (to, to, 1));
    assert_eq!((part.keys.len(), &after.parts[0]), (2, &before.parts[0]));
    // A press on the contour between two points takes the part as a whole.
    let line = &before.parts[2].tracks[&1];
    let half = (line[1] + line[2]) * 0.5;
    assert_eq!(drag(&mut effect, 1.0, half, half + Point::new(-2.0, -3.0)), [OK; 3]);
    let moved = kept(&effect).scene;
    let middle = line.iter().sum::<Point>() / 3.0 + Point::new(-2.0, -3.0);
    assert!(moved.parts[2].centers[&1].distance(middle) < 1e-4 && moved.parts[2].pins.is_empty());
    // A pin of the frame goes along with a part that is moved as a whole.
    let drop = &kept(&effect).scene.parts[1].tracks[&2];
    let (from, by) = ((drop[2] + drop[3]) * 0.5, Point::new(2.0, 1.0));
    assert_eq!(drag(&mut effect, 2.0, from, from + by), [OK; 3]);
    let moved = kept(&effect).scene.parts[1].clone();
    assert!(moved.pins[&2][&1].distance(to + by) < 1e-4 && moved.centers.contains_key(&2), "{:?}", moved.pins);
    effect.undo();
    // The overlay says that the tracks are old.
    assert_eq!(effect.overlay(DRAW, true, 1.0, [0.0; 2], 0.1), OK);
    let old = effect.texts().iter().filter(|text| text.contains("track again")).count();
    assert_eq!(old, 2 * 2, "each with a dark copy: {:?}", effect.texts());
    let steps = effect.history();
    assert_eq!(steps.iter().filter(|label| *label == "Move points").count(), 3, "{steps:?}");
    effect.undo();
    while let Some(wanted) = texts.pop() {
        assert!((effect.text("document"), effect.text("state")) == wanted, "{} steps left", texts.len());
        effect.undo();
    }
    clean(&host);
}

#[test]
fn a_drag_is_one_step_and_none_if_it_moves_nothing() {
    let host = host();
    let mut effect = effect(&host, FILTER, &ClipSettings::default());
    let at = scene().parts[0].tracks[&2][3];
    let before = effect.history().len();
    assert_eq!(effect.overlay(DOWN, true, 2.0, shown(at), 0.1), OK);
    for k in 0..50 {
        assert_eq!(effect.overlay(MOVE, true, 2.0, shown(at + Point::splat(0.1 * f64::from(k))), 0.1), OK);
        assert_eq!(effect.overlay(DRAW, true, 2.0, [0.0; 2], 0.1), OK);
    }
    assert_eq!(effect.history().len(), before, "nothing is stored while the pen is down");
    assert_eq!(effect.overlay(UP, true, 2.0, shown(at + Point::splat(5.0)), 0.1), OK);
    assert_eq!(effect.history().len(), before + 1);
    // A press and release in one place selects the point, and its part.
    let document = effect.text("document");
    let at = scene().parts[1].tracks[&2][3];
    assert_eq!(drag(&mut effect, 2.0, at, at)[2], OK);
    assert_eq!((effect.text("document") == document, effect.text("part").as_str()), (true, "drop"));
    clean(&host);
}

#[test]
fn events_are_left_to_the_host_without_a_tool_and_with_wrong_documents() {
    let host = host();
    let mut effect = effect(&host, FILTER, &ClipSettings::default());
    let at = scene().parts[0].tracks[&2][3];
    effect.set("tool", &[OFF]);
    for action in [DOWN, MOVE, UP] {
        assert_eq!(effect.overlay(action, false, 2.0, shown(at), 0.1), NOT_OURS, "{action}");
    }
    effect.set("tool", &[0.0]);
    // A movement of the pen that is not down is the host's, and so is a key that changes nothing.
    assert_eq!(effect.overlay(MOVE, false, 2.0, shown(at), 0.1), NOT_OURS);
    assert_eq!(effect.overlay_key(KEY, 2.0, DELETE), NOT_OURS);
    effect.set_text("document", "nonsense");
    for action in [DRAW, DOWN, MOVE, UP, KEY] {
        assert_eq!(effect.overlay(action, true, 2.0, shown(at), 0.1), NOT_OURS, "{action}");
    }
    clean(&host);
}

#[test]
fn a_composition_without_a_document_is_drawn_on() {
    let host = host();
    let mut effect = effect(&host, FILTER, &ClipSettings { first: 1001.0, last: 1010.0, ..ClipSettings::default() });
    effect.set_text("document", "");
    effect.set("tool", &[CONTOUR]);
    effect.set_text("part", "größe");
    let corners = [(10.0, 10.0), (40.0, 12.0), (25.0, 40.0)].map(|(x, y)| Point::new(x, y));
    for at in corners {
        assert_eq!(effect.overlay(DOWN, true, 1003.0, shown(at), 0.2), OK, "{:?}", host.messages());
        assert_eq!(effect.overlay(UP, true, 1003.0, shown(at), 0.2), OK);
    }
    assert_eq!(effect.text("document"), "", "an unfinished contour is not stored");
    assert_eq!(effect.overlay(DOWN, true, 1003.0, shown(corners[0]), 0.2), OK);
    let document = kept(&effect);
    let footage = &document.scene.footage;
    assert_eq!((footage.first, footage.last, footage.width, footage.height), (1001, 1010, 64, 48));
    let part = &document.scene.parts[0];
    assert_eq!((part.name.as_str(), part.closed, &part.keys[&1003]), ("größe", true, &corners.to_vec()));
    // Drawn again on another frame it is a key of the same part.
    for at in corners {
        effect.overlay(DOWN, true, 1008.0, shown(at + Point::new(5.0, 3.0)), 0.2);
    }
    assert_eq!(effect.overlay_key(KEY, 1008.0, ENTER), OK);
    let document = kept(&effect);
    assert_eq!((document.scene.parts.len(), document.scene.parts[0].keys.len()), (1, 2));
    // A contour that cannot be, is told and changes nothing.
    effect.overlay(DOWN, true, 1005.0, [10.0, 10.0], 0.2);
    assert_eq!(effect.overlay_key(KEY, 1005.0, ENTER), OK);
    assert!(host.messages().iter().any(|text| text.contains("at least 3")));
    assert!(kept(&effect).scene == document.scene);
    effect.undo();
    effect.undo();
    assert_eq!(effect.text("document"), "");
}

#[test]
fn a_contour_that_is_refused_stays_until_it_can_be_finished() {
    let host = host();
    let mut effect = effect(&host, FILTER, &ClipSettings::default());
    effect.set("tool", &[CONTOUR]);
    effect.set_text("part", "ground line");
    let corners = [(10.0, 10.0), (40.0, 12.0), (25.0, 40.0), (10.0, 10.0)].map(|(x, y)| Point::new(x, y));
    for at in corners {
        assert_eq!(effect.overlay(DOWN, true, 3.0, shown(at), 0.2), OK);
    }
    let told = host.messages();
    assert!(
        told.iter().any(|text| text.contains("is open") && text.contains("press New part; then press Return")),
        "{told:?}"
    );
    assert_eq!(effect.press_at("newPart", 3.0), OK);
    assert_eq!(effect.overlay_key(KEY, 3.0, ENTER), OK);
    assert_eq!(kept(&effect).scene.parts[3].keys[&3], corners[..3]);
    // A point that no document can have is told when the contour is stored. The others are not lost.
    for at in [corners[0], corners[1], Point::new(1e12, 3.0)] {
        assert_eq!(effect.overlay(DOWN, true, 4.0, shown(at), 0.2), OK);
    }
    assert_eq!(effect.overlay_key(KEY, 4.0, ENTER), "kOfxStatFailed");
    let told = host.messages();
    assert!(told.iter().any(|text| text.contains("found [1000000000000")), "{told:?}");
    effect.overlay_key(KEY, 4.0, BACK);
    assert_eq!(effect.overlay(DOWN, true, 4.0, shown(corners[2]), 0.2), OK);
    assert_eq!(effect.overlay_key(KEY, 4.0, ENTER), OK, "{:?}", host.messages());
    assert_eq!(kept(&effect).scene.parts[4].keys[&4], corners[..3]);
}

#[test]
fn a_new_part_is_shown_although_parts_names_others() {
    let host = host();
    let mut effect = effect(&host, FILTER, &ClipSettings::default());
    effect.set("tool", &[CONTOUR]);
    let corners = [(10.0, 10.0), (40.0, 12.0), (25.0, 40.0), (10.0, 10.0)].map(|(x, y)| Point::new(x, y));
    for (parts, name, after) in
        [("star, gr*", "", "star, gr*, part 1"), ("star,", "arm", "star, arm"), ("", "leg", ""), ("l*", "leg 2", "l*")]
    {
        effect.set_text("parts", parts);
        effect.set_text("part", name);
        for at in corners {
            assert_eq!(effect.overlay(DOWN, true, 3.0, shown(at), 0.2), OK);
        }
        assert_eq!(effect.text("parts"), after);
        // It can be picked, and it is a step of undo with its name in the list.
        effect.overlay(DRAW, true, 3.0, [0.0; 2], 0.1);
        assert!(effect.drawn().iter().any(|(closed, line)| *closed && near(line[0], shown(corners[0]))));
    }
    (0..3).for_each(|_| effect.undo());
    assert_eq!((kept(&effect).scene.parts.len(), host.messages()), (4, Vec::new()));
}

/// Places of the handles around the selection: first that which rotates, then from the upper left corner clockwise.
fn handles(effect: &mut Effect, time: f64) -> Vec<Point> {
    assert_eq!(effect.overlay(DRAW, true, time, [0.0; 2], 0.1), OK);
    let yellow = |colour: &[f32; 5]| colour[..3] == [1.0, 0.85, 0.2];
    let lines = effect.drawn().into_iter().zip(effect.drawn_colours());
    let squares =
        lines.filter(|((closed, points), colour)| *closed && yellow(colour) && points[1][0] - points[0][0] < 1.0);
    let middle = |points: Vec<[f64; 2]>| {
        let [x, y] = [0, 1].map(|axis| points.iter().map(|p| p[axis]).sum::<f64>() / 4.0);
        Point::new(x, HEIGHT as f64 - y)
    };
    squares.map(|((_, points), _)| middle(points)).collect()
}

fn reach(points: &[Point]) -> [Point; 2] {
    [points.iter().copied().fold(Point::MAX, Point::min), points.iter().copied().fold(Point::MIN, Point::max)]
}

#[test]
fn a_freehand_stroke_is_a_contour_and_handles_scale_and_rotate_it() {
    let host = host();
    let mut effect = effect(&host, FILTER, &ClipSettings::default());
    effect.set("tool", &[FREEHAND]);
    effect.set_text("part", "egg");
    let on = |k: i32| {
        Point::new(30.0, 24.0) + Point::from_angle(std::f64::consts::TAU * f64::from(k) / 90.0) * Point::new(12.0, 8.0)
    };
    assert_eq!(effect.overlay(DOWN, true, 3.0, shown(on(0)), 0.1), OK);
    for k in 1..90 {
        assert_eq!(effect.overlay(MOVE, true, 3.0, shown(on(k)), 0.1), OK);
    }
    assert_eq!(effect.overlay(UP, true, 3.0, shown(on(90)), 0.1), OK, "{:?}", host.messages());
    let egg = |effect: &Effect| kept(effect).scene.parts[3].keys[&3].clone();
    let drawn = egg(&effect);
    assert!((6..60).contains(&drawn.len()), "{}", drawn.len());
    let off = |p: &Point| (((*p - Point::new(30.0, 24.0)) / Point::new(12.0, 8.0)).length() - 1.0).abs();
    assert!(drawn.iter().map(off).fold(0.0, f64::max) < 0.05);
    // The upper right corner scales about the lower left one.
    effect.set("tool", &[0.0]);
    let places = handles(&mut effect, 3.0);
    assert_eq!(places.len(), 9);
    assert_eq!(drag(&mut effect, 3.0, places[3], places[3] + Point::new(6.0, -4.0)), [OK; 3]);
    let ([least, most], [low, high]) = (reach(&egg(&effect)), reach(&drawn));
    let kept_corner = (least.x - low.x).abs() + (most.y - high.y).abs();
    assert!(
        kept_corner < 1e-3 && (most.x - high.x - 6.0).abs() < 0.8 && (low.y - least.y - 4.0).abs() < 0.8,
        "{least} {most}"
    );
    // A quarter of a turn with the handle above: width and height change places.
    let (before, places) = (egg(&effect), handles(&mut effect, 3.0));
    let middle = (places[1] + places[5]) * 0.5;
    let arm = middle.y - places[0].y;
    assert_eq!(drag(&mut effect, 3.0, places[0], middle + Point::new(arm, 0.0)), [OK; 3]);
    let size = |points: &[Point]| reach(points)[1] - reach(points)[0];
    let (was, now) = (size(&before), size(&egg(&effect)));
    assert!((was.x - now.y).abs() + (was.y - now.x).abs() < 1e-2, "{was} {now}");
    let labels = effect.history();
    assert_eq!(labels.iter().filter(|label| *label == "Transform points").count(), 2, "{labels:?}");
    effect.undo();
    assert_eq!(egg(&effect), before);
    clean(&host);
}

#[test]
fn buttons_make_and_delete_keys_points_and_parts() {
    let host = host();
    let mut effect = effect(&host, FILTER, &ClipSettings::default());
    let was = scene();
    assert_eq!(effect.press_at("newKey", 2.0), OK, "{:?}", host.messages());
    let all = kept(&effect).scene;
    assert!(all.parts.iter().zip(&was.parts).all(|(now, was)| now.keys[&2] == was.tracks[&2]));
    effect.set_text("part", "star");
    assert_eq!(effect.press_at("deleteKey", 2.0), OK);
    assert_eq!(kept(&effect).scene.parts.iter().map(|part| part.keys.len()).collect::<Vec<_>>(), [2, 3, 3]);
    assert_eq!(effect.press_at("deleteKey", 2.0), "kOfxStatFailed");
    assert!(host.messages().iter().any(|text| text.contains("\"star\" has no key on frame 2")));
    // Points are selected with a box.
    drag(&mut effect, 2.0, Point::new(61.0, 30.0), Point::new(45.0, 10.0));
    assert_eq!(effect.press_at("insertPoints", 2.0), "kOfxStatFailed");
    drag(&mut effect, 2.0, Point::new(63.0, 46.0), Point::new(47.0, 5.0));
    let count = |effect: &Effect| kept(effect).scene.parts[1].point_count();
    assert_eq!((effect.press_at("smoothPoints", 2.0).as_str(), count(&effect)), (OK, 4), "{:?}", host.messages());
    assert_eq!((effect.press_at("insertPoints", 2.0).as_str(), count(&effect)), (OK, 5));
    assert_eq!((effect.press_at("deletePoints", 2.0).as_str(), count(&effect)), (OK, 4));
    assert_eq!(effect.press_at("deletePoints", 2.0), "kOfxStatFailed");
    effect.set_text("part", "star");
    // Its points are selected too.
    assert_eq!((effect.press("nextPart"), effect.press("previousPart")), (OK.into(), OK.into()));
    assert_eq!(effect.press_at("deletePart", 2.0), OK);
    assert_eq!((kept(&effect).scene.parts.len(), effect.text("part").as_str()), (2, ""));
    // The part that has its place now is not selected.
    assert_eq!(effect.overlay_key(KEY, 2.0, DELETE), NOT_OURS);
    assert_eq!(kept(&effect).scene.parts.len(), 2);
    effect.undo();
    assert_eq!((kept(&effect).scene.parts.len(), effect.text("part").as_str()), (3, "star"));
    assert_eq!(effect.press_at("newPart", 2.0), OK);
    assert_eq!(effect.text("part"), "");
}

#[test]
fn locked_parts_are_left_alone() {
    let host = host();
    let mut effect = effect(&host, FILTER, &ClipSettings::default());
    effect.set_text("part", "star");
    effect.set("partLock", &[1.0]);
    let before = effect.text("document");
    let at = scene().parts[0].tracks[&2][0];
    drag(&mut effect, 2.0, at, at + Point::new(3.0, 2.0));
    assert_eq!(effect.press_at("deletePart", 2.0), "kOfxStatFailed");
    // Nor does a contour that is drawn replace its key.
    effect.set("tool", &[FREEHAND]);
    drag(&mut effect, 0.0, at, at + Point::new(3.0, 2.0));
    effect.set("tool", &[0.0]);
    assert!(host.messages().iter().any(|text| text.contains("\"star\" is locked or not among Parts")));
    // The lock belongs to the part, also when another one is selected.
    effect.set_text("part", "drop");
    assert_eq!(effect.get("partLock", 0.0), [0.0]);
    drag(&mut effect, 2.0, at, at + Point::new(3.0, 2.0));
    assert!(effect.text("document") == before);
}

#[test]
fn picking_is_in_screen_pixels() {
    let host = host();
    for (aspect, pixel, off, picked) in [
        (1.0, 0.1, 0.7, true),
        (1.0, 0.1, 0.9, false),
        (2.0, 0.1, 0.35, true),
        (2.0, 0.1, 0.55, false),
        (1.0, 0.5, 3.5, true),
    ] {
        // The render scale of a proxy changes nothing: places are in canonical coordinates.
        for proxy in [1.0, 0.5] {
            let source = ClipSettings { aspect, ..ClipSettings::default() };
            let mut effect = effect(&host, FILTER, &source);
            let p = scene().parts[0].tracks[&2][0];
            // Canonical coordinates have square pixels; the footage's pixels are `aspect` wide.
            let at = [(p.x + off) * aspect, HEIGHT as f64 - p.y];
            let to = [at[0] + 8.0 * pixel, at[1]];
            effect.overlay_at_scale(DOWN, (true, 2.0), at, pixel, proxy);
            effect.overlay_at_scale(UP, (true, 2.0), to, pixel, proxy);
            let text = effect.text("document");
            let json = rototoon_ofx::roto::stored::decode(&text).unwrap();
            let pins = &Document::parse(&json, "kept").unwrap().scene.parts[0].pins;
            assert_eq!(pins.contains_key(&2), picked, "{aspect} {pixel} {off} {proxy}: {pins:?}");
        }
    }
}

#[test]
fn without_the_suites_there_is_no_overlay_and_no_error() {
    let mut host = host();
    host.configure(&Settings { missing_suites: vec!["OfxDrawSuite".into()], ..Settings::default() });
    host.reload(bundles());
    let mut effect = effect(&host, FILTER, &ClipSettings::default());
    assert_eq!(effect.overlay(DRAW, true, 2.0, [0.0; 2], 1.0), "none");
    assert_eq!(effect.overlay(DRAW, false, 2.0, [0.0; 2], 1.0), OK);
    clean(&host);
}
