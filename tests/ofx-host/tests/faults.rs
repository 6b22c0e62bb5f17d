//! Faults that were seen in real hosts.

use crate::common::{
    CUTOUT, FILTER, HEIGHT, IDS, MATTE, OK, OVERLAY, ROTO, WHOLE, WIDTH, bundles, clean, document, effect, footage,
    host, p, part, pattern, rendered, scene,
};
use rototoon::project::Document;
use rototoon::render;
use rototoon::scene::{Part, Scene};
use rototoon_ofx_host::{Bounds, ClipSettings, Picture, Settings};

/// The value of a channel at a pixel, with rows from the top.
fn at(picture: &Picture, x: usize, y: usize, channel: usize) -> f32 {
    picture.values[picture.channels * ((picture.height - 1 - y) * picture.width + x) + channel]
}

fn byte(value: f32) -> u8 {
    (value.clamp(0.0, 1.0) * 255.0).round() as u8
}

/// Discs in a ring, which all share pixels with others.
fn ring(count: usize) -> Scene {
    let disc = |index: usize| {
        let turn = std::f64::consts::TAU * index as f64 / count as f64;
        let middle = p(32.3, 23.6) + 11.0 * rototoon::geometry::Point::from_angle(turn);
        let contour = move |frame: f64| {
            (0..30)
                .map(|k| middle + p(frame, 0.0) + 9.4 * rototoon::geometry::Point::from_angle(0.21 * f64::from(k)))
                .collect()
        };
        part(&format!("disc {index}"), (index * 2 % count) as f64, true, contour)
    };
    Scene { footage: footage(), parts: (0..count).map(disc).collect() }
}

#[test]
fn ids_are_those_of_the_command_line_to_the_byte() {
    let host = host();
    let mut different = 0;
    for scene in [scene(), ring(3), ring(9)] {
        let json = Document::new(scene).to_json();
        let scene = Document::parse(&json, "ring").unwrap().scene;
        let mut effect = effect(&host, FILTER, &ClipSettings::default());
        effect.set("output", &[IDS]);
        effect.set_text("document", &json);
        for frame in [0, 3] {
            let found = rendered(&host, &mut effect, f64::from(frame), WHOLE);
            let wanted = render::ids::ids(&render::visible::visible(&scene, frame, None));
            for y in 0..HEIGHT {
                for x in 0..WIDTH {
                    for channel in 0..4 {
                        let (found, wanted) = (at(&found, x, y, channel), wanted.get(x, y)[channel]);
                        assert_eq!(byte(found), byte(wanted), "{frame} {x} {y} {channel}");
                        different += usize::from(found != wanted);
                    }
                }
            }
        }
    }
    // Heights are turned over, so a last bit may differ.
    assert!(different < 20, "{different} values differ in a bit");
    clean(&host);
}

#[test]
fn ids_blurred_by_motion_share_pixels_and_are_light_in_linear_hosts() {
    let host = host();
    let mut effect = effect(&host, FILTER, &ClipSettings::default());
    effect.set("output", &[IDS]);
    effect.set("motionBlur", &[1.0]);
    effect.set("motionBlurSamples", &[4.0]);
    let ids = rendered(&host, &mut effect, 2.0, WHOLE);
    effect.set("output", &[MATTE]);
    let matte = rendered(&host, &mut effect, 2.0, WHOLE);
    let apart = (0..WIDTH * HEIGHT).map(|k| (ids.values[4 * k + 3] - matte.values[4 * k]).abs()).fold(0.0, f32::max);
    assert!(apart < 1e-5, "the ids of a pixel sum to its matte: {apart}");
    host.configure(&Settings { name: "uk.co.thefoundry.nuke".into(), ..Settings::default() });
    effect.set("output", &[IDS]);
    effect.set("motionBlur", &[0.0]);
    let light = rendered(&host, &mut effect, 2.0, WHOLE);
    let colour = rototoon::scene::palette::distinct(0).map(rototoon::image::colour::decode);
    let inside = (0..3).map(|channel| at(&light, 30, 22, channel)).collect::<Vec<_>>();
    assert!(inside.iter().zip(colour).all(|(a, b)| (a - b).abs() < 1e-5), "{inside:?} {colour:?}");
}

#[test]
fn natron_is_known_under_another_hosts_name() {
    let mut host = host();
    // Natron's preference "Appear to plug-ins as": its floats are linear light all the same, and it shows messages.
    for (natron, linear) in [(true, true), (false, false)] {
        host.configure(&Settings { name: "DaVinciResolve".into(), natron, ..Settings::default() });
        host.reload(bundles());
        let mut effect = effect(&host, FILTER, &ClipSettings::default());
        effect.set("output", &[IDS]);
        let ids = rendered(&host, &mut effect, 2.0, WHOLE);
        let shown = rototoon::scene::palette::distinct(0);
        let wanted = if linear { shown.map(rototoon::image::colour::decode) } else { shown };
        let inside = [0, 1, 2].map(|channel| at(&ids, 30, 22, channel));
        assert!(inside.iter().zip(wanted).all(|(a, b)| (a - b).abs() < 1e-5), "{natron}: {inside:?} {wanted:?}");
        effect.set_text("document", "nonsense");
        assert_eq!(effect.render(2.0, WHOLE, 1.0, 1, 0), "kOfxStatFailed");
        assert_eq!(host.messages().len(), usize::from(natron));
        let _ = host.errors();
    }
    host.configure(&Settings::default());
    host.reload(bundles());
}

#[test]
fn a_matte_is_coverage_in_all_channels_of_a_straight_image() {
    let host = host();
    for depth in ["OfxBitDepthByte", "OfxBitDepthShort", "OfxBitDepthHalf", "OfxBitDepthFloat"] {
        let source = ClipSettings {
            depth: depth.into(),
            premultiplication: "OfxImageAlphaUnPremultiplied".into(),
            ..ClipSettings::default()
        };
        let mut effect = effect(&host, FILTER, &source);
        effect.set("output", &[MATTE]);
        effect.set("feather", &[4.0]);
        let picture = rendered(&host, &mut effect, 1.0, WHOLE);
        let pixels: Vec<&[f32]> = picture.values.chunks(4).collect();
        assert!(pixels.iter().all(|pixel| pixel.iter().all(|value| *value == pixel[3])), "{depth}");
        assert!(pixels.iter().filter(|pixel| (0.2..0.8).contains(&pixel[0])).count() > 100, "{depth}");
    }
}

#[test]
fn growing_and_feathering_are_bounded_and_heard() {
    let host = host();
    let (width, height) = (960, 540);
    let scale = 15.0;
    let mut large = scene();
    (large.footage.width, large.footage.height) = (width, height);
    let grown = |part: &mut Part| {
        let shapes = part.keys.values_mut().chain(part.tracks.values_mut());
        shapes.flatten().for_each(|point| *point *= scale * 0.7);
    };
    large.parts.iter_mut().for_each(grown);
    let source = ClipSettings { x2: width as i32, y2: height as i32, ..ClipSettings::default() };
    let mut effect = host.effect(ROTO, FILTER);
    effect.set_clip("Source", &source);
    effect.set_clip("Output", &source);
    assert_eq!(effect.create(), OK);
    effect.set_text("document", &Document::new(large).to_json());
    let values: [(&str, f64); 5] =
        [("output", MATTE), ("feather", 300.0), ("grow", 200.0), ("motionBlur", 1.0), ("motionBlurSamples", 64.0)];
    values.iter().for_each(|(id, value)| effect.set(id, &[*value]));
    // A strip of it: the first ten rows of a fourth of the picture.
    let strip = Bounds { x1: 0, y1: 200, x2: 240, y2: 210 };
    // With a falloff each instant is blurred.
    for falloff in [1.0, 2.0] {
        host.configure(&Settings::default());
        effect.set("falloff", &[falloff]);
        let picture = rendered(&host, &mut effect, 2.0, strip);
        assert!(picture.values.iter().any(|value| *value > 0.5));
        // An abort is heard in each phase.
        for after in [0, 3, 40, 200, 700] {
            host.configure(&Settings { abort_after: after, ..Settings::default() });
            assert_eq!(effect.render(2.0, strip, 1.0, 1, 0), "kOfxStatFailed", "{falloff} {after}");
            assert_eq!(host.live_images(), 0);
        }
        // These were meant.
        let _ = host.errors();
    }
}

#[test]
fn pixels_at_another_scale_than_the_host_says_are_met() {
    let host = host();
    for (output, real, tiles, said) in
        [(MATTE, 0.5, true, 1.0), (CUTOUT, 0.5, false, 1.0), (IDS, 0.5, false, 1.0), (MATTE, 2.0, true, 0.5)]
    {
        let mut effect = effect(&host, FILTER, &ClipSettings::default());
        effect.set("output", &[output]);
        host.configure(&Settings::default());
        let scale = said * real;
        let window = Bounds { x1: 0, y1: 0, x2: (64.0 * scale) as i32, y2: (48.0 * scale) as i32 };
        assert_eq!(effect.render(2.0, window, scale, 1, 0), OK);
        let honest = effect.output();
        host.configure(&Settings { real_scale: real, tiles, ..Settings::default() });
        assert_eq!(effect.render(2.0, window, said, 1, 0), OK);
        assert!(effect.output() == honest, "{output} {real}");
    }
    host.configure(&Settings::default());
}

#[test]
fn a_frame_around_shapes_that_nearly_fill_it_does_not_make_them_larger() {
    let host = host();
    // The region of the output is that of the shapes, and the host renders the whole frame.
    for (right, bottom) in [(61.0, 47.0), (32.0, 48.0 - 24.0)] {
        let top = if right > 40.0 { 2.5 } else { 24.0 };
        let (left, lowest) = if right > 40.0 { (1.0, bottom) } else { (0.0, 48.0) };
        let contour = move |_| vec![p(left, top), p(right, top), p(right, lowest), p(left, lowest)];
        let mut effect = effect(&host, FILTER, &ClipSettings::default());
        let document = Document::new(Scene { footage: footage(), parts: vec![part("back", 0.0, true, contour)] });
        effect.set_text("document", &document.to_json());
        effect.set("output", &[MATTE]);
        let (x1, y1) = (left as i32, (48.0 - lowest) as i32);
        let own = Bounds { x1, y1, x2: right as i32, y2: (48.0 - top).ceil() as i32 };
        effect.set_region("Output", 1.0, own);
        let picture = rendered(&host, &mut effect, 1.0, WHOLE);
        let row = (0..WIDTH).map(|x| at(&picture, x, 40, 0)).sum::<f32>();
        assert!((row - (right - left) as f32).abs() < 1e-3, "{right}: {row}");
    }
    clean(&host);
}

#[test]
fn shapes_show_in_pictures_whose_scale_is_wrong() {
    let host = host();
    let mut effect = effect(&host, FILTER, &ClipSettings::default());
    // In the upper right, outside of a picture of half the size.
    let corner = part("box", 0.0, true, |_| vec![p(44.0, 4.0), p(60.0, 4.0), p(60.0, 12.0), p(44.0, 12.0)]);
    let document = Document::new(Scene { footage: footage(), parts: vec![corner] });
    effect.set_text("document", &document.to_json());
    effect.set("output", &[OVERLAY]);
    let half = Bounds { x1: 0, y1: 0, x2: 32, y2: 24 };
    for (tiles, identical) in [(true, "Source"), (false, "")] {
        host.configure(&Settings { real_scale: 0.5, tiles, ..Settings::default() });
        assert_eq!(effect.identity(2.0, half, 1.0), identical, "{tiles}");
    }
    host.configure(&Settings::default());
}

#[test]
fn a_smaller_source_in_a_host_of_one_size_fills_the_picture() {
    let host = host();
    // The host gives half the size and says nothing of it; the project's format is that of the footage.
    let half = ClipSettings { x2: 32, y2: 24, ..ClipSettings::default() };
    let mut effect = host.effect(ROTO, FILTER);
    effect.set_clip("Source", &half);
    effect.set_clip("Output", &ClipSettings::default());
    for frame in 0..=4 {
        effect.set_frame("Source", f64::from(frame), WIDTH, &pattern(frame));
    }
    assert_eq!(effect.create(), OK);
    effect.set_text("document", &document());
    effect.set("output", &[MATTE]);
    let window = Bounds { x1: 0, y1: 0, x2: 32, y2: 24 };
    let mut drawn = |multi_resolution| {
        host.configure(&Settings { multi_resolution, ..Settings::default() });
        assert_eq!(effect.render(2.0, window, 1.0, 1, 0), OK);
        effect.output().values.iter().sum::<f32>()
    };
    let (many, one) = (drawn(true), drawn(false));
    let whole: f32 = render::matte(&scene(), 2, None).data().iter().sum();
    assert!((one - whole).abs() < 0.01 * whole, "all of the figure, at half the size, in four channels: {one} {whole}");
    assert!(many != one);
}

#[test]
fn persistent_messages_that_are_null_are_not_called() {
    let mut host = host();
    for name in ["DaVinciResolveLite", "a host of the future"] {
        host.configure(&Settings { name: name.into(), null_messages: true, ..Settings::default() });
        host.reload(bundles());
        let mut effect = effect(&host, FILTER, &ClipSettings::default());
        let wanted = rendered(&host, &mut effect, 2.0, WHOLE);
        // A message about the picture, which the next change would clear.
        effect.set_text("document", "nonsense");
        assert_eq!(effect.render(2.0, WHOLE, 1.0, 1, 0), "kOfxStatFailed", "{name}");
        effect.set_text("document", &document());
        let _ = host.errors();
        assert!(rendered(&host, &mut effect, 2.0, WHOLE) == wanted, "{name}");
        // Buttons have the first version of the suite.
        assert_eq!(effect.press("save"), "kOfxStatFailed", "{name}");
        assert!(host.messages().join("").contains("choose a project file"), "{name}");
        let _ = host.errors();
    }
    host.configure(&Settings::default());
    host.reload(bundles());
}

#[test]
fn messages_that_a_host_drops_go_to_the_log() {
    for (name, messages) in [("RototoonTestHost", 1), ("MLT", 0)] {
        let mut host = host();
        host.configure(&Settings { name: name.into(), ..Settings::default() });
        host.reload(crate::common::bundles());
        let mut effect = effect(&host, FILTER, &ClipSettings::default());
        effect.set_text_silently("document", "no document");
        assert_eq!(effect.render(1.0, WHOLE, 1.0, 1, 0), "kOfxStatFailed");
        assert_eq!(host.messages().len(), messages, "{name}");
    }
}
