//! Tracing of drawings whose lines are known.

use super::common::{Line, covered, draw, line, ring, white};
use rototoon_base::geometry::{Point, polyline};
use rototoon_base::scene::Raster;
use rototoon_lines::{Options, Stroke, Style, trace};
use std::sync::Arc;

fn traced(lines: &[Line]) -> Vec<Stroke> {
    trace(draw(240, 200, lines, white), &Options::default())
}

/// Each line is covered by one stroke of its own, and there are no other strokes.
fn assert_same(strokes: &[Stroke], lines: &[Line], reach: f64) {
    let lengths: Vec<f64> = strokes.iter().map(|s| polyline::length(&s.points, s.closed).round()).collect();
    assert_eq!(strokes.len(), lines.len(), "strokes of lengths {lengths:?}");
    let mut taken = vec![false; strokes.len()];
    for (k, line) in lines.iter().enumerate() {
        let fits = |s: &Stroke| {
            covered(&line.points, line.closed, &s.points, s.closed, reach) > 0.93
                && covered(&s.points, s.closed, &line.points, line.closed, reach) > 0.97
        };
        let found = strokes.iter().position(fits).unwrap_or_else(|| panic!("line {k} has no stroke"));
        assert!(!std::mem::replace(&mut taken[found], true), "line {k} shares a stroke");
        assert_eq!(strokes[found].points.len(), strokes[found].widths.len());
    }
}

fn wave() -> Line {
    let points: Vec<(f64, f64)> =
        (0..=60).map(|k| (20.0 + 3.0 * f64::from(k), 60.0 + 25.0 * (f64::from(k) * 0.15).sin())).collect();
    line(&points)
}

#[test]
fn one_line_is_one_stroke_with_its_width() {
    for width in [1.5, 2.0, 3.0, 8.0] {
        let lines = [Line { width, ..wave() }];
        let strokes = traced(&lines);
        assert_same(&strokes, &lines, 1.0);
        let widths = &strokes[0].widths;
        let mean = widths.iter().sum::<f64>() / widths.len() as f64;
        assert!((mean - width).abs() < 0.25, "{width}: {mean}");
    }
}

#[test]
fn lines_that_cross_go_straight_on() {
    for angle in [35.0f64, 60.0, 90.0] {
        let way = 80.0 * Point::from_angle(angle.to_radians());
        let (a, b) = (Point::new(120.0, 100.0) - way, Point::new(120.0, 100.0) + way);
        let lines = [line(&[(20.0, 100.0), (220.0, 100.0)]), line(&[(a.x, a.y), (b.x, b.y)])];
        assert_same(&traced(&lines), &lines, 1.3);
    }
}

#[test]
fn at_a_t_the_bar_goes_on_and_the_stem_ends() {
    let lines = [line(&[(20.0, 60.0), (220.0, 60.0)]), line(&[(120.0, 60.0), (130.0, 180.0)])];
    assert_same(&traced(&lines), &lines, 1.3);
}

#[test]
fn a_corner_stays_in_its_stroke_and_stays_sharp() {
    let lines = [line(&[(40.0, 160.0), (120.0, 40.0), (200.0, 160.0)])];
    let strokes = traced(&lines);
    assert_same(&strokes, &lines, 1.2);
    assert!(polyline::distance(Point::new(120.0, 40.0), &strokes[0].points, false) < 2.0);
}

#[test]
fn a_ring_is_a_closed_stroke() {
    let lines = [ring(Point::new(110.0, 100.0), 60.0)];
    let strokes = traced(&lines);
    assert!(strokes[0].closed);
    assert_same(&strokes, &lines, 0.8);
}

#[test]
fn a_gap_of_the_pen_is_bridged_and_a_wide_one_is_not() {
    let parts = |gap: f64| [line(&[(20.0, 80.0), (110.0, 80.0)]), line(&[(110.0 + gap + 3.0, 80.0), (220.0, 80.0)])];
    assert_same(&traced(&parts(5.0)), &[line(&[(20.0, 80.0), (220.0, 80.0)])], 1.0);
    assert_same(&traced(&parts(40.0)), &parts(40.0), 1.0);
}

#[test]
fn separation_lines_keep_their_colours() {
    let colours = [[0.9, 0.2, 0.2], [0.2, 0.3, 0.95], [0.1, 0.1, 0.1]];
    let at = |k: usize| Line {
        colour: colours[k],
        ..line(&[(20.0, 40.0 + 50.0 * k as f64), (220.0, 40.0 + 50.0 * k as f64)])
    };
    let lines = [at(0), at(1), at(2)];
    let strokes = traced(&lines);
    assert_same(&strokes, &lines, 1.0);
    for stroke in &strokes {
        let k = ((stroke.points[0].y - 40.0) / 50.0).round() as usize;
        assert!((0..3).all(|c| (stroke.colour[c] - colours[k][c]).abs() < 0.15), "{k}: {:?}", stroke.colour);
    }
}

#[test]
fn shade_creases_and_light_lines_on_black_make_no_difference() {
    let lines = [wave(), line(&[(20.0, 150.0), (220.0, 130.0)])];
    let shade = |x: usize, y: usize| {
        let crease = if (x + y) % 160 < 80 { 0.0 } else { 0.03 };
        [0.85 - 0.3 * x as f32 / 240.0 - crease; 3]
    };
    assert_same(&trace(draw(240, 200, &lines, shade), &Options::default()), &lines, 1.2);
    let light = lines.map(|line| Line { colour: [0.95; 3], ..line });
    assert_same(&trace(draw(240, 200, &light, |_, _| [0.05; 3]), &Options::default()), &light, 1.2);
}

#[test]
fn faint_lines_are_found_with_more_sensitivity() {
    let faint = Line { colour: [0.8; 3], ..line(&[(20.0, 150.0), (220.0, 150.0)]) };
    let lines = [wave(), faint];
    let with =
        |sensitivity: f64| trace(draw(240, 200, &lines, white), &Options { sensitivity, ..Options::default() }).len();
    assert_eq!((with(1.0), with(4.0)), (1, 2));
}

#[test]
fn lines_sketched_twice_become_one_when_asked() {
    let at = |y: f64| line(&[(20.0, 100.0 + y), (120.0, 103.0), (220.0, 100.0 - y)]);
    let lines = [at(2.0), at(-2.0)];
    let strokes = |style: Style| trace(draw(240, 200, &lines, white), &Options { style, ..Options::default() });
    assert_eq!(strokes(Style::Rough).len(), 1);
}

#[test]
fn pictures_without_lines_have_no_strokes() {
    for colour in [[1.0; 3], [0.0; 3], [0.5, 0.4, 0.3]] {
        assert!(trace(draw(120, 90, &[], |_, _| colour), &Options::default()).is_empty());
    }
    for (width, height) in [(0, 0), (1, 1), (1, 50), (50, 2)] {
        trace(Arc::new(Raster::new(width, height, [0.2; 3])), &Options::default());
    }
}

#[test]
fn hostile_pictures_give_finite_strokes() {
    let mut seed = 1u32;
    let mut noise = move || {
        seed = seed.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        (seed >> 8) as f32 / (1u32 << 24) as f32
    };
    let texture = Raster::from_fn(160, 120, |x, y| {
        let soft = 0.5 + 0.3 * (x as f32 * 0.07).sin() * (y as f32 * 0.05).cos();
        [soft + 0.2 * noise(), soft, 0.5 * noise()]
    });
    let odd = Raster::from_fn(40, 40, |x, y| if x == y { [f32::NAN, f32::INFINITY, -4.0] } else { [0.7; 3] });
    let dots = Raster::from_fn(160, 120, |x, y| if x % 4 < 2 && y % 4 < 2 { [0.0; 3] } else { [1.0; 3] });
    for picture in [texture, odd, dots] {
        for style in [Style::Auto, Style::Clean, Style::Rough] {
            for stroke in trace(Arc::new(picture.clone()), &Options { style, ..Options::default() }) {
                assert!(stroke.points.iter().all(|p| p.is_finite()));
                assert!(stroke.widths.iter().all(|w| w.is_finite() && *w > 0.0));
                assert!(stroke.points.len() > 1 && stroke.widths.len() == stroke.points.len());
            }
        }
    }
}

#[test]
fn a_broad_line_and_one_that_leaves_the_picture_are_traced() {
    let broad = Line { width: 40.0, ..line(&[(40.0, 100.0), (200.0, 100.0)]) };
    let strokes = traced(&[broad]);
    assert_eq!(strokes.len(), 1);
    let middle = strokes[0].widths[strokes[0].widths.len() / 2];
    assert!((middle - 40.0).abs() < 4.0, "{middle}");
    let lines = [line(&[(-30.0, 50.0), (270.0, 120.0)])];
    let strokes = traced(&lines);
    assert!(
        strokes.len() == 1
            && covered(&[Point::new(2.0, 57.5), Point::new(238.0, 112.5)], false, &strokes[0].points, false, 1.5)
                > 0.98
    );
}

#[test]
fn five_thousand_marks_are_five_thousand_strokes() {
    let marks: Vec<Line> = (0..5000)
        .map(|k| {
            let (x, y) = (f64::from(k % 100) * 20.0 + 5.0, f64::from(k / 100) * 20.0 + 5.0);
            let way = if (k + k / 100) % 2 == 0 { (12.0, 1.0) } else { (1.0, 12.0) };
            Line { width: 2.0, ..line(&[(x, y), (x + way.0, y + way.1)]) }
        })
        .collect();
    let strokes = trace(draw(2000, 1010, &marks, white), &Options { style: Style::Clean, ..Options::default() });
    assert!((4900..=5000).contains(&strokes.len()), "{}", strokes.len());
}

#[test]
fn the_number_of_threads_changes_nothing() {
    let lines = [wave(), line(&[(20.0, 100.0), (220.0, 30.0)]), ring(Point::new(100.0, 120.0), 40.0)];
    let with = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| traced(&lines))
    };
    assert_eq!(with(1), with(3));
}
