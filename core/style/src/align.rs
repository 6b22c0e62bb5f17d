//! Alignment of clips of one motion in time.
//!
//! **Dynamic time warping** (Sakoe & Chiba 1978) finds the monotone path of least total distance between two clips of
//! postures. Its steps are (1, 1), (1, 0) and (0, 1). Dynamic programming finds the path within a band about the
//! diagonal. Each frame of the leading clip gets the mean time of the frames that it is paired with. Only two rows of
//! costs are kept, and two bits for the step into each pair of the band: 60 MB for two clips of 20 000 frames.
//!
//! **Gait cycles** are found by self-similarity. The period is the lag of the first deep minimum of the mean distance
//! between frames that are a lag apart. The autocorrelation method for pitch works in the same way. The distance is
//! divided by its mean over all shorter lags (de Cheveigné & Kawahara); this excludes the trivial minimum at lag zero.
//!
//! Limits: both compare postures only, with the pelvis at the origin. Their time grows with the square of the frames.

use super::Request;
use rototoon_base::scene::Clip;
use rototoon_base::scene::clip::{between, resample};
use rototoon_base::scene::skeleton::{COUNT, Posture};
use std::ops::Range;

/// Half width of the band, in tenths of the longer clip.
const BAND: usize = 3;

/// A minimum counts as a cycle if the normalised distance is below this.
const ALIKE: f64 = 0.35;

/// Squared distance of two postures, each with its pelvis as the origin.
fn distance(a: &Posture, b: &Posture) -> f64 {
    (1..COUNT).map(|k| ((a[k] - a[0]) - (b[k] - b[0])).length_squared()).sum()
}

/// The path of least distance: pairs of frames (of `a`, of `b`) from (0, 0) to the last frame of both. Empty if a clip
/// is empty.
pub fn time_warp(a: &[Posture], b: &[Posture]) -> Vec<(usize, usize)> {
    let (n, m) = (a.len(), b.len());
    if n == 0 || m == 0 {
        return Vec::new();
    }
    let band = Band::new(n, m);
    let mut taken = Steps::default();
    // The costs of the row before and of the present one.
    let (mut above, mut row) = (vec![f64::INFINITY; m], vec![f64::INFINITY; m]);
    for i in 0..n {
        row.fill(f64::INFINITY);
        let columns = band.columns(i);
        taken.begin_row(columns.clone());
        for j in columns {
            // Of equal costs the first one counts: the diagonal.
            let diagonal = if i > 0 && j > 0 { above[j - 1] } else { f64::INFINITY };
            let left = if j > 0 { row[j - 1] } else { f64::INFINITY };
            let from = [(diagonal, Step::Diagonal), (above[j], Step::Above), (left, Step::Left)];
            let (before, step) = from.into_iter().fold(from[0], |best, next| if next.0 < best.0 { next } else { best });
            row[j] = distance(&a[i], &b[j]) + if (i, j) == (0, 0) { 0.0 } else { before };
            taken.set(i, j, step);
        }
        std::mem::swap(&mut above, &mut row);
    }
    let (mut i, mut j) = (n - 1, m - 1);
    let mut path = vec![(i, j)];
    while (i, j) != (0, 0) {
        (i, j) = match taken.get(i, j) {
            // A row or column at the edge has one way only.
            _ if i == 0 => (0, j - 1),
            _ if j == 0 => (i - 1, 0),
            Step::Diagonal => (i - 1, j - 1),
            Step::Above => (i - 1, j),
            Step::Left => (i, j - 1),
        };
        path.push((i, j));
    }
    path.reverse();
    path
}

/// The pairs about the diagonal that a path may use. The bounds are counted in whole numbers: a pair on the edge of the
/// band is in it on every machine.
struct Band {
    columns: usize,
    /// The last row and the last column.
    last: (usize, usize),
    /// Half width, in parts of a column of which there are ten times `last.0`.
    half: usize,
    whole: bool,
}

impl Band {
    fn new(rows: usize, columns: usize) -> Self {
        let last @ (row, column) = (rows.max(2) - 1, columns.max(2) - 1);
        // A share of the longer clip, and never less than two columns or one more than the slope.
        let half = (BAND * columns.max(rows) * row).max(10 * (column + row)).max(20 * row);
        Self { columns, last, half, whole: rows == 1 || columns == 1 }
    }

    /// The columns of row `i`.
    fn columns(&self, i: usize) -> Range<usize> {
        if self.whole {
            return 0..self.columns;
        }
        let (middle, parts) = (10 * i * self.last.1, 10 * self.last.0);
        let (first, last) = (middle.saturating_sub(self.half).div_ceil(parts), (middle + self.half) / parts);
        first..(last + 1).min(self.columns)
    }
}

/// The step by which a path comes to a pair.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Step {
    Diagonal,
    Above,
    Left,
}

/// A step for each pair of a band, two bits each.
#[derive(Default)]
struct Steps {
    /// For each row its first column, and the number of pairs before it.
    rows: Vec<(usize, usize)>,
    pairs: usize,
    bits: Vec<u8>,
}

impl Steps {
    fn begin_row(&mut self, columns: Range<usize>) {
        self.rows.push((columns.start, self.pairs));
        self.pairs += columns.len();
        self.bits.resize(self.pairs.div_ceil(4), 0);
    }

    fn place(&self, i: usize, j: usize) -> (usize, usize) {
        let (first, before) = self.rows[i];
        let at = before + j - first;
        (at / 4, 2 * (at % 4))
    }

    fn set(&mut self, i: usize, j: usize, step: Step) {
        let (byte, shift) = self.place(i, j);
        self.bits[byte] |= (step as u8) << shift;
    }

    fn get(&self, i: usize, j: usize) -> Step {
        let (byte, shift) = self.place(i, j);
        [Step::Diagonal, Step::Above, Step::Left, Step::Left][usize::from(self.bits[byte] >> shift & 3)]
    }
}

/// Warps a clip onto the frames of another clip of the same motion. For each frame of the leading clip it gives the
/// posture at the same moment of the motion.
pub fn warped(clip: &[Posture], leading: &[Posture]) -> Vec<Posture> {
    let path = time_warp(leading, clip);
    let mut times = vec![(0.0, 0.0); leading.len()];
    for (i, j) in path {
        times[i].0 += j as f64;
        times[i].1 += 1.0;
    }
    // The paired frames are integers. Smoothing over neighbours removes the steps and keeps the times monotone.
    let mean: Vec<f64> = times.iter().map(|(sum, count)| sum / f64::max(*count, 1.0)).collect();
    let last = mean.len().saturating_sub(1);
    (0..mean.len())
        .map(|i| {
            let reach = i.min(last - i).min(2);
            let near = &mean[i - reach..=i + reach];
            between(clip, near.iter().sum::<f64>() / near.len() as f64)
        })
        .collect()
}

/// Frames of one cycle of a clip; `None` if the clip does not repeat itself.
pub fn cycle_length(postures: &[Posture]) -> Option<usize> {
    let n = postures.len();
    let apart =
        |lag: usize| (0..n - lag).map(|i| distance(&postures[i], &postures[i + lag])).sum::<f64>() / (n - lag) as f64;
    let longest = n * 2 / 3;
    let mut sum = 0.0;
    let mut normalised = vec![1.0];
    for lag in 1..=longest {
        let here = apart(lag);
        sum += here;
        normalised.push(if sum > 0.0 { here * lag as f64 / sum } else { 1.0 });
    }
    let first = (2..longest).find(|&lag| normalised[lag] < ALIKE && normalised[lag] <= normalised[lag + 1])?;
    Some(first)
}

/// The cycles of a clip, cut at the frames most like its first. Empty if the clip does not repeat itself.
pub fn cycles(postures: &[Posture]) -> Vec<Vec<Posture>> {
    let Some(length) = cycle_length(postures) else { return Vec::new() };
    let reach = (length / 6).max(1);
    let mut cuts = vec![0];
    while let Some(next) = cuts.last().map(|cut| cut + length).filter(|next| *next < postures.len()) {
        let near = next - reach..(next + reach + 1).min(postures.len());
        let best =
            near.min_by(|&i, &j| distance(&postures[i], &postures[0]).total_cmp(&distance(&postures[j], &postures[0])));
        cuts.extend(best);
    }
    cuts.windows(2).map(|cut| postures[cut[0]..cut[1]].to_vec()).collect()
}

/// How much slower a style is than the content.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct PaceRatio {
    /// The length of the style's motions in those of the content's; 1 if nothing tells it.
    pub ratio: f64,
    /// Number of motions that tell it.
    pub motions: usize,
}

/// The median ratio of the lengths of the style's and the content's clips over the motions that both have. A clip of one posture is a
/// drawn pose and has no length.
pub(super) fn pace(clips: &[Clip], request: &Request) -> PaceRatio {
    let frames = |clip: &Clip| Some(clip.postures.len()).filter(|frames| *frames > 1).map(|frames| frames as f64);
    let content =
        |motion: &str| clips.iter().find(|c| c.character == request.content && c.motion == motion).and_then(frames);
    let mut ratios: Vec<f64> = clips
        .iter()
        .filter(|c| c.character == request.style && c.motion != request.motion)
        .filter_map(|c| Some((frames(c)? / content(&c.motion)?).ln()))
        .collect();
    ratios.sort_by(f64::total_cmp);
    let motions = ratios.len();
    let middle = motions.saturating_sub(1) / 2..motions / 2 + 1;
    let ratio = ratios.get(middle).map_or(1.0, |middle| (middle.iter().sum::<f64>() / middle.len() as f64).exp());
    PaceRatio { ratio, motions }
}

/// Resamples a clip to play slower (`ratio` above 1) or faster. Its standard deviations come from the nearest frame.
pub(super) fn change_pace(clip: &mut Clip, ratio: f64) {
    let (before, after) = (clip.postures.len(), (clip.postures.len() as f64 * ratio).round().max(1.0) as usize);
    clip.postures = resample(&clip.human().unwrap_or_default(), after).into_iter().map(Vec::from).collect();
    let step = (before.max(1) - 1) as f64 / after.saturating_sub(1).max(1) as f64;
    clip.deviation = (0..after)
        .filter_map(|frame| clip.deviation.get(((frame as f64 * step).round() as usize).min(before - 1)).cloned())
        .collect();
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use rototoon_base::geometry::Point;

    fn swing(phase: f64) -> Posture {
        std::array::from_fn(|k| {
            Point::new(k as f64 * phase.sin(), (2.0 * phase).cos() + k as f64 * phase.cos()) * (k.min(1) as f64)
        })
    }

    #[test]
    fn drawn_poses_and_single_slow_motions_do_not_tell_the_pace() {
        let clip = |who: &str, what: &str, frames: usize| Clip::new(who, what, vec![swing(0.1); frames]);
        let request = Request { style: "old", motion: "walk", content: "plain", keys: &[] };
        let mut clips = vec![clip("plain", "walk", 32)];
        let motions = ["run", "bow", "hop", "nod", "wave"];
        clips.extend(motions.map(|motion| clip("plain", motion, 20)));
        let told = |frames: [usize; 5]| {
            let more = motions.iter().zip(frames).map(|(motion, frames)| clip("old", motion, frames));
            let found = pace(&clips.iter().cloned().chain(more).collect::<Vec<_>>(), &request);
            (format!("{:.3}", found.ratio), found.motions)
        };
        assert_eq!(told([24, 24, 1, 1, 1]), ("1.200".to_owned(), 2));
        assert_eq!(told([60, 24, 25, 23, 24]), ("1.200".to_owned(), 5), "a run of three cycles");
        assert_eq!(told([1; 5]), ("1.000".to_owned(), 0));
        clips[1].postures.truncate(1);
        assert_eq!(pace(&[&clips[..2], &[clip("old", "run", 20)]].concat(), &request).motions, 0);
    }

    #[test]
    fn a_clip_played_unevenly_is_brought_back() {
        let phase = |t: f64| 3.0 * t;
        let lead: Vec<Posture> = (0..40).map(|i| swing(phase(i as f64 / 39.0))).collect();
        let uneven: Vec<Posture> = (0..60).map(|i| swing(phase((i as f64 / 59.0).powf(1.4)))).collect();
        let back = warped(&uneven, &lead);
        assert_eq!(back.len(), 40);
        let error = |clip: &[Posture]| clip.iter().zip(&lead).map(|(a, b)| distance(a, b)).sum::<f64>();
        assert!(
            error(&back) < 0.02 * error(&resample(&uneven, 40)),
            "{} {}",
            error(&back),
            error(&resample(&uneven, 40))
        );
        assert_eq!(time_warp(&lead, &lead), (0..40).map(|i| (i, i)).collect::<Vec<_>>());
    }

    #[test]
    fn clips_of_very_unequal_length_still_have_a_path() {
        let (one, many) = (vec![swing(0.3)], (0..50).map(|i| swing(i as f64 * 0.1)).collect::<Vec<_>>());
        assert_eq!(time_warp(&one, &many).len(), 50);
        assert_eq!(warped(&one, &many).len(), 50);
        assert_eq!(warped(&many, &one).len(), 1);
        let three: Vec<Posture> = many[..3].to_vec();
        assert_eq!(time_warp(&three, &many).last(), Some(&(2, 49)));
    }

    /// The complete table of costs, without a band where it does not bind.
    fn time_warp_naive(a: &[Posture], b: &[Posture]) -> Vec<(usize, usize)> {
        let (n, m) = (a.len(), b.len());
        let (row, column) = (n.max(2) - 1, m.max(2) - 1);
        let band = (BAND * m.max(n) * row).max(10 * (column + row)).max(20 * row);
        let steps = |i: usize, j: usize| {
            let diagonal = (i > 0 && j > 0).then(|| (i - 1, j - 1));
            let (up, left) = ((i > 0).then(|| (i - 1, j)), (j > 0).then(|| (i, j - 1)));
            diagonal.into_iter().chain(up).chain(left)
        };
        let mut cost = vec![f64::INFINITY; n * m];
        for (i, j) in (0..n).flat_map(|i| (0..m).map(move |j| (i, j))) {
            if n == 1 || m == 1 || 10 * (j * row).abs_diff(i * column) <= band {
                let before = steps(i, j).map(|(i, j)| cost[i * m + j]).fold(f64::INFINITY, f64::min);
                cost[i * m + j] = distance(&a[i], &b[j]) + if (i, j) == (0, 0) { 0.0 } else { before };
            }
        }
        let mut path = vec![(n - 1, m - 1)];
        while let Some(&(i, j)) = path.last().filter(|&&at| at != (0, 0)) {
            path.extend(steps(i, j).min_by(|p, q| cost[p.0 * m + p.1].total_cmp(&cost[q.0 * m + q.1])));
        }
        path.reverse();
        path
    }

    proptest! {
        #[test]
        fn the_path_is_that_of_the_complete_table(a in prop::collection::vec(0u8..6, 1..40), b in prop::collection::vec(0u8..6, 1..40)) {
            // Few phases make ties.
            let clip = |phases: &[u8]| phases.iter().map(|&p| swing(f64::from(p))).collect::<Vec<_>>();
            let (a, b) = (clip(&a), clip(&b));
            prop_assert_eq!(time_warp(&a, &b), time_warp_naive(&a, &b));
        }
    }

    /// Row 3 of 6 reaches column 21 of 24 exactly: 3 · 23 / 5 + 0.3 · 24 = 21.
    #[test]
    fn a_pair_on_the_edge_of_the_band_is_in_it() {
        assert_eq!(Band::new(6, 24).columns(3), 7..22);
        assert_eq!(Band::new(6, 24).columns(2), 2..17);
    }

    #[test]
    fn a_walk_is_cut_into_its_cycles() {
        let turn = std::f64::consts::TAU;
        let clip: Vec<Posture> = (0..100).map(|i| swing(turn * i as f64 / 24.0)).collect();
        assert_eq!(cycle_length(&clip), Some(24));
        assert_eq!(cycles(&clip).iter().map(Vec::len).collect::<Vec<_>>(), [24, 24, 24, 24]);
        let once: Vec<Posture> = (0..50).map(|i| swing(1.5 * i as f64 / 50.0)).collect();
        assert_eq!(cycle_length(&once), None);
        assert_eq!(cycle_length(&once[..1]), None);
    }
}
