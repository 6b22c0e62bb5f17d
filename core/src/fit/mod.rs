//! Fitting.
mod clean;
mod corners;
mod count;
mod feet;
mod profile;
mod section;
mod solve;
mod trial;

use crate::geometry::Point;
use crate::curve::Spline;

pub fn fit_raw(points: &[Point], closed: bool, tolerance: f64) -> (Spline, f64) {
    let distinct = clean::distinct(points, closed);
    let data = clean::filled(&distinct, closed, tolerance);
    let n = data.points.len();
    let corners = corners::corners(&data.points, &data.lengths, data.total, closed, tolerance);
    let limit = tolerance * 0.998;
    let mut nodes: Vec<(Point, bool)> = vec![];
    let mut worst = 0.0f64;
    let debug = std::env::var("FIT_DEBUG").is_ok();
    let mut run = |a: usize, b: usize, ends: section::Ends, held: [Point; 4]| {
        // wraps
        let count = if ends == section::Ends::Periodic { n } else { (b + n - a - 1) % n + 2 };
        let idx: Vec<usize> = (0..count).map(|k| (a + k) % n).collect();
        let pts: Vec<Point> = idx.iter().map(|&k| data.points[k]).collect();
        let mut lengths: Vec<f64> = idx.iter().map(|&k| data.lengths[k] - data.lengths[a]).collect();
        for l in lengths.iter_mut().skip(1) { if *l <= 0.0 { *l += data.total; } }
        let total = if ends == section::Ends::Periodic { data.total } else { lengths[count - 1] };
        let given = trial::Given { points: &pts, lengths: &lengths, total, ends, held, limit };
        if debug { eprintln!(" section {a}..{b} {count} points {ends:?}"); }
        let t = count::fewest(&given, 400).expect("fit");
        worst = worst.max(t.errors.largest);
        t.nodes
    };
    use section::{End, Ends};
    if closed && corners.is_empty() {
        let t = run(0, 0, Ends::Periodic, [Point::ZERO; 4]);
        nodes.extend(t.into_iter().map(|p| (p, false)));
    } else if closed {
        for k in 0..corners.len() {
            let (c, d) = (corners[k], corners[(k + 1) % corners.len()]);
            let t = run(c.index, d.index, Ends::Open(End::Corner, End::Corner), [c.place, c.place, d.place, d.place]);
            nodes.push((c.place, true));
            nodes.extend(t[1..t.len() - 1].iter().map(|&p| (p, false)));
        }
    } else {
        let mut marks = vec![(0, data.points[0], End::Free)];
        marks.extend(corners.iter().map(|c| (c.index, c.place, End::Corner)));
        marks.push((n - 1, data.points[n - 1], End::Free));
        for w in marks.windows(2) {
            let t = run(w[0].0, w[1].0, Ends::Open(w[0].2, w[1].2), [w[0].1, w[0].1, w[1].1, w[1].1]);
            if w[0].2 == End::Free { nodes.push((t[0], false)); } else { nodes.push((w[0].1, true)); }
            nodes.extend(t[1..t.len() - 1].iter().map(|&p| (p, false)));
            if w[1].2 == End::Free { nodes.push((t[t.len() - 1], false)); }
        }
    }
    let mut guides = vec![];
    for (p, c) in nodes { guides.push(p); if c { guides.push(p); } }
    (Spline::new(guides, closed).unwrap(), worst)
}
