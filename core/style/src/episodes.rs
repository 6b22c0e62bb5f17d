//! How far a prediction is to be trusted when few clips of the style are known: a rehearsal on the other characters.
//!
//! The covariances of `stance` describe how characters of the library vary. They do not say whether one clip of a style
//! tells anything about its other motions in *this* library. Performers whose manner changes from motion to motion
//! mislead the prediction, which is then worse than the content's clip as it is. The library answers this itself. An
//! *episode* takes another character of which the motions are hidden except those that are known of the style, predicts
//! one of the hidden ones, and compares it with the true clip. Each candidate
//!
//! prediction = mean + β (content − mean) + α offset,
//!
//! with α, β of a small grid, gets its errors in all episodes. (α, β) = (1, 0) is the plain prediction. Another candidate
//! takes its place only if its mean error is lower by more than one standard error of the paired differences between characters (the
//! rule of Breiman et al. 1984 for choosing among models by cross-validation), so a library in which the prediction is right
//! loses nothing to chance. The moving part of the clip is decided in the same way, with the errors of `gaussian`'s
//! predictions of known clips.
//!
//! The errors of the episodes also say how sure the result is ([`Sure`]).
//!
//! Limits: at least [`LEAST`] other characters are needed; with fewer the plain prediction stays. The work is limited to [`WORK`] operations.

use super::basis::{Axes, COSINES};
use super::cells::Cells;
use super::kernels::Kernels;
use super::stance;
use std::collections::{BTreeMap, BTreeSet};

/// Values of α and β.
const OFFSET: [f64; 3] = [1.0, 0.5, 0.0];
const CONTENT: [f64; 5] = [0.0, 0.25, 0.5, 0.75, 1.0];
/// Fewest characters whose episodes are evidence.
pub(super) const LEAST: usize = 3;
/// Most episodes.
const MOST: usize = 60;
/// Most multiplications.
const WORK: f64 = 4e8;

/// How sure a translation is, from rehearsals on the library's other characters with as little known.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sure {
    /// Number of rehearsals.
    pub episodes: usize,
    /// Mean error of the posture that a character holds through a clip, over that of copying the content. Below 1 the
    /// translation tells more than the copy.
    pub of_copying: f64,
    /// What the change is added to (β): 0 the mean of all characters, 1 the content's own posture, else between them.
    pub content: f64,
    /// How much of the predicted change from the mean of all characters is made, 0 to 1 (α).
    pub offset: f64,
}

/// Squared distances of the candidates in one episode, and of the copy.
struct Episode {
    character: usize,
    candidates: Vec<f64>,
    copy: f64,
}

/// α and β of all candidates, the plain prediction first.
fn candidates() -> Vec<(f64, f64)> {
    OFFSET.iter().flat_map(|&a| CONTENT.iter().map(move |&b| (a, b))).collect()
}

/// The candidate whose mean error is lowest, if it is clearly lower than that of the first. `errors` are those of the
/// candidates in each episode, with its character. Episodes of one character are not independent: their mean counts once.
fn choose(errors: &[(usize, Vec<f64>)]) -> usize {
    let count = errors.first().map_or(0, |(_, e)| e.len());
    let mut sums: BTreeMap<usize, (f64, Vec<f64>)> = BTreeMap::new();
    for (character, of_one) in errors {
        let sum = sums.entry(*character).or_insert_with(|| (0.0, vec![0.0; count]));
        sum.0 += 1.0;
        sum.1.iter_mut().zip(of_one).for_each(|(s, e)| *s += e);
    }
    let means: Vec<Vec<f64>> = sums.into_values().map(|(n, sum)| sum.iter().map(|s| s / n).collect()).collect();
    let n = means.len() as f64;
    let mean = |k: usize| means.iter().map(|e| e[k]).sum::<f64>() / n;
    let best = (0..count).min_by(|&a, &b| mean(a).total_cmp(&mean(b))).unwrap_or(0);
    let gain = mean(0) - mean(best);
    let variance = means.iter().map(|e| (e[0] - e[best] - gain).powi(2)).sum::<f64>() / (n - 1.0).max(1.0);
    if means.len() >= LEAST && gain > (variance / n).sqrt() { best } else { 0 }
}

/// Corrects the static part of a prediction, coefficients of the axes with the motion's mean included. `None` without
/// enough episodes; then nothing changes.
pub(super) fn judge(
    cells: &Cells,
    kernels: &Kernels,
    axes: &Axes,
    (style, motion, content): (usize, usize, usize),
    predicted: &mut [f64],
) -> Option<Sure> {
    let hold = |s: usize, m: usize| cells.known[s * cells.motions + m] && (s, m) != (style, motion);
    if !hold(content, motion) {
        return None;
    }
    let own: Vec<usize> = (0..cells.motions).filter(|&m| hold(style, m)).collect();
    let possible: Vec<(usize, usize)> = (0..cells.characters)
        .filter(|&a| a != style && a != content)
        .flat_map(|a| (0..cells.motions).map(move |b| (a, b)))
        .filter(|&(a, b)| hold(a, b) && hold(content, b) && own.iter().any(|&m| m != b && hold(a, m)))
        .collect();
    let size = (0..cells.characters * cells.motions).filter(|&k| cells.known[k]).count() as f64;
    let most = ((WORK / size.powi(3)) as usize).min(MOST);
    let step = possible.len().div_ceil(most.max(1)).max(1);
    let episodes: Vec<Episode> = possible
        .iter()
        .step_by(step)
        .take(most)
        .filter_map(|&(a, b)| {
            let keep = |s: usize, m: usize| hold(s, m) && (s != a || (m != b && own.contains(&m)));
            episode(cells, kernels, axes, (a, b, content), &keep)
        })
        .collect();
    let errors: Vec<(usize, Vec<f64>)> =
        episodes.iter().map(|e| (e.character, e.candidates.iter().map(|d| d.sqrt()).collect())).collect();
    if errors.iter().map(|e| e.0).collect::<BTreeSet<_>>().len() < LEAST {
        return None;
    }
    let best = choose(&errors);
    let (offset, share) = candidates()[best];
    let mean = cells.mean_of(motion, style);
    for (axis, value) in predicted.iter_mut().enumerate() {
        let base = mean[axis] + share * (cells.block(content, motion)[axis] - mean[axis]);
        *value = base + offset * (*value - mean[axis]);
    }
    let copy: f64 = episodes.iter().map(|e| e.copy.sqrt()).sum();
    let of_copying = if copy > 0.0 { errors.iter().map(|e| e.1[best]).sum::<f64>() / copy } else { 1.0 };
    Some(Sure { episodes: episodes.len(), of_copying, content: share, offset })
}

fn episode(
    cells: &Cells,
    kernels: &Kernels,
    axes: &Axes,
    (a, b, content): (usize, usize, usize),
    keep: &dyn Fn(usize, usize) -> bool,
) -> Option<Episode> {
    let mean = stance::mean(cells, b, keep);
    let found = stance::from(cells, kernels, axes, (a, b), keep)?;
    let (truth, copy) = (&cells.block(a, b)[..cells.axes], &cells.block(content, b)[..cells.axes]);
    let distance = |of: &dyn Fn(usize) -> f64| (0..cells.axes).map(|k| (of(k) - truth[k]).powi(2)).sum::<f64>();
    let candidates = candidates()
        .into_iter()
        .map(|(offset, share)| distance(&|k| mean[k] + share * (copy[k] - mean[k]) + offset * (found[k] - mean[k])))
        .collect();
    Some(Episode { character: a, candidates, copy: distance(&|k| copy[k]) })
}

/// How much of the moving part is to be the content's: β by the same rule. `errors` are those of the predictions of known
/// clips, by clip (character, motion): truth minus prediction in all coefficients.
pub(super) fn moving_share(cells: &Cells, content: usize, errors: &[((usize, usize), Vec<f64>)]) -> f64 {
    let moving = cells.axes..COSINES * cells.axes;
    let of_clip = |((s, m), error): &((usize, usize), Vec<f64>)| -> Option<(usize, Vec<f64>)> {
        if *s == content || !cells.known[content * cells.motions + m] {
            return None;
        }
        let (truth, copy) = (cells.block(*s, *m), cells.block(content, *m));
        let distance = |share: f64| {
            let one = |k: usize| ((1.0 - share) * error[k] + share * (truth[k] - copy[k])).powi(2);
            moving.clone().map(one).sum::<f64>().sqrt()
        };
        Some((*s, CONTENT.iter().map(|&share| distance(share)).collect()))
    };
    let errors: Vec<(usize, Vec<f64>)> = errors.iter().filter_map(of_clip).collect();
    CONTENT[choose(&errors)]
}

#[cfg(test)]
mod tests {
    use super::super::basis::MODEL_FRAMES;
    use super::super::grid::{Row, WIDTH};
    use super::*;

    const CHARACTERS: usize = 10;
    const MOTIONS: usize = 5;

    /// Clips without movement on three axes; `added` gives what a character adds to a motion. Of character 0 only motion 1 is
    /// known. Character 1 is the content.
    fn cells(added: impl Fn(usize, usize) -> [f64; 3]) -> Cells {
        let clip = |s: usize, m: usize| {
            let mut block = vec![0.0; COSINES * 3];
            block[..3].copy_from_slice(&added(s, m));
            block
        };
        Cells {
            characters: CHARACTERS,
            motions: MOTIONS,
            axes: 3,
            known: (0..CHARACTERS * MOTIONS).map(|k| k >= MOTIONS || k == 1).collect(),
            x: (0..CHARACTERS).map(|s| (0..MOTIONS).flat_map(|m| clip(s, m)).collect()).collect(),
        }
    }

    fn axes() -> Axes {
        Axes { vectors: [2, 3, 5].map(|at| std::array::from_fn(|d| f64::from(u8::from(d == at)))).into(), even: 2 }
    }

    fn judged(cells: &Cells) -> (Vec<f64>, Option<Sure>) {
        let mean = |m: usize| -> Row { std::array::from_fn(|d| if d == WIDTH - 1 { 0.1 * m as f64 } else { 0.0 }) };
        let kernels = Kernels::new(&(0..MOTIONS).map(|m| vec![mean(m); MODEL_FRAMES]).collect::<Vec<_>>());
        let mut predicted = stance::predict(cells, &kernels, &axes(), (0, 0)).unwrap();
        let sure = judge(cells, &kernels, &axes(), (0, 0, 1), &mut predicted);
        (predicted, sure)
    }

    /// A number from −1 to 1 that looks like chance.
    fn chance(s: usize, m: usize, axis: usize) -> f64 {
        (f64::sin((s * 71 + m * 37 + axis * 13 + 5) as f64) * 43_758.547).fract()
    }

    #[test]
    fn a_manner_that_goes_through_all_motions_is_trusted() {
        let cells = cells(|s, _| [0, 1, 2].map(|axis| chance(s, 0, axis)));
        let (found, sure) = judged(&cells);
        let sure = sure.unwrap();
        assert_eq!((sure.offset, sure.content), (1.0, 0.0));
        assert!(sure.of_copying < 0.7, "{sure:?}");
        let off = |from: &dyn Fn(usize) -> f64| (0..3).map(|k| (from(k) - chance(0, 0, k)).powi(2)).sum::<f64>();
        assert!(off(&|k| found[k]) < 0.5 * off(&|k| chance(1, 0, k)));
    }

    #[test]
    fn where_all_do_something_else_in_each_motion_the_content_is_kept() {
        // The content does each motion plainly; the others add anything.
        let cells = cells(|s, m| [0, 1, 2].map(|axis| if s == 1 { 0.0 } else { chance(s, m, axis) }));
        let (found, sure) = judged(&cells);
        let sure = sure.unwrap();
        assert!(sure.content >= 0.5 && sure.offset < 1.0, "{sure:?}");
        assert!(sure.of_copying < 1.02, "{sure:?}");
        assert!(found.iter().all(|v| v.abs() < 0.4), "{found:?}");
    }

    #[test]
    fn without_others_nothing_changes() {
        let mut cells = cells(|s, m| [chance(s, m, 0), 0.0, 0.0]);
        cells.known[2 * MOTIONS..].fill(false);
        let (found, sure) = judged(&cells);
        assert_eq!(sure, None);
        assert!(found.iter().all(|v| v.is_finite()));
    }

    #[test]
    fn movement_is_the_content_s_where_that_predicts_the_others_better() {
        let mut cells = cells(|_, _| [0.0; 3]);
        for s in 0..CHARACTERS {
            for k in 0..MOTIONS * COSINES * 3 {
                cells.x[s][k] += 0.1 * chance(s, k, 1);
            }
        }
        let share = |error: f64| {
            let of = |s: usize, m: usize| ((s, m), vec![error; COSINES * 3]);
            let errors: Vec<_> = (2..CHARACTERS).flat_map(|s| (0..MOTIONS).map(move |m| of(s, m))).collect();
            moving_share(&cells, 1, &errors)
        };
        assert_eq!(share(0.0), 0.0);
        assert!(share(1.0) > 0.7, "{}", share(1.0));
    }
}
