//! The cross-crate tests, one module a topic.
//!
//! - `documents`: reading and writing project documents, good and bad
//! - `architecture`: which module may use which

mod architecture;
mod documents;
