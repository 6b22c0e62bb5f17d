//! Curves made of parabolas: uniform quadratic B-splines and their pieces.
//!
//! A drawn line is stored as a [`Spline`] with guiding points G_i. The curve passes through their midpoints
//! P_i = (G_{i−1} + G_i)/2, tangent to the polygon of the guiding points. Between two midpoints it is the parabola
//! ([`Quadratic`] Bézier piece) P_i, G_i, P_{i+1} (Yang et al. 1986, eq. 3 and 4). Parabolas are used because most
//! questions of animation have a closed answer for them: length, area, box, nearest point, crossings.
//!
//! - [`quadratic`]: a piece; evaluation, splitting, box, area
//! - [`length`]: arc length and its inverse
//! - [`nearest`]: the nearest point, from a cubic equation
//! - [`intersect`]: the meetings of two pieces, from a quartic equation; `straight`: those of straight pieces
//! - [`spline`]: the complete curve
//! - [`convert`]: conversion to and from Bézier curves
//!
//! Coordinates are pixels, x to the right, y down, but only the sign of areas depends on it. Inputs are finite points;
//! [`Spline`] checks this.

pub mod convert;
pub mod intersect;
pub mod length;
mod meeting;
pub mod nearest;
mod piece_tree;
pub mod quadratic;
pub mod spline;
mod straight;

pub use convert::{Cubic, NotUniform};
pub use length::ArcLengths;
pub use meeting::Meeting;
pub use nearest::Nearest;
pub use piece_tree::PieceTree;
pub use quadratic::Quadratic;
pub use spline::{Spline, SplineError};
