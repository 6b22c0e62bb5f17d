//! What the test suites and the development commands share.
//!
//! - [`sample`]: the sample cartoon with exact truth
//! - [`measure`]: how near tracked contours come to the truth
//! - [`golden`]: pictures that somebody accepted
//! - [`sheet`]: contact sheets

pub mod golden;
pub mod measure;
pub mod sample;
pub mod sheet;
