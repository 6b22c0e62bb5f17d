//! Marks the tracker by its sources, so that a cache never gives the tracks of another one.

#[path = "../build/mark.rs"]
mod mark;

/// What the tracker is compiled from, from its own folder.
const SOURCES: [&str; 6] = ["src", "../base/src", "../fit/src", "../fourier/src", "../image/src", "../lines/src"];

fn main() -> std::io::Result<()> {
    mark::put("ROTOTOON_TRACKER", &SOURCES, "../..")
}
