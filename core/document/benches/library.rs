//! Time of opening the index of a library of about 2500 postures (79 clips of 32 frames), and of reading all clips with
//! and without an index.

use criterion::{Criterion, criterion_group, criterion_main};
use rototoon_base::geometry::Point;
use rototoon_base::scene::Clip;
use rototoon_document::clips::Clips;
use rototoon_document::library::{Addition, Existing, Library};
use std::hint::black_box;
use std::path::Path;

const CLIPS: usize = 79;
const FRAMES: usize = 32;

fn clip(number: usize) -> Clip {
    let place = |frame: usize, k: usize| {
        let phase = 0.2 * frame as f64 + k as f64 + 0.37 * number as f64;
        Point::new(phase.sin(), 0.1 * k as f64 + phase.cos())
    };
    let postures = (0..FRAMES).map(|frame| std::array::from_fn(|k| place(frame, k))).collect();
    Clip::new(format!("character {}", number % 9), format!("motion {}", number / 9), postures)
}

fn filled(folder: &Path) {
    let mut library = Library::open(folder);
    let clips = Clips { clips: (0..CLIPS).map(clip).collect(), fps: 24.0 };
    library.add(&[Addition { clips: &clips, source: "" }], Existing::Refuse).expect("a folder that can be written");
}

fn open_and_read(criterion: &mut Criterion) {
    let folder = tempfile::tempdir().expect("a temporary folder");
    filled(folder.path());
    let mut group = criterion.benchmark_group("library of 2500 postures");
    group.bench_function("index", |bench| bench.iter(|| black_box(Library::open(folder.path()))));
    group.bench_function("all clips", |bench| {
        bench.iter(|| {
            let library = Library::open(folder.path());
            black_box(library.checked(|_| true))
        });
    });
    std::fs::remove_file(folder.path().join("library.json")).expect("the index");
    group.bench_function("all clips, without index", |bench| {
        bench.iter(|| {
            let library = Library::open(folder.path());
            black_box(library.checked(|_| true))
        });
    });
    group.finish();
}

criterion_group!(benches, open_and_read);
criterion_main!(benches);
