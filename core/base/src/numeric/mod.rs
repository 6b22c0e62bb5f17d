//! Numerical methods that know nothing of pictures or contours.
//!
//! - [`assignment`]: rows to columns at the least total cost
//! - [`banded`]: Cholesky factorisation of symmetric band matrices
//! - [`cholesky`]: sparse Cholesky factorisation of many matrices with one pattern
//! - [`damped_system`]: damped normal equations; long rows are a correction of low rank
//! - [`dense`]: small dense positive definite systems
//! - [`gradient_check`]: compares an analytic Jacobian with central differences
//! - [`lanes`]: arithmetic on eight values at once
//! - [`median`](mod@median): the middle of a list
//! - [`normal_equations`]: JᵀJ and Jᵀr of a sparse Jacobian of fixed pattern
//! - [`roots`]: real roots of polynomials up to the quartic
//! - [`sparse_assignment`]: assignment where each row may take few columns, or none
//! - [`sparse_least_squares`]: Levenberg–Marquardt for sparse non-linear least squares
//! - [`trust_region`]: Gauss–Newton within a trust region, solved by conjugate gradients
//! - [`vector`]: compiles hot loops for the processor that runs them

pub mod assignment;
pub mod banded;
pub mod cholesky;
pub mod damped_system;
pub mod dense;
pub mod gradient_check;
pub mod lanes;
pub mod median;
pub mod normal_equations;
pub mod roots;
pub mod sparse_assignment;
pub mod sparse_least_squares;
pub mod trust_region;
pub mod vector;
