//! The sample cartoon in the host alone: drawn with the pen on two frames, tracked, corrected, tracked again, rendered.
//!
//! The result is that of the core's own tracker on the same keys and corrections, to the last bit. It is also that of the
//! session that C and Python have, which gets the drawn keys, tracks, sets the pin, and tracks again.

use crate::common::{FILTER, MATTE, OK, ROTO, clean, host, kept, lay_lines, rendered};
use rototoon::geometry::Point;
use rototoon::pipeline;
use rototoon::project::Document;
use rototoon::render;
use rototoon::scene::{Colour, FrameError, FrameNumber, FrameSource, Part, Raster, Scene, Silent};
use rototoon::track::{TrackOptions, Tracker};
use rototoon_capi::edit;
use rototoon_capi::session::Session;
use rototoon_ofx_host::{Bounds, ClipSettings, Effect, Host};
use rototoon_tests::sample::character::PARTS;
use rototoon_tests::sample::{self, Drawn, HOLD};
use std::path::Path;
use std::sync::Arc;
use tiny_skia::{Pixmap, PremultipliedColorU8};

const DOWN: &str = "OfxInteractActionPenDown";
const MOVE: &str = "OfxInteractActionPenMotion";
const UP: &str = "OfxInteractActionPenUp";
/// Half the size of the sample, so that the test is short.
const WIDTH: usize = sample::WIDTH as usize / 2;
const HEIGHT: usize = sample::HEIGHT as usize / 2;
/// The frames that are drawn on: those of the first and the third drawing.
const KEYS: [FrameNumber; 2] = [0, 4];
/// Composition's frame of the first frame.
const FIRST: f64 = 1001.0;
/// Parts that are drawn: enough for a figure.
const DRAWN: usize = 8;

/// The pictures of the drawings at half size, with rows from the top.
fn pictures(drawings: &[Drawn]) -> Vec<Arc<Raster<Colour>>> {
    let half = |drawn: &Drawn| {
        let picture = &drawn.picture;
        let value = |x: usize, y: usize, c: usize| {
            let at = |dx: usize, dy: usize| {
                let pixel = picture.pixels()[(2 * y + dy) * picture.width() as usize + 2 * x + dx];
                [pixel.red(), pixel.green(), pixel.blue()][c]
            };
            let sum = [(0, 0), (1, 0), (0, 1), (1, 1)].map(|(dx, dy)| u32::from(at(dx, dy))).iter().sum::<u32>();
            (sum / 4) as f32 / 255.0
        };
        Arc::new(Raster::from_fn(WIDTH, HEIGHT, |x, y| [0, 1, 2].map(|c| value(x, y, c))))
    };
    drawings.iter().take(3).map(half).collect()
}

struct Film<'a>(&'a [Arc<Raster<Colour>>]);

impl FrameSource for Film<'_> {
    fn picture(&self, frame: FrameNumber) -> Result<Arc<Raster<Colour>>, FrameError> {
        Ok(self.0[(frame as usize - FIRST as usize) / HOLD].clone())
    }
}

fn node<'a>(host: &'a Host, film: &[Arc<Raster<Colour>>]) -> Effect<'a> {
    let mut effect = host.effect(ROTO, FILTER);
    let last = FIRST + f64::from(KEYS[1]);
    let source = ClipSettings { x2: WIDTH as i32, y2: HEIGHT as i32, first: FIRST, last, ..ClipSettings::default() };
    effect.set_clip("Source", &source);
    effect.set_clip("Output", &source);
    for frame in 0..=KEYS[1] {
        let picture = &film[frame as usize / HOLD];
        let rows = (0..HEIGHT).rev().flat_map(|y| picture.row(y).iter().flat_map(|[r, g, b]| [*r, *g, *b, 1.0]));
        effect.set_frame("Source", FIRST + f64::from(frame), WIDTH, &rows.collect::<Vec<f32>>());
    }
    assert_eq!(effect.create(), OK);
    effect
}

fn shown(p: Point) -> [f64; 2] {
    [p.x, HEIGHT as f64 - p.y]
}

/// The outline of a part at half size.
fn outline(drawings: &[Drawn], part: usize, frame: FrameNumber) -> Vec<Point> {
    drawings[frame as usize / HOLD].outlines[part].points.iter().map(|p| *p * 0.5).collect()
}

/// Draws the parts on a frame, point by point.
fn draw(host: &Host, effect: &mut Effect, drawings: &[Drawn], frame: FrameNumber) {
    let time = FIRST + f64::from(frame);
    effect.set("tool", &[1.0]);
    for (part, paint) in PARTS.iter().enumerate().take(DRAWN) {
        effect.set_text("part", paint.name);
        let points = outline(drawings, part, frame);
        for &p in points.iter().chain(&points[..1]) {
            // Zoomed in so far that neighbouring points are apart on the screen.
            assert_eq!(effect.overlay(DOWN, true, time, shown(p), 0.02), OK, "{:?}", host.messages());
            assert_eq!(effect.overlay(UP, true, time, shown(p), 0.02), OK);
        }
    }
    effect.set("tool", &[0.0]);
}

/// Puts the overlay over a frame into a picture in the folder of the tests' files, to look at.
fn photograph(effect: &mut Effect, film: &[Arc<Raster<Colour>>], frame: FrameNumber, name: &str) {
    const ZOOM: f32 = 2.0;
    let time = FIRST + f64::from(frame);
    assert_eq!(effect.overlay("OfxInteractActionDraw", true, time, [0.0; 2], 1.0 / f64::from(ZOOM)), OK);
    let picture = &film[frame as usize / HOLD];
    let (width, height) = (WIDTH as u32 * ZOOM as u32, HEIGHT as u32 * ZOOM as u32);
    let mut shown = Pixmap::new(width, height).unwrap();
    for (k, pixel) in shown.pixels_mut().iter_mut().enumerate() {
        let (x, y) = (k % width as usize / ZOOM as usize, k / width as usize / ZOOM as usize);
        let [r, g, b] = picture.get(x, y).map(|value| (255.0 * (0.5 + 0.5 * value)) as u8);
        *pixel = PremultipliedColorU8::from_rgba(r, g, b, 255).unwrap();
    }
    lay_lines(effect, &mut shown, ZOOM);
    let file = Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("overlay-{name}.png"));
    shown.save_png(file).unwrap();
}

/// The core's own track of a document.
fn followed(document: &Document, film: &[Arc<Raster<Colour>>]) -> Scene {
    let mut scene = document.scene.clone();
    let options = TrackOptions::default();
    let tracking = Tracker::new(options).track(&pipeline::in_effect(&scene), &Film(film), &Silent).unwrap();
    pipeline::store(&mut scene, &tracking);
    // Rounded as in documents.
    Document::parse(&Document::new(scene).to_json(), "the reference").unwrap().scene
}

/// The scene of a session of C and Python, in the document's digits.
fn scene_of(session: &Session) -> Scene {
    Document::parse(&session.document(), "the session").unwrap().scene
}

/// A session of C and Python with the drawn keys. Its film is files in a folder.
fn session(drawn: &Document, film: &[Arc<Raster<Colour>>], folder: &Path) -> Session {
    for frame in 0..=KEYS[1] {
        let picture = &film[frame as usize / HOLD];
        let file = folder.join(format!("f_{:04}.png", FIRST as i32 + frame));
        let byte = |x: u32, y: u32, c: usize| (picture.get(x as usize, y as usize)[c] * 255.0).round() as u8;
        let image =
            image::RgbImage::from_fn(WIDTH as u32, HEIGHT as u32, |x, y| image::Rgb([0, 1, 2].map(|c| byte(x, y, c))));
        image.save(file).unwrap();
    }
    let mut document = drawn.clone();
    document.scene.footage.pattern = "f_%04d.png".into();
    Session::new(&document.to_json(), folder).unwrap()
}

/// The share of points within two pixels of the truth, on the frames between the keys.
fn good(scene: &Scene, drawings: &[Drawn]) -> f64 {
    let (mut good, mut all) = (0, 0);
    for (index, part) in scene.parts.iter().enumerate() {
        for frame in KEYS[0] + 1..KEYS[1] {
            let truth = outline(drawings, index, frame);
            let found = &part.tracks[&(frame + FIRST as i32)];
            good += found.iter().zip(&truth).filter(|(a, b)| a.distance(**b) <= 2.0).count();
            all += truth.len();
        }
    }
    f64::from(good as u32) / f64::from(all as u32)
}

/// Draws the parts on the key frames with the pen, and returns the document. Its keys are where they were drawn.
fn drawn(host: &Host, effect: &mut Effect, drawings: &[Drawn]) -> Document {
    for frame in KEYS {
        draw(host, effect, drawings, frame);
    }
    let drawn = kept(effect);
    assert_eq!(drawn.scene.parts.len(), DRAWN);
    for (index, part) in drawn.scene.parts.iter().enumerate() {
        for frame in KEYS {
            let wanted = outline(drawings, index, frame);
            let key = &part.keys[&(frame + FIRST as i32)];
            assert!(key.iter().zip(&wanted).all(|(a, b)| a.distance(*b) < 1e-4), "{} {frame}", part.name);
        }
    }
    drawn
}

/// Moves the worst point of a tracked frame to its true place with the pen, and returns the document.
fn corrected(effect: &mut Effect, tracked: &Document, drawings: &[Drawn], frame: FrameNumber) -> Document {
    let (time, number) = (FIRST + f64::from(frame), frame + FIRST as i32);
    let worst = (0..DRAWN).flat_map(|part| {
        let truth = outline(drawings, part, frame);
        let found = tracked.scene.parts[part].tracks[&number].clone();
        truth.into_iter().zip(found).enumerate().map(move |(point, (truth, found))| (part, point, truth, found))
    });
    let (part, point, truth, found) = worst.max_by(|a, b| a.2.distance(a.3).total_cmp(&b.2.distance(b.3))).unwrap();
    effect.set_text("parts", PARTS[part].name);
    for (action, at) in [(DOWN, found), (MOVE, truth), (UP, truth)] {
        assert_eq!(effect.overlay(action, true, time, shown(at), 0.02), OK);
    }
    effect.set_text("parts", "");
    let corrected = kept(effect);
    effect.overlay(DOWN, true, time, [5.0, 5.0], 0.5);
    effect.overlay(UP, true, time, [300.0, 250.0], 0.5);
    assert!(corrected.scene.parts[part].pins[&number][&point].distance(truth) < 1e-3);
    corrected
}

/// Checks that the matte of a frame is that of the command line.
fn same_matte(host: &Host, effect: &mut Effect, scene: &Scene, frame: FrameNumber) {
    effect.set("output", &[MATTE]);
    let window = Bounds { x1: 0, y1: 0, x2: WIDTH as i32, y2: HEIGHT as i32 };
    let picture = rendered(host, effect, FIRST + f64::from(frame), window);
    let wanted = render::matte(scene, frame + FIRST as i32, None);
    let apart = |y: usize, x: usize| (picture.values[4 * ((HEIGHT - 1 - y) * WIDTH + x)] - wanted.get(x, y)).abs();
    let most = (0..HEIGHT).flat_map(|y| (0..WIDTH).map(move |x| (y, x))).map(|(y, x)| apart(y, x)).fold(0.0, f32::max);
    assert!(most < 1e-5, "{most}");
}

/// Whether the parts have the same tracks and confidence.
fn same_tracks(a: &Scene, b: &Scene) -> bool {
    let same = |(a, b): (&Part, &Part)| a.name == b.name && a.tracks == b.tracks && a.confidence == b.confidence;
    a.parts.len() == b.parts.len() && a.parts.iter().zip(&b.parts).all(same)
}

/// Undoes the host's steps until after the latest one with this label.
fn undo(effect: &mut Effect, label: &str) {
    while effect.history().last().is_some_and(|own| own != label) {
        effect.undo();
    }
    effect.undo();
}

/// Fixes in a session all points that are fixed in a scene.
fn pin_as_in(session: &mut Session, scene: &Scene) {
    for part in &scene.parts {
        for (&frame, pins) in &part.pins {
            for (&point, &to) in pins {
                edit::pin(session.scene_mut(), &part.name, frame, point as i64, to).unwrap();
            }
        }
    }
}

#[test]
fn a_cartoon_is_drawn_tracked_corrected_and_rendered_in_the_host() {
    let host = host();
    let drawings = sample::draw().unwrap();
    let film = pictures(&drawings);
    let mut effect = node(&host, &film);
    let drawn = drawn(&host, &mut effect, &drawings);
    photograph(&mut effect, &film, KEYS[1], "drawn");
    photograph(&mut effect, &film, 1, "old");
    let before = (effect.text("document"), effect.text("state"));
    assert_eq!(effect.press_at("track", FIRST), OK, "{:?}", host.messages());
    let tracked = kept(&effect);
    assert!(tracked.scene.parts == followed(&drawn, &film).parts, "as the core tracks the same keys");
    let first = good(&tracked.scene, &drawings);

    let frame = 2;
    let corrected = corrected(&mut effect, &tracked, &drawings, frame);
    photograph(&mut effect, &film, frame, "corrected");
    let middle = (effect.text("document"), effect.text("state"));
    assert_eq!(effect.press_at("track", FIRST), OK, "{:?}", host.messages());
    let again = kept(&effect);
    assert!(again.scene.parts == followed(&corrected, &film).parts);
    let second = good(&again.scene, &drawings);
    println!("good: {first:.4}, after a correction {second:.4}");
    assert!(first > 0.8 && second >= first - 0.01, "{first} {second}");
    let folder = tempfile::tempdir().unwrap();
    let mut session = session(&drawn, &film, folder.path());
    session.track("{}", None).unwrap();
    assert!(same_tracks(&scene_of(&session), &tracked.scene), "the session of Python");
    pin_as_in(&mut session, &corrected.scene);
    session.track("{}", None).unwrap();
    assert!(same_tracks(&scene_of(&session), &again.scene), "the session of Python after the correction");
    same_matte(&host, &mut effect, &again.scene, frame);

    // Each step of the host's undo gives back the bytes.
    undo(&mut effect, "Track");
    assert!((effect.text("document"), effect.text("state")) == middle, "the second track");
    undo(&mut effect, "Move points");
    undo(&mut effect, "Track");
    assert!((effect.text("document"), effect.text("state")) == before, "correction and first track");
    clean(&host);
}
