//! The default fit, made steady: a larger tolerance does not take more pieces or corners.
//!
//! A fit for a smaller tolerance is a fit for every larger one. The search for the fewest guiding points is local, so it may
//! miss that. The fit is therefore compared with that for the next rung of a fixed ladder of smaller limits. If that one has
//! fewer pieces or fewer corners, it is taken, and the next rung below is tried in the same way. If it has hardly more
//! pieces, one rung further is tried before the search ends: a rung may miss what the one below it finds.
//!
//! **Not more guiding points than points.** Where noise is as large as the limit, straight lines between some of the points
//! are what is left, and each has two guiding points. The points themselves may then do better: as guiding points they give
//! a curve that is within half a pixel of all of them where they are pixels. Only a line whose corners are farther apart
//! than the tolerance can need more guiding points than it has points: each corner needs two. A rung whose guiding points are
//! the points has reached the noise. It has no corners, so it is not taken for having fewer of them.
//!
//! Limits: two tolerances between the same two rungs are not compared with each other: of 13 800 random lines four got one
//! piece more at 1 px than at 0.7 px. The search may end above a rung that is better: of 18 000 random lines one got a corner
//! more at 4 px than at 2 px. No rung is tried that is as small as the noise of the points.

use super::clean::{self, Cleaned};
use super::grain::Grain;
use super::whole::Whole;
use super::{corners, whole};
use rototoon_base::geometry::Point;

/// Rungs of the ladder for each doubling of the limit.
const RUNGS: f64 = 2.0;

/// A fit has hardly more pieces than another one if it has at most this many times as many. From rung to rung smooth lines get
/// 1.12 times as many.
const HARDLY_MORE: f64 = 1.05;

/// Fits a line of at least two different points. Returns the line as it was fitted, and the fit.
pub(super) fn fit(points: &[Point], closed: bool, tolerance: f64) -> (Cleaned, Whole) {
    let fine = clean::filled(points, closed);
    let grain = Grain::of(points, &fine);
    let source = Source { points, closed, fine, grain };
    let mut limit = grain.limit(tolerance);
    let mut best = source.fit(limit);
    let mut missed = false;
    let mut rung = (RUNGS * limit.log2()).ceil() - 1.0;
    loop {
        limit = (rung / RUNGS).exp2();
        if limit < f64::MIN_POSITIVE || limit <= source.grain.floor() {
            return best;
        }
        let stricter = source.fit(limit);
        let fewer = |size: fn(&Whole) -> usize| size(&stricter.1) < size(&best.1);
        if fewer(pieces) || (fewer(corner_count) && !is_on_points(&stricter)) {
            (best, missed) = (stricter, false);
        } else if missed || pieces(&stricter.1) as f64 > HARDLY_MORE * pieces(&best.1) as f64 {
            return best;
        } else {
            missed = true;
        }
        rung -= 1.0;
    }
}

fn pieces(whole: &Whole) -> usize {
    whole.spline.piece_count()
}

fn corner_count(whole: &Whole) -> usize {
    whole.spline.corners().len()
}

/// Whether a fit has a guiding point for each point. Such a curve has no corners, whatever the line has.
fn is_on_points((data, whole): &(Cleaned, Whole)) -> bool {
    whole.spline.guides().len() >= data.points.len()
}

/// A line to fit.
struct Source<'a> {
    points: &'a [Point],
    closed: bool,
    fine: Cleaned,
    grain: Grain,
}

impl Source<'_> {
    /// The fit with this limit, by itself.
    fn fit(&self, limit: f64) -> (Cleaned, Whole) {
        let data = Cleaned { floor: self.grain.floor(), ..clean::cleaned(self.points, self.closed, limit) };
        let corners = corners::corners(&data, &self.fine, self.closed, self.grain, limit);
        let found = whole::fit(&data, self.closed, &corners, limit);
        if found.spline.guides().len() > data.points.len()
            && let Some(on_points) = whole::on_points(&data, self.closed, limit)
        {
            return (data, on_points);
        }
        (data, found)
    }
}
