//! What all development commands share: running programs, and Python environments.
//!
//! - [`shell`]: programs, paths and folders
//! - [`python`]: interpreters and virtual environments

pub mod python;
pub mod shell;
