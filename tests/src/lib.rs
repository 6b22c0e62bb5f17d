//! Code that the test suites and the development commands share.
//!
//! - [`sample`]: the sample cartoon with exact truth
//! - [`doll`]: a second drawn character
//! - [`puppet`]: synthetic footage of any size, for measuring speed and memory
//! - [`grain`]: noise on pictures
//! - [`truth`]: truth documents
//! - [`measure`]: the errors of tracked contours
//! - [`artist`]: how many corrections tracks still need
//! - [`benchmark`]: the benchmark of tracking, with tables and pictures
//! - [`memory`]: peak memory of a process
//! - [`golden`]: comparison with accepted pictures
//! - [`sheet`]: contact sheets
//! - [`stylebench`]: measurements of limbs, overlap order and translation
//! - [`tweening`]: measurements of matching and in-betweens
//! - [`filling`]: the benchmark of fills
//! - [`chart`], [`drawing`], [`lettering`]: plots as SVG and PNG

#![forbid(unsafe_code)]

pub mod artist;
pub mod benchmark;
pub mod chart;
pub mod doll;
pub mod drawing;
pub mod filling;
pub mod golden;
pub mod grain;
pub mod lettering;
pub mod measure;
pub mod memory;
pub mod puppet;
pub mod sample;
pub mod sheet;
pub mod stylebench;
pub mod truth;
pub mod tweening;
