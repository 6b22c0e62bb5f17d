//! Complete contours on drawings with a known true outline.

use super::*;
use rototoon_base::geometry::polyline;

/// An antialiased picture: `paint` gives the colour at a point, and each pixel is the mean of 6 × 6 samples.
fn drawing(width: usize, height: usize, paint: impl Fn(Point) -> Colour) -> Raster<Colour> {
    Raster::from_fn(width, height, |x, y| {
        let mut sum = [0.0; 3];
        for i in 0..36 {
            let shift = Point::new((i % 6) as f64 + 0.5, (i / 6) as f64 + 0.5) / 6.0;
            let colour = paint(Point::new(x as f64, y as f64) + shift);
            (0..3).for_each(|c| sum[c] += colour[c] / 36.0);
        }
        sum
    })
}

const PAPER: Colour = [0.95, 0.93, 0.85];
const FILL: Colour = [0.85, 0.45, 0.2];
const INK: Colour = [0.08, 0.05, 0.1];

fn ring(centre: Point, radius: f64, count: usize) -> Vec<Point> {
    (0..count).map(|k| centre + radius * Point::from_angle(k as f64 * std::f64::consts::TAU / count as f64)).collect()
}

fn outlined_disc(centre: Point, radius: f64, ink: f64) -> Raster<Colour> {
    drawing(120, 110, |p| match p.distance(centre) - radius {
        away if away.abs() < 0.5 * ink => INK,
        away if away < 0.0 => FILL,
        _ => PAPER,
    })
}

fn worst(paths: &[Vec<Point>], error: impl Fn(Point) -> f64) -> f64 {
    paths.iter().flatten().map(|&p| error(p).abs()).fold(0.0, f64::max)
}

#[test]
fn the_centre_of_a_discs_outline_is_followed() {
    let centre = Point::new(60.3, 54.8);
    for ink in [1.5, 2.5, 4.0] {
        let picture = outlined_disc(centre, 40.0, ink);
        let contour = ring(centre, 40.0, 7);
        let paths = snap_contour(&picture, &contour, true, &SnapOptions::default());
        assert_eq!(paths.len(), 7);
        for (k, path) in paths.iter().enumerate() {
            assert_eq!((path[0], path[path.len() - 1]), (contour[k], contour[(k + 1) % 7]));
        }
        let error = worst(&paths, |p| p.distance(centre) - 40.0);
        assert!(error < 0.5, "ink of {ink} px: {error}");
        let around: f64 = paths.iter().map(|path| polyline::length(path, false)).sum();
        assert!((around / (80.0 * std::f64::consts::PI) - 1.0).abs() < 0.03, "ink of {ink} px: length {around}");
    }
}

#[test]
fn one_side_of_a_discs_outline_is_followed() {
    let centre = Point::new(60.3, 54.8);
    let picture = outlined_disc(centre, 40.0, 4.0);
    for radius in [38.0, 42.0] {
        let paths = snap_contour(&picture, &ring(centre, radius, 8), true, &SnapOptions::default());
        let error = worst(&paths, |p| p.distance(centre) - radius);
        assert!(error < 0.5, "radius {radius}: {error}");
    }
}

#[test]
fn the_border_of_a_disc_without_ink_is_followed() {
    let centre = Point::new(60.0, 55.0);
    let picture = drawing(120, 110, |p| if p.distance(centre) < 35.0 { FILL } else { PAPER });
    let paths = snap_contour(&picture, &ring(centre, 35.0, 6), true, &SnapOptions::default());
    let error = worst(&paths, |p| p.distance(centre) - 35.0);
    assert!(error < 0.5, "{error}");
}

#[test]
fn a_slanted_border_is_straight() {
    let (a, b) = (Point::new(8.0, 12.0), Point::new(90.0, 61.0));
    let normal = (b - a).perp().normalize();
    let picture = drawing(100, 80, |p| if (p - a).dot(normal) < 0.0 { PAPER } else { FILL });
    let paths = snap_contour(&picture, &[a, b], false, &SnapOptions::default());
    assert!(paths[0].len() > 50);
    let error = worst(&paths, |p| (p - a).dot(normal));
    assert!(error < 0.25, "{error}");
}

#[test]
fn the_path_does_not_jump_to_a_stronger_parallel_line() {
    // The line to follow is fainter and has a gap of 8 px.
    let faint = [0.6, 0.6, 0.6];
    let picture = drawing(120, 60, |p| {
        if (p.y - 20.0).abs() < 1.0 && (p.x - 60.0).abs() > 4.0 {
            faint
        } else if (p.y - 30.0).abs() < 1.5 {
            INK
        } else {
            PAPER
        }
    });
    let contour = [Point::new(5.0, 20.0), Point::new(115.0, 20.0)];
    for follow in [Follow::Line, Follow::Auto] {
        let options = SnapOptions { follow, ..SnapOptions::default() };
        let paths = snap_contour(&picture, &contour, false, &options);
        let error = worst(&paths, |p| p.y - 20.0);
        assert!(error < 0.5, "{follow:?}: {error}");
    }
}

#[test]
fn ends_beside_the_ink_are_kept_and_the_path_joins_it() {
    let picture = drawing(80, 40, |p| if (p.y - 20.0).abs() < 1.2 { INK } else { PAPER });
    let contour = [Point::new(5.0, 18.0), Point::new(75.0, 21.5)];
    let paths = snap_contour(&picture, &contour, false, &SnapOptions { follow: Follow::Line, ..Default::default() });
    assert_eq!((paths[0][0], paths[0][paths[0].len() - 1]), (contour[0], contour[1]));
    let middle: Vec<_> = paths[0].iter().filter(|p| p.x > 12.0 && p.x < 68.0).copied().collect();
    assert!(middle.len() > 40);
    assert!(worst(&[middle], |p| p.y - 20.0) < 0.2);
}

#[test]
fn segments_without_ink_to_follow_stay_straight() {
    let blank = Raster::new(50, 40, PAPER);
    let (a, b) = (Point::new(5.0, 5.0), Point::new(40.0, 30.0));
    let straight =
        |picture: &Raster<Colour>, contour: &[Point]| snap_contour(picture, contour, false, &SnapOptions::default());
    assert_eq!(straight(&blank, &[a, b]), [[a, b]]);
    assert_eq!(straight(&blank, &[a, a]), [[a, a]]);
    let drawn = drawing(50, 40, |p| if p.x < 25.0 { INK } else { PAPER });
    let outside = Point::new(-3.0, 200.0);
    assert_eq!(straight(&drawn, &[a, outside, b]), [[a, outside], [outside, b]]);
    let broken = straight(&drawn, &[a, Point::new(f64::NAN, 3.0)]);
    assert!(broken[0].len() == 2 && broken[0][1].x.is_nan());
    // The border crosses the strip, but it does not connect the two ends.
    assert_eq!(straight(&drawn, &[Point::new(5.0, 20.0), Point::new(45.0, 20.0)])[0].len(), 2);
}

#[test]
fn tiny_contours_and_pictures_are_snapped() {
    let dot = Raster::new(1, 1, PAPER);
    let options = SnapOptions::default();
    let corners = [Point::ZERO, Point::ONE];
    assert_eq!(snap_contour(&dot, &corners, false, &options), [corners]);
    assert!(snap_contour(&dot, &[], true, &options).is_empty());
    assert!(snap_contour(&dot, &[Point::ONE], true, &options).is_empty());
    assert_eq!(snap_contour(&dot, &corners, true, &options).len(), 2);
    let nothing = Raster::from_vec(0, 0, Vec::new()).unwrap();
    assert_eq!(snap_contour(&nothing, &corners, false, &options), [corners]);
}

#[test]
fn a_shared_snapper_gives_the_same_paths() {
    let centre = Point::new(60.3, 54.8);
    let picture = outlined_disc(centre, 40.0, 2.5);
    let shared = Snapper::new(&picture);
    let options = SnapOptions::default();
    for count in [5, 9, 20] {
        let contour = ring(centre, 40.0, count);
        assert_eq!(shared.snap(&contour, true, &options), snap_contour(&picture, &contour, true, &options));
    }
}
