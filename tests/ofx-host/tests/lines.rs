//! Tests of the effect that shows the images that a tracker of edges uses.

use crate::common::{FILTER, GENERAL, HEIGHT, OK, WHOLE, WIDTH, clean, host, rendered};
use rototoon::image::canny::{CannyOptions, canny};
use rototoon::image::distance_transform::manhattan;
use rototoon::image::mean_shift::{MeanShiftOptions, mean_shift};
use rototoon::scene::{Colour, Raster};
use rototoon_ofx_host::{ClipSettings, Effect, Host};

const LINES: &str = "org.rototoon.Lines";

/// A dark blob on light paper, with some noise. Rows are from the top.
fn picture() -> Raster<Colour> {
    Raster::from_fn(WIDTH, HEIGHT, |x, y| {
        let (dx, dy) = (x as f32 - 30.0, y as f32 - 22.0);
        let noise = ((x * 7 + y * 13) % 11) as f32 / 500.0;
        if dx * dx + 2.0 * dy * dy < 300.0 { [0.3 + noise, 0.2, 0.5] } else { [0.9 - noise, 0.9, 0.8] }
    })
}

fn instance<'a>(host: &'a Host, settings: &ClipSettings) -> Effect<'a> {
    let mut effect = host.effect(LINES, FILTER);
    effect.set_clip("Source", settings);
    effect.set_clip("Output", settings);
    let picture = picture();
    let mut values = Vec::with_capacity(4 * WIDTH * HEIGHT);
    // `flat_map` compiles to a branch on uninitialised memory, which valgrind reports.
    (0..HEIGHT).rev().for_each(|y| picture.row(y).iter().for_each(|&[r, g, b]| values.extend([r, g, b, 1.0])));
    effect.set_frame("Source", 1.0, WIDTH, &values);
    assert_eq!(effect.create(), OK);
    effect
}

#[test]
fn it_shows_what_the_core_computes() {
    let host = host();
    assert_eq!(host.contexts(LINES), [FILTER, GENERAL]);
    let mut effect = instance(&host, &ClipSettings::default());
    effect.set("sigma", &[1.0]);
    let filtered = mean_shift(&picture(), &MeanShiftOptions { radius: 5, range: 20, ..MeanShiftOptions::default() });
    let edges = canny(&filtered, &CannyOptions { sigma: 1.0, low: 50.0, high: 120.0, ..CannyOptions::default() });
    let distances = manhattan(&edges);
    assert!(edges.data().iter().filter(|edge| **edge).count() > 40);
    for output in 0..3 {
        effect.set("output", &[f64::from(output)]);
        effect.preferences();
        let found = rendered(&host, &mut effect, 1.0, WHOLE);
        for y in 0..HEIGHT {
            for x in 0..WIDTH {
                let wanted = match output {
                    0 => filtered.get(x, y)[0],
                    1 => f32::from(u8::from(edges.get(x, y))),
                    _ => distances.get(x, y) / 20.0,
                };
                let value = found.values[4 * ((HEIGHT - 1 - y) * WIDTH + x)];
                assert!((value - wanted).abs() < 1e-5, "{output} {x} {y}: {value} {wanted}");
            }
        }
    }
    clean(&host);
}

#[test]
fn every_image_format_is_supported() {
    let host = host();
    for depth in ["OfxBitDepthByte", "OfxBitDepthShort", "OfxBitDepthHalf", "OfxBitDepthFloat"] {
        for components in ["OfxImageComponentRGBA", "OfxImageComponentRGB", "OfxImageComponentAlpha"] {
            let settings = ClipSettings {
                depth: depth.into(),
                components: components.into(),
                padding: 5 * 4,
                top_down: true,
                margin: 2,
                ..ClipSettings::default()
            };
            let mut effect = instance(&host, &settings);
            for output in [0.0, 1.0, 2.0] {
                effect.set("output", &[output]);
                rendered(&host, &mut effect, 1.0, WHOLE);
                assert_eq!(effect.render(1.0, WHOLE, 0.5, 1, 0), OK);
            }
        }
    }
    let mut alone = instance(&host, &ClipSettings { connected: false, ..ClipSettings::default() });
    assert_eq!(alone.render(1.0, WHOLE, 1.0, 1, 0), "kOfxStatFailed");
}
