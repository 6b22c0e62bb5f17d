//! The clip's postures as those of the drawing's body: retargeted if the clip is of another body, and mirrored if it looks to
//! the other side.
//!
//! A clip of another body is first mirrored to look as its own template does, then retargeted, then mirrored to look as the
//! drawing does. A clip on a drawing whose own motion it is stays as it is.

use super::{Mirror, PipelineError, ReshapeJob, Sides, wrong};
use crate::geometry::Point;
use crate::reshape::facing::{mirrored, of_clip, of_drawing, typical};
use crate::reshape::fit::{Shown, is_own};
use crate::reshape::foot::Foot;
use crate::reshape::retarget::{RetargetError, retarget};

/// A clip for the drawing's body.
pub(super) struct Moves {
    /// Its postures, in the clip's unit.
    pub postures: Vec<Vec<Point>>,
    /// Chains that nothing moves.
    pub still: Vec<String>,
    /// For each key point whether the clip moves the bone that ends in it.
    pub moved: Vec<bool>,
    /// Whether it was mirrored.
    pub mirrored: bool,
    /// To which sides drawing and clip look, if that decided it.
    pub sides: Option<Sides>,
}

/// The job's clip for the body of a drawing with these feet.
pub(super) fn moves(known: &Shown, feet: &[Foot], job: &ReshapeJob) -> Result<Moves, PipelineError> {
    let (clip, template) = (job.clip, &known.template);
    let sides = Sides {
        drawing: of_drawing(template, &known.postures, |k| known.told[k], feet),
        clip: of_clip(&clip.template, &clip.postures),
    };
    let same = clip.template.same_points(template) && job.chains.is_empty();
    let auto = job.mirror == Mirror::Auto && !(same && is_own(known, &clip.postures));
    let looks = [sides.clip.unwrap_or(typical(&clip.template)), sides.drawing.unwrap_or(typical(template))];
    // Whether the clip is mirrored before it is retargeted, and after.
    let (before, after) = match (auto, same) {
        (true, true) => (false, sides.clip.is_some() && sides.drawing.is_some() && looks[0] != looks[1]),
        (true, false) => (looks[0] != typical(&clip.template), looks[1] != typical(template)),
        (false, _) => (false, job.mirror == Mirror::On),
    };
    let flipped = |postures: Vec<Vec<Point>>, flip: bool| if flip { mirrored(&postures) } else { postures };
    let mut given = clip.clone();
    given.postures = flipped(given.postures, before);
    let (postures, still, moved) = if same {
        (given.postures, Vec::new(), vec![true; template.len()])
    } else {
        let made = retarget(&given, template, &job.chains).map_err(failed)?;
        (made.clip.postures, made.still, made.moved)
    };
    let postures = flipped(postures, after);
    Ok(Moves { postures, still, moved, mirrored: before != after, sides: auto.then_some(sides) })
}

/// A failed retargeting. Pairs that do not fit the bodies are the fault of the option.
fn failed(error: RetargetError) -> PipelineError {
    let text = error.to_string();
    match (error, text.strip_prefix("chains: ")) {
        (RetargetError::Chain { .. } | RetargetError::Twice { .. }, Some(reason)) => {
            PipelineError::option("chains", reason)
        }
        _ => wrong(text),
    }
}
