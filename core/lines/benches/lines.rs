//! Time of tracing and of carrying: a 1920×1080 drawing of 100 strokes, and one of 5,000 marks.

#[path = "../tests/main/common.rs"]
mod common;

use common::{Line, draw, line, white};
use criterion::{Criterion, criterion_group, criterion_main};
use rototoon_base::geometry::Point;
use rototoon_lines::{Drawing, Options, Tracked, carry};
use std::f64::consts::TAU;
use std::hint::black_box;

const SIZE: (usize, usize) = (1920, 1080);

/// Bent strokes on a grid of ten by ten, which cross their neighbours. `time` moves and bends them.
fn strokes(time: f64) -> Vec<Line> {
    let stroke = |k: u32| {
        let centre =
            Point::new(150.0 + 180.0 * f64::from(k % 10) + 6.0 * time, 100.0 + 97.0 * f64::from(k / 10) + 3.0 * time);
        let angle = f64::from(k * 7919 % 360) * TAU / 360.0 + 0.03 * time;
        let at = |i: u32| {
            let t = f64::from(i) / 20.0 - 1.0;
            centre + Point::from_angle(angle).rotate(Point::new(110.0 * t, 35.0 * t * t + 3.0 * time * t))
        };
        Line { points: (0..=40).map(at).collect(), closed: false, width: 4.0, colour: [0.1; 3] }
    };
    (0..100).map(stroke).collect()
}

/// Short marks, side by side.
fn marks(time: f64) -> Vec<Line> {
    let mark = |k: u32| {
        let (x, y) = (f64::from(k % 100) * 19.0 + 10.0 + time, f64::from(k / 100) * 21.0 + 10.0);
        let way = if (k + k / 100).is_multiple_of(2) { (12.0, 1.0) } else { (1.0, 12.0) };
        Line { width: 2.0, ..line(&[(x, y), (x + way.0, y + way.1)]) }
    };
    (0..5000).map(mark).collect()
}

fn lines(c: &mut Criterion) {
    let mut group = c.benchmark_group("lines/1080p");
    group.sample_size(10);
    for (name, film) in [("100 strokes", strokes as fn(f64) -> Vec<Line>), ("5000 marks", marks)] {
        let pictures = [0.0, 1.0].map(|time| draw(SIZE.0, SIZE.1, &film(time), white));
        let look = |k: usize| Drawing::new(pictures[k].clone(), &Options::default());
        group.bench_function(format!("trace {name}"), |b| b.iter(|| black_box(look(0).strokes())));
        let first = look(0);
        let traced: Vec<Tracked> =
            first.strokes().into_iter().enumerate().map(|(track, stroke)| Tracked::sure(track, stroke)).collect();
        group.bench_function(format!("carry {name}"), |b| {
            b.iter(|| black_box(carry(&first, &traced, &look(1), &mut 10_000)));
        });
    }
    group.finish();
}

criterion_group!(benches, lines);
criterion_main!(benches);
