//! Painted regions and strokes in the host are those of the command line, at any scale, in any tile and format.

use crate::common::{
    CEL, CELS, FILTER, HEIGHT, LINES, OK, OVERLAY, PAINT, PAINTED, ROTO, WHOLE, WIDTH, bundles, clean, drawn_document,
    host, pattern, rendered,
};
use image::{Rgba, RgbaImage};
use rototoon::image::colour;
use rototoon::pictures::Sequence;
use rototoon::pipeline::{self, Picture as Look, RenderJob};
use rototoon::project::Document;
use rototoon::render::encode::displayed;
use rototoon::render::form::Form;
use rototoon::render::paint::multiplied;
use rototoon::scene::{Footage, Raster, Silent};
use rototoon_ofx_host::{Bounds, ClipSettings, Effect, Host, Settings};
use std::path::Path;

const LINEAR: &str = "uk.co.thefoundry.nuke";
/// The name of straight alpha.
pub const STRAIGHT: &str = "OfxImageAlphaUnPremultiplied";

/// The picture of the command line for an output.
fn look(output: f64) -> Look {
    match output as usize {
        5 => Look::Paint,
        6 => Look::Painted,
        7 => Look::Lines,
        _ => Look::Cel,
    }
}

/// A drawing: paper that is transparent on the right, and grey ink.
fn drawing() -> RgbaImage {
    RgbaImage::from_fn(WIDTH as u32, HEIGHT as u32, |x, y| {
        let ink = (x * 3 + y * 7) % 11 < 3;
        let grey = if ink { (40 + 3 * x) as u8 } else { 250 };
        Rgba([grey, grey.saturating_sub(9), (grey / 2) + 100, if x < 40 { 255 } else { (255 - 2 * x - y) as u8 }])
    })
}

/// What the command line writes of a document for a frame, at a scale: as OpenEXR, linear light multiplied by alpha; and as PNG.
struct Written {
    light: Raster<[f32; 4]>,
    shown: RgbaImage,
}

fn written(text: &str, output: f64, frame: i32, scale: f64) -> Written {
    let folder = tempfile::tempdir().unwrap();
    let document = Document::parse(text, "cels").unwrap();
    (0..=4).for_each(|frame| drawing().save(folder.path().join(format!("f_{frame}.png"))).unwrap());
    let write = |ending: &str| {
        let output_path = folder.path().join(format!("out_%d.{ending}")).to_str().unwrap().to_owned();
        let job = RenderJob {
            picture: look(output),
            frames: Some(frame..=frame),
            offset: 0,
            parts: None,
            scale,
            form: Form::default(),
            output: output_path,
        };
        pipeline::render(&document, folder.path(), &job, &Silent).unwrap().remove(0)
    };
    let (exr, png) = (write("exr"), write("png"));
    assert!(exr.is_file());
    let size = |side: usize| (side as f64 * scale) as usize;
    let footage = Footage {
        pattern: "out_%d.exr".into(),
        width: size(WIDTH),
        height: size(HEIGHT),
        ..document.scene.footage.clone()
    };
    let light = Sequence::new(&footage, folder.path()).unwrap().layer(frame).unwrap();
    Written { light, shown: image::open(png).unwrap().to_rgba8() }
}

/// A node with a document over the drawing as the pixels of `source`, which are linear light or display values.
pub fn node<'a>(host: &'a Host, text: &str, output: f64, source: &ClipSettings, linear: bool) -> Effect<'a> {
    let mut effect = host.effect(ROTO, FILTER);
    effect.set_clip("Source", source);
    effect.set_clip("Output", source);
    let straight = source.premultiplication == STRAIGHT;
    let (mut values, picture) = (Vec::new(), drawing());
    for y in (0..HEIGHT as u32).rev() {
        for x in 0..WIDTH as u32 {
            let [r, g, b, alpha] = picture.get_pixel(x, y).0.map(|value| f32::from(value) / 255.0);
            let times = if straight { 1.0 } else { alpha };
            values.extend([r, g, b].map(|value| times * if linear { colour::decode(value) } else { value }));
            values.push(alpha);
        }
    }
    (0..=4).for_each(|frame| effect.set_frame("Source", f64::from(frame), WIDTH, &values));
    assert_eq!(effect.create(), OK);
    effect.set_text("document", text);
    effect.set("output", &[output]);
    effect.preferences();
    effect
}

/// The pixels of the last render from the top, as values for each pixel.
fn pixels(effect: &Effect) -> Vec<[f32; 4]> {
    let picture = effect.output();
    assert_eq!((picture.damage, picture.untouched, picture.channels), (0, 0, 4));
    let rows = picture.values.chunks_exact(4 * picture.width).rev();
    rows.flat_map(|row| row.as_chunks::<4>().0.to_vec()).collect()
}

/// A host of this name, with its plugins.
fn named(name: &str) -> Host {
    let mut host = host();
    host.configure(&Settings { name: name.into(), ..Settings::default() });
    host.reload(bundles());
    host
}

fn usual(mut host: Host) {
    clean(&host);
    host.configure(&Settings::default());
    host.reload(bundles());
}

/// The most by which pixels differ from those of the command line.
fn apart(found: &[[f32; 4]], wanted: &[[f32; 4]]) -> f32 {
    assert_eq!(found.len(), wanted.len());
    found.iter().flatten().zip(wanted.iter().flatten()).map(|(a, b)| (a - b).abs()).fold(0.0, f32::max)
}

/// The outputs and frames on which they have something to show.
fn cases() -> impl Iterator<Item = (f64, i32)> {
    let of = |output: f64| if output == LINES { &[1, 2, 3, 4][..] } else { &[1, 2][..] };
    CELS.into_iter().flat_map(move |output| of(output).iter().map(move |&frame| (output, frame)))
}

#[test]
fn floats_of_linear_hosts_are_those_of_the_command_line() {
    let host = named(LINEAR);
    for (output, frame) in cases() {
        let wanted = written(&drawn_document(), output, frame, 1.0).light;
        assert!(wanted.data().iter().filter(|pixel| pixel[3] > 0.02).count() > 80, "{output} {frame}");
        let mut effect = node(&host, &drawn_document(), output, &ClipSettings::default(), true);
        assert_eq!(effect.render(f64::from(frame), WHOLE, 1.0, 1, 0), OK);
        let worst = apart(&pixels(&effect), wanted.data());
        // The host's rows are counted from below.
        assert!(worst < 1e-6, "{output} {frame}: {worst}");
    }
    usual(host);
}

#[test]
fn proxies_of_linear_hosts_are_those_of_the_command_line() {
    let host = named(LINEAR);
    for (output, frame) in cases().filter(|(output, _)| *output != PAINTED) {
        let mut effect = node(&host, &drawn_document(), output, &ClipSettings::default(), true);
        for scale in [0.5, 0.25, 2.0] {
            let wanted = written(&drawn_document(), output, frame, scale).light;
            let side = |side: usize| (side as f64 * scale) as i32;
            let window = Bounds { x2: side(WIDTH), y2: side(HEIGHT), ..WHOLE };
            assert_eq!(effect.render(f64::from(frame), window, scale, 1, 0), OK);
            let worst = apart(&pixels(&effect), wanted.data());
            assert!(worst < 1e-6, "{output} {frame} {scale}: {worst}");
        }
    }
    usual(host);
}

#[test]
fn proxies_of_a_painted_drawing_are_its_proxy_over_that_of_the_paint() {
    let host = named(LINEAR);
    let mut effect = crate::common::effect(&host, FILTER, &ClipSettings::default());
    effect.set_text("document", &drawn_document());
    effect.set("output", &[PAINTED]);
    let paint = written(&drawn_document(), PAINT, 1, 0.5).light;
    let half = Bounds { x2: WIDTH as i32 / 2, y2: HEIGHT as i32 / 2, ..WHOLE };
    assert_eq!(effect.render(1.0, half, 0.5, 1, 0), OK);
    let (found, source) = (pixels(&effect), pattern(1));
    for (at, found) in found.iter().enumerate() {
        let (x, y) = (at % (WIDTH / 2), at / (WIDTH / 2));
        // The source's pixels are blocks, and its rows are counted from below.
        let first = 4 * ((HEIGHT - 1 - 2 * y) * WIDTH + 2 * x);
        let wanted = multiplied([0, 1, 2, 3].map(|k| source[first + k]), paint.get(x, y));
        assert!(apart(&[*found], &[wanted]) < 1e-6, "{x} {y}: {found:?} {wanted:?}");
    }
    assert_eq!(effect.destroy(), OK);
    usual(host);
}

#[test]
fn floats_of_other_hosts_are_display_colours() {
    let host = host();
    for (output, frame) in cases() {
        let wanted = written(&drawn_document(), output, frame, 1.0).light.map(displayed);
        let mut effect = node(&host, &drawn_document(), output, &ClipSettings::default(), false);
        assert_eq!(effect.render(f64::from(frame), WHOLE, 1.0, 1, 0), OK);
        let worst = apart(&pixels(&effect), wanted.data());
        assert!(worst < 2e-6, "{output} {frame}: {worst}");
    }
    clean(&host);
}

#[test]
fn bytes_are_those_of_the_command_line() {
    let host = host();
    for (output, frame) in cases() {
        let source = ClipSettings {
            depth: "OfxBitDepthByte".into(),
            premultiplication: STRAIGHT.into(),
            ..ClipSettings::default()
        };
        let wanted = written(&drawn_document(), output, frame, 1.0);
        let mut effect = node(&host, &drawn_document(), output, &source, false);
        let straight = output == PAINTED;
        assert_eq!(effect.preferences().ends_with(STRAIGHT), straight, "{output}");
        assert_eq!(effect.render(f64::from(frame), WHOLE, 1.0, 1, 0), OK);
        let byte = |value: f32| (value.clamp(0.0, 1.0) * 255.0).round() as u8;
        let light = wanted.light.data().iter();
        for (at, ((found, png), light)) in pixels(&effect).iter().zip(wanted.shown.pixels()).zip(light).enumerate() {
            // Straight as in the file, or the same colours multiplied.
            let wanted = if straight { png.0 } else { displayed(*light).map(byte) };
            let black = straight && png.0[3] == 0;
            assert!(black || found.map(byte) == wanted, "{output} {frame} {at}: {found:?} {wanted:?}");
        }
    }
    clean(&host);
}

#[test]
fn tiles_and_threads_change_no_bit() {
    let host = host();
    for (output, frame) in cases() {
        let mut effect = node(&host, &drawn_document(), output, &ClipSettings::default(), false);
        let time = f64::from(frame);
        let whole = rendered(&host, &mut effect, time, WHOLE);
        for window in [Bounds { x1: 11, y1: 9, x2: 47, y2: 30 }, Bounds { x1: 40, y1: 0, x2: 41, y2: 48 }] {
            let tile = rendered(&host, &mut effect, time, window);
            for y in 0..tile.height {
                let start = 4 * ((y + window.y1 as usize) * WIDTH + window.x1 as usize);
                let row = &tile.values[4 * y * tile.width..4 * (y + 1) * tile.width];
                assert!(row == &whole.values[start..start + 4 * tile.width], "{output} {frame} {y}");
            }
        }
        for (threads, rows, cpus) in [(1, 7, 1), (4, 5, 1), (1, 0, 4)] {
            host.configure(&Settings { cpus, ..Settings::default() });
            assert_eq!(effect.render(time, WHOLE, 1.0, threads, rows), OK);
            assert!(effect.output() == whole, "{output} {frame} {threads} {rows} {cpus}");
        }
        host.configure(&Settings::default());
    }
    clean(&host);
}

#[test]
fn every_depth_and_component_has_the_same_picture() {
    let host = host();
    for output in CELS {
        let mut plain = node(&host, &drawn_document(), output, &ClipSettings::default(), false);
        let reference = rendered(&host, &mut plain, 1.0, WHOLE);
        for depth in ["OfxBitDepthByte", "OfxBitDepthShort", "OfxBitDepthHalf", "OfxBitDepthFloat"] {
            for (components, kept) in [("RGBA", 0..4), ("RGB", 0..3), ("Alpha", 3..4)] {
                // A source without alpha is another drawing.
                if output == PAINTED && components == "RGB" {
                    continue;
                }
                let components = format!("OfxImageComponent{components}");
                let clip = ClipSettings { depth: depth.into(), components, ..ClipSettings::default() };
                let mut effect = node(&host, &drawn_document(), output, &clip, false);
                // The output has the components of the source, as in a host that gives no others.
                effect.set("output", &[OVERLAY]);
                effect.preferences();
                effect.set("output", &[output]);
                let found = rendered(&host, &mut effect, 1.0, WHOLE);
                assert_eq!(found.channels, kept.len());
                let wanted = reference.values.chunks(4).flat_map(|pixel| pixel[kept.clone()].to_vec());
                let worst = found.values.iter().zip(wanted).map(|(a, b)| (a - b).abs()).fold(0.0, f32::max);
                // A source in bytes is rounded already, and dark colours rise steeply from light.
                let most = if output == PAINTED { 3.0 / 255.0 } else { 0.5 / 255.0 + 1e-4 };
                assert!(worst <= most, "{output} {clip:?}: {worst}");
            }
        }
    }
    clean(&host);
}

#[test]
fn wide_pixels_and_another_place_do_not_change_the_picture() {
    let host = host();
    for output in CELS {
        let draw = |clip: &ClipSettings, window: Bounds| {
            let mut effect = node(&host, &drawn_document(), output, clip, false);
            assert_eq!(effect.render(1.0, window, 1.0, 1, 0), OK);
            pixels(&effect)
        };
        let plain = draw(&ClipSettings::default(), WHOLE);
        assert!(apart(&draw(&ClipSettings { aspect: 1.4568, ..ClipSettings::default() }, WHOLE), &plain) < 1e-6);
        let there = Bounds { x1: -37, y1: 1000, x2: WIDTH as i32 - 37, y2: HEIGHT as i32 + 1000 };
        let clip = ClipSettings { x1: there.x1, y1: there.y1, x2: there.x2, y2: there.y2, ..ClipSettings::default() };
        assert!(apart(&draw(&clip, there), &plain) < 1e-5, "{output}");
    }
    clean(&host);
}

#[test]
fn strokes_are_stretched_with_the_footage() {
    let host = host();
    // Pixels of twice the width and the same height: each is a pair of the original's columns.
    let wide = ClipSettings { x2: 2 * WIDTH as i32, ..ClipSettings::default() };
    let mut effect = node(&host, &drawn_document(), LINES, &wide, false);
    let sum = |values: Vec<[f32; 4]>| values.iter().map(|pixel| pixel[3]).sum::<f32>();
    assert_eq!(effect.render(1.0, Bounds { x2: wide.x2, ..WHOLE }, 1.0, 1, 0), OK);
    let stretched = pixels(&effect);
    assert!(host.messages().iter().any(|text| text.contains("64x48")));
    let mut effect = node(&host, &drawn_document(), LINES, &ClipSettings::default(), false);
    assert_eq!(effect.render(1.0, WHOLE, 1.0, 1, 0), OK);
    let plain = pixels(&effect);
    for (at, pixel) in plain.iter().enumerate() {
        let (x, y) = (at % WIDTH, at / WIDTH);
        let mean = (0..2).map(|k| stretched[2 * WIDTH * y + 2 * x + k][3]).sum::<f32>() / 2.0;
        assert!((mean - pixel[3]).abs() < 0.03, "{x} {y}: {mean} {}", pixel[3]);
    }
    assert!((sum(stretched) / sum(plain) - 2.0).abs() < 0.01);
}

#[test]
fn an_aborted_render_of_paint_ends_early() {
    let host = host();
    for output in CELS {
        let mut effect = node(&host, &drawn_document(), output, &ClipSettings::default(), false);
        for after in [0, 1, 20, 60] {
            host.configure(&Settings { abort_after: after, cpus: 2, ..Settings::default() });
            assert_eq!(effect.render(1.0, WHOLE, 1.0, 1, 0), "kOfxStatFailed", "{output} {after}");
            assert_eq!(host.live_images(), 0);
        }
        host.configure(&Settings::default());
        let _ = (host.log(), host.messages());
        rendered(&host, &mut effect, 1.0, WHOLE);
        assert_eq!(host.messages(), [""; 0]);
    }
}

#[test]
fn paint_of_a_file_is_shown_loaded_and_saved() {
    let host = host();
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("a.json");
    std::fs::write(&file, drawn_document()).unwrap();
    let mut effect = node(&host, "", CEL, &ClipSettings::default(), false);
    effect.set_text_silently("project", file.to_str().unwrap());
    let of_file = rendered(&host, &mut effect, 1.0, WHOLE);
    assert_eq!(effect.press("load"), OK);
    assert!(rendered(&host, &mut effect, 1.0, WHOLE) == of_file && of_file.values.contains(&1.0));
    // An edit of a part leaves it alone.
    effect.set_text("part", "star");
    assert_eq!(effect.press("deletePart"), OK);
    std::fs::remove_file(&file).unwrap();
    assert_eq!(effect.press("save"), OK);
    let saved = Document::load(&file).unwrap();
    let kept = Document::parse(&drawn_document(), "kept").unwrap();
    assert_eq!((saved.filled(), saved.traced()), (kept.filled(), kept.traced()));
    assert!(rendered(&host, &mut effect, 1.0, WHOLE) == of_file);
    clean(&host);
}

#[test]
fn cels_are_looked_at() {
    const ZOOM: usize = 6;
    let host = host();
    let (width, height) = (WIDTH * ZOOM, HEIGHT * ZOOM);
    let mut sheet = RgbaImage::new(2 * width as u32, 2 * height as u32);
    for (place, output) in CELS.into_iter().enumerate() {
        let mut effect = node(&host, &drawn_document(), output, &ClipSettings::default(), false);
        // What is drawn without the source is drawn at twice its size: it is sharper.
        let scale = if output == PAINTED { 1 } else { 2 };
        let window = Bounds { x2: scale * WIDTH as i32, y2: scale * HEIGHT as i32, ..WHOLE };
        assert_eq!(effect.render(1.0, window, f64::from(scale), 1, 0), OK);
        let (found, scale) = (pixels(&effect), scale as usize);
        for (x, y) in (0..width).flat_map(|x| (0..height).map(move |y| (x, y))) {
            let [r, g, b, alpha] = found[scale * WIDTH * (y * scale / ZOOM) + x * scale / ZOOM];
            let checked = if (x / 12 + y / 12) % 2 == 0 { 0.8 } else { 0.6 };
            let seen = [r, g, b].map(|value| (255.0 * (value + checked * (1.0 - alpha))) as u8);
            let (left, top) = (place % 2 * width, place / 2 * height);
            sheet.put_pixel((left + x) as u32, (top + y) as u32, Rgba([seen[0], seen[1], seen[2], 255]));
        }
    }
    sheet.save(Path::new(env!("CARGO_TARGET_TMPDIR")).join("cels.png")).unwrap();
}
