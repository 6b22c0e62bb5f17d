//! Marks what traces and paints by its sources, so that a cache never gives the strokes and regions of other code.

#[path = "build/mark.rs"]
mod mark;

/// What the kept steps of the pipeline are compiled from, from the folder of this crate. Pictures are not among it: they have marks of their own.
const SOURCES: [&str; 9] = [
    "src/pipeline.rs",
    "src/pipeline",
    "base/src",
    "fill/src",
    "fit/src",
    "fourier/src",
    "image/src",
    "lines/src",
    "track/src",
];

fn main() -> std::io::Result<()> {
    mark::put("ROTOTOON_PIPELINE", &SOURCES, "..")
}
