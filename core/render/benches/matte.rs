//! Time of the mattes of twelve moving parts as the OpenFX plugin draws them, in full HD on one thread.
//!
//! Targets: 8 ms per frame, 60 ms with motion blur of 16 samples, and linear growth with pixels and points.

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use rototoon_base::geometry::Point;
use rototoon_base::scene::{Falloff, FalloffCurve};
use rototoon_render::coverage::Window;
use rototoon_render::mask::Mask;
use rototoon_render::widths;
use std::hint::black_box;

/// Twelve overlapping limbs of a figure that fills the picture, at a time in frames.
fn parts(width: f64, height: f64, points: usize, time: f64) -> Vec<Vec<Point>> {
    let part = |index: usize| {
        let middle =
            Point::new(width * (0.1 + 0.8 * (index % 4) as f64 / 3.0), height * (0.2 + 0.3 * (index / 4) as f64));
        let turn = Point::from_angle(0.5 * index as f64 + 0.05 * time);
        let at = |k: usize| {
            let angle = std::f64::consts::TAU * k as f64 / points as f64;
            let bulge = 1.0 + 0.2 * (3.0 * angle).sin();
            let p = Point::new(0.14 * width * angle.cos(), 0.11 * height * angle.sin()) * bulge;
            middle + turn.rotate(p) + 4.0 * time * Point::X
        };
        (0..points).map(at).collect()
    };
    (0..12).map(part).collect()
}

fn mask(width: usize, height: usize, points: usize, samples: usize, grow: f64, feather: f64) -> (Mask, Window) {
    let at = |k: usize| parts(width as f64, height as f64, points, k as f64 / samples as f64);
    let window = Window { left: 0, top: 0, right: width as i64, bottom: height as i64 };
    (Mask::new((0..samples).map(at).collect(), grow, feather), window)
}

fn mattes(bench: &mut Criterion) {
    let mut group = bench.benchmark_group("matte 1920x1080");
    for (name, points, samples, grow, feather) in [
        ("12 parts of 24 points", 24, 1, 0.0, 0.0),
        ("motion blur of 16 samples", 24, 16, 0.0, 0.0),
        ("grown by 8", 24, 1, 8.0, 0.0),
        ("feathered by 10", 24, 1, 0.0, 10.0),
        ("12 parts of 2400 points", 2400, 1, 0.0, 0.0),
    ] {
        group.bench_function(name, |bench| {
            // The plugin also prepares the outlines once per frame.
            bench.iter(|| {
                let (mask, window) = mask(1920, 1080, points, samples, grow, feather);
                black_box(mask.draw(window, &mut || true))
            });
        });
    }
    for (name, samples) in [("feathered by 10, linear", 1), ("motion blur of 16 samples, feathered by 10, linear", 16)]
    {
        let linear = Falloff { rate: 1.0, curve: Some(FalloffCurve::Linear) };
        group.bench_function(name, |bench| {
            bench.iter(|| {
                let (mask, window) = mask(1920, 1080, 24, samples, 0.0, 10.0);
                black_box(mask.with_falloff(linear).draw(window, &mut || true))
            });
        });
    }
    group.bench_function("12 parts, each feathered from 0 to 20 along its contour", |bench| {
        let window = Window { left: 0, top: 0, right: 1920, bottom: 1080 };
        bench.iter(|| {
            for part in parts(1920.0, 1080.0, 24, 0.0) {
                let segments: Vec<Vec<Point>> = (0..24).map(|k| vec![part[k], part[(k + 1) % 24]]).collect();
                let widths: Vec<f64> = (0..24).map(|k| f64::from(12 - (k - 12i32).abs()) * 20.0 / 12.0).collect();
                let mask = Mask::new(vec![vec![part]], 0.0, 0.0).with_widths(&widths::pieces(&segments, &widths));
                black_box(mask.draw(window, &mut || true));
            }
        });
    });
    group.finish();
}

/// Sixty small overlapping parts of a crowd in a picture of 4096 x 2160 pixels, blurred by motion, feathered, far grown.
fn crowd(bench: &mut Criterion) {
    let (width, height) = (4096usize, 2160usize);
    let window = Window { left: 0, top: 0, right: width as i64, bottom: height as i64 };
    let at = |time: f64| {
        let part = |index: usize| {
            let (column, row) = ((index % 10) as f64, (index / 10) as f64);
            let middle = Point::new(width as f64 * (0.05 + 0.1 * column), height as f64 * (0.1 + 0.16 * row));
            let turn = Point::from_angle(0.5 * index as f64 + 0.05 * time);
            let corner = |k: usize| {
                let angle = std::f64::consts::TAU * k as f64 / 24.0;
                let bulge = 1.0 + 0.2 * (3.0 * angle).sin();
                middle
                    + turn.rotate(Point::new(230.0 * angle.cos(), 150.0 * angle.sin()) * bulge)
                    + 4.0 * time * Point::X
            };
            (0..24).map(corner).collect()
        };
        (0..60).map(part).collect::<Vec<Vec<Point>>>()
    };
    let mut group = bench.benchmark_group("matte 4096x2160 of 60 parts");
    group.sample_size(10);
    for (name, samples, grow, feather) in [
        ("still", 1, 0.0, 0.0),
        ("motion blur of 16 samples", 16, 0.0, 0.0),
        ("motion blur of 16 samples, feathered by 10", 16, 0.0, 10.0),
        ("grown by 200", 1, 200.0, 0.0),
        ("grown by 8", 1, 8.0, 0.0),
    ] {
        let instants: Vec<_> = (0..samples).map(|k| at(f64::from(k) / f64::from(samples))).collect();
        let mask = || Mask::new(instants.clone(), grow, feather);
        group.bench_function(name, |bench| bench.iter(|| black_box(mask().draw(window, &mut || true))));
        if grow == 0.0 {
            group.bench_function(format!("{name}, row by row"), |bench| bench.iter(|| by_rows(&mask(), window)));
        }
    }
    group.finish();
}

/// Makes the rows as the plugin does, which puts each into the host's picture before the next one.
fn by_rows(mask: &Mask, window: Window) {
    let mut rows = mask.rows(window, &mut || true).expect("nobody aborts");
    for _ in 0..window.height() {
        black_box(rows.next(&mut || true));
    }
}

fn growth(bench: &mut Criterion) {
    let mut group = bench.benchmark_group("matte growth");
    for step in [1usize, 2, 4] {
        let (width, height) = (480 * step, 270 * step);
        group.throughput(Throughput::Elements((width * height) as u64));
        group.bench_with_input(BenchmarkId::new("pixels", width * height), &step, |bench, _| {
            let (mask, window) = mask(width, height, 24, 1, 0.0, 0.0);
            bench.iter(|| black_box(mask.draw(window, &mut || true)));
        });
    }
    for points in [24usize, 240, 2400] {
        group.throughput(Throughput::Elements(12 * points as u64));
        group.bench_with_input(BenchmarkId::new("points", 12 * points), &points, |bench, &points| {
            let (mask, window) = mask(1920, 1080, points, 1, 0.0, 0.0);
            bench.iter(|| black_box(mask.draw(window, &mut || true)));
        });
    }
    group.finish();
}

criterion_group! { name = benches; config = Criterion::default().sample_size(20); targets = mattes, crowd, growth }
criterion_main!(benches);
