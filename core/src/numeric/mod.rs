//! Numerical methods that know nothing of pictures.
//!
//! - [`assignment`]: rows to columns at the least total cost
//! - [`banded`]: Cholesky factorisation of symmetric band matrices
//! - [`correlation`]: correlation of pictures by the fast Fourier transform

pub mod assignment;
pub mod banded;
pub mod correlation;
