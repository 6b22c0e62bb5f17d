//! The bundle, documents and pictures for the tests.

use rototoon::geometry::Point;
use rototoon::project::Document;
use rototoon::scene::{Footage, Part, Scene};
use rototoon_ofx_host::{Bounds, ClipSettings, Effect, Host, Picture};
use serde_json::{Value, json};
use std::path::{Path, PathBuf};
use std::sync::OnceLock;
use tiny_skia::{Color, Paint, PathBuilder, Pixmap, Stroke, Transform};

/// The effect's id.
pub const ROTO: &str = "org.rototoon.Roto";
/// The context with one input.
pub const FILTER: &str = "OfxImageEffectContextFilter";
/// The context with any inputs.
pub const GENERAL: &str = "OfxImageEffectContextGeneral";
/// The status of success.
pub const OK: &str = "kOfxStatOK";

/// Width of the test footage.
pub const WIDTH: usize = 64;
/// Height of the test footage.
pub const HEIGHT: usize = 48;

/// Index of the output Cutout.
pub const CUTOUT: f64 = 0.0;
/// Index of the output Matte.
pub const MATTE: f64 = 1.0;
/// Index of the output Overlay.
pub const OVERLAY: f64 = 2.0;
/// Index of the output Ids.
pub const IDS: f64 = 3.0;

/// Index of the output Mattes.
pub const MATTES: f64 = 4.0;
/// Index of the output Paint.
pub const PAINT: f64 = 5.0;
/// Index of the output Painted.
pub const PAINTED: f64 = 6.0;
/// Index of the output Lines.
pub const LINES: f64 = 7.0;
/// Index of the output Cel.
pub const CEL: f64 = 8.0;

/// All outputs.
pub const OUTPUTS: [f64; 9] = [CUTOUT, MATTE, OVERLAY, IDS, MATTES, PAINT, PAINTED, LINES, CEL];
/// Those that show painted regions and strokes.
pub const CELS: [f64; 4] = [PAINT, PAINTED, LINES, CEL];

/// A folder that contains only a bundle, because hosts scan everything in it. The bundle has the library of the bundle that
/// the variable `ROTOTOON_OFX_BUNDLE` names, or else the library built with the tests. Optimised tests have a folder of their
/// own: under valgrind they run for long, and other tests must not change their plugin meanwhile.
pub fn bundles() -> &'static Path {
    static FOLDER: OnceLock<PathBuf> = OnceLock::new();
    FOLDER.get_or_init(|| {
        let name = if cfg!(debug_assertions) { "ofx-bundles" } else { "ofx-bundles-release" };
        let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join(name);
        let inner = folder.join("Rototoon.ofx.bundle/Contents/Linux-x86-64");
        std::fs::create_dir_all(&inner).unwrap();
        let library = match std::env::var_os("ROTOTOON_OFX_BUNDLE") {
            Some(bundle) => Path::new(&bundle).join("Contents/Linux-x86-64/Rototoon.ofx"),
            None => std::env::current_exe().unwrap().with_file_name("librototoon_ofx.so"),
        };
        // The library gets another name first, because a running test may have the old one open.
        let new = inner.join(format!("new-{}", std::process::id()));
        std::fs::copy(&library, &new).unwrap_or_else(|error| panic!("{library:?}: {error}"));
        std::fs::rename(new, inner.join("Rototoon.ofx")).unwrap();
        folder
    })
}

/// A host with the plugin.
pub fn host() -> Host {
    Host::open(bundles())
}

/// A point.
pub fn p(x: f64, y: f64) -> Point {
    Point::new(x, y)
}

/// Footage of the test size.
pub fn footage() -> Footage {
    Footage { pattern: "f_%d.png".into(), first: 0, last: 4, fps: 24.0, width: WIDTH, height: HEIGHT, held: false }
}

/// A part with tracks on frames 0 to 4.
pub fn part(name: &str, depth: f64, closed: bool, contour: impl Fn(f64) -> Vec<Point>) -> Part {
    // Rounded as in documents.
    let rounded = |p: Point| (p * 1e4).round() / 1e4;
    let contour = |frame: f64| contour(frame).into_iter().map(rounded).collect::<Vec<_>>();
    let tracks = (0..=4).map(|frame| (frame, contour(f64::from(frame)))).collect();
    let keys = [0, 4].map(|frame| (frame, contour(f64::from(frame)))).into();
    Part { name: name.into(), closed, depth, keys, tracks, ..Part::default() }
}

/// A star, a drop behind it, and an open line, all moving.
pub fn scene() -> Scene {
    let star = |frame: f64| {
        let at = |k: usize| {
            let radius = if k.is_multiple_of(2) { 16.0 } else { 7.3 };
            p(26.0 + 2.0 * frame, 21.0) + Point::from_angle(0.1 + 0.2 * frame + 0.6283185 * k as f64) * radius
        };
        (0..10).map(at).collect()
    };
    let drop = |frame: f64| vec![p(30.0, 8.0 + frame), p(55.3, 20.1), p(50.0, 41.7), p(33.3, 39.0 - frame)];
    let line = |frame: f64| vec![p(3.0, 44.0), p(20.0, 40.0 - frame), p(60.0, 46.0)];
    let parts =
        vec![part("star", 2.0, true, star), part("drop", 1.0, true, drop), part("ground line", 0.0, false, line)];
    Scene { footage: footage(), parts }
}

/// The scene as a document.
pub fn document() -> String {
    Document::new(scene()).to_json()
}

/// The scene with painted regions on the frames 1 and 2, traced strokes on the same, a drawing on 3, and an in-between on 4.
pub fn drawn_document() -> String {
    let square = |x: f64, y: f64, side: f64| json!([[x, y], [x + side, y], [x + side, y + 0.8 * side], [x, y + side]]);
    let region = |track: u32, outline: &Value, holes: &[Value], colour: [f32; 3]| json!({"track": track, "outline": outline, "holes": holes, "colour": colour});
    let painted = |x: f64| {
        let (wall, door) = (square(4.3 + x, 3.2, 40.0), square(12.1 + x, 9.7, 14.4));
        let front = region(5, &square(30.0, 20.5 - x, 33.0), &[], [0.1, 0.2, 0.9]);
        let wall = region(0, &wall, std::slice::from_ref(&door), [0.8, 0.4, 0.2]);
        json!([wall, region(3, &door, &[], [1.0, 0.9, 0.1]), front])
    };
    let line = |x: f64| {
        let points = [[2.0 + x, 40.2], [20.4, 8.8 + x], [44.0, 30.0], [61.0, 4.5]];
        json!({"track": 0, "points": points, "closed": false, "widths": [1.0, 3.5, 2.25, 0.7], "colour": [0.1, 0.1, 0.1]})
    };
    let solid =
        json!({"track": 2, "points": square(40.0, 33.0, 9.1), "closed": true, "fill": true, "colour": [0.3, 0.0, 0.3]});
    let lined = json!({"track": 12, "points": square(14.0, 26.0, 6.2), "closed": true, "fill": true, "widths": [1.5, 1.5, 1.5, 1.5]});
    let plain = json!({"points": [[5.5, 5.5], [50.0, 40.0], [60.0, 12.0]], "closed": false, "colour": [0.0, 0.4, 0.1]});
    let between = json!({"track": 7, "points": [[5.5, 25.5], [50.0, 21.0]], "closed": false, "widths": [6.0, 3.0], "opacity": 0.5});
    let mut all: Value = serde_json::from_str(&document()).unwrap();
    let fields = json!({
        "filled": [{"frame": 1, "regions": painted(0.0)}, {"frame": 2, "regions": painted(2.3)}],
        "traced": [{"frame": 1, "strokes": [line(0.0), solid, lined]}, {"frame": 2, "strokes": [line(1.7)]}],
        "drawings": [{"frame": 3, "strokes": [plain]}],
        "in_betweens": [{"frame": 4, "strokes": [between]}],
    });
    all.as_object_mut().unwrap().extend(fields.as_object().unwrap().clone());
    all.to_string()
}

/// The document that an instance stores in its parameter.
pub fn kept(effect: &Effect) -> Document {
    let text = effect.text("document");
    assert!(text.bytes().all(|b| b.is_ascii_alphanumeric() || b == b'-' || b == b'_'), "a host may mangle {text}");
    Document::parse(&rototoon_ofx::roto::stored::decode(&text).unwrap(), "kept").unwrap()
}

/// An instance of the effect with the test document and source.
pub fn effect<'a>(host: &'a Host, context: &str, source: &ClipSettings) -> Effect<'a> {
    let mut effect = host.effect(ROTO, context);
    effect.set_clip("Source", source);
    effect.set_clip("Output", &ClipSettings { connected: true, ..source.clone() });
    for frame in 0..=4 {
        effect.set_frame("Source", f64::from(frame), WIDTH, &pattern(frame));
    }
    assert_eq!(effect.create(), OK);
    effect.set_text("document", &document());
    effect
}

/// A premultiplied picture of byte values in blocks of 2 × 2 pixels. Neither a depth nor half size rounds it.
pub fn pattern(frame: i32) -> Vec<f32> {
    let pixel = |k: usize| {
        let (x, y) = (k % WIDTH / 2, k / WIDTH / 2);
        let byte = |n: usize| (n % 256) as f32 / 255.0;
        let alpha = 155 + (x * 5 + y * 3) % 101;
        let colour = |n: usize| byte(n * alpha / 300 % (alpha + 1));
        [colour(x * 7 + frame as usize), colour(y * 11), colour(x * 3 + y * 5), byte(alpha)]
    };
    (0..WIDTH * HEIGHT).flat_map(pixel).collect()
}

/// All pixels of the test footage.
pub const WHOLE: Bounds = Bounds { x1: 0, y1: 0, x2: WIDTH as i32, y2: HEIGHT as i32 };

/// Renders and returns the picture. Checks for errors and for wrongly written pixels.
pub fn rendered(host: &Host, effect: &mut Effect, time: f64, window: Bounds) -> Picture {
    assert_eq!(effect.render(time, window, 1.0, 1, 0), OK, "{:?}", host.messages());
    clean(host);
    let picture = effect.output();
    assert_eq!((picture.damage, picture.untouched), (0, 0));
    picture
}

/// Checks that the log has no error status and that all images are released.
pub fn clean(host: &Host) {
    let errors = host.errors();
    assert!(errors.is_empty(), "{errors:#?}");
    assert_eq!(host.live_images(), 0, "images that were not released");
}

/// Lays the lines of the overlay that was drawn last over a picture of the viewer at a zoom.
pub fn lay_lines(effect: &Effect, shown: &mut Pixmap, zoom: f32) {
    let height = shown.height() as f32;
    for ((closed, points), [r, g, b, a, width]) in effect.drawn().into_iter().zip(effect.drawn_colours()) {
        let mut path = PathBuilder::new();
        for (k, [x, y]) in points.into_iter().enumerate() {
            let (x, y) = (x as f32 * zoom, height - y as f32 * zoom);
            if k == 0 { path.move_to(x, y) } else { path.line_to(x, y) }
        }
        if closed {
            path.close();
        }
        let mut paint = Paint::default();
        paint.set_color(Color::from_rgba(r, g, b, a).unwrap());
        let stroke = Stroke { width, ..Stroke::default() };
        if let Some(path) = path.finish() {
            shown.stroke_path(&path, &paint, &stroke, Transform::identity(), None);
        }
    }
}
