//! The cross-crate tests, one module a topic.
//!
//! - `documents`: reading and writing project documents, good and bad
//! - `architecture`: which module may use which, and no cycle of imports
//! - `crates`: the picture of the crates in the documentation
//! - `pages`: the documentation's tables of parameters
//! - `features`: nothing that packages share is compiled twice
//! - `style`: from the sample cartoon's contours to another character's drawing in another manner
//! - `bench_tracking`: the benchmark of tracking on a small scene

mod architecture;
mod bench_tracking;
mod crates;
mod documents;
mod features;
mod pages;
mod style;
