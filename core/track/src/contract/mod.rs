//! What every preset sees: what it is given, and what it answers.
//!
//! - [`job`]: one part over one span, its track, and the trait of a solver of jobs
//! - [`tasks`]: the jobs of a scene, their order, and their tracks put together
//! - [`tracking`]: the tracks of a scene, and the trait of a solver of scenes
//! - [`error`]: why tracking failed
//! - [`cache`]: results that are kept beyond the program
//!
//! Nothing here knows how anything is tracked.

pub mod cache;
pub mod error;
pub mod job;
pub mod tasks;
pub mod tracking;
