//! The picture does not depend on depth, components, tiles, row order or threads.

use crate::common::{
    CUTOUT, FILTER, GENERAL, HEIGHT, IDS, MATTE, MATTES, OK, OVERLAY, PAINTED, WHOLE, WIDTH, clean, effect, host,
    pattern, rendered, scene,
};
use rototoon::project::Document;
use rototoon_ofx_host::{Bounds, ClipSettings, Host, Picture, Settings};

/// Half a code value of a byte, and the rounding of a half.
const HALF_A_CODE: f32 = 0.5 / 255.0 + 1e-4;
const DEPTHS: [&str; 4] = ["OfxBitDepthByte", "OfxBitDepthShort", "OfxBitDepthHalf", "OfxBitDepthFloat"];
const COMPONENTS: [&str; 3] = ["OfxImageComponentRGBA", "OfxImageComponentRGB", "OfxImageComponentAlpha"];

/// The values of a picture, reduced to those of a picture with `channels` values per pixel.
fn channels(reference: &Picture, channels: usize) -> Vec<f32> {
    let pixels = reference.values.chunks(reference.channels);
    match channels {
        4 => reference.values.clone(),
        3 => pixels.flat_map(|pixel| pixel[..3].to_vec()).collect(),
        _ => pixels.map(|pixel| pixel[3]).collect(),
    }
}

fn scaled(window: Bounds, scale: f64) -> Bounds {
    let at = |v: i32| (f64::from(v) * scale) as i32;
    Bounds { x1: at(window.x1), y1: at(window.y1), x2: at(window.x2), y2: at(window.y2) }
}

/// Sets parameters that make pixels depend on their neighbours.
fn set(effect: &mut rototoon_ofx_host::Effect, output: f64) {
    effect.set("output", &[output]);
    effect.set("grow", &[1.5]);
    effect.set("feather", &[2.0]);
    effect.set("motionBlur", &[0.8]);
    effect.set("motionBlurSamples", &[5.0]);
}

/// Checks that pictures of a format agree with the reference, however many threads and tiles draw them.
fn agrees(host: &Host, settings: &ClipSettings, (output, scale): (f64, f64), reference: &Picture) {
    let mut effect = effect(host, FILTER, settings);
    // The output has the components of the source, as in a host that gives no others.
    effect.set("output", &[OVERLAY]);
    effect.preferences();
    set(&mut effect, output);
    let mut first: Option<Picture> = None;
    for (threads, tile_rows, cpus) in [(1, 0, 1), (1, 7, 1), (4, 5, 1), (1, 0, 4)] {
        let what = format!("{output} {scale} {settings:?} {threads} {tile_rows} {cpus}");
        host.configure(&Settings { cpus, ..Settings::default() });
        assert_eq!(effect.render(2.0, scaled(WHOLE, scale), scale, threads, tile_rows), OK, "{what}");
        let picture = effect.output();
        assert_eq!((picture.damage, picture.untouched), (0, 0), "{what}");
        let wanted = channels(reference, picture.channels);
        let worst = picture.values.iter().zip(&wanted).map(|(a, b)| (a - b).abs()).fold(0.0, f32::max);
        assert!(picture.values.len() == wanted.len() && worst <= HALF_A_CODE, "{what}: {worst}");
        // Tiles and threads change no bit.
        assert!(first.get_or_insert_with(|| picture.clone()).values == picture.values, "{what}");
    }
}

#[test]
fn every_image_format_gives_the_same_picture() {
    let host = host();
    for output in [CUTOUT, MATTE, OVERLAY, IDS] {
        for scale in [1.0, 0.5] {
            let mut reference = effect(&host, FILTER, &ClipSettings::default());
            set(&mut reference, output);
            assert_eq!(reference.render(2.0, scaled(WHOLE, scale), scale, 1, 0), OK);
            let reference = reference.output();
            assert!(reference.values.iter().any(|v| *v > 0.1 && *v < 0.9));
            for (depth, components) in DEPTHS.iter().flat_map(|d| COMPONENTS.map(|c| (*d, c))) {
                for (padding, top_down, margin) in [(0, false, 0), (12, true, 3)] {
                    let (depth, components) = (depth.into(), components.into());
                    let plain = ClipSettings::default();
                    let settings = ClipSettings { depth, components, padding, top_down, margin, ..plain };
                    agrees(&host, &settings, (output, scale), &reference);
                }
            }
            clean(&host);
        }
    }
}

#[test]
fn a_source_without_alpha_has_an_output_with_alpha_where_there_is_one() {
    let host = host();
    let rgb = ClipSettings { components: "OfxImageComponentRGB".into(), ..ClipSettings::default() };
    let mut effect = effect(&host, FILTER, &rgb);
    effect.set_text("alphaParts", "star");
    let mut shown = |output: f64, channel: f64| {
        effect.set("output", &[output]);
        effect.set("matteChannel", &[channel]);
        let preferences = effect.preferences();
        let picture = rendered(&host, &mut effect, 2.0, WHOLE);
        let alphas: Vec<f32> =
            picture.values.chunks(picture.channels).filter_map(|pixel| pixel.get(3).copied()).collect();
        (preferences, picture.channels, alphas.contains(&0.0) && alphas.contains(&1.0))
    };
    for (output, channel) in [(CUTOUT, 0.0), (MATTE, 0.0), (MATTE, 1.0), (IDS, 0.0), (MATTES, 0.0)] {
        let (preferences, channels, has_alpha) = shown(output, channel);
        assert!(channels == 4 && has_alpha, "{output} {channel}: {preferences}");
        let ending =
            if channel == 0.0 { "RGBA OfxImageAlphaPremultiplied" } else { "RGBA OfxImageAlphaUnPremultiplied" };
        assert!(preferences.ends_with(ending), "{output} {channel}: {preferences}");
    }
    for (output, channel) in [(OVERLAY, 0.0), (PAINTED, 0.0), (MATTE, 2.0)] {
        assert_eq!(shown(output, channel).1, 3, "{output} {channel}");
    }
    let _ = host.messages();
    // A host that gives no alpha is told what is missing, once.
    effect.set("output", &[CUTOUT]);
    for _ in 0..2 {
        rendered(&host, &mut effect, 2.0, WHOLE);
    }
    let told = host.messages();
    assert!(told.len() == 1 && told[0].contains("without alpha"), "{told:?}");
}

/// By how much a picture is taller that threads divide among them. The usual one is drawn in one piece.
const TALLER: usize = 9;

#[test]
fn any_number_of_threads_draws_the_same_picture() {
    let host = host();
    let mut tall = scene();
    tall.footage.height = TALLER * HEIGHT;
    for part in &mut tall.parts {
        let shapes = part.keys.values_mut().chain(part.tracks.values_mut());
        shapes.flatten().for_each(|point| point.y *= TALLER as f64);
    }
    let clip = ClipSettings { y2: (TALLER * HEIGHT) as i32, ..ClipSettings::default() };
    let mut effect = effect(&host, FILTER, &clip);
    effect.set_frame("Source", 2.0, WIDTH, &pattern(2).repeat(TALLER));
    effect.set_text("document", &Document::new(tall).to_json());
    let whole = Bounds { y2: (TALLER * HEIGHT) as i32, ..WHOLE };
    for output in [CUTOUT, MATTE, OVERLAY, IDS] {
        set(&mut effect, output);
        for (grow, feather) in [(0.0, 0.0), (0.0, 2.0), (1.5, 2.0)] {
            effect.set("grow", &[grow]);
            effect.set("feather", &[feather]);
            let mut drawn = |cpus| {
                host.configure(&Settings { cpus, ..Settings::default() });
                rendered(&host, &mut effect, 2.0, whole)
            };
            let alone = drawn(1);
            let row = |y: usize| &alone.values[4 * y * WIDTH..4 * (y + 1) * WIDTH];
            assert!((100..300).all(|y| row(y).iter().any(|value| *value > 0.1)), "{output} {grow} {feather}");
            for cpus in [2, 3, 7] {
                assert!(drawn(cpus).values == alone.values, "{output} {grow} {feather} {cpus}");
            }
        }
    }
}

#[test]
fn a_tile_is_a_piece_of_the_whole() {
    let host = host();
    let mut effect = effect(&host, GENERAL, &ClipSettings { margin: 2, ..ClipSettings::default() });
    for output in [CUTOUT, MATTE, OVERLAY, IDS] {
        set(&mut effect, output);
        let whole = rendered(&host, &mut effect, 3.0, WHOLE);
        let window = Bounds { x1: 11, y1: 9, x2: 47, y2: 30 };
        let tile = rendered(&host, &mut effect, 3.0, window);
        for y in 0..tile.height {
            let start = 4 * ((y + 9) * WIDTH + 11);
            let row = &tile.values[4 * y * tile.width..4 * (y + 1) * tile.width];
            assert!(row == &whole.values[start..start + 4 * tile.width], "{output} {y}");
        }
    }
}

#[test]
fn a_picture_off_the_origin_is_the_same_picture() {
    let host = host();
    let mut here = effect(&host, FILTER, &ClipSettings::default());
    let there =
        ClipSettings { x1: -37, y1: 1000, x2: WIDTH as i32 - 37, y2: HEIGHT as i32 + 1000, ..ClipSettings::default() };
    let mut there = effect(&host, FILTER, &there);
    for output in [CUTOUT, MATTE, OVERLAY, IDS] {
        here.set("output", &[output]);
        there.set("output", &[output]);
        let shifted = Bounds { x1: -37, y1: 1000, x2: WIDTH as i32 - 37, y2: HEIGHT as i32 + 1000 };
        let (a, b) = (rendered(&host, &mut here, 1.0, WHOLE), rendered(&host, &mut there, 1.0, shifted));
        let worst = a.values.iter().zip(&b.values).map(|(a, b)| (a - b).abs()).fold(0.0, f32::max);
        assert!(worst < 1e-5, "{output}: {worst}");
    }
}

#[test]
fn premultiplication_is_honoured_both_ways() {
    let host = host();
    let source = |premultiplication: &str| ClipSettings {
        premultiplication: premultiplication.into(),
        ..ClipSettings::default()
    };
    let mut multiplied = effect(&host, FILTER, &source("OfxImageAlphaPremultiplied"));
    let mut separate = effect(&host, FILTER, &source("OfxImageAlphaUnPremultiplied"));
    let mut opaque = effect(&host, FILTER, &source("OfxImageOpaque"));
    assert!(separate.preferences().ends_with("OfxImageAlphaUnPremultiplied"));
    assert!(opaque.preferences().ends_with("OfxImageAlphaPremultiplied"), "{}", opaque.preferences());
    separate.set("output", &[MATTE]);
    assert!(separate.preferences().ends_with("OfxImageAlphaPremultiplied"));
    separate.set("output", &[CUTOUT]);
    separate.preferences();
    let (a, b, c) = (
        rendered(&host, &mut multiplied, 1.0, WHOLE),
        rendered(&host, &mut separate, 1.0, WHOLE),
        rendered(&host, &mut opaque, 1.0, WHOLE),
    );
    multiplied.set("output", &[MATTE]);
    multiplied.preferences();
    let matte = rendered(&host, &mut multiplied, 1.0, WHOLE);
    let source = pattern(1);
    for (k, pixel) in source.chunks(4).enumerate() {
        let m = matte.values[4 * k];
        let near = |found: f32, wanted: f32| assert!((found - wanted).abs() < 1e-5, "{k}: {found} {wanted}");
        for channel in 0..3 {
            near(a.values[4 * k + channel], pixel[channel] * m);
            near(b.values[4 * k + channel], if m > 0.0 { pixel[channel] } else { 0.0 });
            near(c.values[4 * k + channel], pixel[channel] * m);
        }
        near(a.values[4 * k + 3], pixel[3] * m);
        near(b.values[4 * k + 3], pixel[3] * m);
        near(c.values[4 * k + 3], m);
    }
}

#[test]
fn the_pixel_aspect_ratio_does_not_change_the_pixels() {
    let host = host();
    let mut square = effect(&host, FILTER, &ClipSettings::default());
    let mut wide = effect(&host, FILTER, &ClipSettings { aspect: 2.0, ..ClipSettings::default() });
    for effect in [&mut square, &mut wide] {
        effect.set("output", &[MATTE]);
    }
    assert!(rendered(&host, &mut square, 1.0, WHOLE).values == rendered(&host, &mut wide, 1.0, WHOLE).values);
}

#[test]
fn the_smallest_pictures() {
    let host = host();
    for (width, height) in [(1, 1), (1, 30), (30, 1)] {
        let source = ClipSettings { x2: width, y2: height, ..ClipSettings::default() };
        let mut effect = effect(&host, FILTER, &source);
        for output in [CUTOUT, MATTE, OVERLAY, IDS] {
            set(&mut effect, output);
            let window = Bounds { x1: 0, y1: 0, x2: width, y2: height };
            rendered(&host, &mut effect, 1.0, window);
            let nothing = Bounds { x1: 0, y1: 0, x2: 0, y2: 0 };
            assert_eq!(effect.render(1.0, nothing, 1.0, 1, 0), OK);
        }
        clean(&host);
    }
}
