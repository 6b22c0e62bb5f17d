//! Sweeps of the tolerance over lines of many kinds: steady numbers of pieces and corners, corners where a person sees them,
//! rounding that is not fitted.

#[allow(dead_code, reason = "the program that prints the sweep uses the rest")]
mod family;

use family::{Line, Random, along, gear, ladder, lines, pixels, resampled, zigzag};
use proptest::prelude::*;
use rototoon_base::geometry::Point;
use rototoon_fit::{Fitted, Options, fit};

fn fitted(line: &Line, tolerance: f64) -> Fitted {
    fit(&line.points, line.closed, &Options::new(tolerance)).unwrap()
}

/// The kinds of each shape: exact points, pixels, jitter.
fn of(name: &str, shape: &[Point], closed: bool) -> [Line; 3] {
    let even = resampled(shape, closed, 1.0);
    let mut random = Random(3);
    let jitter = even.iter().map(|p| *p + Point::new(random.signed(), random.signed()) * 0.3).collect();
    let line = |kind: &str, points| Line { name: format!("{name}, {kind}"), points, closed };
    [line("jitter", jitter), line("pixels", pixels(shape, closed)), line("exact", even)]
}

/// Fits at rising tolerances. Neither pieces nor corners may become more.
fn check_steady(line: &Line, tolerances: impl Iterator<Item = f64>) {
    let mut last: Option<(f64, usize, usize)> = None;
    for tolerance in tolerances {
        let fit = fitted(line, tolerance);
        let (pieces, corners) = (fit.spline.piece_count(), fit.spline.corners().len());
        if let Some((before, more, more_corners)) = last {
            let name = &line.name;
            assert!(pieces <= more, "{name}: {more} pieces at {before} px, {pieces} at {tolerance} px");
            assert!(
                corners <= more_corners,
                "{name}: {more_corners} corners at {before} px, {corners} at {tolerance} px"
            );
        }
        last = Some((tolerance, pieces, corners));
    }
}

/// The least tolerance that is clearly above the noise of a line of this kind.
fn audible(name: &str) -> f64 {
    if name.ends_with("jitter") {
        0.7
    } else if name.ends_with("pixels") {
        0.5
    } else {
        0.0
    }
}

#[test]
fn a_larger_tolerance_takes_no_more_pieces_or_corners() {
    // The random lines of the family have a property test of their own.
    for line in lines().iter().filter(|line| !line.name.contains(char::is_numeric)) {
        check_steady(line, ladder().into_iter().filter(|&t| t >= audible(&line.name)).step_by(2));
    }
}

#[test]
fn each_tip_of_a_zigzag_is_one_corner_at_any_tolerance_below_its_height() {
    for (width, height) in [(14.0, 24.0), (20.0, 12.0)] {
        let shape = zigzag(12, width, height);
        for line in of("zigzag", &shape, false) {
            let tips = &shape[1..13];
            // The tips are half of the height above and below the middle line.
            for tolerance in ladder().into_iter().filter(|&t| t >= audible(&line.name) && t < 0.5 * height - 1.0) {
                let fit = fitted(&line, tolerance);
                let corners: Vec<Point> = fit.spline.corners().iter().map(|&k| fit.spline.guides()[k]).collect();
                let at = |tip: &Point| corners.iter().filter(|c| c.distance(*tip) <= 2.0 + tolerance).count();
                let counts: Vec<usize> = tips.iter().map(at).collect();
                assert_eq!(counts, [1; 12], "{} {width} × {height} at {tolerance} px", line.name);
                assert_eq!(corners.len(), 12, "{} {width} × {height} at {tolerance} px", line.name);
            }
        }
    }
}

#[test]
fn the_corners_of_gears_and_sparse_polygons_are_found() {
    for line in of("gear", &gear(18, 150.0, 24.0), true) {
        for tolerance in [0.7, 1.5, 5.0] {
            assert_eq!(fitted(&line, tolerance).spline.corners().len(), 72, "{} at {tolerance} px", line.name);
        }
    }
    let sparse = Line { name: String::new(), points: zigzag(12, 14.0, 24.0), closed: false };
    for tolerance in [0.25, 1.0, 4.0] {
        assert_eq!(fitted(&sparse, tolerance).spline.corners().len(), 12, "{tolerance}");
    }
}

#[test]
fn a_smooth_crest_is_not_a_corner() {
    for (wavelength, height) in [(120.0, 30.0), (60.0, 14.0), (200.0, 80.0)] {
        let wave = |t: f64| {
            Point::new(20.0 + 600.0 * t, 150.0 + height * (600.0 * t / wavelength * std::f64::consts::TAU).sin())
        };
        for line in of("wave", &along(9000, wave), false) {
            for tolerance in ladder().into_iter().filter(|&t| t >= audible(&line.name)) {
                let corners = fitted(&line, tolerance).spline.corners();
                assert_eq!(corners, [] as [usize; 0], "{} {wavelength} × {height} at {tolerance} px", line.name);
            }
        }
    }
}

/// A smooth outline with random bumps.
fn random_outline(seed: u64) -> Vec<Point> {
    let mut random = Random(seed);
    let terms: Vec<(f64, f64)> =
        (2..8).map(|k| (70.0 / f64::from(k * k) * random.signed(), 3.0 * random.signed())).collect();
    along(4000, |t| {
        let t = t * std::f64::consts::TAU;
        let bumps: f64 = terms.iter().zip(2..).map(|((size, phase), k)| size * (f64::from(k) * t + phase).cos()).sum();
        Point::from_angle(t) * (100.0 + bumps) + 200.0
    })
}

/// Fifteen straight sides that go right, up and down.
fn random_sides(seed: u64) -> Vec<Point> {
    let mut random = Random(seed);
    let mut place = Point::new(50.0, 200.0);
    let mut next = |_| {
        place += Point::new(25.0 + 12.0 * random.signed(), 50.0 * random.signed());
        place
    };
    (0..16).map(&mut next).collect()
}

#[test]
fn a_fit_whose_guiding_points_are_the_points_is_not_taken_for_having_no_corners() {
    // At half a pixel the jitter of these sides is not told from their shape: each point would be a guiding point.
    let [jitter, ..] = of("sides", &random_sides(2423), false);
    let at = |tolerance: f64| fitted(&jitter, tolerance).spline;
    assert!(at(0.5).piece_count() > 500 && at(0.5).corners().is_empty());
    assert_eq!((at(0.7).corners().len(), at(1.0).corners().len()), (7, 7));
    assert!(at(0.7).piece_count() < 30, "{} pieces", at(0.7).piece_count());
}

/// The seeds are fixed: the search is local, and of 18 000 such lines one gets a corner more at 4 px than at 2 px.
#[test]
fn random_curves_are_steady() {
    for seed in 0..8 {
        for (kind, shape) in [("outline", random_outline(seed)), ("sides", random_sides(seed))] {
            for line in of(&format!("seed {seed}, {kind}"), &shape, false) {
                // Rungs of the ladder in `steady`: of two tolerances between the same two rungs, nothing is promised.
                check_steady(&line, [0.5f64.sqrt(), 1.0, 2.0, 4.0].into_iter());
            }
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(8))]

    #[test]
    fn pixels_never_get_more_guides_than_points(
        steps in prop::collection::vec((-1i32..=1, -1i32..=1), 40..400), tolerance in 0.02f64..2.0, closed: bool,
    ) {
        let mut place = Point::new(0.5, 0.5);
        let mut points = vec![place];
        for (x, y) in steps {
            place += Point::new(f64::from(x), f64::from(y));
            if points.last() != Some(&place) {
                points.push(place);
            }
        }
        // A long closing line would not be one of pixels.
        let closed = closed && place.distance(points[0]) < 2.0;
        let fit = fit(&points, closed, &Options::new(tolerance)).unwrap();
        prop_assert!(fit.max_error <= tolerance.max((tolerance + 0.5).min(1.0)));
        prop_assert!(fit.spline.guides().len() <= points.len(), "{} {}", fit.spline.guides().len(), points.len());
    }
}
