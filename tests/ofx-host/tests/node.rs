//! Tests of what a roto node has: settings of parts, channels, masks, regions, motion and export.

use crate::common::{
    CUTOUT, FILTER, GENERAL, HEIGHT, MATTE, MATTES, OK, WHOLE, WIDTH, bundles, clean, effect, footage, host, kept, p,
    part, pattern, rendered,
};
use rototoon::geometry::Point;
use rototoon::project::Document;
use rototoon::render::header::{BT709, Facts, describe};
use rototoon::scene::Scene;
use rototoon_ofx_host::{ClipSettings, Effect, Host, Picture, Region, Settings};

/// Two squares: "left" from 4 to 24 pixels, in front of it "right" from 14 to 44, both from row 8 to row 40.
fn squares() -> String {
    let square = |x0: f64, x1: f64| move |_| vec![p(x0, 8.0), p(x1, 8.0), p(x1, 40.0), p(x0, 40.0)];
    let parts = vec![part("left", 0.0, true, square(4.0, 24.0)), part("right", 1.0, true, square(14.0, 44.0))];
    Document::new(Scene { footage: footage(), parts }).to_json()
}

fn node<'a>(host: &'a Host, context: &str) -> Effect<'a> {
    let mut effect = effect(host, context, &ClipSettings::default());
    effect.set_text("document", &squares());
    effect.set("output", &[MATTE]);
    effect
}

/// The values of a channel in the middle row.
fn row(picture: &Picture, channel: usize) -> Vec<f32> {
    let start = HEIGHT / 2 * WIDTH;
    (0..WIDTH).map(|x| picture.values[4 * (start + x) + channel]).collect()
}

fn shown(host: &Host, effect: &mut Effect, time: f64) -> Vec<f32> {
    row(&rendered(host, effect, time, WHOLE), 3)
}

#[test]
fn parts_add_subtract_intersect_and_have_opacity() {
    let host = host();
    let mut effect = node(&host, FILTER);
    let at = |values: &[f32]| [values[8], values[18], values[34], values[60]];
    assert_eq!(at(&shown(&host, &mut effect, 1.0)), [1.0, 1.0, 1.0, 0.0]);
    effect.set_text("part", "right");
    effect.set("partMode", &[1.0]);
    assert_eq!(at(&shown(&host, &mut effect, 1.0)), [1.0, 0.0, 0.0, 0.0]);
    effect.set("partMode", &[2.0]);
    assert_eq!(at(&shown(&host, &mut effect, 1.0)), [0.0, 1.0, 0.0, 0.0]);
    effect.set("partMode", &[0.0]);
    effect.set("partOpacity", &[0.5]);
    assert_eq!(at(&shown(&host, &mut effect, 1.0)), [1.0, 1.0, 0.5, 0.0]);
    effect.set("partInvert", &[1.0]);
    assert_eq!(at(&shown(&host, &mut effect, 1.0)), [1.0, 1.0, 0.0, 0.5]);
    effect.set("partInvert", &[0.0]);
    effect.set("partOn", &[0.0]);
    assert_eq!(at(&shown(&host, &mut effect, 1.0)), [1.0, 1.0, 0.0, 0.0]);
    // The other part has the defaults, and the settings come back with their part.
    effect.set_text("part", "left");
    assert_eq!((effect.get("partOn", 0.0), effect.get("partOpacity", 0.0)), (vec![1.0], vec![1.0]));
    assert_eq!(at(&shown(&host, &mut effect, 1.0)), [1.0, 1.0, 0.0, 0.0]);
    effect.set("partFeather", &[4.0]);
    let soft = shown(&host, &mut effect, 1.0);
    assert!((soft[3] - 0.5).abs() < 0.2 && soft[8] == 1.0, "{soft:?}");
    effect.set_text("part", "right");
    assert_eq!((effect.get("partOn", 0.0), effect.get("partOpacity", 0.0)), (vec![0.0], vec![0.5]));
    assert_eq!(shown(&host, &mut effect, 1.0), soft);
    clean(&host);
}

#[test]
fn settings_of_parts_are_animated_by_the_hosts_keys() {
    let host = host();
    let mut effect = node(&host, FILTER);
    effect.set_text("part", "right");
    effect.set_at("partOpacity", 0.0, &[0.0]);
    effect.set_at("partOpacity", 4.0, &[1.0]);
    let faded = |host: &Host, effect: &mut Effect| [0.0, 1.0, 2.0, 4.0].map(|time| shown(host, effect, time)[34]);
    assert_eq!(faded(&host, &mut effect), [0.0, 0.25, 0.5, 1.0]);
    // Stored for the part while the page shows another one, and shown with its keys again.
    effect.set_text("part", "left");
    assert_eq!(faded(&host, &mut effect), [0.0, 0.25, 0.5, 1.0]);
    effect.set("partOpacity", &[0.25]);
    assert_eq!(effect.get("partOpacity", 2.0), [0.25]);
    effect.set_text("part", "right");
    assert_eq!([0.0, 1.0, 4.0].map(|time| effect.get("partOpacity", time)[0]), [0.0, 0.25, 1.0]);
    assert_eq!(faded(&host, &mut effect), [0.0, 0.25, 0.5, 1.0]);
    // A key that the host's curve editor moves without telling the plugin stays with its part too.
    effect.set_at_silently("partOpacity", 4.0, &[0.5]);
    effect.set_text("part", "left");
    assert_eq!(faded(&host, &mut effect), [0.0, 0.125, 0.25, 0.5]);
    effect.set_text("part", "right");
    effect.set_at("partOpacity", 4.0, &[1.0]);
    // Undo takes the page and the selection back together.
    effect.set_text("part", "left");
    effect.set_text("part", "right");
    let steps = effect.history();
    assert_eq!(steps.last().map(String::as_str), Some("Select part"));
    effect.undo();
    assert_eq!((effect.text("state").len() > 20, effect.get("partOpacity", 2.0)), (true, vec![0.25]));
    assert_eq!(faded(&host, &mut effect), [0.0, 0.25, 0.5, 1.0]);
}

#[test]
fn a_value_that_the_host_holds_between_keys_is_held_when_its_part_is_selected_again() {
    let host = host();
    let mut effect = node(&host, FILTER);
    effect.set_text("part", "right");
    for (id, first, last) in [("partOpacity", 1.0, 0.0), ("partGrow", 0.0, 0.25), ("partOn", 1.0, 0.0)] {
        effect.set_at(id, 0.0, &[first]);
        effect.set_at(id, 10.0, &[last]);
        effect.hold_keys(id);
    }
    let shown = |effect: &Effect| {
        ["partOpacity", "partGrow", "partOn"].map(|id| [0.0, 3.0, 9.0, 10.0, 12.0].map(|time| effect.get(id, time)[0]))
    };
    let held = shown(&effect);
    assert_eq!(held[0], [1.0, 1.0, 1.0, 0.0, 0.0]);
    for _ in 0..3 {
        effect.set_text("part", "left");
        effect.set_text("part", "right");
        assert_eq!((shown(&effect), effect.keys("partOpacity").len()), (held, 3));
    }
    clean(&host);
}

#[test]
fn the_mode_of_a_part_has_keys_where_the_host_has_them_for_choices() {
    let mut host = host();
    for (choice_keys, said) in [(true, "1"), (false, "0")] {
        host.configure(&Settings { choice_keys, ..Settings::default() });
        host.reload(bundles());
        let effect = node(&host, FILTER);
        assert_eq!(effect.parameter_property("partMode", "OfxParamPropAnimates", 0), said);
        assert_eq!(effect.parameter_property("output", "OfxParamPropAnimates", 0), "0");
    }
    let mut effect = node(&host, FILTER);
    effect.set_text("part", "right");
    // Added, and subtracted from frame 2 on.
    effect.set_at("partMode", 1.0, &[0.0]);
    effect.set_at("partMode", 2.0, &[1.0]);
    let cut = |host: &Host, effect: &mut Effect| [0.0, 1.0, 2.0, 4.0].map(|time| shown(host, effect, time)[34]);
    assert_eq!(cut(&host, &mut effect), [1.0, 1.0, 0.0, 0.0]);
    // The keys stay with the part, and come back.
    effect.set_text("part", "left");
    assert_eq!(effect.keys("partMode"), []);
    assert_eq!(cut(&host, &mut effect), [1.0, 1.0, 0.0, 0.0]);
    effect.set_text("part", "right");
    assert_eq!(effect.keys("partMode"), [(1.0, vec![0.0]), (2.0, vec![1.0])]);
    assert_eq!(cut(&host, &mut effect), [1.0, 1.0, 0.0, 0.0]);
    clean(&host);
    drop(effect);
    host.configure(&Settings::default());
    host.reload(bundles());
}

#[test]
fn a_matte_goes_into_any_channel_over_the_source() {
    let host = host();
    let mut effect = node(&host, FILTER);
    let source = pattern(1);
    let middle = &source[4 * (HEIGHT / 2 * WIDTH)..][..4 * WIDTH];
    for (choice, channel) in [(1.0, 3), (2.0, 0), (3.0, 1), (4.0, 2)] {
        effect.set("matteChannel", &[choice]);
        let picture = rendered(&host, &mut effect, 1.0, WHOLE);
        for other in 0..4 {
            let wanted: Vec<f32> = if other == channel {
                (0..WIDTH).map(|x| f32::from((4..44).contains(&x))).collect()
            } else {
                middle.iter().skip(other).step_by(4).copied().collect()
            };
            assert_eq!(row(&picture, other), wanted, "{choice} {other}");
        }
    }
    effect.set("matteChannel", &[1.0]);
    effect.set("premultiply", &[1.0]);
    let picture = rendered(&host, &mut effect, 1.0, WHOLE);
    assert!(row(&picture, 0)[..4].iter().all(|value| *value == 0.0));
    assert_eq!(row(&picture, 0)[10], middle[40]);
    assert!(effect.preferences().ends_with("OfxImageAlphaPremultiplied"));
    effect.set("matteChannel", &[0.0]);
    for (choice, inside, outside) in [(1.0, middle[43], 0.0), (2.0, 1.0, middle[4 * 60 + 3])] {
        effect.set("sourceAlpha", &[choice]);
        let values = row(&rendered(&host, &mut effect, 1.0, WHOLE), 3);
        assert!((values[10] - inside).abs() < 1e-6 && (values[60] - outside).abs() < 1e-6, "{choice} {values:?}");
    }
    clean(&host);
}

#[test]
fn colours_under_a_premultiplied_matte_have_the_sources_alpha_once() {
    let host = host();
    let multiplied = pattern(1);
    let straight: Vec<f32> = multiplied
        .chunks(4)
        .flat_map(|pixel| [pixel[0] / pixel[3], pixel[1] / pixel[3], pixel[2] / pixel[3], pixel[3]])
        .collect();
    let drawn = |premultiplication: &str, frame: &[f32], alpha: f64| {
        let source = ClipSettings { premultiplication: premultiplication.into(), ..ClipSettings::default() };
        let mut effect = effect(&host, FILTER, &source);
        effect.set_frame("Source", 1.0, WIDTH, frame);
        let values = [("output", MATTE), ("matteChannel", 1.0), ("premultiply", 1.0), ("sourceAlpha", alpha)];
        values.iter().for_each(|(id, value)| effect.set(id, &[*value]));
        effect.preferences();
        rendered(&host, &mut effect, 1.0, WHOLE).values
    };
    for alpha in [1.0, 2.0] {
        let found = drawn("OfxImageAlphaPremultiplied", &multiplied, alpha);
        let wanted = drawn("OfxImageAlphaUnPremultiplied", &straight, alpha);
        assert!(found.iter().zip(&wanted).all(|(a, b)| (a - b).abs() < 1e-5), "{alpha}");
        // Inside of the matte with Multiply, and outside of it with Add, there is the source as it was.
        let as_was = found
            .chunks(4)
            .zip(multiplied.chunks(4))
            .filter(|(a, b)| a.iter().zip(*b).all(|(a, b)| (a - b).abs() < 1e-5));
        assert!(as_was.count() > 200, "{alpha}");
    }
    clean(&host);
}

#[test]
fn each_channel_has_a_matte_of_its_own() {
    let host = host();
    let mut effect = node(&host, FILTER);
    effect.set("output", &[MATTES]);
    effect.set_text("redParts", "left");
    effect.set_text("greenParts", "right");
    effect.set_text("alphaParts", "*");
    let picture = rendered(&host, &mut effect, 1.0, WHOLE);
    for (channel, from, to) in [(0, 4, 24), (1, 14, 44), (2, 0, 0), (3, 4, 44)] {
        let wanted: Vec<f32> = (0..WIDTH).map(|x| f32::from((from..to).contains(&x))).collect();
        assert_eq!(row(&picture, channel), wanted, "{channel}");
    }
}

#[test]
fn a_mask_limits_matte_and_cutout() {
    let host = host();
    let mut effect = node(&host, GENERAL);
    effect.set_clip("Mask", &ClipSettings::default());
    let mask: Vec<f32> = (0..WIDTH * HEIGHT).flat_map(|k| [0.0, 0.0, 0.0, (k % WIDTH) as f32 / 64.0]).collect();
    effect.set_frame("Mask", 1.0, WIDTH, &mask);
    effect.preferences();
    let free = shown(&host, &mut effect, 1.0);
    assert_eq!(free[20], 1.0, "the mask is not used unless the user says so");
    effect.set("useMask", &[1.0]);
    let limited = shown(&host, &mut effect, 1.0);
    assert!((0..WIDTH).all(|x| (limited[x] - free[x] * x as f32 / 64.0).abs() < 1e-6), "{limited:?}");
    effect.set("output", &[CUTOUT]);
    effect.set("invert", &[1.0]);
    let cut = shown(&host, &mut effect, 1.0);
    assert_eq!(cut[0], 0.0);
    assert_eq!(effect.identity(1.0, WHOLE, 1.0), "");
    assert_eq!(effect.frames_needed("Mask", 1.0), [1.0, 1.0]);
    // All of the mask is needed where the picture is asked for.
    let wanted = Region { status: String::new(), x1: 3.0, y1: 5.0, x2: 60.0, y2: 40.0 };
    let needed = effect.region_of_interest("Mask", 1.0, 1.0, &wanted);
    assert_eq!([needed.x1, needed.y1, needed.x2, needed.y2], [3.0, 5.0, 60.0, 40.0]);
    clean(&host);
}

#[test]
fn a_connected_mask_without_pixels_leaves_nothing() {
    let host = host();
    let mut effect = node(&host, GENERAL);
    effect.set("useMask", &[1.0]);
    assert_eq!(shown(&host, &mut effect, 1.0)[20], 1.0, "a mask that is not connected limits nothing");
    // The mask's region is outside of the picture, so the host has no image of it.
    effect.set_clip("Mask", &ClipSettings { x1: 900, y1: 900, x2: 964, y2: 948, ..ClipSettings::default() });
    effect.preferences();
    assert_eq!(shown(&host, &mut effect, 1.0), [0.0; WIDTH]);
    effect.set("output", &[CUTOUT]);
    assert_eq!(shown(&host, &mut effect, 1.0), [0.0; WIDTH]);
    clean(&host);
}

#[test]
fn region_and_frames_are_limited() {
    let host = host();
    let mut effect = node(&host, FILTER);
    let region = |region: Region| [region.x1, region.y1, region.x2, region.y2];
    assert_eq!(region(effect.region_of_definition(1.0, 1.0)), [4.0, 8.0, 44.0, 40.0]);
    for choice in [1.0, 2.0] {
        effect.set("region", &[choice]);
        assert_eq!(region(effect.region_of_definition(1.0, 1.0)), [0.0, 0.0, 64.0, 48.0]);
    }
    effect.set("shownFirst", &[2.0]);
    effect.set("shownLast", &[3.0]);
    assert_eq!(shown(&host, &mut effect, 1.0)[10], 1.0);
    effect.set("limitFrames", &[1.0]);
    let drawn = [1.0, 2.0, 3.0, 4.0].map(|time| shown(&host, &mut effect, time)[10]);
    assert_eq!(drawn, [0.0, 1.0, 1.0, 0.0]);
    // Hosts sum times as floats.
    let drawn = [1.9, 1.9999999, 3.0000001, 3.1].map(|time| shown(&host, &mut effect, time)[10]);
    assert_eq!(drawn, [0.0, 1.0, 1.0, 0.0]);
}

#[test]
fn the_shutter_opens_when_its_phase_says() {
    let host = host();
    let mut effect = effect(&host, FILTER, &ClipSettings::default());
    let moving = part("box", 0.0, true, |f| {
        vec![p(8.0 * f, 8.0), p(8.0 * f + 16.0, 8.0), p(8.0 * f + 16.0, 40.0), p(8.0 * f, 40.0)]
    });
    let document = Document::new(Scene { footage: footage(), parts: vec![moving] });
    effect.set_text("document", &document.to_json());
    effect.set("output", &[MATTE]);
    effect.set("motionBlur", &[1.0]);
    effect.set("motionBlurSamples", &[64.0]);
    // The middle of the blurred box.
    let middle = |effect: &mut Effect| {
        let values = row(&rendered(&host, effect, 2.0, WHOLE), 3);
        let sum: f32 = values.iter().sum();
        values.iter().enumerate().map(|(x, value)| (x as f32 + 0.5) * value).sum::<f32>() / sum
    };
    for (phase, wanted) in [(-180.0, 24.0), (0.0, 28.0), (-360.0, 20.0)] {
        effect.set("shutterPhase", &[phase]);
        let found = middle(&mut effect);
        assert!((found - wanted).abs() < 0.02, "{phase}: {found}");
    }
}

/// A node with the tests' document, whose frame 0 is the composition's frame 100, and which shows the part "star".
fn star_of_frame_100(host: &Host) -> Effect<'_> {
    let mut effect = effect(host, FILTER, &ClipSettings::default());
    effect.set("frameOffset", &[100.0]);
    effect.set_text("part", "star");
    effect
}

#[test]
fn the_motion_of_a_part_becomes_keys() {
    let host = host();
    let mut effect = effect(&host, FILTER, &ClipSettings::default());
    assert_eq!(effect.press("writeMotion"), "kOfxStatFailed");
    assert!(host.messages()[0].contains("select a part"));
    let mut effect = star_of_frame_100(&host);
    assert_eq!(effect.press_at("writeMotion", 100.0), OK, "{:?}", host.messages());
    let star = kept_or_plain(&effect).scene.parts[0].clone();
    for frame in 0..=4 {
        let time = f64::from(100 + frame);
        let points = &star.tracks[&frame];
        let centre = points.iter().sum::<Point>() / points.len() as f64;
        let found = effect.get("center", time);
        assert!((found[0] - centre.x).abs() < 1e-9 && (found[1] - (HEIGHT as f64 - centre.y)).abs() < 1e-9);
        // The star turns by 0.2 radians a frame, clockwise where y is up.
        let turn = effect.get("rotate", time)[0].to_radians();
        assert!((turn + 0.2 * f64::from(frame)).abs() < 1e-3, "{frame}: {turn}");
        assert!((effect.get("scale", time)[0] - 1.0).abs() < 1e-3);
        assert!((effect.get("translate", time)[0] - 2.0 * f64::from(frame)).abs() < 1e-3);
    }
}

#[test]
fn shapes_become_files_of_other_programs() {
    let host = host();
    let mut effect = star_of_frame_100(&host);
    let folder = tempfile::tempdir().unwrap();
    for (name, said) in [
        ("a größe.nk", "RotoPaint"),
        ("a.ntp", "fr.inria.built-in.Roto"),
        ("a.py", "createBezier"),
        ("a.jsx", "ADBE Mask"),
        ("a.fxs", "<Silhouette"),
        ("a.setting", "= PolylineMask {"),
        ("b.SVG", "<svg"),
    ] {
        let file = folder.path().join(name);
        effect.set_text("exportFile", file.to_str().unwrap());
        assert_eq!(effect.press("export"), OK, "{:?}", host.messages());
        let text = std::fs::read_to_string(file).unwrap();
        assert!(text.contains(said) && text.contains("star"), "{name}");
    }
    let _ = (host.log(), host.messages());
    effect.set_text("exportFile", folder.path().join("a.txt").to_str().unwrap());
    assert_eq!(effect.press("export"), "kOfxStatFailed");
    assert!(host.messages().last().unwrap().contains(".nk, .ntp, .py, .jsx, .fxs, .setting, .svg or .exr"));
}

#[test]
fn another_node_reads_the_files_in_the_pixels_of_the_footage() {
    let host = host();
    let mut effect = star_of_frame_100(&host);
    // The composition shows the project's frames 0 to 4 on its frames 5 to 9.
    effect.set("frameOffset", &[5.0]);
    let was = kept_or_plain(&effect).scene.parts[0].tracks[&4].clone();
    let folder = tempfile::tempdir().unwrap();
    for name in ["a größe.nk", "a.ntp", "a.fxs", "b.SVG"] {
        let file = folder.path().join(name);
        effect.set_text("exportFile", file.to_str().unwrap());
        assert_eq!(effect.press("export"), OK, "{:?}", host.messages());
        let mut other = node(&host, FILTER);
        other.set_text("document", "");
        other.set("frameOffset", &[100.0]);
        let _ = (host.log(), host.messages());
        other.set_text("project", file.to_str().unwrap());
        if name.ends_with("nk") {
            // The source of this node has the composition's frames 0 to 10; the project's are -100 to -90.
            let read = kept(&other).scene;
            assert!(read.parts.iter().all(|part| part.keys.keys().all(|frame| (-95..=-91).contains(frame))));
        }
        other.set("frameOffset", &[2.0]);
        other.set_text("document", "");
        assert_eq!(other.press("load"), OK, "{name} {:?}", host.messages());
        let read = kept(&other).scene;
        assert_eq!(read.parts.len(), 3, "{name}");
        let star = read.parts.iter().find(|part| part.name == "star").unwrap();
        let (last, now) = star.keys.last_key_value().unwrap();
        // The project's frame 4 is the composition's frame 9. An SVG of Rototoon says which frames it shows.
        assert_eq!(*last, 9 - 2, "{name}");
        let reach = |points: &[Point]| points.iter().fold((Point::MAX, Point::MIN), |(a, b), &p| (a.min(p), b.max(p)));
        let ((low, high), wanted) = (reach(now), reach(&was));
        assert!((low - wanted.0).length() < 0.1 && (high - wanted.1).length() < 0.1, "{name}");
        // The file of the other program is not replaced by a document.
        assert_eq!(other.press("save"), "kOfxStatFailed");
    }
}

/// The stored document, in either form.
fn kept_or_plain(effect: &Effect) -> Document {
    let text = effect.text("document");
    let json = rototoon_ofx::roto::stored::decode(&text).unwrap().into_owned();
    Document::parse(&json, "kept").unwrap()
}

#[test]
fn damaged_settings_of_parts_are_told() {
    let host = host();
    let mut effect = node(&host, FILTER);
    effect.set_text("state", "rototoon1_abc");
    assert_eq!(effect.render(1.0, WHOLE, 1.0, 1, 0), "kOfxStatFailed");
    assert!(host.messages().iter().any(|text| text.contains("settings of parts")), "{:?}", host.messages());
    let _ = host.log();
    effect.set_text("state", "");
    assert_eq!(shown(&host, &mut effect, 1.0)[10], 1.0);
    let _ = kept;
}

#[test]
fn ids_for_keyers_are_written_for_each_frame_of_the_composition() {
    let host = host();
    let mut effect = node(&host, FILTER);
    effect.set("frameOffset", &[1001.0]);
    let folder = tempfile::tempdir().unwrap();
    effect.set_text("exportFile", folder.path().join("ids_%04d.exr").to_str().unwrap());
    host.configure(&Settings { cancel_after: 2, ..Settings::default() });
    assert_eq!(effect.press("export"), OK, "cancelling is no error");
    let files = || {
        let names = std::fs::read_dir(folder.path()).unwrap().map(|entry| entry.unwrap().file_name());
        let mut names: Vec<String> = names.map(|name| name.into_string().unwrap()).collect();
        names.sort();
        names
    };
    assert!(files().len() < 5, "{:?}", files());
    host.configure(&Settings::default());
    assert_eq!(effect.press("export"), OK, "{:?}", host.messages());
    assert_eq!(files(), [1001, 1002, 1003, 1004, 1005].map(|frame| format!("ids_{frame}.exr")));
    // The same bytes as those of the command line's function for the document's frame.
    let scene = Document::parse(&squares(), "squares").unwrap().scene;
    let wanted = rototoon::render::id_picture(&scene, 2, None, rototoon::render::Format::EXR).unwrap();
    let facts = Facts { pixel_aspect: 1.0, chromaticities: BT709, fps: scene.footage.fps, time_code: None };
    let wanted = describe(wanted, &facts);
    assert!(std::fs::read(folder.path().join("ids_1003.exr")).unwrap() == wanted);
    // A percent sign in the name of a folder is written as two.
    let odd = folder.path().join("100%");
    std::fs::create_dir(&odd).unwrap();
    effect.set_text("exportFile", folder.path().join("100%%").join("a_%d.exr").to_str().unwrap());
    assert_eq!(effect.press("export"), OK, "{:?}", host.messages());
    assert!(std::fs::read(odd.join("a_1003.exr")).unwrap() == wanted);
    effect.set_text("exportFile", folder.path().join("ids.exr").to_str().unwrap());
    assert_eq!(effect.press("export"), "kOfxStatFailed");
    let told = host.messages().join("\n");
    assert!(told.contains("export file:") && told.contains("ids.exr"), "{told}");
}
