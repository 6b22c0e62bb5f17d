//! What *Live* costs and saves: an edit beside a complete Track, and renders with and without frames to compare the source with.
//!
//! Prints the least of several times on the wall. Calls of the tests' host include its own work: it makes each image anew.

#[allow(dead_code, reason = "the tests use the rest")]
#[path = "../tests/common.rs"]
mod common;

use common::{FILTER, OK, OVERLAY, ROTO, host, kept, part};
use rototoon::geometry::Point;
use rototoon::project::Document;
use rototoon::scene::{Footage, Scene};
use rototoon_ofx_host::{Bounds, ClipSettings, Effect, Host};
use rototoon_tests::sample;
use std::time::{Duration, Instant};

/// Renders of each kind.
const RENDERS: usize = 12;

fn timed(work: impl FnOnce() -> String) -> Duration {
    let start = Instant::now();
    assert_eq!(work(), OK);
    start.elapsed()
}

/// An instance whose source has these frames, with Live on or off.
fn node<'a>(host: &'a Host, document: &str, frames: &[Vec<f32>], width: usize, live: bool) -> Effect<'a> {
    let mut effect = host.effect(ROTO, FILTER);
    let source = ClipSettings {
        x2: width as i32,
        y2: (frames[0].len() / 4 / width) as i32,
        last: frames.len() as f64 - 1.0,
        ..ClipSettings::default()
    };
    effect.set_clip("Source", &source);
    effect.set_clip("Output", &source);
    for (frame, pixels) in frames.iter().enumerate() {
        effect.set_frame("Source", frame as f64, width, pixels);
    }
    assert_eq!(effect.create(), OK);
    effect.set_text("document", document);
    effect.set("live", &[f64::from(u8::from(live))]);
    effect
}

/// Drags a point of a tracked frame.
fn correct(effect: &mut Effect, height: f64, (frame, point): (i32, usize)) -> String {
    let document = kept(effect);
    let from = document.scene.parts[0].tracks[&frame][point];
    let mut status = String::new();
    for (action, by) in [("PenDown", 0.0), ("PenMotion", 3.0), ("PenUp", 3.0)] {
        let at = [from.x + by, height - from.y];
        status = effect.overlay(&format!("OfxInteractAction{action}"), true, f64::from(frame), at, 0.02);
    }
    assert_eq!(kept(effect).scene.parts[0].pins.len(), document.scene.parts[0].pins.len() + 1);
    status
}

/// An edit of the sample cartoon: 16 parts, 24 frames of 960×540.
fn edit(host: &Host) {
    let drawings = sample::draw().unwrap();
    let document = sample::project(&drawings, sample::key_frames).to_string();
    let frame = |frame: usize| -> Vec<f32> {
        let picture = &drawings[frame / sample::HOLD].picture;
        let rows = picture.pixels().chunks(sample::WIDTH as usize).rev().flatten();
        rows.flat_map(|p| [p.red(), p.green(), p.blue(), p.alpha()]).map(|value| f32::from(value) / 255.0).collect()
    };
    let frames: Vec<Vec<f32>> = (0..sample::FRAMES).map(frame).collect();
    let mut effect = node(host, &document, &frames, sample::WIDTH as usize, true);
    let track = timed(|| effect.press("track"));
    let name = kept(&effect).scene.parts[0].name.clone();
    effect.set_text("parts", &name);
    let height = f64::from(sample::HEIGHT);
    println!("sample cartoon: Track {:.2} s", track.as_secs_f64());
    for (edit, place) in [(2, 0), (3, 1), (4, 2), (8, 0), (9, 1)].into_iter().enumerate() {
        let time = timed(|| correct(&mut effect, height, place));
        println!("edit {} on frame {}: {:.2} s", edit + 1, place.0, time.as_secs_f64());
    }
    println!("Track again {:.2} s", timed(|| effect.press("track")).as_secs_f64());
}

/// Renders of two parts that fill most of a picture of 3840×2160.
fn renders(host: &Host) {
    let (width, height) = (3840usize, 2160usize);
    let footage = Footage { pattern: "%d.png".into(), first: 0, last: 1, fps: 24.0, width, height, held: false };
    let ring = |middle: Point| {
        move |time: f64| -> Vec<Point> {
            let at = |k: usize| middle + Point::new(9.0 * time, 0.0) + 900.0 * Point::from_angle(0.26 * k as f64);
            (0..24).map(at).collect()
        }
    };
    let mut parts = vec![
        part("left", 1.0, true, ring(Point::new(1000.0, 1080.0))),
        part("right", 0.0, true, ring(Point::new(2800.0, 1080.0))),
    ];
    for part in &mut parts {
        part.keys = [0, 1].map(|frame| (frame, part.tracks[&frame].clone())).into();
        part.tracks.retain(|frame, _| *frame < 2);
    }
    let document = Document::new(Scene { footage, parts }).to_json();
    let value = |frame: usize, k: usize| ((k * 7 + frame) % 251) as f32 / 251.0;
    let frames: Vec<Vec<f32>> =
        (0..2).map(|frame| (0..4 * width * height).map(|k| value(frame, k / 4)).collect()).collect();
    let window = Bounds { x1: 0, y1: 0, x2: width as i32, y2: height as i32 };
    for (name, output) in [("cutout", 0.0), ("overlay", OVERLAY)] {
        let mut nodes = [false, true].map(|live| {
            let mut effect = node(host, &document, &frames, width, live);
            assert_eq!(effect.press("track"), OK, "{:?}", host.messages());
            effect.set("output", &[output]);
            effect
        });
        let mut least = [Duration::MAX; 2];
        for _ in 0..RENDERS {
            for (effect, least) in nodes.iter_mut().zip(&mut least) {
                *least = timed(|| effect.render(1.0, window, 1.0, 1, 0)).min(*least);
            }
        }
        assert!(host.messages().is_empty(), "nothing has changed");
        let [without, with] = least.map(|time| 1e3 * time.as_secs_f64());
        println!(
            "{name} of {width}x{height} floats: {without:.1} ms without frames, {with:.1} ms with frames to compare"
        );
    }
}

fn main() {
    // Cargo asks for the names of tests too.
    if std::env::args().any(|argument| argument == "--list") {
        return;
    }
    let host = host();
    edit(&host);
    renders(&host);
}
