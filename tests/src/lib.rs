//! What the test suites and the development commands share.
//!
//! - [`sample`]: the sample cartoon with exact truth
//! - [`doll`]: a second drawn character
//! - [`puppet`]: drawn footage of any size for measuring speed and memory
//! - [`truth`]: truth documents
//! - [`measure`]: how near tracked contours come to the truth
//! - [`artist`]: how many corrections they still need
//! - [`benchmark`]: every preset over sets with truth, tables and pictures of it
//! - [`memory`]: peak memory of a process
//! - [`golden`]: pictures that somebody accepted
//! - [`sheet`]: contact sheets
//! - [`stylebench`]: limbs, overlap order and translation measured
//! - [`chart`], [`drawing`], [`lettering`]: plots as SVG and PNG

pub mod artist;
pub mod benchmark;
pub mod chart;
pub mod doll;
pub mod drawing;
pub mod golden;
pub mod lettering;
pub mod measure;
pub mod memory;
pub mod puppet;
pub mod sample;
pub mod sheet;
pub mod stylebench;
pub mod truth;
pub mod tweening;
