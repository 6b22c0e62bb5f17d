//! Small dense systems by nalgebra, behind the interface of `numeric::dense`, and our own band factorisation beside
//! nalgebra's dense one.
//!
//! `cargo bench -p rototoon-base --bench dense`. The module docs of `numeric::banded` quote what this prints.

use criterion::{BenchmarkId, Criterion, criterion_group, criterion_main};
use nalgebra::{DMatrix, DVector};
use rototoon_base::numeric::banded::BandMatrix;
use rototoon_base::numeric::dense::DenseCholesky;
use std::hint::black_box;

/// A positive definite matrix, row by row.
fn matrix(n: usize) -> Vec<f64> {
    let noise = |k: usize| ((k * 7919 + 104_729) % 1009) as f64 / 1009.0 - 0.5;
    let half: Vec<f64> = (0..n * n).map(noise).collect();
    let product = |i: usize, j: usize| (0..n).map(|q| half[i * n + q] * half[j * n + q]).sum::<f64>();
    (0..n * n).map(|k| product(k / n, k % n) + if k / n == k % n { 1.0 } else { 0.0 }).collect()
}

fn inverses(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("dense inverse");
    for n in [4, 16, 64, 192] {
        let rows = matrix(n);
        group.bench_with_input(BenchmarkId::new("by rows", n), &rows, |bencher, rows| {
            bencher.iter(|| DenseCholesky::new(n, black_box(rows)).map(|factor| factor.inverse()));
        });
        group.bench_with_input(BenchmarkId::new("nalgebra", n), &rows, |bencher, rows| {
            bencher.iter(|| DMatrix::from_row_slice(n, n, black_box(rows)).cholesky().map(|factor| factor.inverse()));
        });
    }
    group.finish();
}

fn solutions(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("dense solve");
    for n in [4, 16, 64, 192] {
        let rows = matrix(n);
        group.bench_with_input(BenchmarkId::new("by rows", n), &rows, |bencher, rows| {
            bencher.iter(|| {
                let mut b = vec![1.0; n];
                if let Some(factor) = DenseCholesky::new(n, black_box(rows)) {
                    factor.solve(&mut b, 1);
                }
                b
            });
        });
        group.bench_with_input(BenchmarkId::new("nalgebra", n), &rows, |bencher, rows| {
            bencher.iter(|| {
                let mut b = DVector::from_element(n, 1.0);
                if let Some(factor) = DMatrix::from_row_slice(n, n, black_box(rows)).cholesky() {
                    factor.solve_mut(&mut b);
                }
                b
            });
        });
    }
    group.finish();
}

/// A lattice's normal equations: nalgebra has no band factorisation, so its dense one stands beside ours.
fn bands(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("band factor");
    for (n, half) in [(120, 18), (400, 42)] {
        let mut band = BandMatrix::zeros(n, half);
        for i in 0..n {
            band.add(i, i, 4.0 * half as f64);
            for j in i + 1..(i + half + 1).min(n) {
                band.add(i, j, ((i * 31 + j * 17) % 13) as f64 / 13.0 - 0.5);
            }
        }
        let dense = DMatrix::from_fn(n, n, |i, j| band.get(i, j));
        let name = format!("{n} rows, half width {half}");
        group.bench_with_input(BenchmarkId::new("own", &name), &band, |bencher, band| {
            bencher.iter(|| black_box(band).clone().factor());
        });
        group.bench_with_input(BenchmarkId::new("nalgebra", &name), &dense, |bencher, dense| {
            bencher.iter(|| black_box(dense).clone().cholesky());
        });
    }
    group.finish();
}

criterion_group!(benches, inverses, solutions, bands);
criterion_main!(benches);
