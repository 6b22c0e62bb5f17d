//! Curve fitting: from points to quadratic B-splines with few guiding points, with a guaranteed tolerance.
//!
//! This crate fits lines that are already points: strokes of a pen, traced outlines. It finds no lines in pictures;
//! `rototoon-snap` does that.
//!
//! [`fit`] takes a drawn or traced line and returns a uniform quadratic B-spline ([`rototoon_base::curve::Spline`]). No point
//! of the line is farther than the tolerance from the curve, and no place of the continuous curve is farther than the
//! tolerance from the line. The largest distance is returned; `bound` describes how it is measured. Rounding to pixels is
//! not fitted (`grain`).
//!
//! # The default method
//!
//! A uniform spline has no knots to place: its guiding points are the only unknowns that can be chosen. The guiding
//! points decide where pieces end along the line, so the parameters of the points are unknowns as well. Eliminating the
//! parameters leaves a nonlinear least-squares problem in the guiding points (`solve`). Its Gauss–Newton steps are
//! banded and cheap. What remains is to find a good start and the smallest number of guiding points.
//!
//! 1. `clean` removes repeated points and fills long segments.
//! 2. `grain` estimates rounding and noise. `corners` finds corners by the turning angle over a stretch of arc length; a
//!    pixel staircase does not disturb it. Corners cut the line into sections, which are fitted separately.
//! 3. `profile` estimates how long a parabola may be along the line.
//! 4. `trial` makes a fit with a given number of nodes: a linear solve, least squares, then the reduction of the
//!    *largest* error.
//! 5. `count` finds the smallest number of nodes for which that succeeds. `long` does the same in chunks, in linear
//!    time.
//! 6. `whole` joins the sections and measures the curve. `polygon` is used where nothing smooth fits.
//! 7. `steady` compares the fit with those for smaller limits, so that a larger tolerance takes no more pieces or corners.
//!
//! `attributes` transfers pressure and similar values to the guiding points. `together` gives several curves the
//! same number of guiding points.
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
mod grain;
mod grow;
mod long;
mod polygon;
mod profile;
mod section;
mod solve;
mod steady;
mod together;
mod trial;
mod whole;
pub mod yang1986;

#[cfg(test)]
mod tests;

pub use together::{Polyline, fit_together};

use rototoon_base::curve::Spline;
use rototoon_base::geometry::{Point, polyline};

/// Options of curve fitting.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Options {
    /// Largest distance between line and curve, in pixels; positive and finite.
    ///
    /// Below one pixel, and on points that are rounded to pixels, it is meant for the line before rounding. With the
    /// default method the largest distance is then the tolerance plus half a pixel, at most one pixel.
    pub tolerance: f64,
    /// The method.
    pub preset: Preset,
}

impl Options {
    /// The default method with this tolerance, in pixels.
    pub fn new(tolerance: f64) -> Self {
        Self { tolerance, preset: Preset::Rototoon }
    }
}

/// A method of fitting.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Preset {
    /// The default method; it needs the fewest guiding points.
    #[default]
    Rototoon,
    /// The procedure of Yang et al. 1986.
    Yang1986,
}

impl Preset {
    /// The preset with an id; `None` for an unknown id.
    pub fn from_id(id: &str) -> Option<Self> {
        match id {
            "rototoon" => Some(Self::Rototoon),
            "yang1986" => Some(Self::Yang1986),
            _ => None,
        }
    }
}

/// The reason why a line cannot be fitted.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum FitError {
    /// It has no points.
    #[error("found no points, expected at least one")]
    Empty,
    /// A coordinate of a point is not a number or too large.
    #[error("point {index}: found ({x}, {y}), expected numbers between -1e9 and 1e9")]
    Point {
        /// Index of the point.
        index: usize,
        /// The x found.
        x: f64,
        /// The y found.
        y: f64,
    },
    /// The tolerance is not a positive, finite number.
    #[error("tolerance: found {found} px, expected a positive number")]
    Tolerance {
        /// The value found.
        found: f64,
    },
    /// Among curves fitted together, one cannot take the common number of guiding points.
    #[error("found no fit with exactly {count} guiding points within the tolerance, expected one")]
    Guides {
        /// The common number of guiding points.
        count: usize,
    },
    /// An attribute does not have one value for each point.
    #[error("values at the points: found {found}, expected one for each of {expected} points")]
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
    /// The curve, in the coordinates of the points (pixels).
    pub spline: Spline,
    /// Upper bound of the distances from the points to the curve and from the curve to the line of the points, in
    /// pixels.
    pub max_error: f64,
    /// The parameter of the place on the curve that belongs to each given point.
    pub parameters: Vec<f64>,
}

impl Fitted {
    /// A curve that is one point.
    fn point(guides: Vec<Point>, closed: bool, points: usize) -> Self {
        Self { spline: Spline::of_finite(guides, closed), max_error: 0.0, parameters: vec![0.0; points] }
    }

    /// Values at the guiding points whose blend along the curve ([`Spline::blend`]) is nearest to `values`, which has
    /// one value for each given point.
    ///
    /// # Errors
    ///
    /// A number of values that differs from the number of points.
    pub fn attribute(&self, values: &[f64]) -> Result<Vec<f64>, FitError> {
        if values.len() != self.parameters.len() {
            return Err(FitError::Values { found: values.len(), expected: self.parameters.len() });
        }
        Ok(attributes::fit(&self.spline, &self.parameters, values))
    }
}

/// Fits a curve to a line of points, in pixels. The last point joins the first where the line is `closed`.
///
/// Repeated points count once. A line that is one point gives a spline with one guiding point.
///
/// # Errors
///
/// A tolerance that is not positive and finite; no points; a point that cannot be used.
pub fn fit(points: &[Point], closed: bool, options: &Options) -> Result<Fitted, FitError> {
    checked(points, options.tolerance)?;
    if points.iter().all(|p| *p == points[0]) {
        return Ok(Fitted::point(vec![points[0]], closed, points.len()));
    }
    let (data, whole) = match options.preset {
        Preset::Rototoon => steady::fit(points, closed, options.tolerance),
        Preset::Yang1986 => {
            let data = clean::cleaned(points, closed, options.tolerance);
            let whole = yang1986::fit(&data, closed, options.tolerance);
            (data, whole)
        }
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
