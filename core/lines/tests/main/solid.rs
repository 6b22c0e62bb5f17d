//! Solid blacks beside lines: which ink is a shape, which is a line, and how exact the outline is.

use super::common::{Line, covered, draw, draw_onto, line, ring, white};
use rototoon_base::geometry::{Point, polygon, polyline};
use rototoon_base::scene::{Colour, Raster};
use rototoon_lines::{Drawing, Options, Stroke, Style, Tracked, carry, trace};
use std::sync::Arc;

const INK: Colour = [0.1; 3];

/// Fills a polygon with soft edges: the share of 16 × 16 places of a pixel that are inside.
fn fill_onto(picture: &mut Raster<Colour>, points: &[Point], colour: Colour) {
    let (width, height) = (picture.width(), picture.height());
    let fine: Vec<Point> = points.iter().map(|&p| 16.0 * p).collect();
    let mut cover = Raster::new(width, height, 0u32);
    polygon::for_each_span(&fine, 16 * width, 16 * height, |y, first, behind| {
        (first..behind).for_each(|x| cover.set(x / 16, y / 16, cover.get(x / 16, y / 16) + 1));
    });
    for (x, y) in (0..height).flat_map(|y| (0..width).map(move |x| (x, y))) {
        let (share, under) = (cover.get(x, y) as f32 / 256.0, picture.get(x, y));
        picture.set(x, y, [0, 1, 2].map(|c| under[c] + share * (colour[c] - under[c])));
    }
}

fn around(centre: Point, count: u32, radius: impl Fn(f64) -> f64) -> Vec<Point> {
    let turn = |k: u32| f64::from(k) * std::f64::consts::TAU / f64::from(count);
    (0..count).map(|k| centre + radius(turn(k)) * Point::from_angle(turn(k))).collect()
}

fn disc(centre: Point, radius: f64) -> Vec<Point> {
    around(centre, 180, |_| radius)
}

/// Paper with lines and black shapes.
fn picture(lines: &[Line], shapes: &[Vec<Point>]) -> Raster<Colour> {
    let mut picture = (*draw(240, 200, lines, white)).clone();
    shapes.iter().for_each(|shape| fill_onto(&mut picture, shape, INK));
    picture
}

fn traced(picture: Raster<Colour>) -> Vec<Stroke> {
    trace(Arc::new(picture), &Options { style: Style::Clean, ..Options::default() })
}

fn pixels(points: &[Point]) -> Raster<bool> {
    let mut out = Raster::new(240, 200, false);
    polygon::for_each_span(points, 240, 200, |y, first, behind| (first..behind).for_each(|x| out.set(x, y, true)));
    out
}

/// Intersection over union of two outlines.
fn same(a: &[Point], b: &[Point]) -> f64 {
    let (a, b) = (pixels(a), pixels(b));
    let count = |both: fn(bool, bool) -> bool| a.data().iter().zip(b.data()).filter(|&(&a, &b)| both(a, b)).count();
    count(|a, b| a && b) as f64 / count(|a, b| a || b).max(1) as f64
}

fn fills(strokes: &[Stroke]) -> Vec<&Stroke> {
    strokes.iter().filter(|stroke| stroke.fill).collect()
}

fn bar() -> Line {
    line(&[(15.0, 185.0), (225.0, 178.0)])
}

#[test]
fn a_disc_beside_a_line_is_one_filled_outline() {
    let shape = disc(Point::new(110.0, 90.0), 16.0);
    let strokes = traced(picture(&[bar()], std::slice::from_ref(&shape)));
    assert_eq!(strokes.len(), 2);
    let fill = fills(&strokes)[0];
    assert!(fill.closed && fill.widths.is_empty());
    assert!((0..3).all(|c| (fill.colour[c] - INK[c]).abs() < 0.02), "{:?}", fill.colour);
    assert!(fill.points.iter().all(|p| (p.distance((110.0, 90.0).into()) - 16.0).abs() < 0.7));
    assert!(same(&fill.points, &shape) > 0.96);
}

#[test]
fn a_disc_alone_is_a_shape_and_a_dot_is_a_stroke() {
    assert_eq!(fills(&traced(picture(&[], &[disc(Point::new(110.0, 90.0), 30.0)]))).len(), 1);
    let dots = traced(picture(&[bar()], &[disc(Point::new(60.0, 60.0), 4.0)]));
    assert_eq!((dots.len(), fills(&dots).len()), (2, 0));
}

#[test]
fn a_line_that_hangs_on_a_blot_stays_a_line_and_meets_the_outline() {
    let shape = disc(Point::new(90.0, 100.0), 22.0);
    let lines = [line(&[(90.0, 100.0), (220.0, 60.0)]), line(&[(90.0, 100.0), (20.0, 180.0)])];
    let strokes = traced(picture(&lines, std::slice::from_ref(&shape)));
    assert_eq!(strokes.len(), 3, "{:?}", strokes.iter().map(|s| s.points.len()).collect::<Vec<_>>());
    let fill = fills(&strokes)[0];
    assert!(same(&fill.points, &shape) > 0.95);
    for stroke in strokes.iter().filter(|s| !s.fill) {
        let ends = [stroke.points[0], stroke.points[stroke.points.len() - 1]];
        let gap = ends.map(|end| polyline::distance(end, &fill.points, true)).into_iter().fold(f64::MAX, f64::min);
        assert!(gap < 1.0, "the gap is {gap}");
        assert!(lines.iter().any(|l| covered(&stroke.points, false, &l.points, false, 1.5) > 0.95));
    }
}

#[test]
fn a_star_keeps_its_tips() {
    let tips = |turn: f64| {
        let part = (5.0 * turn / std::f64::consts::TAU).fract();
        18.0 + 22.0 * (1.0 - 2.0 * part).abs()
    };
    let shape = around(Point::new(110.0, 90.0), 200, tips);
    let strokes = traced(picture(&[bar()], std::slice::from_ref(&shape)));
    assert_eq!((strokes.len(), fills(&strokes).len()), (2, 1));
    assert!(same(&fills(&strokes)[0].points, &shape) > 0.93, "{}", same(&fills(&strokes)[0].points, &shape));
}

#[test]
fn a_hole_is_a_shape_of_its_own_over_the_black() {
    let centre = Point::new(110.0, 90.0);
    let mut drawn = picture(&[bar()], &[disc(centre, 30.0)]);
    let hole = disc(centre + Point::new(9.0, -9.0), 7.0);
    fill_onto(&mut drawn, &hole, [1.0; 3]);
    let strokes = traced(drawn);
    let fills = fills(&strokes);
    assert_eq!((strokes.len(), fills.len()), (3, 2));
    assert!(same(&fills[1].points, &hole) > 0.9 && fills[1].colour[0] > 0.95, "the hole lies over the black");
}

#[test]
fn a_brush_line_that_swells_stays_a_line() {
    let centre = |k: u32| Point::new(20.0 + 2.0 * f64::from(k), 70.0 + 12.0 * (f64::from(k) * 0.06).sin());
    let half = |k: u32| 1.0 + 7.0 * (f64::from(k) * std::f64::consts::PI / 100.0).sin();
    let side = |sign: f64| (0..=100).map(move |k| centre(k) + Point::new(0.0, sign * half(k)));
    let brush: Vec<Point> = side(-1.0).chain(side(1.0).rev()).collect();
    let strokes = traced(picture(&[bar()], &[brush]));
    assert_eq!((strokes.len(), fills(&strokes).len()), (2, 0));
    let widest = strokes.iter().flat_map(|s| &s.widths).copied().fold(0.0, f64::max);
    assert!((widest - 16.0).abs() < 2.0, "{widest}");
}

#[test]
fn a_thick_ring_is_a_line_and_a_boot_on_a_heavy_contour_is_a_shape() {
    let heavy = |width: f64, radius: f64| Line { width, ..ring(Point::new(110.0, 90.0), radius) };
    for (width, radius) in [(14.0, 30.0), (20.0, 45.0)] {
        let strokes = traced(picture(&[bar(), heavy(width, radius)], &[]));
        assert_eq!((strokes.len(), fills(&strokes).len()), (2, 0), "{width}");
    }
    let leg = Line { width: 7.0, ..line(&[(110.0, 20.0), (110.0, 110.0)]) };
    let boot = around(Point::new(120.0, 120.0), 120, |t| 22.0 + 6.0 * (2.0 * t).cos());
    let strokes = traced(picture(&[bar(), leg], std::slice::from_ref(&boot)));
    let found = fills(&strokes);
    assert_eq!((strokes.len(), found.len()), (3, 1));
    assert!(same(&found[0].points, &boot) > 0.93, "{}", same(&found[0].points, &boot));
}

#[test]
fn hatching_that_runs_together_is_no_shape() {
    // Each line is 3 px broad, and the seams between them are paler.
    let mut drawn = picture(&[bar()], &[]);
    for (x, y) in (60..100).flat_map(|y| (80..130).map(move |x| (x, y))) {
        drawn.set(x, y, [if (x + y) % 4 == 0 { 0.65 } else { 0.1 }; 3]);
    }
    assert!(fills(&traced(drawn)).is_empty());
}

#[test]
fn lines_that_meet_are_no_shape() {
    let ends = |count: u32, at: f64| {
        let centre = Point::new(120.0, 100.0);
        let way = move |k: u32| 80.0 * Point::from_angle(at * f64::from(k) / f64::from(count));
        (0..count).map(move |k| line(&[(centre - way(k)).into(), (centre + way(k)).into()])).collect::<Vec<Line>>()
    };
    for (count, at) in [(2, 0.3), (2, 0.8), (3, 3.1), (3, 0.9)] {
        assert!(fills(&traced(picture(&ends(count, at), &[]))).is_empty(), "{count} lines over {at}");
    }
    let broad = [Line { width: 9.0, ..ring(Point::new(90.0, 100.0), 50.0) }, Line { width: 9.0, ..bar() }, bar()];
    assert!(fills(&traced(picture(&broad, &[]))).is_empty(), "broad lines");
}

#[test]
fn any_round_shape_is_outlined_exactly() {
    let mut seed = 11u32;
    let mut any = move || {
        seed = seed.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        f64::from(seed >> 8) / f64::from(1u32 << 24)
    };
    for _ in 0..24 {
        let (size, a, b, turn) = (12.0 + 20.0 * any(), 0.25 * any(), 0.12 * any(), 6.3 * any());
        let centre = Point::new(90.0 + 40.0 * any(), 70.0 + 40.0 * any());
        let shape = around(centre, 240, |t| size * (1.0 + a * (2.0 * t + turn).cos() + b * (3.0 * t).sin()));
        let strokes = traced(picture(&[bar()], std::slice::from_ref(&shape)));
        let fills = fills(&strokes);
        assert_eq!((strokes.len(), fills.len()), (2, 1), "{size} {a} {b} {turn}");
        assert!(same(&fills[0].points, &shape) > 0.94, "{size} {a} {b}: {}", same(&fills[0].points, &shape));
    }
}

#[test]
fn a_shape_keeps_its_number_and_its_fill_on_the_next_drawings() {
    let shape = |time: f64| disc(Point::new(90.0 + 7.0 * time, 90.0 - 3.0 * time), 15.0 + time);
    let eye = |time: f64| ring(Point::new(88.0 + 7.0 * time, 88.0 - 3.0 * time), 34.0);
    let look = |time: f64| {
        let picture = picture(&[eye(time), bar()], &[shape(time)]);
        Drawing::new(Arc::new(picture), &Options { style: Style::Clean, ..Options::default() })
    };
    let mut from = look(0.0);
    let mut strokes: Vec<Tracked> =
        from.strokes().into_iter().enumerate().map(|(track, stroke)| Tracked::sure(track, stroke)).collect();
    let mut next = strokes.len();
    assert_eq!((next, strokes[0].stroke.fill), (3, true), "the shape is behind the lines");
    for time in 1..=4 {
        let to = look(f64::from(time));
        strokes = carry(&from, &strokes, &to, &mut next);
        from = to;
        assert_eq!((strokes.len(), next), (3, 3), "drawing {time}");
        let found = strokes.iter().find(|tracked| tracked.track == 0).unwrap();
        assert!(found.stroke.fill && found.stroke.closed && found.confidence > 0.5);
        let exact = same(&found.stroke.points, &shape(f64::from(time)));
        assert!(exact > 0.93, "drawing {time}: {exact}");
        assert!(found.stroke.colour[0] < 0.15, "{:?}", found.stroke.colour);
    }
}

#[test]
fn a_shape_at_the_border_of_the_picture_is_outlined() {
    let shape = disc(Point::new(6.0, 90.0), 30.0);
    let mut drawn = picture(&[bar()], &[shape]);
    draw_onto(&mut drawn, &line(&[(60.0, 20.0), (200.0, 60.0)]));
    let strokes = traced(drawn);
    assert_eq!((strokes.len(), fills(&strokes).len()), (3, 1));
}

#[test]
fn a_disc_of_any_size_is_a_shape() {
    // Behind a disc nearly as broad as the window of the paper's estimate, paper is found that is darker than it is.
    for radius in 8..20 {
        let drawn = |x: usize, y: usize| {
            let round = (x as f64 - 111.5).hypot(y as f64 - 89.5) < f64::from(radius);
            if round || y == 30 || y == 31 { INK } else { white(x, y) }
        };
        let strokes = traced(Raster::from_fn(160, 120, drawn));
        let found = fills(&strokes);
        assert_eq!((found.len(), strokes.len()), (1, 2), "radius {radius}");
        assert!(same(&found[0].points, &disc(Point::new(112.0, 90.0), f64::from(radius))) > 0.93, "radius {radius}");
    }
}
