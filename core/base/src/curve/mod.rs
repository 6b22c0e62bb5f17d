//! Curves made of parabolas: uniform quadratic B-splines and their pieces.
//!
//! A drawn line is stored as a [`Spline`]: guiding points G_i whose midpoints P_i = (G_{i−1} + G_i)/2 the curve passes,
//! tangent to the polygon of the guiding points. Between two midpoints it is the parabola ([`Quadratic`] Bézier piece)
//! P_i, G_i, P_{i+1} (Yang et al. 1986, eq. 3 and 4). Parabolas are the curves for which most that animation asks has a
//! closed answer: length, area, box, nearest point, crossings.
//!
//! - [`quadratic`]: a piece; evaluation, splitting, box, area
//! - [`length`]: arc length and its inverse
//! - [`nearest`]: the nearest point, a cubic
//! - [`intersect`]: where two pieces meet, a quartic; `straight`: straight ones; `meeting`: how they meet
//! - [`spline`]: the whole curve
//! - [`convert`]: to and from Bézier curves
//!
//! Coordinates are pixels, x right, y down, but nothing here depends on it. Inputs are finite points; [`Spline`] makes
//! sure of it.

pub mod convert;
pub mod intersect;
pub mod length;
mod meeting;
pub mod nearest;
pub mod quadratic;
pub mod spline;
mod straight;

pub use convert::{Cubic, NotUniform};
pub use length::ArcLengths;
pub use meeting::Meeting;
pub use nearest::Nearest;
pub use quadratic::Quadratic;
pub use spline::{Spline, SplineError};
