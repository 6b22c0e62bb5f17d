//! The cross-crate tests, with one module for each topic.
//!
//! - `documents`: reading and writing project documents, good and bad
//! - `architecture`: the dependencies between modules of the core
//! - `features`: shared dependencies are not compiled twice
//! - `style`: the sample cartoon's motion in another style, performed by another drawn character
//! - `bench_tracking`: the benchmark of tracking on a small scene

mod architecture;
mod bench_tracking;
mod documents;
mod features;
mod style;
