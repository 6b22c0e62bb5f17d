//! This package is empty. Its `Cargo.toml` says why it exists.

#![forbid(unsafe_code)]
