//! Curve fitting: strokes of any points.

use crate::given::{self, number, points};
use arbitrary::{Result, Unstructured};
use rototoon::fit::{Options, Preset, fit as fitted, fit_together};
use rototoon::geometry::Point;
use rototoon::pipeline::fit_curves;
use rototoon::project::curves::Curves;
use rototoon::scene::Silent;

/// The largest number of points of a stroke.
const POINTS: usize = 24;

/// Fits decoded strokes, or the curves of a text.
pub fn fit(data: &[u8]) {
    if data.starts_with(b"{") {
        if let Ok(curves) = Curves::from_json(&String::from_utf8_lossy(data), "fuzz") {
            let _ = fit_curves(&curves, &Options::new(0.5), &Silent);
        }
    } else {
        let _ = decoded(&mut Unstructured::new(data));
    }
}

fn decoded(u: &mut Unstructured) -> Result<()> {
    // The printed procedure adds nodes one by one: on a scribble it takes seconds.
    let (preset, most) = if u.ratio(1u8, 8)? { (Preset::Yang1986, 6) } else { (Preset::Rototoon, POINTS) };
    let closed = u.arbitrary()?;
    let tolerance = if u.ratio(1u8, 4)? { number(u)? } else { 0.5 };
    let options = Options { tolerance, preset };
    let line = points(u, 0, most)?;
    let other = if u.ratio(1u8, 4)? { Some(points(u, 0, most)?) } else { None };
    check(&line, closed, &options);
    let values = (0..line.len()).map(|_| given::number(u)).collect::<Result<Vec<_>>>()?;
    if let Ok(found) = fitted(&line, closed, &options) {
        assert_eq!(found.attribute(&values).map(|v| v.len()), Ok(found.spline.guides().len()));
    }
    if let Some(other) = other {
        let _ = fit_together(&[(&line, closed), (&other, closed)], &options);
    }
    Ok(())
}

/// Fits a stroke, and holds the method to its word: no point is farther from the curve than the tolerance, or than a pixel
/// at most where the points may be rounded to pixels.
fn check(line: &[Point], closed: bool, options: &Options) {
    let Ok(found) = fitted(line, closed, options) else { return };
    assert!(found.spline.guides().iter().all(|p| p.is_finite()), "a guiding point is not finite");
    assert_eq!(found.parameters.len(), line.len());
    // The last digits of large coordinates are not the method's fault.
    let size = line.iter().map(|p| p.abs().max_element()).fold(0.0, f64::max);
    let rounded = line.len() >= 16;
    let bound = if rounded { options.tolerance.max((options.tolerance + 0.5).min(1.0)) } else { options.tolerance };
    let most = bound + 1e-12 * size;
    assert!(options.preset != Preset::Rototoon || found.max_error <= most, "{} > {most}", found.max_error);
}
