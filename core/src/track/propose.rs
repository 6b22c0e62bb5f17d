//! Which frames of a footage an artist should key.
//!
//! A tracker gets from a key to those drawings that look like it, so a few drawings are wanted that all others look like:
//! those in between resemble the one before or the one after. Held frames are one drawing ([`super::drawings`]), and at a
//! cut a new sequence begins ([`super::cuts`]), whose first and last drawings are keys: tracks go from key to key.
//!
//! **Dissimilarity.** Pictures are reduced to cells of 16 working pixels. D(i, j) is the mean over cells of the least
//! colour distance (‖ΔRGB‖, three channels of 0 to 1) to any of the nine cells around the same place in the other picture,
//! both ways: small motion costs nothing, what appears, vanishes or goes far does. That is rough, but it is the same for
//! all frames, and it needs no motion that would have to be right.
//!
//! **Way.** A tracker goes from drawing to drawing, and each step may lose a part, even on the way to a drawing that looks
//! like the key. The way L(i, j) from one drawing to another is the sum of its steps, each D of the two neighbours plus the
//! mean of D over all neighbours.
//!
//! **Choice.** With keys k₁ < k₂ < …, a drawing t between a and b costs min(D(a, t) + L(a, t), D(t, b) + L(t, b)): it is
//! reached from one of them. The keys of least total cost for each number of them come from dynamic programming over drawings in order, O(n² · keys) after O(n · [`REACH`])
//! dissimilarities; two neighbouring keys are at most [`REACH`] drawings apart. Frames keyed already stay keys.
//!
//! **Number.** Unless it is given, the knee of cost over number: where the curve is farthest below the straight line from
//! its beginning to its end, all drawings keyed.
//!
//! Limits: the whole picture speaks, so a moving camera asks for more keys than the parts need; nothing is known of which
//! limb hides which.

use super::TrackError;
use super::cuts::is_cut;
use super::drawings::same_drawing;
use super::features::{Features, WORKING_LINES, working_scale};
use crate::geometry::Point;
use crate::scene::{Colour, Footage, FrameNumber, FrameSource, Progress, Raster};
use rayon::prelude::{IntoParallelIterator, ParallelIterator};
use std::collections::BTreeSet;

/// Side of a cell in working pixels.
const CELL: f64 = 16.0;
/// Drawings from one key to the next at the most.
pub const REACH: usize = 60;
/// Level (index in `LEVELS`) that cells are read from.
const LEVEL: usize = 0;

/// A drawing of the footage.
#[derive(Clone, Debug)]
struct Drawing {
    first: FrameNumber,
    last: FrameNumber,
    cells: Raster<Colour>,
    /// Whether a shot begins with it.
    begins: bool,
}

/// Frames to key, rising: those in `keyed` (as far as they lie in the footage), and with them `count` in all, or as many
/// as seem worth it. The ends of each shot are always among them, so there may be more than `count`.
pub fn propose(
    footage: &Footage,
    frames: &dyn FrameSource,
    keyed: &BTreeSet<FrameNumber>,
    count: Option<usize>,
    progress: &dyn Progress,
) -> Result<Vec<FrameNumber>, TrackError> {
    let drawings = read(footage, frames, progress)?;
    let n = drawings.len();
    let ends = |d: usize| drawings[d].begins || d + 1 == n || drawings[d + 1].begins;
    let known = |d: usize| keyed.range(drawings[d].first..=drawings[d].last).next().copied();
    let fixed: Vec<bool> = (0..n).map(|d| ends(d) || known(d).is_some()).collect();
    progress.report("Comparing drawings", 0.8)?;
    let costs = interval_costs(&drawings, &fixed);
    let paths = best_keys(&costs, n);
    let least = paths.iter().position(|path| path.is_some()).unwrap_or(0);
    let wanted = count.unwrap_or_else(|| knee(&paths)).clamp(least, n);
    let chosen = paths[wanted].as_ref().map_or_else(Vec::new, |(_, keys)| keys.clone());
    let frame = |&d: &usize| match known(d) {
        Some(frame) => frame,
        // The end of a shot is keyed on its very last frame, so that tracks reach it.
        None if !drawings[d].begins && (d + 1 == n || drawings[d + 1].begins) => drawings[d].last,
        None => drawings[d].first,
    };
    let mut found: BTreeSet<FrameNumber> = chosen.iter().map(frame).collect();
    found.extend(keyed.range(footage.first..=footage.last));
    progress.report("Comparing drawings", 1.0)?;
    Ok(found.into_iter().collect())
}

/// The drawings of a footage in order.
fn read(footage: &Footage, frames: &dyn FrameSource, progress: &dyn Progress) -> Result<Vec<Drawing>, TrackError> {
    let mut drawings: Vec<Drawing> = Vec::new();
    let mut before: Option<Features> = None;
    let all = f64::from(footage.last - footage.first + 1);
    for frame in footage.first..=footage.last {
        progress.report("Reading frames", 0.8 * f64::from(frame - footage.first) / all)?;
        let features = Features::new(&*frames.picture(frame)?);
        match (drawings.last_mut(), &before) {
            (Some(drawing), Some(earlier)) if same_drawing(earlier, &features) => drawing.last = frame,
            (_, earlier) => {
                let begins = earlier.as_ref().is_none_or(|e| is_cut(e, &features));
                let cells = cells(&features, footage);
                drawings.push(Drawing { first: frame, last: frame, cells, begins });
            }
        }
        before = Some(features);
    }
    Ok(drawings)
}

fn cells(features: &Features, footage: &Footage) -> Raster<Colour> {
    let width = footage.width as f64 / working_scale(footage.height.max(1));
    let count = |length: f64| (length / CELL).ceil().max(1.0) as usize;
    let level = features.level(LEVEL);
    Raster::from_fn(count(width), count(WORKING_LINES), |x, y| {
        let center = Point::new(x as f64 + 0.5, y as f64 + 0.5) * CELL;
        let at = |dx: f64, dy: f64| level.colour(center + Point::new(dx, dy) * (0.25 * CELL));
        let corners = [at(-1.0, -1.0), at(1.0, -1.0), at(-1.0, 1.0), at(1.0, 1.0)];
        [0, 1, 2].map(|k| corners.iter().map(|c| c[k]).sum::<f32>() / 4.0)
    })
}

/// How much of either picture finds no like around its place in the other.
fn dissimilarity(a: &Raster<Colour>, b: &Raster<Colour>) -> f64 {
    0.5 * (unlike(a, b) + unlike(b, a))
}

fn unlike(from: &Raster<Colour>, to: &Raster<Colour>) -> f64 {
    let mut sum = 0.0;
    for y in 0..from.height() {
        for x in 0..from.width() {
            let colour = from.get(x, y);
            let mut least = f32::INFINITY;
            for v in y.saturating_sub(1)..(y + 2).min(to.height()) {
                for other in &to.row(v)[x.saturating_sub(1)..(x + 2).min(to.width())] {
                    let square: f32 = (0..3).map(|k| (colour[k] - other[k]) * (colour[k] - other[k])).sum();
                    least = least.min(square);
                }
            }
            sum += f64::from(least.sqrt());
        }
    }
    sum / (from.width() * from.height()).max(1) as f64
}

/// By drawing a, then b − a − 1: what the drawings between the keys a and b cost; infinite where a fixed key lies between.
fn interval_costs(drawings: &[Drawing], fixed: &[bool]) -> Vec<Vec<f64>> {
    let n = drawings.len();
    let apart: Vec<Vec<f64>> = (0..n)
        .into_par_iter()
        .map(|a| {
            let same_shot = |b: &usize| !drawings[a + 1..=*b].iter().any(|d| d.begins);
            let reached = (a + 1..n.min(a + 1 + REACH)).take_while(same_shot);
            reached.map(|b| dissimilarity(&drawings[a].cells, &drawings[b].cells)).collect()
        })
        .collect();
    let along = ways(&apart);
    let between = |a: usize, b: usize| -> f64 {
        if drawings[b].begins {
            // From one shot to the next nothing lies between.
            return if b == a + 1 { 0.0 } else { f64::INFINITY };
        }
        let to =
            |i: usize, j: usize| apart[i].get(j - i - 1).map_or(f64::INFINITY, |apart| apart + along[j] - along[i]);
        let cost = |t: usize| if fixed[t] { f64::INFINITY } else { to(a, t).min(to(t, b)) };
        (a + 1..b).map(cost).sum()
    };
    (0..n).map(|a| (a + 1..n.min(a + 1 + REACH)).map(|b| between(a, b)).collect()).collect()
}

/// Length of the way from the first drawing to each; `apart` by drawing, then by how many drawings further less one.
fn ways(apart: &[Vec<f64>]) -> Vec<f64> {
    let steps: Vec<f64> = apart.iter().filter_map(|row| row.first().copied()).collect();
    let mean = steps.iter().sum::<f64>() / steps.len().max(1) as f64;
    let mut way = 0.0;
    let mut along = vec![0.0];
    for row in apart.iter().take(apart.len().saturating_sub(1)) {
        way += row.first().copied().unwrap_or(0.0) + mean;
        along.push(way);
    }
    along
}

/// For each number of keys, the least cost and the keys; none where there is no such choice.
fn best_keys(costs: &[Vec<f64>], n: usize) -> Vec<Option<(f64, Vec<usize>)>> {
    let mut found = vec![None; n + 1];
    if n == 0 {
        found[0] = Some((0.0, Vec::new()));
        return found;
    }
    // least[k][b]: cost up to key b, being the k-th, and the key before.
    let mut least = vec![vec![(f64::INFINITY, 0usize); n]];
    least[0][0] = (0.0, 0);
    for k in 0..n {
        if least[k][n - 1].0.is_finite() {
            let mut keys = vec![n - 1];
            for row in (1..=k).rev() {
                keys.push(least[row][keys[keys.len() - 1]].1);
            }
            keys.reverse();
            found[k + 1] = Some((least[k][n - 1].0, keys));
        }
        let mut next = vec![(f64::INFINITY, 0); n];
        for (a, row) in costs.iter().enumerate() {
            for (step, cost) in row.iter().enumerate() {
                let (b, total) = (a + 1 + step, least[k][a].0 + cost);
                if total < next[b].0 {
                    next[b] = (total, a);
                }
            }
        }
        least.push(next);
    }
    found
}

/// The number of keys at the knee of the costs.
fn knee(paths: &[Option<(f64, Vec<usize>)>]) -> usize {
    let known: Vec<(f64, f64)> =
        paths.iter().enumerate().filter_map(|(k, path)| path.as_ref().map(|(cost, _)| (k as f64, *cost))).collect();
    let (Some(&(first, most)), Some(&(last, least))) = (known.first(), known.last()) else { return 0 };
    let below = |&(k, cost): &(f64, f64)| {
        let share = (k - first) / (last - first).max(1.0);
        most + (least - most) * share - cost
    };
    let best = known.iter().fold((first, 0.0), |best, point| {
        let depth = below(point);
        if depth > best.1 + 1e-12 { (point.0, depth) } else { best }
    });
    best.0 as usize
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{FrameError, Silent};
    use std::sync::Arc;

    /// A ball on paper at the places given, one a frame; negative places are of another shot.
    struct Ball(Vec<f64>);

    impl Ball {
        fn footage(&self) -> Footage {
            let last = self.0.len() as FrameNumber - 1;
            Footage { pattern: "%d.png".into(), first: 0, last, fps: 12.0, width: 240, height: 120 }
        }

        fn propose(&self, keyed: &[FrameNumber], count: Option<usize>) -> Vec<FrameNumber> {
            propose(&self.footage(), self, &keyed.iter().copied().collect(), count, &Silent).unwrap()
        }
    }

    impl FrameSource for Ball {
        fn picture(&self, frame: FrameNumber) -> Result<Arc<Raster<Colour>>, FrameError> {
            let at = self.0[frame as usize];
            let paper = if at < 0.0 { [0.1, 0.2, 0.4] } else { [0.95; 3] };
            Ok(Arc::new(Raster::from_fn(240, 120, |x, y| {
                let inside = Point::new(x as f64 - at.abs(), y as f64 - 60.0).length() < 15.0;
                if inside { [0.8, 0.2, 0.1] } else { paper }
            })))
        }
    }

    #[test]
    fn holds_are_one_drawing_and_ends_and_cuts_are_keys() {
        let ball = Ball(vec![30.0, 30.0, 30.0, -40.0, -40.0]);
        assert_eq!(ball.propose(&[], None), [0, 3]);
        assert_eq!(ball.propose(&[], Some(1)), [0, 3], "no fewer than the ends of the shots");
        assert_eq!(Ball(vec![20.0]).propose(&[], None), [0]);
    }

    #[test]
    fn a_third_key_goes_to_where_the_part_dwells_away_from_both_ends() {
        let ball = Ball(vec![30.0, 32.0, 110.0, 112.0, 114.0, 200.0, 202.0]);
        let found = ball.propose(&[], Some(3));
        assert_eq!((found[0], found[2]), (0, 6));
        assert!((2..=4).contains(&found[1]), "{found:?}");
        assert_eq!(ball.propose(&[], None).len(), 3, "that is the knee, too");
    }

    #[test]
    fn keys_that_are_there_stay_and_count() {
        let ball = Ball((0..9).map(|k| 25.0 + 22.0 * f64::from(k)).collect());
        let found = ball.propose(&[3], Some(4));
        assert_eq!(found.len(), 4);
        assert!(found.contains(&3) && (found.contains(&5) || found.contains(&6)), "{found:?}");
        assert_eq!(ball.propose(&[], Some(99)), (0..9).collect::<Vec<_>>());
    }

    #[test]
    fn no_other_keys_cost_less() {
        let ball = Ball(vec![30.0, 55.0, 60.0, 140.0, 90.0, 180.0, 170.0, 45.0]);
        let drawings = read(&ball.footage(), &ball, &Silent).unwrap();
        let n = drawings.len();
        let fixed: Vec<bool> = (0..n).map(|d| d == 0 || d + 1 == n).collect();
        let apart = |a: usize, b: usize| dissimilarity(&drawings[a].cells, &drawings[b].cells);
        let steps: Vec<f64> = (1..n).map(|d| apart(d - 1, d)).collect();
        let mean = steps.iter().sum::<f64>() / steps.len() as f64;
        let to = |a: usize, b: usize| apart(a, b) + steps[a..b].iter().map(|s| s + mean).sum::<f64>();
        let cost = |keys: &[usize]| -> f64 {
            let between = |w: &[usize]| (w[0] + 1..w[1]).map(|t| to(w[0], t).min(to(t, w[1]))).sum::<f64>();
            keys.windows(2).map(between).sum()
        };
        let paths = best_keys(&interval_costs(&drawings, &fixed), n);
        for (count, path) in paths.iter().enumerate().skip(2) {
            let (found, keys) = path.as_ref().unwrap();
            assert!((cost(keys) - found).abs() < 1e-9 && keys.len() == count);
            let least = (0..1usize << (n - 2))
                .filter(|bits| bits.count_ones() as usize == count - 2)
                .map(|bits| {
                    let inner = (1..n - 1).filter(|d| bits >> (d - 1) & 1 == 1);
                    cost(&[0].into_iter().chain(inner).chain([n - 1]).collect::<Vec<_>>())
                })
                .fold(f64::INFINITY, f64::min);
            assert!((least - found).abs() < 1e-9, "{count} keys: {found}, but {least} is possible");
        }
    }
}
