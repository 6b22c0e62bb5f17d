//! The matte is the same as that of the command line, and near the truth.

use crate::common::{FILTER, HEIGHT, MATTE, ROTO, WHOLE, WIDTH, clean, document, effect, host, p, rendered, scene};
use rototoon::geometry::Point;
use rototoon::project::Document;
use rototoon::render;
use rototoon::scene::{Footage, Part, Raster, Scene};
use rototoon_ofx_host::{Bounds, ClipSettings, Picture};
use rototoon_tests::sample::character::PARTS;
use rototoon_tests::sample::pose::DRAWINGS;
use rototoon_tests::sample::rig::Rig;
use rototoon_tests::sample::{FRAMES, HOLD};
use tiny_skia::{FillRule, Mask, PathBuilder, Transform};

/// The matte of a picture, with rows from the top.
fn matte(picture: &Picture) -> Raster<f32> {
    Raster::from_fn(picture.width, picture.height, |x, y| {
        picture.values[picture.channels * ((picture.height - 1 - y) * picture.width + x)]
    })
}

fn worst(a: &Raster<f32>, b: &Raster<f32>) -> f32 {
    a.data().iter().zip(b.data()).map(|(a, b)| (a - b).abs()).fold(0.0, f32::max)
}

/// The sample cartoon, tracked perfectly.
fn sample() -> Scene {
    let (width, height) = (rototoon_tests::sample::WIDTH as usize, rototoon_tests::sample::HEIGHT as usize);
    let footage =
        Footage { pattern: "%d.png".into(), first: 0, last: FRAMES as i32 - 1, fps: 24.0, width, height, held: false };
    let rigs: Vec<Rig> = DRAWINGS.iter().map(Rig::new).collect();
    let part = |index: usize| {
        let points = |frame: usize| rigs[frame / HOLD].outlines[index].points.clone();
        Part {
            name: format!("part {index}"),
            closed: rigs[0].outlines[index].closed,
            depth: index as f64,
            keys: [0, FRAMES - 1].map(|frame| (frame as i32, points(frame))).into(),
            tracks: (0..FRAMES).map(|frame| (frame as i32, points(frame))).collect(),
            ..Part::default()
        }
    };
    Scene { footage, parts: (0..PARTS.len()).map(part).collect() }
}

/// The union of polygons, drawn by tiny-skia.
fn by_tiny_skia(polygons: &[Vec<Point>], width: usize, height: usize) -> Raster<f32> {
    let mut mask = Mask::new(width as u32, height as u32).unwrap();
    let mut path = PathBuilder::new();
    for points in polygons {
        points.iter().enumerate().for_each(|(k, p)| {
            if k == 0 { path.move_to(p.x as f32, p.y as f32) } else { path.line_to(p.x as f32, p.y as f32) }
        });
        path.close();
        // Each polygon is filled by itself, so that opposite windings do not cancel.
        let one = std::mem::replace(&mut path, PathBuilder::new()).finish().unwrap();
        mask.fill_path(&one, FillRule::Winding, true, Transform::identity());
    }
    Raster::from_fn(width, height, |x, y| f32::from(mask.data()[y * width + x]) / 255.0)
}

#[test]
fn the_matte_of_the_sample_cartoon_is_that_of_the_command_line_and_near_the_truth() {
    let (host, scene) = (host(), sample());
    let (width, height) = (scene.footage.width, scene.footage.height);
    let source = ClipSettings { x2: width as i32, y2: height as i32, last: 23.0, ..ClipSettings::default() };
    let mut effect = host.effect(ROTO, FILTER);
    effect.set_clip("Source", &source);
    effect.set_clip("Output", &source);
    assert_eq!(effect.create(), "kOfxStatOK");
    effect.set("output", &[MATTE]);
    let json = Document::new(scene).to_json();
    effect.set_text("document", &json);
    let scene = Document::parse(&json, "the sample").unwrap().scene;
    for frame in [0, 7, 14] {
        let window = Bounds { x1: 0, y1: 0, x2: width as i32, y2: height as i32 };
        let found = matte(&rendered(&host, &mut effect, f64::from(frame), window));
        let shown = render::matte(&scene, frame, None);
        assert!(worst(&found, &shown) < 1e-4, "{frame}: {}", worst(&found, &shown));
        let closed = scene.parts.iter().filter(|part| part.closed);
        let polygons: Vec<Vec<Point>> = closed.filter_map(|part| part.outline(frame)).collect();
        let truth = by_tiny_skia(&polygons, width, height);
        let apart = found.data().iter().zip(truth.data()).map(|(a, b)| (a - b).abs());
        let far = apart.clone().filter(|d| *d > 0.3).count();
        let mean = apart.sum::<f32>() / (width * height) as f32;
        // tiny-skia computes coverage with 4 x 4 samples, and composites the coverages where parts meet.
        assert!(far < 60 && mean < 1e-3, "{frame}: {far} pixels, mean {mean}");
    }
    clean(&host);
}

#[test]
fn parts_are_chosen_by_name_and_offset_in_time() {
    let host = host();
    let mut effect = effect(&host, FILTER, &ClipSettings::default());
    effect.set("output", &[MATTE]);
    effect.set_text("parts", "st*");
    effect.set("frameOffset", &[10.0]);
    let found = matte(&rendered(&host, &mut effect, 13.0, WHOLE));
    let wanted = render::matte(&scene(), 3, Some(&[0]));
    assert!(worst(&found, &wanted) < 1e-5);
    effect.set_text("parts", "");
    effect.set("invert", &[1.0]);
    let found = matte(&rendered(&host, &mut effect, 13.0, WHOLE));
    let wanted = render::matte(&scene(), 3, None).map(|m| 1.0 - m);
    assert!(worst(&found, &wanted) < 1e-5);
}

#[test]
fn motion_blur_is_the_mean_of_the_outlines_on_their_arcs() {
    let host = host();
    let mut effect = effect(&host, FILTER, &ClipSettings::default());
    effect.set("output", &[MATTE]);
    effect.set("motionBlur", &[1.0]);
    effect.set("motionBlurSamples", &[4.0]);
    let found = matte(&rendered(&host, &mut effect, 2.0, WHOLE));
    let mut mean = Raster::new(WIDTH, HEIGHT, 0.0f32);
    for time in render::motion::shutter(2.0, 1.0, 4) {
        let parts = scene().parts;
        let outlines = parts.iter().filter(|part| part.closed);
        let outlines: Vec<_> = outlines.filter_map(|part| render::motion::outline_at(part, time, true)).collect();
        let one = render::matte::coverage(&outlines, WIDTH, HEIGHT);
        mean.data_mut().iter_mut().zip(one.data()).for_each(|(sum, value)| *sum += value / 4.0);
    }
    assert!(worst(&found, &mean) < 1e-5, "{}", worst(&found, &mean));
    let still = render::matte(&scene(), 2, None);
    assert!(worst(&found, &still) > 0.2);
}

#[test]
fn the_nearest_part_shows_in_ids_and_its_line_lies_above() {
    let host = host();
    let mut effect = effect(&host, FILTER, &ClipSettings::default());
    effect.set("output", &[3.0]);
    let ids = rendered(&host, &mut effect, 0.0, WHOLE);
    let at = |picture: &Picture, q: Point| {
        let k = 4 * ((HEIGHT - 1 - q.y as usize) * WIDTH + q.x as usize);
        [picture.values[k], picture.values[k + 1], picture.values[k + 2]]
    };
    // A point inside star and drop, one inside the drop only, one inside neither.
    let colour = |index: usize| rototoon::scene::palette::distinct(index);
    let near = |a: [f32; 3], b: [f32; 3]| a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-3);
    assert!(near(at(&ids, p(31.0, 22.0)), colour(0)), "{:?}", at(&ids, p(31.0, 22.0)));
    assert!(near(at(&ids, p(48.0, 28.0)), colour(1)));
    assert!(near(at(&ids, p(60.0, 4.0)), [0.0; 3]));
    let _ = document();
}
