//! Time of the image stage on a drawn picture of one megapixel, on one thread and on all.
//!
//! The picture is written to `target/bench/image.png`. `tests/bench_opencv.py` measures OpenCV on the same pixels and
//! puts both into one table.

use criterion::{BenchmarkGroup, Criterion, Throughput, criterion_group, criterion_main, measurement::WallTime};
use rototoon_base::scene::{Colour, Raster};
use rototoon_image::canny::{CannyOptions, canny};
use rototoon_image::colour::lab_picture;
use rototoon_image::distance_transform::manhattan;
use rototoon_image::gaussian::{Border, blur};
use rototoon_image::mean_shift::{MeanShiftOptions, mean_shift};
use rototoon_image::resize::reduce;
use std::hint::black_box;
use std::path::Path;

const WIDTH: usize = 1250;
const HEIGHT: usize = 800;

/// Centre, radius and colour of discs that imitate painted parts. Each has a line of ink around it.
const DISCS: [(f32, f32, f32, [f32; 3]); 9] = [
    (300.0, 300.0, 160.0, [222.0, 90.0, 70.0]),
    (420.0, 460.0, 120.0, [240.0, 200.0, 90.0]),
    (640.0, 250.0, 90.0, [70.0, 130.0, 200.0]),
    (700.0, 520.0, 190.0, [90.0, 170.0, 110.0]),
    (820.0, 420.0, 60.0, [250.0, 240.0, 230.0]),
    (960.0, 300.0, 130.0, [200.0, 120.0, 190.0]),
    (1050.0, 600.0, 100.0, [120.0, 80.0, 60.0]),
    (180.0, 640.0, 110.0, [60.0, 60.0, 90.0]),
    (560.0, 690.0, 70.0, [255.0, 160.0, 120.0]),
];

/// Half the width of the ink, in pixels.
const INK: f32 = 1.8;

/// Discs with outlines on a painted background, with noise like that of compression, in integer 8-bit levels.
fn picture() -> Raster<Colour> {
    let mut state = 1u32;
    let mut noise = move || {
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        ((state >> 16) % 9) as f32 - 4.0
    };
    Raster::from_fn(WIDTH, HEIGHT, |x, y| {
        let (x, y) = (x as f32 + 0.5, y as f32 + 0.5);
        let wave = 20.0 * (0.02 * x).sin() * (0.03 * y).cos();
        let mut colour = [170.0 + wave, 190.0 - 0.05 * y, 200.0 - wave];
        for (cx, cy, radius, paint) in DISCS {
            let from_line = (x - cx).hypot(y - cy) - radius;
            let inside = (0.5 - from_line).clamp(0.0, 1.0);
            let ink = (INK + 0.5 - from_line.abs()).clamp(0.0, 1.0);
            colour = [0, 1, 2].map(|c| {
                let painted = colour[c] + inside * (paint[c] - colour[c]);
                painted + ink * (25.0 - painted)
            });
        }
        colour.map(|v| (v + noise()).round().clamp(0.0, 255.0) / 255.0)
    })
}

/// Writes the picture to the place where the comparison looks for it.
fn write(picture: &Raster<Colour>) {
    let bytes = picture.data().iter().flatten().map(|v| (255.0 * v).round() as u8).collect();
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../target/bench");
    let written = std::fs::create_dir_all(&folder).is_ok()
        && image::RgbImage::from_vec(WIDTH as u32, HEIGHT as u32, bytes)
            .is_some_and(|picture| picture.save(folder.join("image.png")).is_ok());
    assert!(written, "cannot write {}", folder.display());
}

fn on_threads(group: &mut BenchmarkGroup<WallTime>, name: &str, work: impl Fn() + Sync) {
    for (threads, label) in [(1, "one"), (0, "all")] {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("a pool of threads");
        group.bench_function(format!("{name}/{label}"), |bencher| pool.install(|| bencher.iter(&work)));
    }
}

fn image_stage(criterion: &mut Criterion) {
    let picture = picture();
    write(&picture);
    let options = CannyOptions::default();
    let edges = canny(&picture, &options);
    let mut group = criterion.benchmark_group("image");
    group.throughput(Throughput::Elements((WIDTH * HEIGHT) as u64)).sample_size(20);
    on_threads(&mut group, "canny", || {
        black_box(canny(&picture, &options));
    });
    on_threads(&mut group, "distance_transform", || {
        black_box(manhattan(&edges));
    });
    on_threads(&mut group, "mean_shift", || {
        black_box(mean_shift(&picture, &MeanShiftOptions::default()));
    });
    on_threads(&mut group, "gaussian", || {
        black_box(blur(&picture, 1.0, Border::Reflect101));
    });
    on_threads(&mut group, "reduce", || {
        black_box(reduce(&picture, 2.0));
    });
    on_threads(&mut group, "lab", || {
        black_box(lab_picture(&picture));
    });
    group.finish();
}

criterion_group!(benches, image_stage);
criterion_main!(benches);
