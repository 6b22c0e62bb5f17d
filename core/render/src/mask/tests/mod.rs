//! Masks with and without a feather, in windows.

mod falloff;

use super::*;
use crate::widths;

fn square(x: f64, y: f64, size: f64) -> Vec<Point> {
    vec![Point::new(x, y), Point::new(x + size, y), Point::new(x + size, y + size), Point::new(x, y + size)]
}

#[test]
fn nothing_lies_beyond_the_bounds_and_windows_agree() {
    let instants = vec![vec![square(10.0, 9.0, 8.0)], vec![square(12.3, 9.6, 8.0)]];
    let all = Window { left: 0, top: 0, right: 40, bottom: 36 };
    for (grow, feather) in [(0.0, 0.0), (2.5, 0.0), (-1.5, 3.0), (0.0, 4.2)] {
        let mask = Mask::new(instants.clone(), grow, feather);
        let bounds = mask.bounds().unwrap();
        let whole = mask.draw(all, &mut || true).unwrap();
        for y in 0..36 {
            for x in 0..40 {
                let (p, q) = (Point::new(x as f64, y as f64), Point::new(x as f64 + 1.0, y as f64 + 1.0));
                let beyond = q.cmple(bounds.least).any() || p.cmpge(bounds.most).any();
                assert!(!beyond || whole.get(x, y) < 1e-6, "{grow} {feather} {x} {y} {}", whole.get(x, y));
            }
        }
        let part = Window { left: 11, top: 8, right: 19, bottom: 21 };
        let piece = mask.draw(part, &mut || true).unwrap();
        for y in 0..13 {
            for x in 0..8 {
                assert_eq!(piece.get(x, y), whole.get(x + 11, y + 8), "{grow} {feather}");
            }
        }
    }
}

#[test]
fn a_huge_reach_is_limited() {
    let window = Window { left: 0, top: 0, right: 3, bottom: 2 };
    let huge = |grow, feather| Mask::new(vec![vec![square(0.0, 0.0, 2.0)]], grow, feather);
    let limited = huge(0.0, MOST_REACH);
    let drawn = limited.draw(window, &mut || true).unwrap();
    assert!(drawn.data().iter().all(|value| (0.0..1.0).contains(value)), "{drawn:?}");
    for feather in [1e12, 1e300, f64::INFINITY] {
        assert_eq!(huge(0.0, feather).bounds(), limited.bounds());
        assert_eq!(huge(0.0, feather).draw(window, &mut || true).unwrap(), drawn);
    }
    assert_eq!(huge(f64::INFINITY, 0.0).draw(window, &mut || true).unwrap().data(), [1.0; 6]);
    assert_eq!(huge(f64::NAN, f64::NAN).draw(window, &mut || true).unwrap().data(), [1.0, 1.0, 0.0, 1.0, 1.0, 0.0]);
}

fn paths(corners: &[Point]) -> Vec<Vec<Point>> {
    (0..corners.len()).map(|k| vec![corners[k], corners[(k + 1) % corners.len()]]).collect()
}

/// The share of a quadratic B-spline from -radius to radius that lies below x.
fn rise(x: f64, radius: f64) -> f64 {
    let u = (1.5 * x / radius).clamp(-1.5, 1.5);
    let tail = |u: f64| (1.5 - u).powi(3) / 6.0;
    if u > 0.5 {
        1.0 - tail(u)
    } else if u < -0.5 {
        tail(-u)
    } else {
        0.5 + 0.75 * u - u.powi(3) / 3.0
    }
}

#[test]
fn equal_widths_are_the_feather_itself() {
    let window = Window { left: 0, top: 0, right: 40, bottom: 36 };
    let corners = square(10.0, 9.0, 14.3);
    for (grow, feather, width) in [(0.0, 0.0, 4.2), (0.0, 1.5, 3.0), (2.0, 0.0, 3.3), (0.0, 2.0, 0.0)] {
        let mask = Mask::new(vec![vec![corners.clone()]], grow, feather);
        let soft = mask.with_widths(&widths::pieces(&paths(&corners), &[width; 4]));
        let plain = Mask::new(vec![vec![corners.clone()]], grow, feather + width);
        assert_eq!(soft.bounds(), plain.bounds());
        assert_eq!(soft.draw(window, &mut || true), plain.draw(window, &mut || true), "to the last bit");
    }
}

#[test]
fn widths_that_rise_along_a_border_give_ramps_of_these_widths() {
    // A border at x = 60 from y = 0 to 200, whose width rises from 4 to 24. The other corners are far away.
    let corners: Vec<Point> =
        [(60.0, 0.0), (60.0, 200.0), (-300.0, 200.0), (-300.0, 0.0)].map(|(x, y)| Point::new(x, y)).into();
    let pieces = widths::pieces(&paths(&corners), &[4.0, 24.0, 24.0, 4.0]);
    let mask = Mask::new(vec![vec![corners]], 0.0, 2.0).with_widths(&pieces);
    assert!(mask.is_drawn_whole());
    let window = Window { left: 20, top: 50, right: 100, bottom: 150 };
    let drawn = mask.draw(window, &mut || true).unwrap();
    for (y, radius) in [(20, 2.0 + 4.0 + 7.05), (50, 2.0 + 4.0 + 10.05), (80, 2.0 + 4.0 + 13.05)] {
        for x in 0..80 {
            let wanted = 1.0 - rise(x as f64 + 20.5 - 60.0, radius);
            let found = f64::from(drawn.get(x, y));
            assert!((found - wanted).abs() < 0.01, "{x} {y}: {found} {wanted}");
        }
    }
}

#[test]
fn with_widths_nothing_lies_beyond_the_bounds_and_windows_agree() {
    let corners = square(20.0, 19.0, 30.0);
    let pieces = widths::pieces(&paths(&corners), &[0.0, 12.0, 3.0, 0.0]);
    let all = Window { left: 0, top: 0, right: 70, bottom: 66 };
    let part = Window { left: 17, top: 13, right: 49, bottom: 41 };
    for (grow, feather) in [(0.0, 0.0), (2.5, 1.0)] {
        let mask = Mask::new(vec![vec![corners.clone()]], grow, feather).with_widths(&pieces);
        let [whole, piece] = [all, part].map(|window| mask.draw(window, &mut || true).unwrap());
        for y in 0..part.height() {
            for x in 0..part.width() {
                assert_eq!(piece.get(x, y), whole.get(x + 17, y + 13), "{grow} {feather}");
            }
        }
        let bounds = mask.bounds().unwrap();
        assert!(bounds.least.x < 20.0 - 12.0 && whole.get(35, 34) == 1.0);
        for (k, value) in whole.data().iter().enumerate() {
            let (p, one) = (Point::new((k % 70) as f64, (k / 70) as f64), Point::ONE);
            let beyond = (p + one).cmple(bounds.least).any() || p.cmpge(bounds.most).any();
            assert!(!beyond || *value < 1e-6, "{p} {value}");
        }
    }
    let mask = Mask::new(vec![vec![corners]], 0.0, 0.0).with_widths(&pieces);
    assert_eq!(mask.draw(all, &mut || false), None);
}

#[test]
fn a_mask_of_nothing_has_no_bounds() {
    let window = Window { left: 0, top: 0, right: 3, bottom: 2 };
    for mask in [Mask::new(vec![], 0.0, 1.0), Mask::new(vec![vec![square(0.0, 0.0, 2.0)]], -9.0, 0.0)] {
        assert_eq!(mask.bounds(), None);
        assert_eq!(mask.draw(window, &mut || true).unwrap().data(), [0.0; 6]);
    }
}
