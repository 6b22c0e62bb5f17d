//! The complete curve: sections between corners and ends are fitted one by one and joined.
//!
//! A section that cannot be fitted gets a corner at its worst point and is tried again in two parts. After a few rounds
//! it becomes straight lines ([`super::polygon`]). This happens at once where the noise is as large as the tolerance
//! and every point would count. There is therefore always a result, and it always keeps the tolerance. The joined curve
//! is measured again as a unit ([`super::bound`]). If it strays from the line between points, the sections are fitted
//! again with a smaller limit.

use super::bound::{self, Line};
use super::clean::Cleaned;
use super::corners::Corner;
use super::count::Unfit;
use super::section::{End, Ends};
use super::trial::{Given, Trial};
use super::{count, long, polygon};
use rototoon_base::curve::Spline;
use rototoon_base::geometry::Point;
use rototoon_base::geometry::polyline::nearest_on_segment;

/// Rounds of new corners before straight lines are used.
const ROUNDS: usize = 5;
/// A fault within this many limits of a corner belongs to that corner.
const BESIDE: f64 = 6.0;
/// A fault within this many limits of a corner's place belongs to the same tip.
const TIP: f64 = 2.0;
/// Share of the tolerance that fits use. The rest is for rounding and for the slack of the measurement.
const MARGIN: f64 = 0.998;
/// Rounds with a smaller limit where the curve strays between points.
const STRICTER: usize = 4;
/// Rounds in which sections that stray become straight lines.
const STRAIGHT: usize = 64;

/// A fitted section.
#[derive(Clone, Debug)]
struct Part {
    /// Nodes, each with whether it is a corner (or a doubled end).
    nodes: Vec<(Point, bool)>,
    /// Parameters of its points, counted from 0 at its first piece.
    parameters: Vec<f64>,
}

/// A section to fit, from one mark to the next.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Span {
    from: usize,
    /// Number of points, both ends included.
    count: usize,
    start: (End, Point),
    end: (End, Point),
    periodic: bool,
}

/// A fitted curve, the parameters of the cleaned points, and the measured error in pixels.
#[derive(Clone, Debug)]
pub(super) struct Whole {
    pub spline: Spline,
    pub parameters: Vec<f64>,
    pub error: f64,
    /// Index of a point at the largest error.
    worst: usize,
}

/// Fits a cleaned polyline of at least two points.
pub(super) fn fit(data: &Cleaned, closed: bool, corners: &[Corner], tolerance: f64) -> Whole {
    let mut limit = MARGIN * tolerance;
    for _ in 0..STRICTER {
        let whole = measured(data, closed, &sections(data, closed, corners.to_vec(), limit, ROUNDS));
        if whole.error <= tolerance {
            return whole;
        }
        limit *= (0.95 * tolerance / whole.error).min(0.9);
    }
    let on_points: Vec<Corner> =
        corners.iter().map(|corner| Corner { place: data.points[corner.index], ..*corner }).collect();
    partly_straight(data, closed, &on_points, tolerance)
        .unwrap_or_else(|| measured(data, closed, &sections(data, closed, on_points, MARGIN * tolerance, 0)))
}

/// Fits with straight lines for those sections that stray. `None` where that is not enough.
fn partly_straight(data: &Cleaned, closed: bool, corners: &[Corner], tolerance: f64) -> Option<Whole> {
    let limit = MARGIN * tolerance;
    let n = data.points.len();
    let mut parts = sections(data, closed, corners.to_vec(), limit, ROUNDS);
    let mut made = vec![false; parts.len()];
    for _ in 0..STRAIGHT {
        let whole = measured(data, closed, &parts);
        if whole.error <= tolerance {
            return Some(whole);
        }
        let around = |(span, _): &(Span, Part)| (whole.worst + n - span.from) % n < span.count;
        let strays: Vec<usize> = (0..parts.len()).filter(|&k| !made[k] && around(&parts[k])).collect();
        if strays.is_empty() {
            return None;
        }
        for k in strays {
            make_straight(data, closed, &mut parts, k, limit);
            made[k] = true;
        }
    }
    None
}

/// Replaces a section by straight lines between points. Its corners move to their points, for its neighbours too.
fn make_straight(data: &Cleaned, closed: bool, parts: &mut [(Span, Part)], k: usize, limit: f64) {
    let count = parts.len();
    let span = &mut parts[k].0;
    span.start.1 = data.points[span.from];
    span.end.1 = data.points[(span.from + span.count - 1) % data.points.len()];
    let span = *span;
    parts[k].1 = straight(data, &span, limit);
    if span.periodic {
        return;
    }
    if k > 0 || closed {
        let (before, part) = &mut parts[(k + count - 1) % count];
        before.end.1 = span.start.1;
        if let Some(node) = part.nodes.last_mut() {
            node.0 = span.start.1;
        }
    }
    if k + 1 < count || closed {
        let (after, part) = &mut parts[(k + 1) % count];
        after.start.1 = span.end.1;
        part.nodes[0].0 = span.end.1;
    }
}

/// The guiding points are the points themselves. The curve cuts each corner by a quarter of the points' second difference
/// at most, so it keeps the tolerance on pixels, with as many guiding points as points. `None` where it does not.
pub(super) fn on_points(data: &Cleaned, closed: bool, tolerance: f64) -> Option<Whole> {
    let last = data.points.len() as f64 - 2.0;
    let parameter = |k: usize| if closed { k as f64 + 0.5 } else { (k as f64 - 0.5).clamp(0.0, last.max(1.0)) };
    let parameters: Vec<f64> = (0..data.points.len()).map(parameter).collect();
    let whole = complete(data, closed, data.points.clone(), parameters);
    (whole.error <= tolerance).then_some(whole)
}

/// Fits with exactly `guides` guiding points. `None` where this number is too small, or the fit does not keep the
/// tolerance.
pub(super) fn fit_exactly(
    data: &Cleaned,
    closed: bool,
    corners: &[Corner],
    tolerance: f64,
    guides: usize,
) -> Option<Whole> {
    let limit = MARGIN * tolerance;
    let mut parts = sections(data, closed, corners.to_vec(), limit, ROUNDS);
    let missing = guides.checked_sub(measured(data, closed, &parts).spline.guides().len())?;
    let mut left = missing;
    let nodes: usize = parts.iter().map(|(_, part)| part.nodes.len()).sum();
    let mut still = nodes;
    for (span, part) in &mut parts {
        // Each section gets a share in proportion to its nodes. Nodes that it cannot take are left for the later
        // sections.
        let share = (left * part.nodes.len()).div_ceil(still).min(left);
        still -= part.nodes.len();
        if let Some(richer) = with_nodes(data, span, limit, part, share) {
            left -= share;
            *part = richer;
        }
    }
    // Repeating the guiding point of a corner does not change the shape.
    let mut whole = measured(data, closed, &parts);
    if left > 0 {
        let mut all = whole.spline.guides().to_vec();
        let &corner = whole.spline.corners().first()?;
        all.splice(corner..corner, std::iter::repeat_n(all[corner], left));
        let moved = |t: &f64| if *t > corner as f64 { t + left as f64 } else { *t };
        let parameters = whole.parameters.iter().map(moved).collect();
        whole = Whole { spline: Spline::of_finite(all, closed), parameters, ..whole };
    }
    (whole.error <= tolerance).then_some(whole)
}

/// A section's fit with `more` additional nodes.
fn with_nodes(data: &Cleaned, span: &Span, limit: f64, part: &Part, more: usize) -> Option<Part> {
    if more == 0 || part.nodes.iter().skip(1).rev().skip(1).any(|node| node.1) {
        return None;
    }
    let (points, lengths) = cut(data, span);
    let given = given(data, span, &points, &lengths, limit);
    let trial = count::exactly(&given, part.nodes.len() + more)?;
    Some(part_of(span, trial))
}

/// The sections and their fits. With zero rounds all are straight lines.
fn sections(data: &Cleaned, closed: bool, mut corners: Vec<Corner>, limit: f64, rounds: usize) -> Vec<(Span, Part)> {
    let mut done: Vec<(Span, Part)> = Vec::new();
    for round in 0..=rounds {
        let spans = spans(data, closed, &corners);
        let mut next = Vec::with_capacity(spans.len());
        let mut new = Vec::new();
        for span in spans {
            if let Some(at) = done.iter().position(|(old, _)| *old == span) {
                next.push(done.swap_remove(at));
                continue;
            }
            match if rounds == 0 { Err(vec![Unfit::Noise]) } else { smooth(data, &span, limit) } {
                Ok(part) => next.push((span, part)),
                Err(reasons) => match worst_points(data, &span, &reasons) {
                    worst if round < rounds && !worst.is_empty() => new.extend(worst),
                    _ => next.push((span, straight(data, &span, limit))),
                },
            }
        }
        done = next;
        if new.is_empty() {
            return done;
        }
        for index in new {
            repair(data, closed, &mut corners, index, round, limit);
        }
        corners.sort_by_key(|corner| corner.index);
        corners.dedup_by_key(|corner| corner.index);
    }
    done
}

/// Puts a corner where a fit fails. If there is a corner nearby, that one was misplaced. In the first round it is put
/// on its own point. Later it moves to the fault, or between its place and the fault where both are close (the tip of a
/// sharp corner may be two pixels wide). After that a fault gets a corner of its own.
fn repair(data: &Cleaned, closed: bool, corners: &mut Vec<Corner>, index: usize, round: usize, limit: f64) {
    let apart = |corner: &Corner| {
        let apart = (data.lengths[corner.index] - data.lengths[index]).abs();
        if closed { apart.min(data.total - apart) } else { apart }
    };
    let place = data.points[index];
    let near = corners.iter_mut().filter(|corner| round < 2 && apart(corner) <= BESIDE * limit);
    match near.min_by(|a, b| apart(a).total_cmp(&apart(b))) {
        Some(corner) if round == 0 && corner.place != data.points[corner.index] => {
            corner.place = data.points[corner.index];
        }
        Some(corner) if corner.place.distance(place) <= TIP * limit => corner.place = 0.5 * (corner.place + place),
        Some(corner) => *corner = Corner { index, place },
        None => corners.push(Corner { index, place }),
    }
}

/// The points where corners would help. Empty where noise is the reason, or where the faults are at the ends of the
/// section.
fn worst_points(data: &Cleaned, span: &Span, reasons: &[Unfit]) -> Vec<usize> {
    let n = data.points.len();
    let inner = |&at: &usize| span.periodic || (at > 0 && at + 1 < span.count);
    if reasons.contains(&Unfit::Noise) || span.count < 4 {
        return Vec::new();
    }
    let at = reasons.iter().filter_map(|reason| if let Unfit::At(at) = reason { Some(*at) } else { None });
    at.filter(inner).map(|at| (span.from + at) % n).collect()
}

fn spans(data: &Cleaned, closed: bool, corners: &[Corner]) -> Vec<Span> {
    let n = data.points.len();
    let corner = |c: &Corner| (c.index, End::Corner, c.place);
    let mut marks: Vec<(usize, End, Point)> = Vec::new();
    if !closed {
        marks.push((0, End::Free, data.points[0]));
        marks.extend(corners.iter().filter(|c| c.index > 0 && c.index + 1 < n).map(corner));
        marks.push((n - 1, End::Free, data.points[n - 1]));
        let span = |pair: &[(usize, End, Point)]| {
            let (from, count) = (pair[0].0, pair[1].0 - pair[0].0 + 1);
            Span { from, count, start: (pair[0].1, pair[0].2), end: (pair[1].1, pair[1].2), periodic: false }
        };
        return marks.windows(2).map(span).collect();
    }
    if corners.is_empty() {
        let place = (End::Free, data.points[0]);
        return vec![Span { from: 0, count: n, start: place, end: place, periodic: true }];
    }
    marks.extend(corners.iter().map(corner));
    (0..marks.len())
        .map(|k| {
            let (a, b) = (marks[k], marks[(k + 1) % marks.len()]);
            let count = (b.0 + n - a.0 - 1) % n + 2;
            Span { from: a.0, count, start: (a.1, a.2), end: (b.1, b.2), periodic: false }
        })
        .collect()
}

/// The points of a span, and their arc lengths from its start.
fn cut(data: &Cleaned, span: &Span) -> (Vec<Point>, Vec<f64>) {
    let n = data.points.len();
    let indices = span.from..span.from + span.count;
    let points = indices.clone().map(|k| data.points[k % n]).collect();
    let start = data.lengths[span.from];
    let lengths = indices.map(|k| data.lengths[k % n] + if k >= n { data.total } else { 0.0 } - start).collect();
    (points, lengths)
}

fn smooth(data: &Cleaned, span: &Span, limit: f64) -> Result<Part, Vec<Unfit>> {
    let (points, lengths) = cut(data, span);
    let given = given(data, span, &points, &lengths, limit);
    let is_line = |&p: &Point| p.distance(nearest_on_segment(p, span.start.1, span.end.1)) <= limit;
    if given.ends == Ends::Open(End::Free, End::Free) && points.iter().all(is_line) {
        return Ok(line(&points));
    }
    Ok(part_of(span, long::fit(&given)?))
}

fn given<'a>(data: &Cleaned, span: &Span, points: &'a [Point], lengths: &'a [f64], limit: f64) -> Given<'a> {
    let ends = if span.periodic { Ends::Periodic } else { Ends::Open(span.start.0, span.end.0) };
    let total = if span.periodic { data.total } else { lengths[span.count - 1] };
    let (a, b) = (span.start.1, span.end.1);
    Given { points, lengths, total, ends, held: [a, a, b, b], limit, floor: data.floor }
}

fn part_of(span: &Span, trial: Trial) -> Part {
    let last = trial.nodes.len() - 1;
    let corner = |k: usize| {
        !span.periodic && ((k == 0 && span.start.0 == End::Corner) || (k == last && span.end.0 == End::Corner))
    };
    let nodes = trial.nodes.iter().enumerate().map(|(k, &node)| (node, corner(k))).collect();
    Part { nodes, parameters: trial.parameters }
}

/// An open curve that is one straight line.
fn line(points: &[Point]) -> Part {
    let (a, b) = (points[0], points[points.len() - 1]);
    let along = (b - a) / (b - a).length_squared().max(f64::MIN_POSITIVE);
    let parameters = points.iter().map(|&p| (p - a).dot(along).clamp(0.0, 1.0)).collect();
    Part { nodes: vec![(a, false), (b, false)], parameters }
}

/// Straight lines between some of the points.
fn straight(data: &Cleaned, span: &Span, limit: f64) -> Part {
    let (mut points, _) = cut(data, span);
    if span.periodic {
        points.push(points[0]);
    } else {
        // Corners may be beside their points, by less than the limit.
        let last = points.len() - 1;
        (points[0], points[last]) = (span.start.1, span.end.1);
    }
    let vertices = polygon::vertices(&points, limit);
    let mut parameters = polygon::parameters(&points, &vertices);
    let mut nodes: Vec<(Point, bool)> = vertices.iter().map(|&k| (points[k], true)).collect();
    if span.periodic {
        parameters.pop();
        nodes.pop();
        // The first corner is doubled. Its second guiding point begins the first chord.
        parameters.iter_mut().for_each(|t| *t += 1.0);
    }
    Part { nodes, parameters }
}

/// Joins the sections and measures the curve.
fn measured(data: &Cleaned, closed: bool, parts: &[(Span, Part)]) -> Whole {
    let n = data.points.len();
    let mut guides: Vec<Point> = Vec::new();
    let mut parameters = vec![0.0; n];
    for (span, part) in parts {
        // Each corner must be written once: on a closed curve by the section that begins there, on an open curve by the
        // section that ends there.
        if closed || guides.is_empty() {
            push(&mut guides, part.nodes[0]);
        }
        let piece = match (span.periodic, closed) {
            (true, _) => 0,
            (false, true) => guides.len() - 1,
            (false, false) => guides.len().saturating_sub(2),
        };
        for (k, t) in part.parameters.iter().enumerate() {
            parameters[(span.from + k) % n] = piece as f64 + t;
        }
        let end = if span.periodic || !closed { part.nodes.len() } else { part.nodes.len() - 1 };
        part.nodes[1..end].iter().for_each(|&node| push(&mut guides, node));
    }
    complete(data, closed, guides, parameters)
}

/// The curve with these guiding points. `parameters` are approximate places of the points on it.
fn complete(data: &Cleaned, closed: bool, guides: Vec<Point>, mut parameters: Vec<f64>) -> Whole {
    let spline = Spline::of_finite(guides, closed);
    let count = spline.piece_count() as f64;
    for t in &mut parameters {
        *t = if closed { t.rem_euclid(count) } else { t.clamp(0.0, count) };
    }
    Whole::of(spline, data, &parameters)
}

impl Whole {
    /// Measures a curve. `parameters` are places of the points near their feet.
    pub fn of(spline: Spline, data: &Cleaned, parameters: &[f64]) -> Self {
        let mut feet = parameters.to_vec();
        let line = Line { points: &data.points, closed: spline.is_closed(), parameters };
        let (error, worst) = bound::error(&spline, &line, &mut feet);
        Self { spline, parameters: feet, error, worst }
    }
}

fn push(guides: &mut Vec<Point>, (node, corner): (Point, bool)) {
    guides.push(node);
    if corner {
        guides.push(node);
    }
}
