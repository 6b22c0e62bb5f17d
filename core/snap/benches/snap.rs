//! Time of snapping on a 1920×1080 drawing: twelve outlined discs with sixteen control points each.

use criterion::{Criterion, criterion_group, criterion_main};
use rototoon_base::geometry::Point;
use rototoon_base::scene::{Colour, Raster};
use rototoon_snap::{SnapOptions, Snapper};
use std::hint::black_box;

const RADIUS: f64 = 160.0;

fn centres() -> impl Iterator<Item = Point> {
    (0..12).map(|k| Point::new(240.0 + 480.0 * f64::from(k % 4), 180.0 + 360.0 * f64::from(k / 4)))
}

fn picture() -> Raster<Colour> {
    Raster::from_fn(1920, 1080, |x, y| {
        let p = Point::new(x as f64 + 0.5, y as f64 + 0.5);
        let away = centres().map(|c| p.distance(c) - RADIUS).fold(f64::INFINITY, f64::min);
        let ink = (away.abs() - 2.0).clamp(0.0, 1.0) as f32;
        let fill = if away < 0.0 { [0.9, 0.5, 0.2] } else { [0.8, 0.9, 1.0] };
        fill.map(|c| c * ink)
    })
}

fn snap(c: &mut Criterion) {
    let picture = picture();
    let ring = |centre: Point| -> Vec<Point> {
        (0..16).map(|k| centre + RADIUS * Point::from_angle(f64::from(k) * std::f64::consts::TAU / 16.0)).collect()
    };
    let contours: Vec<Vec<Point>> = centres().map(ring).collect();
    c.bench_function("snap/1080p, 12 contours, 192 segments", |b| {
        b.iter(|| {
            let snapper = Snapper::new(&picture);
            for contour in &contours {
                black_box(snapper.snap(contour, true, &SnapOptions::default()));
            }
        });
    });
}

criterion_group!(benches, snap);
criterion_main!(benches);
