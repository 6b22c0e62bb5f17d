//! The frame on which a breakdown helps most, with the footage as a line test where there is one.

use super::{PipelineError, memory};
use crate::lines::apart::{Apart, Shown as Seen, most};
use crate::pictures::Sequence;
use crate::scene::{FrameNumber, FrameSource, Progress};
use crate::tween::breakdown::{Breakdown, Reason, Shown, suggest};
use serde_json::{Value, json};

/// Mean distance of the keys' lines from the pictures, as a share of the largest distance, above which the pictures do
/// not show these drawings. Lines that have nothing to do with a picture are near something by chance: about half.
const FOREIGN: f64 = 0.35;

/// A suggestion, and what the pictures said.
#[derive(Clone, Debug, PartialEq)]
pub struct Suggestion {
    /// The frame.
    pub breakdown: Breakdown,
    /// By frame, for keys and in-betweens with a picture: their distance from it in pixels.
    pub looked: Vec<(FrameNumber, f64)>,
    /// How far the keys are from their pictures in pixels, if they are so far that the pictures show something else.
    /// Then they count for nothing.
    pub foreign: Option<f64>,
}

/// Suggests a frame for a breakdown. `drawings` are keys and in-betweens in time order, without distances. Frames of the
/// footage without a file are frames without a picture. `None` where nothing lies between two keys. It runs on the
/// caller's rayon pool; the result does not depend on the pool.
///
/// # Errors
///
/// A picture that cannot be read; not enough memory; or [`PipelineError::Cancelled`].
pub fn suggest_breakdown(
    mut drawings: Vec<Shown>,
    pictures: Option<&Sequence>,
    progress: &dyn Progress,
) -> Result<Option<Suggestion>, PipelineError> {
    let found = match pictures {
        Some(pictures) => look(&drawings, pictures, progress)?,
        None => vec![None; drawings.len()],
    };
    let limit = pictures.map_or(0.0, |pictures| FOREIGN * most(pictures.footage().height));
    let foreign = off_keys(&drawings, &found).filter(|&far| far > limit);
    if foreign.is_none() {
        drawings.iter_mut().zip(&found).for_each(|(own, apart)| own.apart = apart.map(|apart| apart.both()));
    }
    progress.report("comparing with the footage", 1.0)?;
    let looked = drawings.iter().zip(&found).filter_map(|(own, apart)| Some((own.frame, apart.as_ref()?.both())));
    let looked = looked.collect();
    Ok(suggest(&drawings).map(|breakdown| Suggestion { breakdown, looked, foreign }))
}

/// By drawing its distances from its picture.
fn look(drawings: &[Shown], pictures: &Sequence, progress: &dyn Progress) -> Result<Vec<Option<Apart>>, PipelineError> {
    let footage = pictures.footage();
    let has = |frame: FrameNumber| (footage.first..=footage.last).contains(&frame) && pictures.path(frame).is_file();
    if drawings.iter().any(|own| has(own.frame)) {
        memory::to_trace(footage)?;
    }
    let mut found = Vec::with_capacity(drawings.len());
    for (k, own) in drawings.iter().enumerate() {
        progress.report("comparing with the footage", k as f64 / drawings.len() as f64)?;
        let lines = own.strokes.iter().map(|stroke| (&stroke.points[..], stroke.closed));
        found.push(match has(own.frame) {
            true => Seen::new(&*pictures.picture(own.frame)?).apart(lines),
            false => None,
        });
    }
    Ok(found)
}

/// The mean distance from the keys' lines to what the pictures show.
fn off_keys(drawings: &[Shown], found: &[Option<Apart>]) -> Option<f64> {
    let keys = drawings.iter().zip(found).filter(|(own, _)| own.key);
    let far: Vec<f64> = keys.filter_map(|(_, apart)| Some(apart.as_ref()?.drawn)).collect();
    (!far.is_empty()).then(|| far.iter().sum::<f64>() / far.len() as f64)
}

impl Suggestion {
    /// The suggestion in a sentence.
    pub fn sentence(&self) -> String {
        let Breakdown { frame, first, last, reason } = self.breakdown;
        let place = format!("frame {frame}, between the keys {first} and {last}");
        match (reason, self.foreign) {
            (Reason::Picture { apart, keys }, _) => {
                format!("{place}: the in-between is {apart:.1} px off the picture, the keys {keys:.1} px")
            }
            (Reason::Movement { .. }, Some(far)) => format!(
                "{place}: the middle of the span that moves most. The pictures show something else: the keys are \
                 {far:.1} px off them"
            ),
            (Reason::Movement { .. }, None) => {
                format!("{place}: the middle of the span that moves most. No picture shows the movement")
            }
        }
    }

    /// The suggestion as JSON: `frame`, `first`, `last`, `by` ("picture" or "movement"), `distance`, `keys`, `foreign`,
    /// `looked` and `text`.
    pub fn to_json(&self) -> Value {
        let short = |v: f64| (v * 1e4).round() / 1e4;
        let Breakdown { frame, first, last, reason } = self.breakdown;
        let (by, distance, keys) = match reason {
            Reason::Picture { apart, keys } => ("picture", apart, Some(short(keys))),
            Reason::Movement { path } => ("movement", path, None),
        };
        let looked: Vec<Value> = self.looked.iter().map(|&(frame, far)| json!([frame, short(far)])).collect();
        json!({"frame": frame, "first": first, "last": last, "by": by, "distance": short(distance), "keys": keys,
            "foreign": self.foreign.map(short), "looked": looked, "text": self.sentence()})
    }
}
