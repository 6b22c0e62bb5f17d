//! Time of fitting splines to pixel outlines: the outline of a cartoon, and lines of growing length.

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use rototoon_base::geometry::Point;
use rototoon_fit::{Options, fit};
use std::f64::consts::TAU;

/// A closed outline of about 1200 px with two corners, one sample per pixel, rounded to pixel centres.
fn outline() -> Vec<Point> {
    let (a, b) = (Point::new(150.0, 60.0), Point::new(420.0, 330.0));
    let side = |from: Point, to: Point, waves: [f64; 3], s: f64| {
        let chord = to - from;
        let bulge = (1..=3).map(|k| waves[k - 1] * (0.5 * TAU * k as f64 * s).sin()).sum::<f64>();
        from + chord * s - chord.perp().normalize() * bulge
    };
    let at = |t: f64| match t < 0.5 {
        true => side(a, b, [135.0, 38.0, -22.0], 2.0 * t),
        false => side(b, a, [150.0, -46.0, 8.0], 2.0 * t - 1.0),
    };
    (0..1217).map(|i| at(i as f64 / 1217.0).floor() + 0.5).collect()
}

/// An open wave of `count` points, rounded to pixel centres.
fn wave(count: usize) -> Vec<Point> {
    let at = |x: f64| Point::new(x, 40.0 * (x / 45.0).sin() + 9.0 * (x / 17.0).cos());
    (0..count).map(|i| at(i as f64).floor() + 0.5).collect()
}

fn bench(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("fit");
    let options = Options::new(1.0);
    let points = outline();
    group.bench_function("cartoon outline", |bencher| bencher.iter(|| fit(&points, true, &options)));
    group.sample_size(10);
    for count in [1_000, 10_000, 100_000] {
        let points = wave(count);
        group.throughput(Throughput::Elements(count as u64));
        group.bench_with_input(BenchmarkId::new("wave", count), &points, |bencher, points| {
            bencher.iter(|| fit(points, false, &options));
        });
    }
    group.finish();
}

criterion_group!(benches, bench);
criterion_main!(benches);
