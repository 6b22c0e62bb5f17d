//! Tests of how parts look: the falloff of their feather, and their colours.

use crate::common::{
    FILTER, HEIGHT, IDS, MATTE, OK, WHOLE, WIDTH, clean, effect, footage, host, kept, lay_lines, p, part, rendered,
};
use rototoon::geometry::Point;
use rototoon::project::Document;
use rototoon::scene::{Falloff, FalloffCurve, Part, Scene, palette};
use rototoon_ofx_host::{ClipSettings, Effect, Host};
use std::path::Path;
use tiny_skia::{Color, Pixmap};

const DRAW: &str = "OfxInteractActionDraw";
/// Indices of the curves of a part.
const LINEAR: f64 = 2.0;

/// Two squares, "left" from 8 to 26 and "right" from 38 to 56 pixels, that move to the right by a pixel with each frame.
fn scene() -> Scene {
    let square = |x: f64| {
        move |frame: f64| -> Vec<Point> {
            let x = x + frame;
            vec![p(x, 10.0), p(x + 18.0, 10.0), p(x + 18.0, 38.0), p(x, 38.0)]
        }
    };
    Scene {
        footage: footage(),
        parts: vec![part("left", 0.0, true, square(8.0)), part("right", 1.0, true, square(38.0))],
    }
}

fn node(host: &Host, scene: Scene) -> Effect<'_> {
    let mut effect = effect(host, FILTER, &ClipSettings::default());
    effect.set_text("document", &Document::new(scene).to_json());
    effect.set("output", &[MATTE]);
    effect
}

/// The middle row of the matte on frame 0.
fn row(host: &Host, effect: &mut Effect, time: f64) -> Vec<f32> {
    let values = rendered(host, effect, time, WHOLE).values;
    (0..WIDTH).map(|x| values[4 * (HEIGHT / 2 * WIDTH + x) + 3]).collect()
}

#[test]
fn a_falloff_of_all_parts_and_one_of_a_part_are_multiplied() {
    let host = host();
    let mut effect = node(&host, scene());
    let hard = row(&host, &mut effect, 0.0);
    effect.set("falloff", &[3.0]);
    assert_eq!(row(&host, &mut effect, 0.0), hard, "nothing is soft");
    effect.set("falloff", &[1.0]);
    effect.set("feather", &[6.0]);
    let soft = row(&host, &mut effect, 0.0);
    effect.set("falloff", &[2.0]);
    let faster = row(&host, &mut effect, 0.0);
    for (x, (a, b)) in soft.iter().zip(&faster).enumerate() {
        assert!((b - a * a).abs() < 1e-3, "{x}: {a} {b}");
    }
    effect.set_text("part", "left");
    effect.set("partFalloff", &[0.5]);
    let back = row(&host, &mut effect, 0.0);
    for x in 0..32 {
        assert!((back[x] - soft[x]).abs() < 1e-3 && (back[x + 32] - faster[x + 32]).abs() < 1e-6, "{x}");
    }
    // An even rise of 12 pixels in the middle of the left border, at 8.
    effect.set("falloff", &[1.0]);
    effect.set("partFalloff", &[1.0]);
    effect.set("partFalloffCurve", &[LINEAR]);
    let even = row(&host, &mut effect, 0.0);
    for x in 3..13 {
        let wanted = (x as f32 + 0.5 - 2.0) / 12.0;
        assert!((even[x] - wanted).abs() < 0.02, "{x}: {} {wanted}", even[x]);
    }
    assert_eq!(even[40..], soft[40..], "the other part keeps its border");
    // The curve of all parts is that of those that say nothing.
    effect.set("partFalloffCurve", &[0.0]);
    effect.set("falloffCurve", &[1.0]);
    let all = row(&host, &mut effect, 0.0);
    assert!(all[..30] == even[..30] && all[40..] != soft[40..]);
    effect.set("partFalloffCurve", &[1.0]);
    assert_eq!(row(&host, &mut effect, 0.0)[..30], soft[..30]);
    clean(&host);
}

#[test]
fn a_falloff_is_animated_by_the_hosts_keys_and_kept_with_its_part() {
    let host = host();
    let mut effect = node(&host, scene());
    effect.set("feather", &[5.0]);
    let plain = [0.0, 1.0, 2.0].map(|time| row(&host, &mut effect, time));
    effect.set_text("part", "left");
    effect.set_at("partFalloff", 0.0, &[1.0]);
    effect.set_at("partFalloff", 2.0, &[3.0]);
    let animated = |host: &Host, effect: &mut Effect| [0.0, 1.0, 2.0].map(|time| row(host, effect, time));
    let found = animated(&host, &mut effect);
    assert_eq!(found[0], plain[0]);
    for (frame, rate) in [(1, 2), (2, 3)] {
        // At the left border, on the left part's side alone.
        for x in 0..20 {
            let wanted = plain[frame][x].powi(rate);
            assert!((found[frame][x] - wanted).abs() < 1e-3, "{frame} {x}: {} {wanted}", found[frame][x]);
        }
    }
    effect.set_text("part", "right");
    assert_eq!((effect.get("partFalloff", 1.0), effect.keys("partFalloff").len()), (vec![1.0], 0));
    assert_eq!(animated(&host, &mut effect), found);
    effect.set_text("part", "left");
    assert_eq!(effect.keys("partFalloff"), [(0.0, vec![1.0]), (2.0, vec![3.0])]);
    clean(&host);
}

#[test]
fn what_moves_has_the_mean_of_its_borders_in_any_tile() {
    let host = host();
    let mut effect = node(&host, scene());
    effect.set("feather", &[4.0]);
    effect.set("falloffCurve", &[1.0]);
    effect.set("falloff", &[1.5]);
    effect.set("motionBlur", &[2.0]);
    effect.set("motionBlurSamples", &[9.0]);
    let whole = rendered(&host, &mut effect, 2.0, WHOLE);
    for (threads, rows) in [(1, 7), (4, 11)] {
        assert_eq!(effect.render(2.0, WHOLE, 1.0, threads, rows), OK);
        assert!(effect.output() == whole, "{threads} {rows}");
    }
    let blurred = row(&host, &mut effect, 2.0);
    assert!(blurred[18] == 1.0 && blurred[34] == 0.0, "{blurred:?}");
    assert!(blurred[3..14].windows(2).all(|pair| pair[0] <= pair[1]), "{blurred:?}");
    clean(&host);
}

#[test]
fn a_documents_falloff_is_drawn_as_by_the_command_line() {
    let host = host();
    let mut scene = scene();
    scene.parts[0].feather = vec![2.0, 9.0, 9.0, 2.0];
    scene.parts[0].falloff = Falloff { rate: 1.7, curve: Some(FalloffCurve::EaseOut) };
    scene.parts[1].feather = vec![4.0; 4];
    scene.parts[1].falloff = Falloff { rate: 0.5, curve: None };
    let own = rototoon::render::matte(&scene, 1, None);
    let mut effect = node(&host, scene);
    let values = rendered(&host, &mut effect, 1.0, WHOLE).values;
    for y in 0..HEIGHT {
        for x in 0..WIDTH {
            // The host counts rows from below.
            assert_eq!(values[4 * ((HEIGHT - 1 - y) * WIDTH + x) + 3], own.get(x, y), "{x} {y}");
        }
    }
}

#[test]
fn falloffs_are_looked_at() {
    let host = host();
    let mut effect = node(&host, scene());
    const ZOOM: usize = 6;
    let mut sheet = Pixmap::new((WIDTH * ZOOM) as u32, (HEIGHT * ZOOM * 4) as u32).unwrap();
    for (place, (curve, rate)) in [(0.0, 1.0), (1.0, 1.0), (0.0, 3.0), (0.0, 0.3)].into_iter().enumerate() {
        effect.set("feather", &[7.0]);
        effect.set("falloffCurve", &[curve]);
        effect.set("falloff", &[rate]);
        let values = rendered(&host, &mut effect, 0.0, WHOLE).values;
        for y in 0..HEIGHT * ZOOM {
            for x in 0..WIDTH * ZOOM {
                let grey = (255.0 * values[4 * ((HEIGHT - 1 - y / ZOOM) * WIDTH + x / ZOOM) + 3]) as u8;
                let at = (place * HEIGHT * ZOOM + y) * WIDTH * ZOOM + x;
                sheet.pixels_mut()[at] = Color::from_rgba8(grey, grey, grey, 255).premultiply().to_color_u8();
            }
        }
    }
    sheet.save_png(Path::new(env!("CARGO_TARGET_TMPDIR")).join("falloffs.png")).unwrap();
}

/// Whether the overlay has a line of a colour.
fn has_line(effect: &mut Effect, colour: [f32; 3]) -> bool {
    assert_eq!(effect.overlay(DRAW, true, 1.0, [0.0; 2], 0.1), OK);
    let near = |line: &[f32; 5]| line.iter().zip(colour).all(|(a, b)| (a - b).abs() < 1e-4);
    effect.drawn_colours().iter().any(near)
}

#[test]
fn a_part_has_the_colour_that_is_chosen_and_its_own_again() {
    let host = host();
    let mut effect = node(&host, scene());
    let chosen = [0.1, 0.9, 0.3];
    assert!(has_line(&mut effect, palette::distinct(0)) && has_line(&mut effect, palette::distinct(1)));
    effect.set("output", &[IDS]);
    let ids = rendered(&host, &mut effect, 1.0, WHOLE);
    effect.set_text("part", "left");
    effect.set("partColor", &chosen.map(f64::from));
    assert!(has_line(&mut effect, chosen) && !has_line(&mut effect, palette::distinct(0)));
    photograph(&mut effect);
    assert!(rendered(&host, &mut effect, 1.0, WHOLE) == ids, "ids keep their colours");
    // Kept while the page shows another part, and through a new name.
    effect.set_text("part", "right");
    assert_eq!(effect.get("partColor", 0.0), [0.0; 3]);
    assert!(has_line(&mut effect, chosen));
    effect.set_text("part", "left");
    assert!(effect.get("partColor", 0.0).iter().zip(chosen).all(|(a, b)| (a - f64::from(b)).abs() < 1e-6));
    effect.set_text("newName", "arm");
    assert_eq!(effect.press("rename"), OK, "{:?}", host.messages());
    assert!(has_line(&mut effect, chosen));
    effect.set("partColor", &[0.0; 3]);
    assert!(has_line(&mut effect, palette::distinct(0)) && !has_line(&mut effect, chosen));
    clean(&host);
}

/// Exports to a file, and returns its text and what was told.
fn exported(host: &Host, effect: &mut Effect, name: &str) -> (String, String) {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join(name);
    effect.set_text("exportFile", file.to_str().unwrap());
    assert_eq!(effect.press("export"), OK, "{:?}", host.messages());
    (std::fs::read_to_string(file).unwrap(), host.messages().join("\n"))
}

#[test]
fn exports_have_the_colours_and_what_they_can_of_the_falloffs() {
    let host = host();
    let mut effect = node(&host, scene());
    effect.set_text("part", "left");
    effect.set("partColor", &[0.25, 0.5, 0.75]);
    effect.set("partFalloff", &[2.0]);
    effect.set("falloff", &[1.5]);
    let (nuke, told) = exported(&host, &mut effect, "shapes.nk");
    // 0.25, 0.5, 0.75 and 3 as the bits of floats.
    assert!(nuke.contains("ro x3e800000 go x3f000000 bo x3f400000 ao 1 ff x40400000 "), "{nuke}");
    assert!(nuke.contains(" ff x3fc00000 ") && told.is_empty(), "{told}");
    let (natron, told) = exported(&host, &mut effect, "shapes.py");
    assert!(natron.contains("(u\"left\", True, (0.25, 0.5, 0.75), 3, [") && told.is_empty(), "{told} {natron}");
    let (after, told) = exported(&host, &mut effect, "shapes.jsx");
    assert!(after.contains("\"color\": [0.250, 0.500, 0.750]"), "{after}");
    assert!(told.contains("no such falloff") && told.contains("\"left\", \"right\""), "{told}");
    let (silhouette, told) = exported(&host, &mut effect, "shapes.fxs");
    assert!(silhouette.contains("<Value>(0.250,0.500,0.750)</Value>") && told.contains("no such falloff"), "{told}");
    let (svg, _) = exported(&host, &mut effect, "shapes.svg");
    assert!(svg.contains("#4080bf"), "{svg}");
    // The rate comes back with the shapes; nothing else of the document has changed.
    let stays: Vec<Part> = Document::parse(&effect.text("document"), "kept").unwrap().scene.parts;
    assert!(stays.iter().all(|part| part.falloff == Falloff::default() && part.colour.is_none()));
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("back.nk");
    std::fs::write(&file, nuke).unwrap();
    effect.set_text("project", file.to_str().unwrap());
    assert_eq!(effect.press("load"), OK, "{:?}", host.messages());
    let back: Vec<f64> = kept(&effect).scene.parts.iter().map(|part| part.falloff.rate).collect();
    assert_eq!(back, [3.0, 1.5]);
    // A linear border is all that After Effects has beside its own.
    effect.set("falloff", &[1.0]);
    effect.set("partFalloff", &[1.0]);
    effect.set("falloffCurve", &[1.0]);
    assert!(exported(&host, &mut effect, "shapes.jsx").0.contains("\"falloff\": \"linear\""));
}

/// Puts the overlay over grey, to look at.
fn photograph(effect: &mut Effect) {
    const ZOOM: f32 = 10.0;
    let mut shown = Pixmap::new(WIDTH as u32 * ZOOM as u32, HEIGHT as u32 * ZOOM as u32).unwrap();
    shown.fill(Color::from_rgba8(60, 60, 60, 255));
    assert_eq!(effect.overlay(DRAW, true, 1.0, [0.0; 2], 1.0 / f64::from(ZOOM)), OK);
    lay_lines(effect, &mut shown, ZOOM);
    shown.save_png(Path::new(env!("CARGO_TARGET_TMPDIR")).join("colours.png")).unwrap();
}
