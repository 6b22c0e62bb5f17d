#![no_main]

libfuzzer_sys::fuzz_target!(init: rototoon_fuzz::start(), |data: &[u8]| rototoon_fuzz::targets::image_png::image_png(data));
