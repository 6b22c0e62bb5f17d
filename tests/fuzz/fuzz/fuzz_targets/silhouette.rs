#![no_main]

libfuzzer_sys::fuzz_target!(init: rototoon_fuzz::start(), |data: &[u8]| rototoon_fuzz::targets::silhouette::silhouette(data));
