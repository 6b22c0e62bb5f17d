//! Tests of the contours over the viewer and of dragging control points.

use crate::common::{FILTER, HEIGHT, OK, bundles, clean, effect, host, kept, scene};
use rototoon::geometry::Point;
use rototoon_ofx_host::{ClipSettings, Effect, Settings};

const DRAW: &str = "OfxInteractActionDraw";
const DOWN: &str = "OfxInteractActionPenDown";
const MOVE: &str = "OfxInteractActionPenMotion";
const UP: &str = "OfxInteractActionPenUp";
const NOT_OURS: &str = "kOfxStatReplyDefault";

fn shown(p: Point) -> [f64; 2] {
    [p.x, HEIGHT as f64 - p.y]
}

fn near(a: [f64; 2], b: [f64; 2]) -> bool {
    (a[0] - b[0]).abs() + (a[1] - b[1]).abs() < 1e-6
}

#[test]
fn contours_and_points_are_drawn_where_they_are() {
    let host = host();
    let mut effect = effect(&host, FILTER, &ClipSettings::default());
    let scene = scene();
    for draw_suite in [false, true] {
        assert_eq!(effect.overlay(DRAW, draw_suite, 2.0, [0.0; 2], 0.5), OK);
        let lines = effect.drawn();
        // Each part has an outline and a square for each of its points, the farthest part first.
        let points: usize = scene.parts.iter().map(|part| part.tracks[&2].len()).sum();
        assert_eq!(lines.len(), 3 + points, "{draw_suite}");
        let ground: Vec<[f64; 2]> = scene.parts[2].tracks[&2].iter().map(|&p| shown(p)).collect();
        assert!(!lines[0].0 && lines[0].1.iter().zip(&ground).all(|(a, b)| near(*a, *b)), "{:?}", lines[0]);
        assert!(lines[1].0 && near(lines[1].1[0], [ground[0][0] - 1.5, ground[0][1] - 1.5]));
        // Between frames there are contours, but no control points.
        assert_eq!(effect.overlay(DRAW, draw_suite, 2.5, [0.0; 2], 0.5), OK);
        assert_eq!(effect.drawn().len(), 3);
        assert_eq!(effect.overlay(DRAW, draw_suite, 40.0, [0.0; 2], 0.5), OK);
        assert_eq!(effect.drawn().len(), 0);
    }
    clean(&host);
}

fn drag(effect: &mut Effect, time: f64, from: Point, to: Point) -> [String; 3] {
    let [from, to] = [shown(from), shown(to)];
    let aside = [from[0] + 1.0, from[1] - 1.0];
    [effect.overlay(DOWN, true, time, aside, 0.5), effect.overlay(MOVE, true, time, aside, 0.5), {
        assert_eq!(effect.overlay(DRAW, true, time, to, 0.5), OK);
        effect.overlay(UP, true, time, to, 0.5)
    }]
}

#[test]
fn a_drag_moves_a_key_or_makes_a_pin() {
    let host = host();
    let mut effect = effect(&host, FILTER, &ClipSettings::default());
    let before = scene();
    for frame in [4, 2] {
        let from = before.parts[1].tracks[&frame][1];
        let to = Point::new(60.0, 10.0);
        assert_eq!(drag(&mut effect, f64::from(frame), from, to), [OK; 3], "{:?}", host.messages());
    }
    let after = kept(&effect).scene;
    let (part, was) = (&after.parts[1], &before.parts[1]);
    let to = Point::new(60.0, 10.0);
    assert_eq!((part.keys[&4][1], part.tracks[&4][1], part.keys[&4][0]), (to, to, was.keys[&4][0]));
    assert_eq!((part.pins[&2][&1], part.tracks[&2][1], part.pins.len()), (to, to, 1));
    assert_eq!((part.keys.len(), &after.parts[0]), (2, &before.parts[0]));
    clean(&host);
}

#[test]
fn pen_events_off_the_points_are_left_to_the_host() {
    let host = host();
    let mut effect = effect(&host, FILTER, &ClipSettings::default());
    let before = effect.text("document");
    for action in [DOWN, MOVE, UP] {
        assert_eq!(effect.overlay(action, false, 2.0, [1.0, 1.0], 0.1), NOT_OURS, "{action}");
    }
    // Pen down and up in one place moves nothing.
    let at = scene().parts[0].tracks[&2][3];
    assert_eq!(effect.overlay(DOWN, false, 2.0, shown(at), 0.1), OK);
    assert_eq!(effect.overlay(UP, false, 2.0, shown(at), 0.1), OK);
    assert_eq!(effect.text("document"), before);
    effect.set_text("document", "nonsense");
    for action in [DRAW, DOWN, MOVE, UP, "OfxInteractActionKeyDown"] {
        assert_eq!(effect.overlay(action, true, 2.0, shown(at), 0.1), NOT_OURS, "{action}");
    }
    clean(&host);
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
