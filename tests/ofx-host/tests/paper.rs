//! Tests of sources with transparent paper: what is tracked is what the command line sees.

use crate::buttons::{HEIGHT, WIDTH, with};
use crate::common::{FILTER, OK, ROTO, clean, host, kept, p, rendered};
use rototoon::geometry::{Point, polyline};
use rototoon::pipeline;
use rototoon::project::Document;
use rototoon::scene::{Part, Silent};
use rototoon::track::TrackOptions;
use rototoon_ofx_host::{Bounds, ClipSettings, Effect, Host};

const LAST: i32 = 4;
/// The first frame with a drawing. Those before are empty cels.
const FIRST: i32 = 1;

fn ring(frame: i32) -> Vec<Point> {
    let centre = p(40.0 + 6.0 * f64::from(frame), 60.0);
    (0..24).map(|k| centre + 22.0 * Point::from_angle(std::f64::consts::TAU * f64::from(k) / 24.0)).collect()
}

/// Black ink on nothing: the alpha of each pixel in bytes. Rows are from the top.
fn ink(frame: i32) -> Vec<u8> {
    let contour = ring(frame);
    let at = |k: usize| {
        let q = p((k % WIDTH) as f64 + 0.5, (k / WIDTH) as f64 + 0.5);
        let far = polyline::distance(q, &contour, true) - 1.0;
        if frame < FIRST { 0 } else { (255.0 * (0.5 - far).clamp(0.0, 1.0)).round() as u8 }
    };
    (0..WIDTH * HEIGHT).map(at).collect()
}

/// The drawing as a picture of the host, each pixel made of its ink. Rows are from the bottom.
fn picture(frame: i32, pixel: impl Fn(f32) -> [f32; 4]) -> Vec<f32> {
    let ink = ink(frame);
    let rows = (0..HEIGHT).rev().flat_map(|y| ink[y * WIDTH..(y + 1) * WIDTH].iter());
    rows.flat_map(|alpha| pixel(f32::from(*alpha) / 255.0)).collect()
}

fn document() -> Document {
    with(Part { name: "ring".into(), closed: true, keys: [(FIRST, ring(FIRST))].into(), ..Part::default() }, LAST)
}

fn node<'a>(host: &'a Host, id: &str, pixel: impl Fn(f32) -> [f32; 4]) -> Effect<'a> {
    let mut effect = host.effect(id, FILTER);
    let source = ClipSettings { x2: WIDTH as i32, y2: HEIGHT as i32, last: f64::from(LAST), ..ClipSettings::default() };
    effect.set_clip("Source", &source);
    effect.set_clip("Output", &source);
    for frame in 0..=LAST {
        effect.set_frame("Source", f64::from(frame), WIDTH, &picture(frame, &pixel));
    }
    assert_eq!(effect.create(), OK);
    effect
}

/// The farthest that a tracked point is from its place.
fn error(document: &Document) -> f64 {
    let tracks = &document.scene.parts[0].tracks;
    let apart =
        |frame: i32| tracks[&frame].iter().map(|q| polyline::distance(*q, &ring(frame), true)).fold(0.0, f64::max);
    (FIRST..=LAST).map(apart).fold(0.0, f64::max)
}

fn tracked(host: &Host, pixel: impl Fn(f32) -> [f32; 4]) -> Document {
    let mut effect = node(host, ROTO, pixel);
    effect.set_text("document", &document().to_json());
    assert_eq!(effect.press("track"), OK, "{:?}", host.messages());
    clean(host);
    kept(&effect)
}

#[test]
fn a_source_with_transparent_paper_is_tracked_as_the_command_line_does() {
    let folder = tempfile::tempdir().unwrap();
    for frame in 0..=LAST {
        let pixels = ink(frame).into_iter().flat_map(|alpha| [0, 0, 0, alpha]).collect();
        let image = image::RgbaImage::from_raw(WIDTH as u32, HEIGHT as u32, pixels).unwrap();
        image.save(folder.path().join(format!("{frame}.png"))).unwrap();
    }
    let mut wanted = document();
    pipeline::track(&mut wanted, folder.path(), &TrackOptions::default(), &Silent).unwrap();
    assert!(error(&wanted) < 0.5, "{}", error(&wanted));
    let host = host();
    let found = tracked(&host, |alpha| [0.0, 0.0, 0.0, alpha]);
    for (frame, points) in &wanted.scene.parts[0].tracks {
        let apart = points.iter().zip(&found.scene.parts[0].tracks[frame]).map(|(a, b)| a.distance(*b));
        let apart = apart.fold(0.0, f64::max);
        assert!(apart < 0.01, "{frame}: {apart}");
    }
}

#[test]
fn white_ink_and_colours_beside_an_alpha_of_zero_are_seen_too() {
    let host = host();
    let white = tracked(&host, |alpha| [alpha; 4]);
    assert!(error(&white) < 0.5, "{}", error(&white));
    // Some hosts give pictures without alpha so.
    let plate = tracked(&host, |alpha| [1.0 - alpha, 1.0 - alpha, 1.0 - alpha, 0.0]);
    assert!(error(&plate) < 0.5, "{}", error(&plate));
}

#[test]
fn lines_of_transparent_ink_are_seen_by_the_effect_lines() {
    let host = host();
    let count = |pixel: fn(f32) -> [f32; 4]| {
        let mut effect = node(&host, "org.rototoon.Lines", pixel);
        effect.set("output", &[1.0]);
        effect.preferences();
        let window = Bounds { x1: 0, y1: 0, x2: WIDTH as i32, y2: HEIGHT as i32 };
        let picture = rendered(&host, &mut effect, f64::from(FIRST), window);
        picture.values.chunks(4).filter(|pixel| pixel[0] > 0.5).count()
    };
    let (paper, clear) = (count(|a| [1.0 - a, 1.0 - a, 1.0 - a, 1.0]), count(|a| [0.0, 0.0, 0.0, a]));
    assert!(paper > 100 && paper == clear, "{paper} {clear}");
}
