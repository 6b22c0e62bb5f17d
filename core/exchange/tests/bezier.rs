//! Bézier exports that are read back: the drawn curve is the snapped path, within the tolerance of the export and that of the reader.

use rototoon_base::geometry::{Point, polyline};
use rototoon_base::scene::{Footage, FrameNumber, Part, Scene};
use rototoon_exchange::export::{self, Detail, SvgOptions};
use rototoon_exchange::import::{self, Shape};

/// Greatest distance of a Bézier curve from the snapped path, in pixels.
const TOLERANCE: f64 = 0.25;
/// What readers add when they make points of curves, in pixels.
const READ: f64 = 0.1;

fn footage() -> Footage {
    Footage { pattern: "%d".into(), first: 1, last: 6, fps: 12.5, width: 160, height: 120, held: false }
}

/// A curve from one point to the next as a snapped path, bent to the left by a share of its length.
fn bow(from: Point, to: Point, bend: f64) -> Vec<Point> {
    let along = to - from;
    let at = |t: f64| from + along * t + along.perp() * bend * (t * std::f64::consts::PI).sin();
    (0..=80).map(|k| at(f64::from(k) / 80.0)).collect()
}

/// A part whose sides are bent more on each frame; one side is straight. Two frames are held, and on one the part is hidden.
fn part(name: &str, closed: bool, at: Point) -> Part {
    let mut part = Part { name: name.into(), closed, ..Part::default() };
    for frame in [1, 2, 3, 5, 6] {
        let moved = f64::from(if frame == 3 { 2 } else { frame });
        let corners = [(0.0, 0.0), (50.0, 4.0), (46.0, 40.0), (6.0, 44.0)].map(|p| at + Point::from(p) + 2.0 * moved);
        let bends = [0.1, -0.08, 0.02, 0.0].map(|bend| bend * moved);
        let count = if closed { 4 } else { 3 };
        let paths = (0..count).map(|k| bow(corners[k], corners[(k + 1) % 4], bends[k])).collect();
        part.keys.insert(frame, corners.to_vec());
        part.tracks.insert(frame, corners.to_vec());
        part.curves.insert(frame, paths);
    }
    part.absent = vec![[4, 4]];
    part
}

fn scene() -> Scene {
    let near = Part { depth: 1.0, ..part("near", false, Point::new(80.0, 40.0)) };
    Scene { footage: footage(), parts: vec![part("far", true, Point::new(10.0, 20.0)), near] }
}

/// The greatest distance between two lines.
fn apart(a: &[Point], b: &[Point], closed: bool) -> f64 {
    let one = |a: &[Point], b: &[Point]| a.iter().map(|p| polyline::distance(*p, b, closed)).fold(0.0, f64::max);
    one(a, b).max(one(b, a))
}

/// Every format that is read back, with what its reader finds.
fn read_back(scene: &Scene) -> Vec<(&'static str, Vec<Shape>)> {
    let (detail, footage) = (Detail::Bezier(TOLERANCE), &scene.footage);
    let svg = export::svg(scene, &SvgOptions { bezier: Some(TOLERANCE), ..SvgOptions::default() });
    let found = [
        ("nk", import::nuke::nuke(&export::nuke(scene, detail), footage, 1)),
        ("ntp", import::natron::natron(&export::natron_project(scene, detail), footage, 1)),
        ("fxs", import::silhouette::silhouette(&export::silhouette(scene, detail), footage)),
        ("setting", import::fusion::fusion(&export::fusion(scene, detail), footage, 1)),
        ("svg", import::svg::svg(&svg, footage, 1)),
    ];
    found.map(|(format, found)| (format, found.unwrap().shapes)).into()
}

#[test]
fn the_curve_that_is_read_is_the_snapped_path() {
    let scene = scene();
    for (format, shapes) in read_back(&scene) {
        assert_eq!(shapes.len(), 2, "{format}");
        for (shape, part) in shapes.iter().zip(&scene.parts) {
            assert_eq!((shape.name.as_str(), shape.closed), (part.name.as_str(), part.closed), "{format}");
            assert_eq!(shape.absent, [[4, 4]], "{format}");
            for (frame, paths) in &part.curves {
                let Some(points) = shape.keys.get(frame) else {
                    // A frame on which the contour is held needs no key.
                    assert!((2..=3).contains(frame), "{format}: no key on frame {frame}");
                    continue;
                };
                let off = apart(points, &paths.concat(), part.closed);
                assert!(off <= TOLERANCE + READ, "{format}: {:?} on frame {frame}: {off}", part.name);
                // The polygon of the control points is much farther away.
                let polygon = apart(&part.tracks[frame], &paths.concat(), part.closed);
                assert!(*frame < 2 || polygon > 4.0, "{polygon}");
            }
        }
    }
}

/// The numbers of an attribute or list in a text, between two marks.
fn numbers(text: &str, from: &str, to: &str) -> Vec<f64> {
    let inner = text.split(from).nth(1).unwrap().split(to).next().unwrap();
    inner.split(|c: char| !(c.is_ascii_digit() || ".-e".contains(c))).filter_map(|word| word.parse().ok()).collect()
}

/// The cubics of a contour, each by its four points, of numbers of points and both of their handles.
fn drawn(numbers: &[f64], relative: bool, closed: bool) -> Vec<Point> {
    let knots: Vec<[Point; 3]> = numbers
        .chunks_exact(6)
        .map(|n| {
            let [at, before, after] = [0, 2, 4].map(|k| Point::new(n[k], n[k + 1]));
            if relative { [at, at + before, at + after] } else { [at, before, after] }
        })
        .collect();
    let next = knots.iter().skip(1).chain(closed.then(|| &knots[0]));
    let cubic = |[a, _, b]: &[Point; 3], [d, c, _]: &[Point; 3]| {
        let (a, b, c, d) = (*a, *b, *c, *d);
        (0..=40).map(move |k| {
            let (t, u) = (f64::from(k) / 40.0, 1.0 - f64::from(k) / 40.0);
            u * u * u * a + 3.0 * u * u * t * b + 3.0 * u * t * t * c + t * t * t * d
        })
    };
    knots.iter().zip(next).flat_map(|(from, to)| cubic(from, to)).collect()
}

#[test]
fn scripts_have_the_handles_of_each_point() {
    let scene = scene();
    let frame: FrameNumber = 6;
    let path = scene.parts[0].curves[&frame].concat();
    let script = export::after_effects(&scene, Detail::Bezier(TOLERANCE));
    let far = script.split("\"name\": \"far\"").nth(1).unwrap();
    assert!(far.contains("\"bent\": true"), "{far}");
    let off = apart(&drawn(&numbers(far, "[5, [", "]"), true, true), &path, true);
    assert!(off <= TOLERANCE + 0.01, "After Effects: {off}");
    let script = export::natron(&scene, Detail::Bezier(TOLERANCE));
    let far = script.split("(u\"far\"").nth(1).unwrap();
    let turned: Vec<Point> = path.iter().map(|p| Point::new(p.x, 120.0 - p.y)).collect();
    let off = apart(&drawn(&numbers(far, "(6, [", "]"), false, true), &turned, true);
    assert!(off <= TOLERANCE + 0.01, "Natron: {off}");
    assert!(far.contains("], True),\n"), "{far}");
}

#[test]
fn a_shape_has_the_same_few_points_on_all_frames() {
    let scene = scene();
    let svg = export::svg(&scene, &SvgOptions { bezier: Some(TOLERANCE), ..SvgOptions::default() });
    let values = svg.split(" values=\"").nth(1).unwrap().split('"').next().unwrap();
    let counts: Vec<(usize, usize)> =
        values.split(';').map(|d| (d.matches('C').count(), d.split([' ', 'C']).count())).collect();
    assert!(counts.iter().all(|count| *count == counts[0] && count.0 == 1), "{counts:?}");
    let points = numbers(values, "C", "Z").len() / 6;
    assert!((4..=8).contains(&points), "{points} curves: {values}");
    let polygons = export::svg(&scene, &SvgOptions::default());
    let values = polygons.split(" values=\"").nth(1).unwrap().split('"').next().unwrap();
    assert!(!values.contains('C') && values.contains('L'), "without the option sides are straight");
}
