//! Numerical tools.
//!
//! - [`banded`]: Cholesky factorisation of symmetric band matrices

pub mod banded;
