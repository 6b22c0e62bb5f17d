//! Every target on random bytes and on changed seeds, for a short while. `cargo xtask fuzz` runs the same for hours.

use proptest::collection::vec;
use proptest::prelude::any;
use proptest::test_runner::{Config, TestCaseError, TestRunner};
use rototoon_fuzz::mutate::{Random, changed, holds};
use rototoon_fuzz::{Target, seeds, targets};

/// Cases of random bytes, and of changed seeds. Slow targets get a share of them.
const CASES: [u32; 2] = [150, 250];

fn runner(cases: u32) -> TestRunner {
    // A finding becomes a seed file; a second list of failures would be one too many.
    TestRunner::new(Config { cases, failure_persistence: None, max_shrink_iters: 200, ..Config::default() })
}

fn verdict(target: Target, input: &[u8]) -> Result<(), TestCaseError> {
    let hex = || input.iter().map(|byte| format!("{byte:02x}")).collect::<String>();
    if holds(target, input) { Ok(()) } else { Err(TestCaseError::fail(format!("{} panics on {}", target.name, hex()))) }
}

fn run(name: &str, share: f64) {
    let target = targets::find(name).unwrap();
    let cases = CASES.map(|cases| (f64::from(cases) * share) as u32);
    runner(cases[0]).run(&vec(any::<u8>(), 0..1024), |input| verdict(target, &input)).unwrap();
    let known = seeds::seeds(name).unwrap();
    let picks = (0..known.len(), 0..known.len(), any::<u64>());
    let change = |(one, other, start): (usize, usize, u64)| {
        verdict(target, &changed(&known[one], &known[other], &mut Random::new(start)))
    };
    runner(cases[1]).run(&picks, change).unwrap();
}

/// One test for each target, so that they run side by side.
macro_rules! targets {
    ($($name:ident: $share:expr,)*) => {
        $(#[test]
        fn $name() {
            run(stringify!($name), $share);
        })*

        #[test]
        fn all_targets_are_run() {
            let run = [$(stringify!($name)),*];
            assert!(targets::ALL.iter().all(|target| run.contains(&target.name)));
        }
    };
}

targets! {
    bvh: 1.0,
    clips: 1.0,
    document: 1.0,
    export: 1.0,
    fit: 1.0,
    image_bmp: 1.0,
    image_exr: 1.0,
    image_jpeg: 1.0,
    image_png: 1.0,
    image_tiff: 1.0,
    image_webp: 1.0,
    openfx: 1.0,
    reshape: 1.0,
    session: 0.5,
    silhouette: 1.0,
    style: 1.0,
    svg: 1.0,
    tween: 1.0,
}
