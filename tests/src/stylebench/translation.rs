//! Measures the error of translation by preset and rank.
//!
//! Sixteen clips, spread evenly over those of all characters except the content's, are left out in turn. Each is made from
//! the other clips and compared with the true clip. The error is the mean distance of the sixteen key points other than the
//! pelvis, with the pelvises on each other, in torso lengths.

use anyhow::{Context, Result, bail};
use rayon::iter::{IntoParallelRefIterator, ParallelIterator};
use rototoon::geometry::Point;
use rototoon::project::clips::Clips;
use rototoon::scene::clip::resample;
use rototoon::scene::proportions::typical_torso;
use rototoon::scene::skeleton::{COUNT, Posture};
use rototoon::scene::{Clip, Silent, Template};
use rototoon::style::{Options, Preset, Request, translate};
use serde::Serialize;

/// The ranks to measure.
const RANKS: [usize; 7] = [1, 2, 4, 6, 10, 16, 24];
/// Most clips that are left out in turn. With all clips the factorisations would take an hour.
const MOST: usize = 16;

/// The mean error of a preset with a rank.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Translated {
    /// Id of the preset; "copy" for the unchanged content.
    pub preset: &'static str,
    /// The rank; `None` if the preset has no rank.
    pub rank: Option<usize>,
    /// Mean distance in torso lengths.
    pub error: f64,
}

/// Measures all presets, those with a rank once for each rank.
pub fn measure(clips: &Clips, content: Option<&str>) -> Result<Vec<Translated>> {
    let clips = &clips.clips;
    let first = clips.first().context("clips: found none, expected several characters and motions")?;
    let content = content.unwrap_or_else(|| match clips.iter().any(|clip| clip.character == "normal") {
        true => "normal",
        false => &first.character,
    });
    let has = |clip: &Clip| clips.iter().any(|other| other.character == content && other.motion == clip.motion);
    let truths: Vec<&Clip> = clips.iter().filter(|clip| clip.character != content && has(clip)).collect();
    if truths.is_empty() {
        bail!("clips: found no other character's clip of a motion by {content:?}, expected at least one");
    }
    let truths: Vec<&Clip> =
        (0..truths.len().min(MOST)).map(|k| truths[k * truths.len() / truths.len().min(MOST)]).collect();
    let mean = |errors: Vec<Result<f64>>| -> Result<f64> {
        let count = errors.len() as f64;
        Ok(errors.into_iter().collect::<Result<Vec<f64>>>()?.iter().sum::<f64>() / count)
    };
    let mut found = Vec::new();
    let copied = truths.iter().map(|truth| {
        let of_content = clips.iter().find(|clip| clip.character == content && clip.motion == truth.motion);
        distance(of_content.context("the content's clip")?, truth)
    });
    found.push(Translated { preset: "copy", rank: None, error: mean(copied.collect())? });
    let one = |truth: &Clip, options: &Options| -> Result<f64> {
        let request = Request { style: &truth.character, motion: &truth.motion, content, keys: &[] };
        let made = translate(clips, &request, options, &Silent)?;
        distance(&made, truth)
    };
    for (preset, _, which) in Preset::ALL {
        let ranks: Vec<Option<usize>> = match which {
            Preset::Rototoon => vec![None],
            _ => RANKS.map(Some).to_vec(),
        };
        for rank in ranks {
            let options = Options { preset: which, rank, keep_contacts: false, ..Options::default() };
            let errors = truths.par_iter().map(|truth| one(truth, &options)).collect();
            found.push(Translated { preset, rank, error: mean(errors)? });
        }
    }
    Ok(found)
}

/// Mean distance of key points, with the pelvises on each other, in torso lengths of the truth.
fn distance(made: &Clip, truth: &Clip) -> Result<f64> {
    let human = |clip: &Clip| clip.human().with_context(|| format!("{:?}: a human clip", clip.character));
    Ok(apart(&human(made)?, &human(truth)?))
}

fn apart(made: &[Posture], truth: &[Posture]) -> f64 {
    let sizes: Vec<Vec<Point>> = truth.iter().copied().map(Vec::from).collect();
    let size = typical_torso(&Template::human(), &sizes).max(f64::MIN_POSITIVE);
    let made = resample(made, truth.len());
    let apart = |a: &Posture, b: &Posture| {
        (1..COUNT).map(|k| (a[k] - a[0]).distance(b[k] - b[0])).sum::<f64>() / (COUNT - 1) as f64
    };
    made.iter().zip(truth).map(|(a, b)| apart(a, b)).sum::<f64>() / (truth.len() as f64 * size)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn distances_are_in_torso_lengths_from_the_pelvis() {
        let truth: Posture = std::array::from_fn(|k| Point::new(0.0, -2.0 * k as f64));
        let moved = truth.map(|p| p + Point::new(5.0, 5.0));
        assert_eq!(apart(&[moved], &[truth]), 0.0);
        let mut hand = truth;
        hand[7] += Point::new(0.0, 4.0);
        assert_eq!(apart(&[hand], &[truth]), 1.0 / 16.0);
    }

    #[test]
    fn clips_without_a_counterpart_are_refused() {
        let clip = Clip::new("a", "walk", vec![[Point::ZERO; COUNT]]);
        assert!(measure(&Clips { clips: vec![], fps: 1.0 }, None).is_err());
        assert!(measure(&Clips { clips: vec![clip], fps: 1.0 }, None).is_err());
    }
}
