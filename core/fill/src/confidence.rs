//! How probable it is that the colour of a region is right.
//!
//! A carried colour fails in a few ways. Each leaves a trace, and each trace is a number. The probability is a logistic regression on them.
//! With M the probability that the region is a region of a source ([`crate::relax`]), and c the region's colour:
//!
//! | evidence | what it is | what it says |
//! | --- | --- | --- |
//! | clear | −ln(1 + 0.001 − (1 − n) s), with s the share of c in all colours that a source gives the region, and n the share in M of regions that the artist left without paint; the mean of the sources, with the largest n | other colours are nearly as good, or a source contradicts, or the artist said nothing of such a region |
//! | around | the logit of the colour's probability in the regions around, weighted by their share of the border | what is around is not known well either, so neighbours could not help |
//! | crowd | the logarithm of Σ M over all regions of the drawing, for the source's region of colour c that the region is most probably; the mean of the sources | many regions want to be the same one, and most of them are wrong |
//! | past | 1 − n times the confidence of the source's regions of colour c, weighted by M; the least of the sources | a mistake goes on |
//!
//! A source that is [silent](mod@crate::carry) about a region, since the artist corrected it, does not count for that region.
//!
//! # Why these
//!
//! They were chosen from about fifty numbers, each time the one that lowered the loss most on films that were left out of the fit, until the next ones
//! added little. Not among them are how well the region meets the source's one, how far it moved and how much that
//! differs from its neighbours, its size, how many drawings away the clicks are, and whether a gap was closed in it: beside the four they add less than a hundredth to the loss.
//!
//! n is a factor, since what is said of painted regions says nothing of the others. As a value of its own it was outweighed by the others, and an
//! unpainted disc among few colours was given 0.67. As a factor of the first value alone it has the least loss, but the disc was given 0.51.
//!
//! `tests/fill_confidence.py` makes the fit, and prints how well it holds on each film that it did not see.
//!
//! # Regions of two colours
//!
//! The regression knows regions that have one true colour. A region that leaks through a wide gap, or in place of a line that is
//! gone, has none: whatever it is given is wrong in part. If s is the share of it that came from things of other colours, which are nowhere else now,
//! by all sources, it has at most 1 − (s / 0.15)². So a closed eye costs a face little, and a figure that has run into the sky makes the sky doubtful.
//!
//! # Witnesses
//!
//! A mistake would become surer from drawing to drawing: each shows rightly who is who on the last one, so all but the mistake itself speaks for it. But a source
//! cannot know a colour better than it has it. So the sources are witnesses: each one's word is worth (1 − n) s p, with p the past by this source alone, and a colour is at
//! most as sure as the word of its best witness. What the clicked drawing says too may become surer again. What the last drawing alone says
//! cannot.
//!
//! # Limits
//!
//! What is wrong and looks right in every way is given a high confidence: a left leg that all sources take for the right one. A drawing
//! that is far from all others makes most regions doubtful, the right ones too.

use crate::evidence::Evidence;
use crate::layout::Layout;
use crate::page::Paint;
use crate::said::Said;

/// The regression's intercept and slopes.
const INTERCEPT: f64 = -2.82;
const SLOPES: Evidence = [0.69, 0.28, -0.37, 0.91];
/// The share of other colours from which a region has no single right one.
const MIXED: f64 = 0.15;
/// Keeps logarithms finite.
const SHARE: f64 = 1e-3;

/// The probability that a colour is right.
pub fn probability(evidence: &Evidence) -> f64 {
    let odds = INTERCEPT + SLOPES.iter().zip(evidence).map(|(slope, value)| slope * value).sum::<f64>();
    1.0 / (1.0 + (-odds).exp())
}

/// The most that a region can have of which this share came from things of other colours that are nowhere else.
pub(crate) fn of_one_colour(swallowed: f64) -> f64 {
    1.0 - (swallowed / MIXED).min(1.0).powi(2)
}

/// For each region what the word of its best witness is worth: no colour is surer than that. 0 for what is not painted.
pub(crate) fn witnessed(known: &[Said], paint: &Paint) -> Vec<f64> {
    let of = |region: usize| {
        let colour = paint.colour(region)?;
        let worth = |said: &Said| {
            let heard = hear(said, &[], region, colour);
            heard.painted * heard.share * heard.past
        };
        Some(known.iter().filter(|said| said.hears(region)).map(worth).fold(0.0, f64::max))
    };
    (0..paint.colours.len()).map(|region| of(region).unwrap_or(0.0)).collect()
}

/// The evidence about each region of a drawing, by what the sources said; `None` for what is not painted.
pub(crate) fn evidence(known: &[Said], layout: &Layout, paint: &Paint) -> Vec<Option<Evidence>> {
    let claims: Vec<Vec<f64>> = known.iter().map(claims).collect();
    let colours: Vec<Option<usize>> = (0..layout.figures.len()).map(|region| paint.colour(region)).collect();
    let sure: Vec<f64> =
        colours.iter().zip(&paint.colours).map(|(c, row)| logit(c.map_or(0.0, |c| f64::from(row[c])))).collect();
    let of = |region: usize| {
        let colour = colours[region]?;
        let loud = known.iter().zip(&claims).filter(|(said, _)| said.hears(region));
        let all: Vec<Heard> = loud.map(|(said, claims)| hear(said, claims, region, colour)).collect();
        let mean = |value: fn(&Heard) -> f64| all.iter().map(value).sum::<f64>() / all.len() as f64;
        let least = |value: fn(&Heard) -> f64| all.iter().map(value).fold(f64::INFINITY, f64::min);
        let painted = least(|heard| heard.painted);
        let around = layout.borders[region].iter().filter(|(other, _)| colours[*other].is_some());
        Some([
            all.iter().map(|heard| -(1.0 - painted * heard.share + SHARE).ln()).sum::<f64>() / all.len() as f64,
            weighted(around.map(|&(other, share)| (f64::from(share), sure[other]))).unwrap_or(sure[region]),
            mean(|heard| heard.claims.max(SHARE).ln()),
            painted * least(|heard| heard.past),
        ])
    };
    (0..layout.figures.len()).map(of).collect()
}

/// What a source says about a region and its colour.
struct Heard {
    share: f64,
    claims: f64,
    past: f64,
    /// The share of regions with paint among those that it may be.
    painted: f64,
}

fn hear(said: &Said, claims: &[f64], region: usize, colour: usize) -> Heard {
    let sums = &said.colours[region];
    let total: f32 = sums.iter().sum();
    let sure = &said.relaxed.sure[region];
    let alike: Vec<usize> = (1..sure.len()).filter(|&i| said.paint.colour(i) == Some(colour)).collect();
    let past = weighted(alike.iter().map(|&i| (f64::from(sure[i]), said.paint.confidence[i])));
    // Of equal ones the first is taken.
    let best = alike.iter().rev().copied().max_by(|&a, &b| sure[a].total_cmp(&sure[b]));
    Heard {
        share: if total > 0.0 { f64::from(sums[colour] / total) } else { 0.0 },
        claims: best.and_then(|best| claims.get(best)).copied().unwrap_or(0.0),
        past: past.unwrap_or(0.0),
        painted: 1.0 - f64::from(said.unpainted[region]),
    }
}

/// For each region of a source, how many regions of the drawing want to be it.
fn claims(said: &Said) -> Vec<f64> {
    let mut claims = vec![0.0; said.paint.colours.len()];
    for row in said.relaxed.sure.iter().skip(1) {
        claims.iter_mut().zip(row).for_each(|(sum, sure)| *sum += f64::from(*sure));
    }
    claims
}

/// The mean of values by their weights; `None` without weight.
fn weighted(values: impl Iterator<Item = (f64, f64)>) -> Option<f64> {
    let (total, sum) = values.fold((0.0, 0.0), |(total, sum), (weight, value)| (total + weight, sum + weight * value));
    (total > 0.0).then(|| sum / total)
}

fn logit(share: f64) -> f64 {
    ((share + SHARE) / (1.0 - share + SHARE)).ln()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::evidence::NAMES;
    use crate::meet::Table;
    use crate::regions::Regions;
    use crate::relax::Relaxed;
    use rototoon_base::scene::Raster;

    /// Paper with two boxes, of which the second and third region border on the paper alone.
    fn layout() -> Layout {
        let boxed = |x: usize, y: usize, middle: usize| x.abs_diff(middle).max(y.abs_diff(30)) == 12;
        Layout::new(&Regions::new(&Raster::from_fn(120, 60, |x, y| boxed(x, y, 30) || boxed(x, y, 80))))
    }

    /// Three regions of two colours: the boxes have one colour.
    fn painted() -> Paint {
        let mut paint = Paint::nothing(3, 2);
        for (region, colour) in [(1, 0), (2, 1), (3, 1)] {
            paint.colours[region][colour] = 1.0;
            paint.confidence[region] = 1.0;
        }
        paint
    }

    /// A source that says of the regions 1 to 3 that they are by `sure` its own regions 1 to 3.
    fn said(paint: &Paint, sure: [[f32; 3]; 3]) -> Said<'_> {
        let row = |row: [f32; 3]| [0.0].into_iter().chain(row).collect::<Vec<f32>>();
        let sure: Table = std::iter::once(vec![0.0; 4]).chain(sure.into_iter().map(row)).collect();
        let colours = sure.iter().map(|row| vec![row[1], row[2] + row[3]]).collect();
        Said {
            paint,
            relaxed: Relaxed { all: sure.clone(), sure },
            colours,
            unpainted: vec![0.0; 4],
            silent: vec![0.0; 4],
        }
    }

    const CLEAR: [[f32; 3]; 3] = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];

    /// The evidence of region 2, whose colour is 1.
    fn of_box(known: &[Said]) -> Evidence {
        evidence(known, &layout(), &painted())[2].unwrap()
    }

    /// Asserts that the confidence falls and that one piece of evidence changed most.
    fn worse(name: &str, before: &Evidence, after: &Evidence) {
        let k = NAMES.iter().position(|own| *own == name).unwrap();
        let changes = (before[k] - after[k]) * SLOPES[k];
        assert!(changes > 0.05, "{name}: {} to {}", before[k], after[k]);
        let (high, low) = (probability(before), probability(after));
        assert!(low < high - 0.001, "{name}: {high} to {low}");
    }

    #[test]
    fn what_is_clear_is_sure() {
        let paint = painted();
        let clear = of_box(&[said(&paint, CLEAR)]);
        let [most, around, crowd, past] = clear;
        assert!(most > 6.8 && around > 6.8 && crowd.abs() < 1e-6, "{clear:?}");
        assert_eq!(past, 1.0);
        assert!(probability(&clear) > 0.9, "{}", probability(&clear));
        assert_eq!(evidence(&[said(&paint, CLEAR)], &layout(), &Paint::nothing(3, 2)), vec![None; 4]);
    }

    #[test]
    fn each_doubt_lowers_the_confidence() {
        let paint = painted();
        let clear = of_box(&[said(&paint, CLEAR)]);
        let with = |row: [f32; 3]| of_box(&[said(&paint, [CLEAR[0], row, CLEAR[2]])]);
        worse("clear", &clear, &with([0.4, 0.6, 0.0]));
        worse("crowd", &clear, &with([0.0, 0.0, 1.0]));
        let opposed = [said(&paint, CLEAR), said(&paint, [CLEAR[0], [0.9, 0.1, 0.0], CLEAR[2]])];
        worse("clear", &clear, &of_box(&opposed));
        let mut doubted = painted();
        doubted.confidence[2] = 0.3;
        worse("past", &clear, &of_box(&[said(&paint, CLEAR), said(&doubted, CLEAR)]));
        let mut bare = said(&paint, CLEAR);
        bare.unpainted[2] = 1.0;
        let unknown = of_box(&[bare]);
        worse("clear", &clear, &unknown);
        assert!(probability(&unknown) < 0.5, "{}", probability(&unknown));
    }

    #[test]
    fn no_colour_is_surer_than_the_word_of_its_best_witness() {
        let (clicked, mut last) = (painted(), painted());
        last.confidence[2] = 0.6;
        let word = |key: [f32; 3]| {
            let known = [said(&clicked, [CLEAR[0], key, CLEAR[2]]), said(&last, CLEAR)];
            (witnessed(&known, &painted())[2], probability(&of_box(&known)))
        };
        // The clicked drawing takes it for the paper. Then it is as sure as it was on the last one.
        let (worth, alone) = word([0.9, 0.1, 0.0]);
        assert!((worth - 0.6).abs() < 1e-6 && alone > 0.8, "{worth}, {alone}");
        assert!((word([0.0, 1.0, 0.0]).0 - 1.0).abs() < 1e-6, "what the clicked drawing says too is surer again");
        assert_eq!(witnessed(&[said(&clicked, CLEAR)], &Paint::nothing(3, 2)), [0.0; 4]);
    }

    #[test]
    fn a_region_of_two_colours_is_bounded() {
        assert_eq!([of_one_colour(0.0), of_one_colour(MIXED), of_one_colour(0.8)], [1.0, 0.0, 0.0]);
        assert!((of_one_colour(MIXED / 3.0) - 8.0 / 9.0).abs() < 1e-12, "a closed eye costs a face little");
    }

    #[test]
    fn doubts_about_neighbours_count() {
        let (source, mut drawn) = (painted(), painted());
        let known = [said(&source, CLEAR)];
        let before = evidence(&known, &layout(), &drawn)[2].unwrap();
        drawn.colours[1] = vec![0.6, 0.4];
        let after = evidence(&known, &layout(), &drawn)[2].unwrap();
        worse("around", &before, &after);
        assert_eq!(before[0], after[0], "its own colour is as clear as before");
    }
}
