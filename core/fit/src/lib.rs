//! From points to quadratic B-splines with few guiding points, within a tolerance that is a guarantee.
//!
//! This crate fits lines that are already points: strokes of a pen, traced outlines. It finds no lines in pictures;
//! `rototoon-snap` does that.
//!
//! [`fit`] takes a drawn or traced line and gives a uniform quadratic B-spline ([`rototoon_base::curve::Spline`]). No point of
//! the line is farther than the tolerance from the curve, and no place of the continuous curve is farther than the
//! tolerance from the line; the largest distance is given back (`bound` says how it is known).
//!
//! # The default
//!
//! The guiding points of a uniform spline are all that can be chosen: there are no knots to place. Where pieces end
//! along the line follows from the guides, hence parameters are unknowns as well. With the parameters eliminated, the
//! distances are a nonlinear least-squares problem in the guides (`solve`) whose Gauss–Newton steps are banded and
//! cheap; what remains is to find a good start and the least number of guides.
//!
//! 1. `clean`: repeated points go, long segments are filled.
//! 2. `corners`: turning angle over a stretch of arc length, which a pixel staircase does not fool. Corners cut the
//!    line into sections that are fitted by themselves.
//! 3. `profile`: how long a parabola may be along the line.
//! 4. `trial`: a fit with a given number of nodes: linear solve, least squares, then the *largest* error.
//! 5. `count`: the fewest nodes for which that succeeds. `long`: the same in chunks, in linear time.
//! 6. `whole`: sections put together and measured; `polygon` where nothing smooth fits.
//!
//! `attributes` carries pressure and the like over to the guides, `together` gives several curves equal numbers of
//! guides.
//!
//! # The preset `yang1986`
//!
//! [`yang1986`] is the two-step procedure of Yang et al. 1986.
//!
//! # Limits
//!
//! The fewest guides *found*: the search is local and may miss the last one. Time grows linearly with the number of
//! points; where noise is as large as the tolerance, straight lines between some of the points are what is left, with
//! many guides.
//!
//! # Example
//!
//! A pen draws 60 px to the right, turns at a right angle and draws 60 px down, while its pressure rises from 0 to 1.
//!
//! ```
//! use rototoon_base::geometry::Point;
//! use rototoon_fit::{Options, fit};
//!
//! let right = (0..60).map(|x| Point::new(f64::from(x), 0.0));
//! let down = (0..=60).map(|y| Point::new(60.0, f64::from(y)));
//! let line: Vec<Point> = right.chain(down).collect();
//! let fitted = fit(&line, false, &Options::new(0.5))?;
//! assert!(fitted.max_error <= 0.5, "the tolerance is a guarantee");
//! assert!(fitted.spline.guides().len() <= 6, "121 points became a handful of guides");
//! assert_eq!(fitted.spline.corners().len(), 1, "the corner stayed sharp");
//!
//! let pressure: Vec<f64> = (0..=120).map(|i| f64::from(i) / 120.0).collect();
//! let at_guides = fitted.attribute(&pressure)?;
//! let at_corner = fitted.spline.blend(&at_guides, fitted.parameters[60]);
//! assert!((at_corner - 0.5).abs() < 0.05, "half of the pressure at half of the way");
//! # Ok::<(), rototoon_fit::FitError>(())
//! ```

#![forbid(unsafe_code)]

mod attributes;
mod bound;
mod clean;
mod corners;
mod count;
mod feet;
mod grow;
mod long;
mod polygon;
mod profile;
mod section;
mod solve;
mod together;
mod trial;
mod whole;
pub mod yang1986;

#[cfg(test)]
mod tests;

pub use together::{Polyline, fit_together};

use rototoon_base::curve::Spline;
use rototoon_base::geometry::{Point, polyline};

/// How curves are fitted.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Options {
    /// Largest distance between line and curve, in pixels; positive and finite.
    pub tolerance: f64,
    /// The method.
    pub preset: Preset,
}

impl Options {
    /// The default method with this tolerance in pixels.
    pub fn new(tolerance: f64) -> Self {
        Self { tolerance, preset: Preset::Rototoon }
    }
}

/// A method of fitting.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Preset {
    /// Fewest guides.
    #[default]
    Rototoon,
    /// Yang et al. 1986.
    Yang1986,
}

impl Preset {
    /// The preset of an id.
    pub fn from_id(id: &str) -> Option<Self> {
        match id {
            "rototoon" => Some(Self::Rototoon),
            "yang1986" => Some(Self::Yang1986),
            _ => None,
        }
    }
}

/// Why a line cannot be fitted.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum FitError {
    /// It has no points.
    #[error("no points, expected at least one")]
    Empty,
    /// A point is not a place, or too far away to compute with.
    #[error("point {index} is ({x}, {y}), expected numbers between -1e9 and 1e9")]
    Point {
        /// Its index.
        index: usize,
        /// What was found.
        x: f64,
        /// What was found.
        y: f64,
    },
    /// The tolerance is not a distance.
    #[error("tolerance {found} px, expected a positive number")]
    Tolerance {
        /// What was found.
        found: f64,
    },
    /// Of curves fitted together, one does not take the common number of guides.
    #[error("no fit with exactly {count} guiding points keeps the tolerance")]
    Guides {
        /// The number.
        count: usize,
    },
    /// An attribute has not one value for each point.
    #[error("{found} values, expected one for each of {expected} points")]
    Values {
        /// Number of values.
        found: usize,
        /// Number of points.
        expected: usize,
    },
}

/// A fitted curve.
#[derive(Clone, Debug, PartialEq)]
pub struct Fitted {
    /// The curve.
    pub spline: Spline,
    /// Bound of the distances from the points to the curve and from the curve to the line of the points, in pixels.
    pub max_error: f64,
    /// Parameter of each given point's place on the curve.
    pub parameters: Vec<f64>,
}

impl Fitted {
    /// A curve that is a point.
    fn point(guides: Vec<Point>, closed: bool, points: usize) -> Self {
        Self { spline: Spline::of_finite(guides, closed), max_error: 0.0, parameters: vec![0.0; points] }
    }

    /// Values at the guides whose blend along the curve ([`Spline::blend`]) comes nearest to one value for each given
    /// point.
    pub fn attribute(&self, values: &[f64]) -> Result<Vec<f64>, FitError> {
        if values.len() != self.parameters.len() {
            return Err(FitError::Values { found: values.len(), expected: self.parameters.len() });
        }
        Ok(attributes::fit(&self.spline, &self.parameters, values))
    }
}

/// Fits a line of points, whose last joins the first where it is `closed`.
///
/// Repeated points count once; a line that is a point gives a spline of one guide.
pub fn fit(points: &[Point], closed: bool, options: &Options) -> Result<Fitted, FitError> {
    checked(points, options.tolerance)?;
    let data = clean::cleaned(points, closed, options.tolerance);
    if data.points.len() == 1 {
        return Ok(Fitted::point(vec![points[0]], closed, points.len()));
    }
    let whole = match options.preset {
        Preset::Rototoon => {
            let corners = corners::corners(&data.points, &data.lengths, data.total, closed, options.tolerance);
            whole::fit(&data, closed, &corners, options.tolerance)
        }
        Preset::Yang1986 => yang1986::fit(&data, closed, options.tolerance),
    };
    Ok(finished(whole, &data))
}

fn finished(whole: whole::Whole, data: &clean::Cleaned) -> Fitted {
    let parameters = data.places.iter().map(|&place| whole.parameters[place]).collect();
    Fitted { spline: whole.spline, max_error: whole.error, parameters }
}

fn checked(points: &[Point], tolerance: f64) -> Result<(), FitError> {
    if !(tolerance > 0.0 && tolerance.is_finite()) {
        return Err(FitError::Tolerance { found: tolerance });
    }
    if points.is_empty() {
        return Err(FitError::Empty);
    }
    match polyline::first_unusable(points) {
        Some(index) => Err(FitError::Point { index, x: points[index].x, y: points[index].y }),
        None => Ok(()),
    }
}
