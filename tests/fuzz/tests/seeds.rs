//! Every seed file as an ordinary test, and the rules for seed files.

use rototoon_fuzz::mutate::holds;
use rototoon_fuzz::{ALL, seeds};
use std::time::{Duration, Instant};

/// No seed takes longer, even on a busy machine.
const MOST_TIME: Duration = Duration::from_secs(5);

#[test]
fn every_seed_file_is_taken() {
    let mut failed = Vec::new();
    for target in ALL {
        for (name, bytes) in seeds::files(target.name).unwrap() {
            let begun = Instant::now();
            let fine = holds(target, &bytes) && begun.elapsed() < MOST_TIME;
            failed.extend((!fine).then(|| format!("{}/{name}", target.name)));
        }
    }
    assert!(failed.is_empty(), "these seeds panic or take long: {}", failed.join(", "));
}

#[test]
fn every_made_seed_is_taken() {
    for target in ALL {
        let found = seeds::seeds(target.name).unwrap();
        assert!(!found.is_empty(), "{} has no seeds", target.name);
        assert!(found.iter().all(|seed| holds(target, seed)), "{}: a made seed panics", target.name);
    }
}

#[test]
fn seed_files_are_small_and_belong_to_a_target() {
    for entry in std::fs::read_dir(seeds::folder("")).unwrap() {
        let name = entry.unwrap().file_name().to_string_lossy().into_owned();
        assert!(ALL.iter().any(|target| target.name == name), "seeds/{name}: no target has this name");
        for (file, bytes) in seeds::files(&name).unwrap() {
            assert!(bytes.len() < seeds::MOST_BYTES, "{name}/{file} has {} bytes", bytes.len());
        }
    }
}

#[test]
fn every_target_has_a_program_for_libfuzzer() {
    let folder = seeds::folder("").join("../fuzz/fuzz_targets");
    let manifest = std::fs::read_to_string(seeds::folder("").join("../fuzz/Cargo.toml")).unwrap();
    for target in ALL {
        let text = std::fs::read_to_string(folder.join(format!("{}.rs", target.name))).unwrap();
        assert!(text.contains(&format!("targets::{0}::{0}(data)", target.name)), "{}", target.name);
        assert!(manifest.contains(&format!("name = \"{}\"", target.name)), "{}", target.name);
    }
    assert_eq!(std::fs::read_dir(folder).unwrap().count(), ALL.len());
}
