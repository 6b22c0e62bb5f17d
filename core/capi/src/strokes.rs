//! Curve fitting and hidden lines of drawings in flat arrays. `rototoon_fit_strokes` and `rototoon_hidden_lines` document
//! the arrays.

use crate::status::Failure;
use rayon::prelude::{IntoParallelIterator, ParallelIterator};
use rototoon::fit::{FitError, Fitted, Options, fit};
use rototoon::geometry::Point;
use rototoon::tween::hidden::{Cover, Depth, FillRule, Form, Line, hidden_lines};
use std::collections::BTreeMap;

/// The strokes of a drawing.
pub struct Strokes<'a> {
    /// One more than there are strokes, beginning with 0, never falling. Stroke `i` has the points `offsets[i]` to
    /// `offsets[i + 1]` (excluded).
    pub offsets: &'a [i32],
    /// x and y of each point, in pixels.
    pub points: &'a [f64],
    /// For each stroke a number that is not 0 if the end joins the start.
    pub closed: &'a [u8],
}

/// The guiding points of fitted strokes.
#[derive(Default)]
pub struct RototoonGuides {
    /// Stroke `i` has the guiding points `offsets[i]` to `offsets[i + 1]` (excluded).
    pub offsets: Vec<i32>,
    /// x and y of each guiding point, in pixels.
    pub points: Vec<f64>,
    /// For each guiding point its values, one per channel.
    pub values: Vec<f64>,
    /// For each guiding point the index of the given point that is nearest along the stroke.
    pub nearest: Vec<i32>,
    /// For each stroke the largest distance between stroke and curve, in pixels.
    pub errors: Vec<f64>,
}

/// The visible and hidden pieces of strokes, ordered by stroke, and along each stroke.
#[derive(Default)]
pub struct RototoonPieces {
    /// For each piece the index of its stroke, never falling.
    pub strokes: Vec<i32>,
    /// For each piece 1 if it is hidden, else 0.
    pub hidden: Vec<i32>,
    /// For each piece its first and last parameter on the stroke.
    pub intervals: Vec<f64>,
    /// Piece `i` has the points `offsets[i]` to `offsets[i + 1]` (excluded). It has none if it is a complete stroke.
    pub offsets: Vec<i32>,
    /// For each point of a piece the indices of three given points.
    pub indices: Vec<i32>,
    /// For each point of a piece the weights of these points.
    pub weights: Vec<f64>,
}

impl Strokes<'_> {
    /// The number of strokes. It is an error if the lengths of the arrays do not fit together.
    pub fn checked(&self) -> Result<usize, Failure> {
        let wrong = |text: String| Err(Failure::Error(text));
        let Some((&first, rest)) = self.offsets.split_first() else {
            return wrong("offsets: none, expected one more than there are strokes".into());
        };
        if first != 0 || self.offsets.windows(2).any(|pair| pair[1] < pair[0]) {
            return wrong("offsets: expected numbers that begin at 0 and never fall".into());
        }
        let points = self.offsets[rest.len()] as usize;
        if self.points.len() != 2 * points {
            return wrong(format!("points: {} numbers, expected x and y of {points} points", self.points.len()));
        }
        if self.closed.len() != rest.len() {
            return wrong(format!("closed: {} values, expected {}", self.closed.len(), rest.len()));
        }
        Ok(rest.len())
    }

    fn range(&self, stroke: usize) -> std::ops::Range<usize> {
        self.offsets[stroke] as usize..self.offsets[stroke + 1] as usize
    }

    /// The points of a stroke.
    pub fn points_of(&self, stroke: usize) -> Vec<Point> {
        self.range(stroke).map(|k| Point::new(self.points[2 * k], self.points[2 * k + 1])).collect()
    }
}

/// A fitted stroke with the values of its guiding points, channel by channel.
struct Carrying {
    fitted: Fitted,
    carried: Vec<Vec<f64>>,
}

/// Fits all strokes to within `tolerance` pixels (on points rounded to pixels see `rototoon_fit::Options`). `values` has `channels` numbers for each point.
pub fn fitted(strokes: &Strokes, values: &[f64], channels: usize, tolerance: f64) -> Result<RototoonGuides, Failure> {
    let count = strokes.checked()?;
    let expected = channels.saturating_mul(strokes.points.len() / 2);
    if values.len() != expected {
        return Err(Failure::Error(format!("values: {} numbers, expected {expected}", values.len())));
    }
    let options = Options::new(tolerance);
    let one = |stroke: usize| -> Result<Option<Carrying>, FitError> {
        let points = strokes.points_of(stroke);
        if points.is_empty() {
            return Ok(None);
        }
        let fitted = fit(&points, strokes.closed[stroke] != 0, &options)?;
        let channel = |c: usize| {
            let given: Vec<f64> = strokes.range(stroke).map(|k| values[k * channels + c]).collect();
            fitted.attribute(&given)
        };
        let carried = (0..channels).map(channel).collect::<Result<_, _>>()?;
        Ok(Some(Carrying { fitted, carried }))
    };
    let all: Vec<_> = (0..count).into_par_iter().map(one).collect();
    let mut guides = RototoonGuides { offsets: vec![0], ..RototoonGuides::default() };
    for (stroke, found) in all.into_iter().enumerate() {
        match found.map_err(|error| Failure::Error(format!("stroke {stroke}: {error}")))? {
            Some(found) => guides.push(&found, strokes.offsets[stroke]),
            None => guides.errors.push(0.0),
        }
        guides.offsets.push((guides.points.len() / 2) as i32);
    }
    Ok(guides)
}

impl RototoonGuides {
    fn push(&mut self, Carrying { fitted, carried }: &Carrying, first: i32) {
        let guides = fitted.spline.guides();
        self.points.extend(guides.iter().flat_map(|g| g.to_array()));
        self.values.extend((0..guides.len()).flat_map(|k| carried.iter().map(move |channel| channel[k])));
        self.nearest.extend(nearest(fitted).into_iter().map(|k| first + k as i32));
        self.errors.push(fitted.max_error);
    }
}

/// For each guiding point the given point whose parameter is nearest to the middle of the guiding point's influence.
fn nearest(fitted: &Fitted) -> Vec<usize> {
    let mut order: Vec<usize> = (0..fitted.parameters.len()).collect();
    order.sort_by(|&a, &b| fitted.parameters[a].total_cmp(&fitted.parameters[b]).then(a.cmp(&b)));
    let (spline, end) = (&fitted.spline, fitted.spline.piece_count() as f64);
    let guides = spline.guides().len();
    let middle = |k: usize| match spline.is_closed() {
        true => k as f64 + 0.5,
        false if k == 0 => 0.0,
        false if k + 1 == guides => end,
        false => k as f64 - 0.5,
    };
    let at = |k: usize| {
        let t = middle(k);
        let after = order.partition_point(|&j| fitted.parameters[j] < t).min(order.len() - 1);
        let before = after.saturating_sub(1);
        let miss = |i: usize| (fitted.parameters[order[i]] - t).abs();
        order[if miss(before) <= miss(after) { before } else { after }]
    };
    (0..guides).map(at).collect()
}

/// The meaning of the strokes' points, their depths and their fills.
pub struct Placing<'a> {
    /// For each stroke 0 for a polyline, 1 for a uniform quadratic B-spline, 2 for a chain of quadratic Bézier curves.
    pub forms: &'a [u8],
    /// For each stroke its layer and its place in the layer. Larger is nearer.
    pub depths: &'a [i32],
    /// For each stroke 0 if it is not filled. Strokes of one layer with the same number are outlines of one shape.
    pub fills: &'a [i32],
}

/// Cuts strokes into visible and hidden pieces.
pub fn pieces(
    strokes: &Strokes,
    placing: &Placing,
    options: &rototoon::tween::hidden::Options,
) -> Result<RototoonPieces, Failure> {
    let count = strokes.checked()?;
    for (name, found, expected) in [
        ("forms", placing.forms.len(), count),
        ("depths", placing.depths.len(), 2 * count),
        ("fills", placing.fills.len(), count),
    ] {
        if found != expected {
            return Err(Failure::Error(format!("{name}: {found} values, expected {expected}")));
        }
    }
    let forms = placing.forms.iter().map(|&form| form_of(form)).collect::<Result<Vec<_>, _>>()?;
    // Strokes without points have no pieces.
    let present: Vec<usize> = (0..count).filter(|&i| !strokes.range(i).is_empty()).collect();
    let lines = present.iter().map(|&i| line(strokes, placing, forms[i], i)).collect::<Result<Vec<_>, _>>()?;
    let covers = covers(placing, &present, &lines);
    let seen = hidden_lines(&lines, &covers, options).map_err(Failure::error)?;
    let mut found = RototoonPieces { offsets: vec![0], ..RototoonPieces::default() };
    for (&stroke, (line, seen)) in present.iter().zip(lines.iter().zip(&seen)) {
        let hidden = seen.hidden.iter().map(|&interval| (interval, 1));
        let mut parts: Vec<_> = seen.visible.iter().map(|&interval| (interval, 0)).chain(hidden).collect();
        parts.sort_by(|a, b| a.0.0.total_cmp(&b.0.0));
        for (interval, hidden) in parts {
            found.strokes.push(stroke as i32);
            found.hidden.push(hidden);
            found.intervals.extend([interval.0, interval.1]);
            if interval != (0.0, line.path.end()) {
                let range = strokes.range(stroke);
                let cut = forms[stroke].cut(range.len(), line.path.is_closed(), interval);
                found.indices.extend(cut.iter().flatten().map(|&(k, _)| (range.start + k) as i32));
                found.weights.extend(cut.iter().flatten().map(|&(_, weight)| weight));
            }
            found.offsets.push((found.weights.len() / 3) as i32);
        }
    }
    Ok(found)
}

fn form_of(form: u8) -> Result<Form, Failure> {
    match form {
        0 => Ok(Form::Polyline),
        1 => Ok(Form::Spline),
        2 => Ok(Form::Chain),
        other => Err(Failure::Error(format!("forms: found {other}, expected 0, 1 or 2"))),
    }
}

fn line(strokes: &Strokes, placing: &Placing, form: Form, stroke: usize) -> Result<Line, Failure> {
    let path = form.path(&strokes.points_of(stroke), strokes.closed[stroke] != 0);
    let path = path.map_err(|error| Failure::Error(format!("stroke {stroke}: {error}")))?;
    let depth = Depth { layer: placing.depths[2 * stroke], stroke: placing.depths[2 * stroke + 1] };
    Ok(Line { path, depth })
}

/// One cover for each fill of a layer. A fill with several outlines has holes. Its depth is that of its rearmost outline.
fn covers(placing: &Placing, present: &[usize], lines: &[Line]) -> Vec<Cover> {
    let mut groups: BTreeMap<(i32, i32), Vec<usize>> = BTreeMap::new();
    for (k, &stroke) in present.iter().enumerate() {
        if placing.fills[stroke] != 0 {
            groups.entry((lines[k].depth.layer, placing.fills[stroke])).or_default().push(k);
        }
    }
    let cover = |group: &Vec<usize>| Cover {
        outlines: group.iter().map(|&k| lines[k].path.clone()).collect(),
        rule: if group.len() == 1 { FillRule::NonZero } else { FillRule::EvenOdd },
        depth: group.iter().map(|&k| lines[k].depth).min().unwrap_or_default(),
    };
    groups.values().map(cover).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn strokes_are_fitted_with_their_values() {
        let line: Vec<f64> = (0..50).flat_map(|k| [k as f64, 0.0]).collect();
        let wave: Vec<f64> = (0..200).flat_map(|k| [k as f64, 40.0 * (k as f64 / 30.0).sin()]).collect();
        let points: Vec<f64> = [line, wave].concat();
        let values: Vec<f64> = points.chunks(2).flat_map(|p| [p[0], 3.0]).collect();
        let strokes = Strokes { offsets: &[0, 50, 50, 250], points: &points, closed: &[0, 0, 0] };
        let found = fitted(&strokes, &values, 2, 0.5).unwrap();
        assert_eq!(found.offsets[..3], [0, 2, 2]);
        assert!(found.offsets[3] < 22 && found.errors.iter().all(|&e| e <= 0.5));
        assert_eq!(found.values.len(), 2 * found.offsets[3] as usize);
        assert!((found.values[2] - 49.0).abs() < 0.5 && (found.values[3] - 3.0).abs() < 1e-6);
        assert_eq!(found.nearest[..2], [0, 49]);
        assert_eq!((found.nearest[2], found.nearest.last()), (50, Some(&249)));
    }

    #[test]
    fn strokes_that_cannot_be_fitted_are_named() {
        let message = |offsets: &[i32], points: &[f64], tolerance: f64| {
            let closed = vec![0; offsets.len().saturating_sub(1)];
            let strokes = Strokes { offsets, points, closed: &closed };
            fitted(&strokes, &[], 0, tolerance).err().unwrap().to_string()
        };
        assert!(message(&[0, 1, 2], &[0.0, 0.0, f64::NAN, 1.0], 1.0).starts_with("stroke 1: point 0"));
        assert!(message(&[0, 1], &[0.0, 0.0], 0.0).contains("tolerance: found 0"));
        assert!(message(&[0, 2], &[0.0, 0.0], 1.0).starts_with("points:"));
        assert!(message(&[0, 2, 1], &[0.0; 2], 1.0).starts_with("offsets:"));
        assert!(message(&[], &[], 1.0).starts_with("offsets:"));
    }

    #[test]
    fn a_line_behind_a_filled_square_is_cut() {
        let points = [0.0, 5.0, 16.0, 5.0, 4.0, 4.0, 8.0, 4.0, 8.0, 8.0, 4.0, 8.0];
        let strokes = Strokes { offsets: &[0, 2, 6], points: &points, closed: &[0, 1] };
        let placing = Placing { forms: &[0, 0], depths: &[0, 0, 0, 1], fills: &[0, 1] };
        let found = pieces(&strokes, &placing, &Default::default()).unwrap();
        assert_eq!(found.strokes, [0, 0, 0, 1]);
        assert_eq!(found.hidden, [0, 1, 0, 0]);
        assert_eq!(found.intervals[..6], [0.0, 0.25, 0.25, 0.5, 0.5, 1.0]);
        assert_eq!(found.offsets, [0, 2, 4, 6, 6]);
        assert_eq!(found.weights.len(), 18);
        let wrong = Placing { forms: &[0, 7], ..placing };
        assert!(pieces(&strokes, &wrong, &Default::default()).is_err());
    }

    #[test]
    fn outlines_of_one_fill_make_holes() {
        let square = |low: f64, high: f64| [low, low, high, low, high, high, low, high];
        let points = [&[0.0, 8.0, 16.0, 8.0][..], &square(0.0, 16.0), &square(4.0, 12.0)].concat();
        let strokes = Strokes { offsets: &[0, 2, 6, 10], points: &points, closed: &[0, 1, 1] };
        let seen = |fills: &[i32]| {
            let placing = Placing { forms: &[0; 3], depths: &[0, 0, 0, 1, 0, 1], fills };
            pieces(&strokes, &placing, &Default::default()).unwrap().hidden.iter().filter(|&&h| h == 0).count()
        };
        // The line in the hole is visible beside the two squares only if both outlines are of one fill.
        assert_eq!([seen(&[0, 3, 3]), seen(&[0, 3, 4]), seen(&[0, 3, 0])], [3, 2, 2]);
    }
}
