//! Numerical methods that know nothing of pictures.
//!
//! - [`assignment`]: rows to columns at the least total cost

pub mod assignment;
