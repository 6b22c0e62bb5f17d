//! Numerical tools.
//!
//! - [`banded`]: Cholesky factorisation of symmetric band matrices
//! - [`correlation`]: correlation of pictures by the fast Fourier transform

pub mod banded;
pub mod correlation;
