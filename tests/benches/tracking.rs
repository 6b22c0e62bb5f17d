//! Times of tracking synthetic scenes: after a pin, of a short shot from files, and in high definition.
//!
//! The goals on two cores are 50 ms after a pin, 1.0 s for the short shot, and 0.15 s per frame in high definition.

use criterion::{BatchSize, Criterion, Throughput, criterion_group, criterion_main};
use rototoon::geometry::Point;
use rototoon::pipeline;
use rototoon::project::Document;
use rototoon::scene::{Scene, Silent};
use rototoon::track::{TrackOptions, Tracker};
use rototoon_tests::puppet::{Pictures, Puppet};
use std::hint::black_box;
use std::path::Path;

/// 160 points in one span of 12 frames.
const SPAN: Puppet = Puppet { width: 540, height: 540, frames: 12, step: usize::MAX, parts: 10, points: 16 };
/// 192 points on 15 frames.
const SHOT: Puppet = Puppet { width: 420, height: 540, frames: 15, step: usize::MAX, parts: 12, points: 16 };
/// 192 points on 13 frames in high definition.
const HD: Puppet = Puppet { width: 1920, height: 1080, frames: 13, step: usize::MAX, parts: 12, points: 16 };

/// The scene with a pin on the middle frame of one part. Each number moves the pin a little farther.
fn pinned(part: usize, number: u32) -> Scene {
    let mut scene = SPAN.scene();
    let (frame, point) = (6, (number % 16) as usize);
    let shift = Point::new(3.0, -2.0) + 1e-3 * f64::from(number) * Point::ONE;
    scene.parts[part].pins.entry(frame).or_default().insert(point, SPAN.outline(part, frame).points[point] + shift);
    scene
}

fn again(c: &mut Criterion, name: &str, part: usize, pictures: &Pictures) {
    let mut tracker = Tracker::new(TrackOptions::default());
    tracker.track(&SPAN.scene(), pictures, &Silent).unwrap();
    let mut number = 0;
    c.bench_function(name, |b| {
        b.iter_batched(
            || {
                number += 1;
                pinned(part, number)
            },
            |scene| {
                let tracking = tracker.track(&scene, pictures, &Silent).unwrap();
                assert!(tracking.jobs[part].solved);
                black_box(tracking)
            },
            BatchSize::PerIteration,
        );
    });
}

fn after_a_pin(c: &mut Criterion) {
    let pictures = SPAN.pictures().unwrap();
    again(c, "track/12 frames, 160 points, after a pin in the farthest part", 0, &pictures);
    again(c, "track/12 frames, 160 points, after a pin in the nearest part", SPAN.parts - 1, &pictures);
}

fn from_files(folder: &Path) {
    let mut document = Document::load(&folder.join("project.json")).unwrap();
    black_box(pipeline::track(&mut document, folder, &TrackOptions::default(), &Silent).unwrap());
}

fn whole(c: &mut Criterion) {
    let folder = tempfile::tempdir().unwrap();
    SHOT.write(folder.path()).unwrap();
    let mut group = c.benchmark_group("track");
    group.sample_size(10);
    group.bench_function("15 frames of 420x540, 192 points, from files", |b| b.iter(|| from_files(folder.path())));
}

fn high_definition(c: &mut Criterion) {
    let folder = tempfile::tempdir().unwrap();
    HD.write(folder.path()).unwrap();
    let mut group = c.benchmark_group("track");
    group.sample_size(10);
    // The elements are frames, so the inverse of the throughput is the time per frame.
    group.throughput(Throughput::Elements(HD.frames as u64));
    group.bench_function("13 frames of 1920x1080, 192 points, from files", |b| b.iter(|| from_files(folder.path())));
}

criterion_group!(benches, after_a_pin, whole, high_definition);
criterion_main!(benches);
