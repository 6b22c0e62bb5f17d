//! The factorisation beside its plain steps, and how well its codes tell classes apart.

use super::*;
use std::f64::consts::TAU;

/// Postures of a smooth family, without negative entries.
fn postures(n: usize, d: usize) -> Mat<f64> {
    Mat::from_fn(n, d, |i, j| {
        let (t, s) = (i as f64 / n as f64, j as f64);
        2.5 + (TAU * t + 0.4 * s).sin() + 0.6 * (2.0 * TAU * t * (1.0 + s / d as f64)).cos()
    })
}

/// The same steps in plain form.
fn naive(x: &Mat<f64>, mut u: Mat<f64>, mut v: Mat<f64>, rounds: usize) -> (Mat<f64>, Mat<f64>) {
    for _ in 0..rounds {
        let vv = &v * v.transpose();
        let eigen = vv.self_adjoint_eigen(Side::Lower).unwrap();
        let step = (&u * &v - x) * v.transpose();
        let mu = 1.0 / eigen.S()[v.nrows() - 1];
        u = Mat::from_fn(u.nrows(), u.ncols(), |i, j| (u[(i, j)] - mu * step[(i, j)]).max(0.0));
        normalise(&mut u, &mut v, Reading::Consistent);
        let (up, down) = (u.transpose() * x, u.transpose() * &u * &v);
        v = Mat::from_fn(v.nrows(), v.ncols(), |i, j| v[(i, j)] * up[(i, j)] / (down[(i, j)] + TINY));
    }
    (u, v)
}

#[test]
fn the_error_is_that_of_the_naive_steps_or_less() {
    let x = postures(120, 14);
    let options = Options { rank: 6, tolerance: 0.0, ..Options::default() };
    let found = factor(x.as_ref(), &[], &options).unwrap();
    let (u, v) = start(x.as_ref(), &options);
    let (u, v) = naive(&x, u, v, 200);
    let plain = (&u * &v - &x).norm_l2() / x.norm_l2();
    assert!(found.error < 1.02 * plain && found.error > 0.3 * plain, "{} {plain}", found.error);
    assert!(found.error < 0.05);
    assert_eq!((found.rounds, found.ended), (200, Ended::Rounds));
    let smallest = |m: &Mat<f64>| (0..m.ncols()).flat_map(|j| m.col_as_slice(j).to_vec()).fold(0.0, f64::min);
    assert_eq!((smallest(&found.codes), smallest(&found.basis)), (0.0, 0.0));
}

#[test]
fn rounds_end_when_nothing_changes_and_are_the_same_each_time() {
    let x = postures(60, 8);
    let options = Options { rank: 4, rounds: 5000, tolerance: 1e-4, ..Options::default() };
    let (a, b) = (factor(x.as_ref(), &[], &options).unwrap(), factor(x.as_ref(), &[], &options).unwrap());
    assert_eq!(a.ended, Ended::Converged);
    assert!(a.rounds < 5000);
    assert_eq!(a.codes, b.codes);
}

#[test]
fn the_print_taken_literally_wipes_the_codes() {
    let options = Options { rank: 6, reading: Reading::Literal, ..Options::default() };
    let found = factor(postures(120, 14).as_ref(), &[], &options).unwrap();
    assert_eq!(found.ended, Ended::Wiped);
    assert_eq!(found.error, 1.0);
}

#[test]
fn rows_of_unit_length_lose_the_magnitude_of_a_frame() {
    // Two frames of one posture, the second twice as large: with rows of unit length both get the same code.
    let x = Mat::from_fn(2, 5, |i, j| (i + 1) as f64 * (j + 1) as f64);
    let (mut u, mut v) = (Mat::from_fn(2, 1, |i, _| (i + 1) as f64), Mat::from_fn(1, 5, |_, j| (j + 1) as f64));
    normalise(&mut u, &mut v, Reading::Consistent);
    assert!((&u * &v - &x).norm_l2() < 1e-12);
    normalise(&mut u, &mut v, Reading::Literal);
    assert_eq!(u[(0, 0)], u[(1, 0)]);
}

#[test]
fn classes_are_told_better_by_codes_that_were_drawn_to() {
    let x = postures(90, 12);
    let labels: Vec<usize> = (0..90).map(|i| i / 30).collect();
    let wrong = |weight: f64| {
        let options = Options { rank: 8, class_weight: weight, ..Options::default() };
        let found = factor(x.as_ref(), &labels, &options).unwrap();
        ((&found.codes * &found.classes - indicator(&labels)).norm_l2(), found.error)
    };
    let (plain, drawn) = (wrong(0.0), wrong(1.0));
    assert!(drawn.0 < plain.0, "{plain:?} {drawn:?}");
    assert!(drawn.1 >= plain.1);
}

#[test]
fn few_directions_of_the_basis_are_worse_and_all_change_nothing() {
    let x = postures(60, 10);
    let error = |directions| {
        let options = Options { rank: 6, directions, ..Options::default() };
        factor(x.as_ref(), &[], &options).unwrap().error
    };
    assert_eq!(error(Some(6)), error(None));
    assert!(error(Some(4)) < error(Some(1)));
    assert!(error(None) < error(Some(1)));
}

#[test]
fn what_cannot_be_factored_is_named() {
    let mut x = postures(4, 3);
    let options = Options { rank: 2, ..Options::default() };
    assert_eq!(factor(x.as_ref(), &[0], &options).unwrap_err(), FactorError::Labels { found: 1, rows: 4 });
    x[(2, 1)] = -1.0;
    let error = factor(x.as_ref(), &[], &options).unwrap_err();
    assert_eq!(error.to_string(), "row 2, column 1: found -1, expected a finite number of at least 0");
    assert_eq!(factor(x.as_ref(), &[], &Options { rank: 0, ..options }).unwrap_err(), FactorError::Rank);
    let zero = factor(Mat::zeros(3, 3).as_ref(), &[], &Options::default()).unwrap();
    assert!(zero.codes.norm_l2().is_finite());
}
