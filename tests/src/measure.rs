//! The errors of tracked contours.
//!
//! Errors are measured on the frames between a part's first and last key that are not keys themselves. Only *scored* points
//! count: they are visible, and the picture's colour changes across the contour there.
//!
//! - `contour`: distance from the tracked control point to the true contour of its part, in pixels
//! - `point`: distance from the tracked control point to its own true position, in pixels
//! - `good`: share of points with `contour` ≤ tol and `point` ≤ 5 tol, where tol = frame height / 270 (2 px at 540 lines)

use crate::truth::{TruePart, Truth};
use anyhow::{Context, Result, ensure};
use rototoon::geometry::polyline;
use rototoon::project::Document;
use rototoon::scene::{Footage, FrameNumber, Part, Scene};
use serde::{Deserialize, Serialize};
use serde_json::Value;

/// One tracked point of one frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Row {
    /// Number of the part in the document.
    pub part: usize,
    /// Frame number.
    pub frame: i32,
    /// Number of the control point.
    pub index: usize,
    /// Distance to the true contour in pixels.
    pub contour: f64,
    /// Distance to the true point in pixels.
    pub point: f64,
    /// Whether the picture shows the point.
    pub scored: bool,
}

/// Figures over many points. If no point is scored, `points` is 0 and all others are NaN.
#[derive(Clone, Copy, Debug, Deserialize, PartialEq, Serialize)]
pub struct Figures {
    /// Number of scored points.
    pub points: usize,
    /// Share of good points, 0 to 1.
    pub good: f64,
    /// Mean distance to the contour in pixels.
    pub contour_mean: f64,
    /// 95th percentile of the distance to the contour.
    pub contour_p95: f64,
    /// Mean distance to the true point in pixels.
    pub point_mean: f64,
    /// 95th percentile of the distance to the true point.
    pub point_p95: f64,
}

/// Compares a tracked project document with a truth document; see [`rows`].
pub fn measure(tracked: &Value, truth: &Value) -> Result<Vec<Row>> {
    let document = Document::parse(&tracked.to_string(), "the tracked document")?;
    rows(&document.scene, &Truth::deserialize(truth).context("the truth document")?)
}

/// Compares a tracked scene with the truth. The rows are ordered by part, frame and point.
///
/// It is an error if something is missing or not finite, or if numbers of points differ. The error names part and frame.
pub fn rows(tracked: &Scene, truth: &Truth) -> Result<Vec<Row>> {
    let (parts, truths) = (&tracked.parts, &truth.parts);
    ensure!(parts.len() == truths.len(), "found {} tracked parts, expected {}", parts.len(), truths.len());
    let mut rows = Vec::new();
    for (k, (part, truth)) in parts.iter().zip(truths).enumerate() {
        ensure!(part.name == truth.name, "found the truth of part {:?}, expected that of {:?}", truth.name, part.name);
        for frame in between_keys(part, &tracked.footage) {
            part_rows(part, truth, k, frame, &mut rows)
                .with_context(|| format!("part {:?}, frame {frame}", part.name))?;
        }
    }
    Ok(rows)
}

/// The frames of the footage between a part's first and last key that are not keys.
pub fn between_keys(part: &Part, footage: &Footage) -> Vec<FrameNumber> {
    let frames = part.spans().into_iter().flat_map(|span| span.between());
    frames.filter(|frame| (footage.first..=footage.last).contains(frame)).collect()
}

fn part_rows(part: &Part, truth: &TruePart, k: usize, frame: FrameNumber, rows: &mut Vec<Row>) -> Result<()> {
    let got = part.tracks.get(&frame).context("no tracked points")?;
    let want = truth.points.get(&frame).context("no true points")?;
    let contour = truth.contour.get(&frame).context("no true contour")?;
    let scored = truth.scored.get(&frame).context("no scored points in the truth")?.as_bytes();
    ensure!(got.len() == want.len(), "found {} tracked points, expected {}", got.len(), want.len());
    ensure!(scored.len() == want.len(), "found {} marks of scored points, expected {}", scored.len(), want.len());
    ensure!(got.iter().all(|p| p.is_finite()), "found tracked points that are not finite");
    rows.extend(got.iter().zip(want).zip(scored).enumerate().map(|(index, ((&g, &w), &mark))| Row {
        part: k,
        frame,
        index,
        contour: polyline::distance(g, contour, part.closed),
        point: g.distance(w),
        scored: mark == b'1',
    }));
    Ok(())
}

/// Largest distance in pixels from the contour at which a point is good, for frames of this height.
pub fn tolerance(height: f64) -> f64 {
    height / 270.0
}

impl Row {
    /// Whether the point is good, for frames of this height.
    pub fn good(&self, height: f64) -> bool {
        self.contour <= tolerance(height) && self.point <= 5.0 * tolerance(height)
    }

    /// Whether the point is scored and not good.
    pub fn bad(&self, height: f64) -> bool {
        self.scored && !self.good(height)
    }
}

/// Figures over the scored rows, for frames of this height.
pub fn figures<'a>(rows: impl IntoIterator<Item = &'a Row>, height: f64) -> Figures {
    let rows: Vec<&Row> = rows.into_iter().filter(|row| row.scored).collect();
    let n = rows.len() as f64;
    let good = rows.iter().filter(|r| r.good(height)).count();
    let mean = |value: fn(&Row) -> f64| rows.iter().map(|r| value(r)).sum::<f64>() / n;
    let p95 = |value: fn(&Row) -> f64| percentile(rows.iter().map(|r| value(r)).collect(), 0.95);
    Figures {
        points: rows.len(),
        good: good as f64 / n,
        contour_mean: mean(|r| r.contour),
        contour_p95: p95(|r| r.contour),
        point_mean: mean(|r| r.point),
        point_p95: p95(|r| r.point),
    }
}

/// The percentile `q` (0 to 1), interpolated linearly between neighbouring values. It is NaN if there are no values.
pub fn percentile(mut values: Vec<f64>, q: f64) -> f64 {
    if values.is_empty() {
        return f64::NAN;
    }
    values.sort_by(f64::total_cmp);
    let at = q * (values.len() - 1) as f64;
    let (below, above) = (values[at.floor() as usize], values[at.ceil() as usize]);
    below + at.fract() * (above - below)
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    const PERFECT: Figures =
        Figures { points: 3, good: 1.0, contour_mean: 0.0, contour_p95: 0.0, point_mean: 0.0, point_p95: 0.0 };

    fn square(dx: f64) -> Value {
        json!([[dx, 0.0], [dx + 100.0, 0.0], [dx + 100.0, 100.0], [dx, 100.0]])
    }

    fn documents(tracked: Value) -> (Value, Value) {
        let footage = json!({"pattern": "%d.png", "first": 0, "last": 2, "fps": 24, "width": 960, "height": 540});
        let part = json!({"name": "a", "closed": true, "keys": {"0": square(0.0), "2": square(0.0)}, "tracks": {"1": tracked}});
        let truth =
            json!({"name": "a", "points": {"1": square(0.0)}, "contour": {"1": square(0.0)}, "scored": {"1": "1101"}});
        (json!({"rototoon": 1, "footage": footage, "parts": [part]}), json!({"parts": [truth]}))
    }

    #[test]
    fn the_truth_itself_is_perfect() {
        let (tracked, truth) = documents(square(0.0));
        let rows = measure(&tracked, &truth).unwrap();
        assert_eq!(rows.len(), 4);
        assert_eq!(figures(&rows, 540.0), PERFECT);
    }

    #[test]
    fn a_shift_along_an_edge_is_off_the_point_but_on_the_contour() {
        let (tracked, truth) = documents(square(6.0));
        let rows = measure(&tracked, &truth).unwrap();
        let of = |i: usize| (rows[i].contour, rows[i].point, rows[i].scored);
        assert_eq!(
            (of(0), of(1), of(2), of(3)),
            ((0.0, 6.0, true), (6.0, 6.0, true), (6.0, 6.0, false), (0.0, 6.0, true))
        );
        let figures = figures(&rows, 540.0);
        assert_eq!((figures.points, figures.good, figures.contour_mean), (3, 2.0 / 3.0, 2.0));
        assert!((figures.contour_p95 - 5.4).abs() < 1e-12);
    }

    #[test]
    fn the_tolerance_grows_with_the_picture() {
        let row = Row { part: 0, frame: 1, index: 0, contour: 3.0, point: 18.0, scored: true };
        assert_eq!(figures(&[row], 540.0).good, 0.0);
        assert_eq!(figures(&[row], 1080.0).good, 1.0);
    }

    #[test]
    fn errors_name_part_and_frame() {
        let (mut tracked, truth) = documents(json!([[0.0, 0.0]]));
        let error = |tracked: &Value| format!("{:#}", measure(tracked, &truth).unwrap_err());
        assert_eq!(error(&tracked), "part \"a\", frame 1: found 1 tracked points, expected 4");
        tracked["parts"][0]["tracks"] = json!({});
        assert_eq!(error(&tracked), "part \"a\", frame 1: no tracked points");
    }

    #[test]
    fn percentiles_lie_between_values() {
        assert_eq!(percentile(vec![3.0, 1.0, 2.0], 0.5), 2.0);
        assert_eq!(percentile(vec![0.0, 10.0], 0.95), 9.5);
        assert!(percentile(vec![], 0.5).is_nan());
    }
}
