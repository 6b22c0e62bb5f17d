//! Tests of masks with a falloff, against a mask that is drawn point by point.

use crate::coverage::Window;
use crate::mask::Mask;
use crate::widths;
use proptest::prelude::*;
use rototoon_base::geometry::Point;
use rototoon_base::scene::{Falloff, FalloffCurve};

fn rectangle(x0: f64, y0: f64, x1: f64, y1: f64) -> Vec<Point> {
    [(x0, y0), (x1, y0), (x1, y1), (x0, y1)].map(|(x, y)| Point::new(x, y)).into()
}

fn falloff(curve: usize, rate: f64) -> Falloff {
    Falloff { rate, curve: Some(FalloffCurve::ALL[curve].0) }
}

/// The course of a border at a place from 0, outside, to 1.
fn course(curve: usize, rate: f64, t: f64) -> f64 {
    let t = t.clamp(0.0, 1.0);
    let bell = match 3.0 * t - 1.5 {
        x if x < -0.5 => (x + 1.5).powi(3) / 6.0,
        x if x > 0.5 => 1.0 - (1.5 - x).powi(3) / 6.0,
        x => 0.5 + 0.75 * x - x.powi(3) / 3.0,
    };
    [bell, t, t * t * (2.0 - t), t * (1.0 + t - t * t)][curve].powf(rate)
}

fn row(mask: &Mask, window: Window) -> Vec<f32> {
    mask.draw(window, &mut || true).unwrap().row(0).to_vec()
}

#[test]
fn the_course_of_the_blur_is_drawn_to_the_last_bit_as_before() {
    let instants = vec![vec![rectangle(5.0, 3.0, 25.3, 20.0)], vec![rectangle(8.2, 4.0, 28.0, 21.5)]];
    let window = Window { left: 0, top: 0, right: 40, bottom: 30 };
    for (grow, feather) in [(0.0, 4.0), (1.5, 3.0), (0.0, 0.0)] {
        let plain = Mask::new(instants.clone(), grow, feather);
        let same = plain.clone().with_falloff(falloff(0, 1.0));
        assert_eq!(same.draw(window, &mut || true), plain.draw(window, &mut || true));
        assert_eq!(same.is_drawn_whole(), plain.is_drawn_whole());
    }
    // Without a soft border a falloff changes nothing.
    let hard = Mask::new(instants, 0.0, 0.0);
    let other = hard.clone().with_falloff(falloff(1, 3.0));
    assert_eq!(other.draw(window, &mut || true), hard.draw(window, &mut || true));
    assert!(!other.is_drawn_whole());
}

#[test]
fn windows_agree_and_it_ends_when_told() {
    let instants: Vec<_> = (0..5).map(|k| vec![rectangle(9.0 + 2.3 * f64::from(k), 8.0, 30.0, 27.0)]).collect();
    let corners = rectangle(9.0, 8.0, 30.0, 27.0);
    let sides: Vec<_> = (0..4).map(|k| vec![corners[k], corners[(k + 1) % 4]]).collect();
    let all = Window { left: 0, top: 0, right: 48, bottom: 40 };
    let part = Window { left: 17, top: 5, right: 39, bottom: 31 };
    for (grow, width) in [(0.0, 0.0), (2.0, 0.0), (0.0, 7.0), (-1.5, 3.0)] {
        let mask = Mask::new(instants.clone(), grow, 4.0).with_falloff(falloff(1, 0.6));
        let mask = mask.with_widths(&widths::pieces(&sides, &[width, 0.0, 0.0, width]));
        assert!(mask.is_drawn_whole());
        let [whole, piece] = [all, part].map(|window| mask.draw(window, &mut || true).unwrap());
        for y in 0..part.height() {
            for x in 0..part.width() {
                assert_eq!(piece.get(x, y), whole.get(x + 17, y + 5), "{grow} {width}");
            }
        }
        let mut rows = 200;
        let stopped = mask.draw(all, &mut || {
            rows -= 1;
            rows > 0
        });
        assert_eq!((stopped, rows), (None, 0), "it asks within each instant");
    }
}

#[test]
fn instants_that_are_the_same_are_one_and_inside_all_is_1() {
    let square = vec![rectangle(10.0, 10.0, 40.0, 40.0)];
    let window = Window { left: 0, top: 25, right: 50, bottom: 26 };
    let one = Mask::new(vec![square.clone()], 0.0, 5.0).with_falloff(falloff(2, 1.7));
    for count in [3, 41, 49, 64] {
        let many = Mask::new(vec![square.clone(); count], 0.0, 5.0).with_falloff(falloff(2, 1.7));
        assert_eq!(row(&many, window), row(&one, window));
        assert!(!many.is_drawn_whole());
        let mut moving = vec![square.clone(); count];
        moving[0] = vec![rectangle(10.5, 10.0, 40.0, 40.0)];
        let row = row(&Mask::new(moving, 0.0, 5.0).with_falloff(falloff(2, 1.7)), window);
        assert!(row[20..30].iter().all(|value| *value == 1.0) && row[..5].iter().all(|value| *value == 0.0), "{row:?}");
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(40))]
    #[test]
    fn a_straight_border_has_the_course_of_its_falloff(
        curve in 0usize..4, rate in 0.3f64..4.0, feather in 2.0f64..30.0, at in 50.0f64..51.0,
    ) {
        // Far away from the other borders.
        let mask = Mask::new(vec![vec![rectangle(at, -200.0, 400.0, 200.0)]], 0.0, feather).with_falloff(falloff(curve, rate));
        let row = row(&mask, Window { left: 0, top: 0, right: 100, bottom: 1 });
        prop_assert!(row.windows(2).all(|pair| pair[0] <= pair[1]), "{:?}", row);
        for (x, value) in row.iter().enumerate() {
            let t = (x as f64 + 0.5 - at + feather) / (2.0 * feather);
            // Pixels are blurred, and a blurred pixel is a mean over its width: a border is softer by a pixel on each side, and
            // courses are steep at their ends.
            let pixel = 1.0 / (2.0 * feather);
            let (least, most) = (course(curve, rate, t - pixel), course(curve, rate, t + pixel));
            prop_assert!((least - 0.02..=most + 0.02).contains(&f64::from(*value)), "{} {}: {} to {}", x, value, least, most);
        }
        prop_assert!(row[..(49.0 - feather) as usize].iter().all(|value| *value == 0.0));
        prop_assert!(row[(52.0 + feather) as usize..].iter().all(|value| *value == 1.0));
    }

    #[test]
    fn what_moves_is_the_mean_of_its_instants(
        curve in 0usize..4, rate in 0.3f64..4.0, feather in 0.5f64..8.0, grow in prop_oneof![Just(0.0), -1.0f64..3.0],
        steps in prop::collection::vec(0.0f64..9.0, 2..6),
    ) {
        let at = |step: &f64| vec![rectangle(12.0 + step, 11.0, 34.0 + 0.5 * step, 29.0 + 0.2 * step)];
        let window = Window { left: 0, top: 0, right: 56, bottom: 44 };
        let mask = |instants| Mask::new(instants, grow, feather).with_falloff(falloff(curve, rate));
        let drawn = mask(steps.iter().map(at).collect()).draw(window, &mut || true).unwrap();
        let each: Vec<_> = steps.iter().map(|step| mask(vec![at(step)]).draw(window, &mut || true).unwrap()).collect();
        for (k, value) in drawn.data().iter().enumerate() {
            let mean = each.iter().map(|one| one.data()[k]).sum::<f32>() / each.len() as f32;
            prop_assert!((value - mean).abs() < 1e-5, "{} {} {}", k, value, mean);
        }
    }
}
