//! Complete fits: the guarantee, bad input, unusual input.

use super::*;
use proptest::prelude::*;
use rototoon_base::geometry::{polygon, polyline};
use std::f64::consts::TAU;

fn fitted(points: &[Point], closed: bool, tolerance: f64) -> Fitted {
    fit(points, closed, &Options::new(tolerance)).unwrap()
}

/// Naive measure: every point against the complete curve, and dense samples of the curve against the complete line.
fn true_error(fit: &Fitted, points: &[Point]) -> f64 {
    let to_curve = points.iter().map(|&p| fit.spline.nearest(p).distance).fold(0.0, f64::max);
    let samples = fit.spline.flattened(40);
    let closed = fit.spline.is_closed();
    samples.iter().map(|&p| polyline::distance(p, points, closed)).fold(to_curve, f64::max)
}

/// Pixel centres along a closed outline.
fn pixels(count: usize, at: impl Fn(f64) -> Point) -> Vec<Point> {
    (0..count).map(|i| at(i as f64 / count as f64).floor() + 0.5).collect()
}

fn bean(t: f64) -> Point {
    Point::from_angle(t * TAU) * (140.0 + 30.0 * (2.0 * t * TAU).cos() + 9.0 * (5.0 * t * TAU).sin()) + 250.0
}

#[test]
fn a_pixel_outline_gets_few_guides_and_keeps_the_tolerance() {
    let points = pixels(1000, bean);
    let fit = fitted(&points, true, 1.0);
    assert!(fit.max_error <= 1.0 && true_error(&fit, &points) <= fit.max_error + 1e-9);
    assert!(fit.spline.guides().len() <= 20, "{}", fit.spline.guides().len());
    assert_eq!(fit.spline.corners(), [] as [usize; 0]);
    // The area is that of the outline, up to half a pixel along it.
    let area = polygon::signed_area(&points);
    assert!((fit.spline.area() - area).abs() < 0.5 * fit.spline.length());
}

#[test]
fn corners_stay_sharp() {
    let star: Vec<Point> = (0..10)
        .map(|k| Point::from_angle(k as f64 * TAU / 10.0) * if k % 2 == 0 { 150.0 } else { 70.0 } + 200.0)
        .collect();
    let points = pixels(1400, |t| {
        let k = (t * 10.0) as usize;
        star[k].lerp(star[(k + 1) % 10], t * 10.0 - k as f64)
    });
    let fit = fitted(&points, true, 1.0);
    let corners = fit.spline.corners();
    assert_eq!(corners.len(), 10);
    for &k in &corners {
        let off = star.iter().map(|s| s.distance(fit.spline.guides()[k])).fold(f64::INFINITY, f64::min);
        // Rounding moves the tip by up to 0.7 px, and the corner is put on a point near the tip.
        assert!(off < 2.5, "{off}");
    }
    assert!(fit.spline.guides().len() <= 26, "{}", fit.spline.guides().len());
    assert!(true_error(&fit, &points) <= 1.0);
}

#[test]
fn lines_and_points_are_kept() {
    let p = Point::new(3.0, 4.0);
    for closed in [false, true] {
        let point = fitted(&[p; 5], closed, 1.0);
        assert_eq!((point.spline.guides(), point.max_error), (&[p][..], 0.0));
        assert_eq!(point.parameters, [0.0; 5]);
    }
    let line: Vec<Point> = (0..50).map(|i| p * i as f64).collect();
    assert_eq!(fitted(&line, false, 0.1).spline.guides(), [Point::ZERO, p * 49.0]);
    assert_eq!(fitted(&line[..2], false, 0.1).spline.guides().len(), 2);
    // A closed line of two points goes there and back.
    let there_and_back = fitted(&[Point::ZERO, p * 10.0], true, 0.1);
    assert!(there_and_back.max_error <= 0.1);
    assert!((there_and_back.spline.length() - 100.0).abs() < 0.5);
}

#[test]
fn bad_input_is_named() {
    let options = Options::new(1.0);
    assert_eq!(fit(&[], true, &options), Err(FitError::Empty));
    for bad in [f64::NAN, f64::INFINITY, 1e10] {
        let error = fit(&[Point::ZERO, Point::new(bad, 1.0)], false, &options).unwrap_err();
        assert!(error.to_string().starts_with(&format!("point 1: found ({bad}, 1), expected")), "{error}");
    }
    for bad in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        let error = fit(&[Point::ZERO], false, &Options::new(bad)).unwrap_err();
        assert_eq!(error.to_string(), format!("tolerance: found {bad} px, expected a positive number"));
    }
    let fit = fitted(&[Point::ZERO, Point::X], false, 1.0);
    assert_eq!(fit.attribute(&[1.0]), Err(FitError::Values { found: 1, expected: 2 }));
}

#[test]
fn a_huge_tolerance_leaves_the_fewest_guides() {
    let points = pixels(500, bean);
    assert_eq!(fitted(&points, true, 1e6).spline.guides().len(), 3);
    assert_eq!(fitted(&points, false, 1e6).spline.guides().len(), 2);
}

#[test]
fn a_tolerance_below_the_noise_is_kept_by_straight_lines() {
    let points: Vec<Point> = pixels(600, bean).iter().map(|p| p.floor() * 1.1).collect();
    let fit = fitted(&points, true, 0.05);
    assert!(fit.max_error <= 0.05 && true_error(&fit, &points) <= 0.05 + 1e-9);
}

#[test]
fn rounding_to_pixels_is_not_fitted() {
    let points = pixels(1000, bean);
    let unrounded: Vec<Point> = (0..1000).map(|i| bean(f64::from(i) / 1000.0)).collect();
    for (tolerance, bound) in [(0.05, 0.55), (0.25, 0.75), (0.5, 1.0), (0.9, 1.0)] {
        let fit = fitted(&points, true, tolerance);
        assert!(fit.max_error <= bound && true_error(&fit, &points) <= bound, "{tolerance}: {}", fit.max_error);
        let most = if tolerance < 0.2 { 100 } else { 40 };
        assert!(fit.spline.guides().len() <= most, "{tolerance}: {}", fit.spline.guides().len());
        // It is nearer to the line before rounding than to the pixels.
        let off = unrounded.iter().map(|&p| fit.spline.nearest(p).distance).fold(0.0, f64::max);
        assert!(off < bound + 0.25, "{tolerance}: {off}");
    }
}

#[test]
fn crossings_do_not_mislead() {
    let eight: Vec<Point> = (0..400)
        .map(|i| {
            let t = i as f64 / 400.0 * TAU;
            Point::new(100.0 * t.sin(), 60.0 * (2.0 * t).sin())
        })
        .collect();
    let fit = fitted(&eight, true, 0.5);
    assert!(true_error(&fit, &eight) <= 0.5 && fit.spline.guides().len() <= 20, "{}", fit.spline.guides().len());
    // Both lobes are drawn once, with opposite directions.
    assert!(fit.spline.area().abs() < 50.0);
    assert!((fit.spline.length() - polyline::length(&eight, true)).abs() < 5.0);
}

#[test]
fn sparse_points_keep_the_curve_near_their_line() {
    let points: Vec<Point> = (0..12).map(|i| bean(i as f64 / 12.0)).collect();
    for tolerance in [0.3, 3.0, 12.0] {
        let fit = fitted(&points, true, tolerance);
        assert!(true_error(&fit, &points) <= tolerance, "{tolerance}");
    }
}

#[test]
fn pressure_is_transferred() {
    let points: Vec<Point> = (0..300).map(|i| bean(i as f64 / 400.0)).collect();
    let pressure: Vec<f64> = (0..300).map(|i| 1.0 + 0.5 * (i as f64 / 60.0).sin()).collect();
    let fit = fitted(&points, false, 0.2);
    let carried = fit.attribute(&pressure).unwrap();
    assert_eq!(carried.len(), fit.spline.guides().len());
    for (&t, want) in fit.parameters.iter().zip(&pressure) {
        assert!((fit.spline.blend(&carried, t) - want).abs() < 0.05);
    }
    // The parameters lead to the places of the points.
    for (&t, &p) in fit.parameters.iter().zip(&points) {
        assert!(fit.spline.point(t).distance(p) <= 0.2);
    }
}

#[test]
fn a_long_line_is_fitted_in_chunks_as_well_as_in_parts() {
    let wave = |i: usize| Point::new(i as f64, 40.0 * (i as f64 / 45.0).sin() + 9.0 * (i as f64 / 17.0).cos());
    let points: Vec<Point> = (0..9000).map(wave).map(|p| p.floor() + 0.5).collect();
    let whole = fitted(&points, false, 1.0);
    assert!(whole.max_error <= 1.0);
    let parts: usize = points.chunks(900).map(|part| fitted(part, false, 1.0).spline.piece_count()).sum();
    let count = whole.spline.piece_count();
    assert!(count as f64 <= 1.1 * parts as f64, "{count} {parts}");
    // On a closed curve the ends of the chunks join as smoothly as the rest.
    let ring = pixels(20_000, |t| Point::from_angle(t * TAU) * (3000.0 + 40.0 * (90.0 * t * TAU).sin()) + 4000.0);
    let ring = fitted(&ring, true, 1.0);
    assert!(ring.max_error <= 1.0 && ring.spline.corners().is_empty());
}

#[test]
fn the_same_points_give_the_same_guides() {
    let points = pixels(700, bean);
    assert_eq!(fitted(&points, true, 0.8), fitted(&points, true, 0.8));
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(48))]

    #[test]
    fn the_tolerance_is_kept_whatever_the_points(
        points in prop::collection::vec((-30i32..30, -30i32..30), 1..60), closed: bool, tolerance in 0.05f64..8.0,
        fine: bool, preset in prop::sample::select(vec![Preset::Rototoon, Preset::Yang1986]),
    ) {
        let scale = if fine { 0.37 } else { 1.0 };
        let points: Vec<Point> = points.into_iter().map(|(x, y)| Point::new(x as f64, y as f64) * scale).collect();
        let fit = fit(&points, closed, &Options { tolerance, preset }).unwrap();
        prop_assert!(fit.max_error <= tolerance);
        prop_assert!(true_error(&fit, &points) <= fit.max_error + 1e-9);
        prop_assert_eq!(fit.parameters.len(), points.len());
    }

    #[test]
    fn smooth_noisy_lines_keep_the_tolerance(
        waves in prop::collection::vec((0.5f64..40.0, 0.0f64..TAU), 1..5), closed: bool,
        jitter in prop::collection::vec((-0.4f64..0.4, -0.4f64..0.4), 200..500), tolerance in 0.6f64..4.0,
    ) {
        let n = jitter.len();
        let points: Vec<Point> = jitter
            .iter()
            .enumerate()
            .map(|(i, &by)| {
                let t = i as f64 / n as f64 * TAU;
                let bumps: f64 = waves.iter().enumerate().map(|(k, (size, phase))| size * ((k + 2) as f64 * t + phase).cos()).sum();
                Point::from_angle(t) * (150.0 + bumps) + Point::from(by)
            })
            .collect();
        let fit = fitted(&points, closed, tolerance);
        prop_assert!(fit.max_error <= tolerance);
        prop_assert!(true_error(&fit, &points) <= fit.max_error + 1e-9);
    }
}
