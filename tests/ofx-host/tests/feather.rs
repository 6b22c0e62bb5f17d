//! Tests of the feather of control points: dragged and typed, in the matte, in the overlay, and taken back.

use crate::common::{
    FILTER, HEIGHT, MATTE, OK, WHOLE, WIDTH, clean, effect, footage, host, kept, lay_lines, p, part, rendered,
};
use rototoon::project::Document;
use rototoon::scene::Scene;
use rototoon_ofx_host::{Bounds, ClipSettings, Effect, Host};
use std::path::Path;
use tiny_skia::{Color, Pixmap};

const DRAW: &str = "OfxInteractActionDraw";
const CONTROL: i32 = 0xffe3;
const FAILED: &str = "kOfxStatFailed";

/// A square from (20, 12) to (44, 36).
fn node(host: &Host) -> Effect<'_> {
    let corners = vec![p(20.0, 12.0), p(44.0, 12.0), p(44.0, 36.0), p(20.0, 36.0)];
    let square = part("square", 0.0, true, |_| corners.clone());
    let mut effect = effect(host, FILTER, &ClipSettings::default());
    effect.set_text("document", &Document::new(Scene { footage: footage(), parts: vec![square] }).to_json());
    effect.set("output", &[MATTE]);
    effect
}

fn drag(effect: &mut Effect, from: [f64; 2], to: [f64; 2]) {
    for (action, at) in
        [("OfxInteractActionPenDown", from), ("OfxInteractActionPenMotion", to), ("OfxInteractActionPenUp", to)]
    {
        assert_eq!(effect.overlay(action, true, 1.0, [at[0], HEIGHT as f64 - at[1]], 0.1), OK);
    }
}

/// The middle row of the matte.
fn row(host: &Host, effect: &mut Effect) -> Vec<f32> {
    let values = rendered(host, effect, 1.0, WHOLE).values;
    (0..WIDTH).map(|x| values[4 * (HEIGHT / 2 * WIDTH + x) + 3]).collect()
}

/// How far right the outer edge goes: the only line with many points.
fn outer_edge(effect: &mut Effect) -> Option<f64> {
    assert_eq!(effect.overlay(DRAW, true, 1.0, [0.0; 2], 0.1), OK);
    let (closed, edge) = effect.drawn().into_iter().find(|(_, points)| points.len() > 50)?;
    assert!(closed);
    edge.into_iter().map(|[x, _]| x).reduce(f64::max)
}

#[test]
fn a_soft_part_whose_depth_is_between_two_others_leaves_no_seam_between_them() {
    let host = host();
    let square = |name: &str, depth: f64, left: f64, right: f64| {
        part(name, depth, true, move |_| vec![p(left, 12.0), p(right, 12.0), p(right, 36.0), p(left, 36.0)])
    };
    let mut parts =
        vec![square("coat", 0.0, 6.0, 18.5), square("shadow", 1.0, 44.0, 56.0), square("leg", 2.0, 18.5, 30.0)];
    parts[1].feather = vec![3.0; 4];
    let mut effect = effect(&host, FILTER, &ClipSettings::default());
    effect.set_text("document", &Document::new(Scene { footage: footage(), parts }).to_json());
    effect.set("output", &[MATTE]);
    let row = row(&host, &mut effect);
    assert!(row[6..30].iter().all(|value| *value > 0.999) && row[42] > 0.0 && row[42] < 1.0, "{row:?}");
}

#[test]
fn a_feather_is_dragged_out_of_points_and_seen_in_the_matte() {
    let host = host();
    let mut effect = node(&host);
    let before = (effect.text("document"), effect.text("state"), effect.history().len());
    assert_eq!(outer_edge(&mut effect), None);
    assert!(row(&host, &mut effect)[..20].iter().all(|value| *value == 0.0));
    // The two corners at the right, one selected with the other.
    drag(&mut effect, [30.0, 5.0], [60.0, 40.0]);
    assert_eq!(effect.overlay_key("OfxInteractActionKeyDown", 1.0, CONTROL), "kOfxStatReplyDefault");
    drag(&mut effect, [44.0, 12.0], [52.0, 12.0]);
    assert_eq!(effect.overlay_key("OfxInteractActionKeyUp", 1.0, CONTROL), "kOfxStatReplyDefault");
    assert_eq!(kept(&effect).scene.parts[0].feather, [0.0, 8.0, 8.0, 0.0]);
    assert_eq!(effect.history().last().map(String::as_str), Some("Feather points"));
    let soft = row(&host, &mut effect);
    // Sharp at the left; at the right it fades from 36 to 52, and is a half at 44.
    assert!(soft[19] == 0.0 && soft[21] == 1.0 && soft[34] > 0.99 && soft[52] < 0.01, "{soft:?}");
    assert!((soft[43] + soft[44] - 1.0).abs() < 0.02 && soft[48] > 0.03 && soft[40] < 0.97, "{soft:?}");
    let edge = outer_edge(&mut effect).unwrap();
    assert!((edge - 52.0).abs() < 0.3, "{edge}");
    photograph(&mut effect);
    // It adds to the feather of the part, and export says that it stays behind.
    effect.set_text("part", "square");
    effect.set("partFeather", &[4.0]);
    let softer = row(&host, &mut effect);
    assert!(softer[53] > 0.001 && softer[17] > 0.001 && softer[15] < 0.001, "{softer:?}");
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("shapes.nk");
    effect.set_text("exportFile", file.to_str().unwrap());
    assert_eq!(effect.press("export"), OK);
    let told = host.messages().join("\n");
    assert!(file.is_file() && told.contains("no feather of the points of \"square\""), "{told}");
    while effect.history().len() > before.2 {
        effect.undo();
    }
    assert!((effect.text("document"), effect.text("state")) == (before.0, before.1));
    clean(&host);
}

#[test]
fn a_feather_of_points_is_stretched_with_the_footage_and_drawn_where_the_matte_ends() {
    let host = host();
    for (size, aspect) in [(1, 1.0), (2, 1.0), (4, 1.0), (2, 2.0)] {
        let (width, height) = (size * WIDTH as i32, size * HEIGHT as i32);
        let source = ClipSettings { x2: width, y2: height, aspect, ..ClipSettings::default() };
        let corners = vec![p(20.0, 12.0), p(44.0, 12.0), p(44.0, 36.0), p(20.0, 36.0)];
        let mut square = part("square", 0.0, true, |_| corners.clone());
        square.feather = vec![4.0; 4];
        let mut effect = effect(&host, FILTER, &source);
        effect.set_text("document", &Document::new(Scene { footage: footage(), parts: vec![square] }).to_json());
        effect.set("output", &[MATTE]);
        // A feather of all parts is in the host's pixels.
        for all in [0.0, 3.0] {
            effect.set("feather", &[all]);
            let window = Bounds { x1: 0, y1: 0, x2: width, y2: height };
            let picture = rendered(&host, &mut effect, 1.0, window);
            let row = height / 2 * width;
            let soft = (0..width).rev().find(|x| picture.values[4 * (row + x) as usize + 3] > 1e-4).unwrap();
            let wanted = f64::from(size) * 48.0 + all;
            assert!((f64::from(soft + 1) - wanted).abs() <= 1.5, "{size} {aspect} {all}: {soft} {wanted}");
            let edge = outer_edge(&mut effect).unwrap() / aspect;
            assert!((edge - wanted).abs() < 0.3 * f64::from(size), "{size} {aspect} {all}: {edge} {wanted}");
        }
    }
    clean(&host);
}

#[test]
fn a_feather_is_typed_for_the_selected_points() {
    let host = host();
    let mut effect = node(&host);
    effect.set("pointFeather", &[6.5]);
    assert_eq!(effect.press_at("featherPoints", 1.0), FAILED);
    assert!(host.messages().join("\n").contains("select points first"));
    let _ = host.errors();
    // A click inside selects all points. Equal widths are the part's feather, to the last bit.
    drag(&mut effect, [32.0, 24.0], [32.0, 24.0]);
    assert_eq!(effect.press_at("featherPoints", 1.0), OK, "{:?}", host.messages());
    assert_eq!(kept(&effect).scene.parts[0].feather, [6.5; 4]);
    let by_points = row(&host, &mut effect);
    effect.undo();
    effect.set_text("part", "square");
    effect.set("partFeather", &[6.5]);
    assert!(row(&host, &mut effect) == by_points && by_points.iter().any(|value| *value > 0.2 && *value < 0.8));
    clean(&host);
}

/// Puts the overlay over the matte, to look at.
fn photograph(effect: &mut Effect) {
    const ZOOM: f32 = 12.0;
    let picture = effect.output();
    let mut shown = Pixmap::new(WIDTH as u32 * ZOOM as u32, HEIGHT as u32 * ZOOM as u32).unwrap();
    for (k, pixel) in shown.pixels_mut().iter_mut().enumerate() {
        let (x, y) = (k % (WIDTH * ZOOM as usize) / ZOOM as usize, k / (WIDTH * ZOOM as usize) / ZOOM as usize);
        let grey = (255.0 * picture.values[4 * ((HEIGHT - 1 - y) * WIDTH + x) + 3]) as u8;
        *pixel = Color::from_rgba8(grey, grey, grey, 255).premultiply().to_color_u8();
    }
    assert_eq!(effect.overlay(DRAW, true, 1.0, [0.0; 2], 1.0 / f64::from(ZOOM)), OK);
    lay_lines(effect, &mut shown, ZOOM);
    shown.save_png(Path::new(env!("CARGO_TARGET_TMPDIR")).join("feather-points.png")).unwrap();
}
