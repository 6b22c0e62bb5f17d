//! Pictures that are no clean line drawings.

use super::common::{Line, covered, draw, line, ring, white};
use rototoon_base::geometry::Point;
use rototoon_base::scene::{Colour, Raster};
use rototoon_lines::{Drawing, Options, Stroke, Style, Tracked, carry, trace};
use std::sync::Arc;

fn clean(picture: Arc<Raster<Colour>>) -> Vec<Stroke> {
    trace(picture, &Options { style: Style::Clean, ..Options::default() })
}

/// Strokes can be handed on: finite, in the picture, lines with widths, fills closed.
fn assert_sound(strokes: &[Stroke], width: usize, height: usize) {
    let within = |p: &Point| p.x > -8.0 && p.y > -8.0 && p.x < width as f64 + 8.0 && p.y < height as f64 + 8.0;
    for stroke in strokes {
        let widths = if stroke.fill { 0 } else { stroke.points.len() };
        assert!(stroke.points.len() > 1 && stroke.widths.len() == widths && (stroke.closed || !stroke.fill));
        assert!(stroke.points.iter().all(|p| p.is_finite() && within(p)), "{:?}", stroke.points);
        assert!(stroke.widths.iter().all(|w| w.is_finite() && *w > 0.0));
    }
}

fn tracked(strokes: Vec<Stroke>) -> Vec<Tracked> {
    strokes.into_iter().enumerate().map(|(track, stroke)| Tracked::sure(track, stroke)).collect()
}

#[test]
fn hatching_is_as_many_strokes_as_were_drawn() {
    let lines: Vec<Line> =
        (0..20).map(|k| line(&[(30.0 + 9.0 * f64::from(k), 150.0), (45.0 + 9.0 * f64::from(k), 50.0)])).collect();
    let strokes = clean(draw(240, 200, &lines, white));
    assert_eq!(strokes.len(), 20);
    let whole = |line: &Line| strokes.iter().any(|s| covered(&line.points, false, &s.points, false, 1.5) > 0.9);
    assert!(lines.iter().all(whole));
}

#[test]
fn a_line_of_one_pixel_and_one_of_sixty_are_one_stroke_each() {
    let thin =
        Arc::new(Raster::from_fn(240, 200, |x, y| if y == 60 && (20..220).contains(&x) { [0.0; 3] } else { [1.0; 3] }));
    let broad = draw(400, 300, &[Line { width: 60.0, ..line(&[(60.0, 150.0), (340.0, 150.0)]) }], white);
    for (picture, width) in [(thin, 1.0), (broad, 60.0)] {
        let strokes = clean(picture);
        assert_eq!(strokes.len(), 1, "{width}: {strokes:?}");
        let middle = strokes[0].widths[strokes[0].widths.len() / 2];
        // The blur before the threshold makes a hairline look up to two pixels broader.
        assert!((middle - width).abs() < 2.1 + 0.03 * width, "{width}: {middle}");
    }
}

#[test]
fn screentone_and_a_photograph_give_sound_strokes() {
    let tone =
        Raster::from_fn(
            240,
            200,
            |x, y| if (x % 6).abs_diff(3) + (y % 6).abs_diff(3) < 3 { [0.1; 3] } else { [1.0; 3] },
        );
    let photograph = Raster::from_fn(240, 200, |x, y| {
        let (x, y) = (x as f32, y as f32);
        let soft = 0.5 + 0.2 * (0.03 * x + 0.02 * y).sin() + 0.15 * (0.11 * x).sin() * (0.07 * y).cos();
        [soft, 0.9 * soft, 0.3 + 0.5 * soft + 0.05 * (1.7 * x + 2.3 * y).sin()]
    });
    for picture in [tone, photograph] {
        assert_sound(&trace(Arc::new(picture), &Options::default()), 240, 200);
    }
}

#[test]
fn lines_along_and_across_the_border_are_traced() {
    let lines = [line(&[(1.0, 0.0), (1.0, 200.0)]), line(&[(-20.0, 100.0), (260.0, 100.0)])];
    let strokes = clean(draw(240, 200, &lines, white));
    assert_sound(&strokes, 240, 200);
    let across = [Point::new(3.0, 100.0), Point::new(237.0, 100.0)];
    assert!(strokes.iter().any(|s| covered(&across, false, &s.points, s.closed, 1.5) > 0.95));
}

#[test]
fn drawings_of_other_sizes_are_carried() {
    let figure = [ring(Point::new(100.0, 90.0), 50.0), line(&[(60.0, 160.0), (140.0, 165.0)])];
    let (small, large) = (draw(240, 200, &figure, white), draw(300, 260, &figure, white));
    let [from, to] = [small, large].map(|picture| Drawing::new(picture, &Options::default()));
    let (strokes, mut next) = (tracked(from.strokes()), 2);
    let found = carry(&from, &strokes, &to, &mut next);
    assert_eq!((found.len(), next), (2, 2));
    let empty = Drawing::new(Arc::new(Raster::new(0, 0, [0.0; 3])), &Options::default());
    assert!(carry(&from, &strokes, &empty, &mut next).is_empty());
    assert_eq!(carry(&empty, &[], &from, &mut next).len(), 2);
}

#[test]
fn letters_are_traced() {
    let text = [
        line(&[(30.0, 150.0), (60.0, 50.0), (90.0, 150.0)]),
        line(&[(41.0, 115.0), (79.0, 115.0)]),
        line(&[(120.0, 50.0), (120.0, 150.0)]),
        line(&[(105.0, 50.0), (140.0, 50.0)]),
        ring(Point::new(185.0, 100.0), 30.0),
    ];
    let strokes = clean(draw(240, 200, &text, white));
    assert_sound(&strokes, 240, 200);
    let whole =
        |line: &Line| strokes.iter().any(|s| covered(&line.points, line.closed, &s.points, s.closed, 2.0) > 0.93);
    assert!(text.iter().all(whole), "{} strokes", strokes.len());
    assert!(strokes.len() <= text.len() + 1);
}
