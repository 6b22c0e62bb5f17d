//! How near tracked contours come to the truth.
//!
//! Over the *scored* points (seen, and the picture changes colour across the contour there) of the frames between a
//! part's first and last key that are not keys themselves:
//!
//! - `contour`: distance from the tracked control point to the true contour of its part, in pixels
//! - `point`: distance from the tracked control point to its own true position, in pixels
//! - `good`: share of points with `contour` ≤ tol and `point` ≤ 5 tol, where tol = frame height / 270 (2 px at 540 lines)

use anyhow::{Context, Result, ensure};
use rototoon::geometry::{Point, polyline};
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

/// Figures over many points. Of no scored point, `points` is 0 and the rest is NaN.
#[derive(Clone, Copy, Debug, PartialEq)]
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

/// Compares a tracked project document with a truth document.
///
/// Errors name the part and the frame where something is missing, not finite, or of another number of points.
pub fn measure(tracked: &Value, truth: &Value) -> Result<Vec<Row>> {
    let (parts, truths) = (list(tracked, "parts")?, list(truth, "parts")?);
    ensure!(parts.len() == truths.len(), "{} parts tracked, {} expected", parts.len(), truths.len());
    let frames = |key: &str| tracked["footage"][key].as_i64().with_context(|| format!("footage.{key} is not a number"));
    let range = frames("first")? as i32..=frames("last")? as i32;
    let mut rows = Vec::new();
    for (k, (part, truth)) in parts.iter().zip(truths).enumerate() {
        let name = part["name"].as_str().unwrap_or_default();
        ensure!(part["name"] == truth["name"], "part {name:?}, but the truth of {}", truth["name"]);
        let closed = part["closed"].as_bool().unwrap_or(true);
        for frame in between_keys(part)?.into_iter().filter(|f| range.contains(f)) {
            part_rows(part, truth, closed, k, frame, &mut rows)
                .with_context(|| format!("part {name:?}, frame {frame}"))?;
        }
    }
    Ok(rows)
}

/// The frames between a part's first and last key that are not keys.
fn between_keys(part: &Value) -> Result<Vec<i32>> {
    let keys = part["keys"].as_object().context("a part has no keys")?;
    let mut frames =
        keys.keys().map(|k| k.parse().with_context(|| format!("frame {k:?}"))).collect::<Result<Vec<i32>>>()?;
    frames.sort_unstable();
    let (Some(&first), Some(&last)) = (frames.first(), frames.last()) else { return Ok(Vec::new()) };
    Ok((first + 1..last).filter(|f| !frames.contains(f)).collect())
}

fn part_rows(part: &Value, truth: &Value, closed: bool, k: usize, frame: i32, rows: &mut Vec<Row>) -> Result<()> {
    let key = frame.to_string();
    let got = points(&part["tracks"][&key]).context("tracked points")?;
    let want = points(&truth["points"][&key]).context("true points")?;
    let contour = points(&truth["contour"][&key]).context("true contour")?;
    let scored = truth["scored"][&key].as_str().context("no scored points in the truth")?.as_bytes();
    ensure!(got.len() == want.len(), "{} tracked points, {} expected", got.len(), want.len());
    ensure!(scored.len() == want.len(), "{} marks of scored points, {} expected", scored.len(), want.len());
    ensure!(got.iter().all(|p| p.is_finite()), "tracked points that are not finite");
    rows.extend(got.iter().zip(&want).zip(scored).enumerate().map(|(index, ((&g, &w), &mark))| Row {
        part: k,
        frame,
        index,
        contour: polyline::distance(g, &contour, closed),
        point: g.distance(w),
        scored: mark == b'1',
    }));
    Ok(())
}

fn list<'a>(document: &'a Value, key: &str) -> Result<&'a Vec<Value>> {
    document[key].as_array().with_context(|| format!("the document has no list {key:?}"))
}

fn points(value: &Value) -> Result<Vec<Point>> {
    let list = value.as_array().context("none")?;
    let number = |v: &Value| v.as_f64().context("not a number");
    list.iter().map(|p| Ok(Point::new(number(&p[0])?, number(&p[1])?))).collect()
}

/// Figures over the scored ones of some rows, for frames of this height.
pub fn figures<'a>(rows: impl IntoIterator<Item = &'a Row>, height: f64) -> Figures {
    let tol = height / 270.0;
    let rows: Vec<&Row> = rows.into_iter().filter(|row| row.scored).collect();
    let n = rows.len() as f64;
    let good = rows.iter().filter(|r| r.contour <= tol && r.point <= 5.0 * tol).count();
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

/// The percentile `q` (0 to 1), linear between neighbouring values; NaN of none.
fn percentile(mut values: Vec<f64>, q: f64) -> f64 {
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

    fn square(dx: f64) -> Value {
        json!([[dx, 0.0], [dx + 100.0, 0.0], [dx + 100.0, 100.0], [dx, 100.0]])
    }

    fn documents(tracked: Value) -> (Value, Value) {
        let footage = json!({"first": 0, "last": 2, "width": 960, "height": 540});
        let part = json!({"name": "a", "closed": true, "keys": {"0": square(0.0), "2": square(0.0)}, "tracks": {"1": tracked}});
        let truth =
            json!({"name": "a", "points": {"1": square(0.0)}, "contour": {"1": square(0.0)}, "scored": {"1": "1101"}});
        (json!({"footage": footage, "parts": [part]}), json!({"parts": [truth]}))
    }

    #[test]
    fn the_truth_itself_is_perfect() {
        let (tracked, truth) = documents(square(0.0));
        let rows = measure(&tracked, &truth).unwrap();
        assert_eq!(rows.len(), 4);
        let figures = figures(&rows, 540.0);
        assert_eq!(
            figures,
            Figures { points: 3, good: 1.0, contour_mean: 0.0, contour_p95: 0.0, point_mean: 0.0, point_p95: 0.0 }
        );
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
    fn what_is_missing_is_named() {
        let (mut tracked, truth) = documents(json!([[0.0, 0.0]]));
        let error = |tracked: &Value| format!("{:#}", measure(tracked, &truth).unwrap_err());
        assert_eq!(error(&tracked), "part \"a\", frame 1: 1 tracked points, 4 expected");
        tracked["parts"][0]["tracks"] = json!({});
        assert_eq!(error(&tracked), "part \"a\", frame 1: tracked points: none");
    }

    #[test]
    fn percentiles_lie_between_values() {
        assert_eq!(percentile(vec![3.0, 1.0, 2.0], 0.5), 2.0);
        assert_eq!(percentile(vec![0.0, 10.0], 0.95), 9.5);
        assert!(percentile(vec![], 0.5).is_nan());
    }
}
