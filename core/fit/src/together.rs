//! Several curves fitted with the same number of guiding points, so that in-betweens can move guiding point to guiding
//! point.
//!
//! Each curve is first fitted by itself. The largest number of guiding points becomes the common one. The other curves
//! are fitted again with exactly that number, distributed over their sections. Rarely, a curve cannot take exactly that
//! number (a corner's guiding point can be repeated without effect). Then the common number rises by one and the
//! procedure repeats.

use super::corners::corners;
use super::grain::Grain;
use super::{FitError, Fitted, Options, checked, clean, finished, fit, whole};
use rototoon_base::geometry::Point;

/// Number of times that the common number may rise.
const ATTEMPTS: usize = 24;

/// A polyline to fit: its points, and whether the last point joins the first.
pub type Polyline<'a> = (&'a [Point], bool);

/// Fits the curves with equal numbers of guiding points, each within the tolerance. The preset of the options is
/// ignored.
///
/// # Errors
///
/// The errors of [`fit`], with the index of the curve; a curve that does not take the common number of guiding points.
pub fn fit_together(curves: &[Polyline], options: &Options) -> Result<Vec<Fitted>, (usize, FitError)> {
    let plain = Options { preset: super::Preset::Rototoon, ..*options };
    let single = |(k, &(points, closed)): (usize, &Polyline)| fit(points, closed, &plain).map_err(|error| (k, error));
    let mut fitted: Vec<Fitted> = curves.iter().enumerate().map(single).collect::<Result<_, _>>()?;
    let Some(mut common) = fitted.iter().map(|f| f.spline.guides().len()).max() else { return Ok(fitted) };
    for _ in 0..ATTEMPTS {
        let wanting = (0..curves.len()).filter(|&k| fitted[k].spline.guides().len() != common).collect::<Vec<_>>();
        let mut refused = None;
        for k in wanting {
            match exactly(curves[k], &plain, common).map_err(|error| (k, error))? {
                Some(richer) => fitted[k] = richer,
                None => refused = Some(k),
            }
        }
        match refused {
            None => return Ok(fitted),
            Some(_) => common += 1,
        }
    }
    let k = (0..curves.len()).find(|&k| fitted[k].spline.guides().len() != common).unwrap_or(0);
    Err((k, FitError::Guides { count: common }))
}

/// Fits one curve with exactly `guides` guiding points; `None` where that is not possible.
fn exactly((points, closed): Polyline, options: &Options, guides: usize) -> Result<Option<Fitted>, FitError> {
    checked(points, options.tolerance)?;
    let data = clean::cleaned(points, closed, options.tolerance);
    if data.points.len() == 1 {
        // A point stays a point, however often it is repeated.
        return Ok(Some(Fitted::point(vec![points[0]; guides], closed, points.len())));
    }
    let fine = clean::filled(points, closed);
    let grain = Grain::of(points, &fine);
    let limit = grain.limit(options.tolerance);
    let found = corners(&data, &fine, closed, grain, limit);
    Ok(whole::fit_exactly(&data, closed, &found, limit, guides).map(|whole| finished(whole, &data)))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn arc(turn: f64, wave: f64) -> Vec<Point> {
        let at = |i: usize| {
            let t = i as f64 / 299.0;
            Point::from_angle(t * turn) * (100.0 + wave * (9.0 * t).sin()) + 200.0
        };
        (0..300).map(at).collect()
    }

    #[test]
    fn curves_of_unequal_need_get_equal_guides_and_keep_the_tolerance() {
        let (a, b, c) = (arc(1.5, 0.0), arc(5.0, 12.0), arc(6.0, 2.0));
        let square: Vec<Point> = [(0.0, 0.0), (90.0, 0.0), (90.0, 90.0), (0.0, 90.0)].map(Point::from).into();
        let point = [Point::ONE; 3];
        let curves = [(&a[..], false), (&b[..], false), (&c[..], true), (&square[..], true), (&point[..], false)];
        let fitted = fit_together(&curves, &Options::new(0.5)).unwrap();
        let counts: Vec<usize> = fitted.iter().map(|f| f.spline.guides().len()).collect();
        assert!(counts.iter().all(|&n| n == counts[0]), "{counts:?}");
        for ((points, closed), fit) in curves.iter().zip(&fitted) {
            assert!(fit.max_error <= 0.5 && fit.spline.is_closed() == *closed);
            for &p in *points {
                assert!(fit.spline.nearest(p).distance <= 0.5);
            }
        }
    }

    #[test]
    fn the_curve_at_fault_is_named() {
        let good = arc(1.0, 0.0);
        let error = fit_together(&[(&good, false), (&[], false)], &Options::new(1.0)).unwrap_err();
        assert_eq!(error, (1, FitError::Empty));
        assert_eq!(fit_together(&[], &Options::new(1.0)).unwrap().len(), 0);
    }
}
