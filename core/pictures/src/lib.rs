//! Pictures from files, one by one and as the footage of a shot.
//!
//! This crate reads. It computes nothing from what it has read (`rototoon-image`), and it draws and writes no pictures
//! (`rototoon-render`).
//!
//! - [`backdrop`]: the grey behind transparent pixels
//! - [`decode`](mod@decode): a picture from a file
//! - [`sequence`]: the pictures of a footage, decoded in parallel, with a cache
//! - [`store`]: frames that a program keeps for several steps

#![forbid(unsafe_code)]

pub mod backdrop;
mod blocks;
pub mod decode;
mod error;
mod holds;
#[cfg(test)]
mod hostile_files;
mod jpeg;
mod layered;
mod open;
pub mod sequence;
pub mod store;
mod stored;
mod tags;

pub use decode::{decode, probe};
pub use error::DecodeError;
pub use sequence::Sequence;
