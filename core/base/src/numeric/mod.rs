//! Numerical methods that know nothing of pictures or contours.
//!
//! - [`assignment`]: pairs of least total cost
//! - [`banded`]: Cholesky factorisation of symmetric band matrices
//! - [`cholesky`]: sparse Cholesky factorisation with the symbolic half kept
//! - [`damped_system`]: damped normal equations, long rows as a correction of low rank
//! - [`dense`]: small dense positive definite systems
//! - [`gradient_check`]: an analytic Jacobian against differences
//! - `lanes`: eight values that are worked on at once
//! - [`normal_equations`]: JᵀJ and Jᵀr of a sparse Jacobian of fixed pattern
//! - [`roots`]: real roots of polynomials up to the quartic
//! - [`sparse_assignment`]: the same where few pairs are allowed
//! - [`sparse_least_squares`]: Levenberg–Marquardt on such problems
//! - [`trust_region`]: Gauss–Newton within a trust region by conjugate gradients
//! - `vector`: hot loops compiled for the machine they run on

pub mod assignment;
pub mod banded;
pub mod cholesky;
pub mod damped_system;
pub mod dense;
pub mod gradient_check;
pub mod lanes;
pub mod normal_equations;
pub mod roots;
pub mod sparse_assignment;
pub mod sparse_least_squares;
pub mod trust_region;
pub mod vector;
