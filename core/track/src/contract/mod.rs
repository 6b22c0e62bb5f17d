//! What every preset sees: what it is given, and what it answers.
//!
//! - [`job`]: one part over one span; the trait of who solves it
//! - [`tasks`]: a scene cut into jobs, and their results put together
//! - [`tracking`]: the tracks of a scene; the trait of who tracks it
//! - [`error`]: why tracking failed
//!
//! Nothing here knows how anything is tracked.

pub mod error;
pub mod job;
pub mod tasks;
pub mod tracking;
