//! A colour of paint that becomes another one on some frames, written into a document.
//!
//! The entry goes behind all others of the field `recolours`, and painted regions that are there already change at once: an entry changes what the ones
//! before it have left, which is what these regions show. So nothing has to be painted again. To take an entry away is another matter: which regions had
//! the old colour is known only to [`super::fill()`], which paints them again.

use super::PipelineError;
use super::fill::field;
use crate::project::fills::{FillClick, FilledRegion, Hue};
use crate::project::recolours::{Recolour, Recolours};
use crate::project::{Document, FieldError, Problems};

/// The most colours that a message names.
const NAMED: usize = 12;

/// Adds an entry to a document, and changes the painted regions that it has. Returns their number.
///
/// # Errors
///
/// [`PipelineError::Field`] for fields that cannot be read.
pub fn recolour(document: &mut Document, entry: &Recolour) -> Result<usize, PipelineError> {
    let mut filled = document.filled().map_err(|error| field(&error))?;
    document.recolours().map_err(|error| field(&error))?;
    let next = filled.iter().flat_map(|own| &own.regions).map(|region| region.track + 1).max().unwrap_or(0);
    let counts = Recolours::new(vec![entry.clone()], &[]).change(&mut filled, next);
    document.add_recolour(entry).map_err(|error| field(&error))?;
    let changed = counts.iter().sum();
    if changed > 0 {
        document.recolour_filled(&filled).map_err(|error| field(&error))?;
    }
    Ok(changed)
}

/// The colours of a document's paint, each once: those of clicks, of painted regions, and those that others become.
///
/// # Errors
///
/// [`PipelineError::Field`] for fields that cannot be read.
pub fn colours(document: &Document) -> Result<Vec<Hue>, PipelineError> {
    known(document, usize::MAX).map_err(|error| field(&error))
}

/// The colours of clicks and what they mean, of painted regions, and of the first few entries.
fn known(document: &Document, entries: usize) -> Result<Vec<Hue>, FieldError> {
    let (mut clicks, filled, recolours) = (document.fills()?, document.filled()?, document.recolours()?);
    let mut meant = clicks.clone();
    meant.iter_mut().for_each(|own| recolours.mean(own));
    clicks.extend(meant);
    let clicked = clicks.iter().flat_map(|own| &own.clicks).filter_map(FillClick::hue);
    let painted = filled.iter().flat_map(|own| &own.regions).map(FilledRegion::hue);
    let made = recolours.list().iter().take(entries).map(|entry| entry.to.clone());
    let mut found: Vec<Hue> = Vec::new();
    for hue in clicked.chain(made).chain(painted) {
        if !found.iter().any(|own| own.is_same(&hue)) {
            found.push(hue);
        }
    }
    Ok(found)
}

/// Colours in words, for messages.
pub fn named(colours: &[Hue]) -> String {
    let mut names: Vec<String> = colours.iter().take(NAMED).map(ToString::to_string).collect();
    match colours.len() {
        0 => return "no colour".into(),
        all if all > NAMED => names.push(format!("{} more", all - NAMED)),
        _ => {}
    }
    names.join(", ")
}

/// Warns of entries without effect.
pub(super) fn problems(document: &Document, problems: &mut Problems) -> Result<(), FieldError> {
    let footage = &document.scene.footage;
    for (k, entry) in document.recolours()?.list().iter().enumerate() {
        let colours = known(document, k)?;
        if !colours.iter().any(|own| own.is_same(&entry.from)) {
            let told = format!("no click and no region has the colour {}, so it has no effect", entry.from);
            problems.warning(format!("recolours[{k}].from"), format!("{told}; the paint has {}", named(&colours)));
        }
        let beyond = entry.first.is_some_and(|first| first > footage.last)
            || entry.last.is_some_and(|last| last < footage.first);
        if beyond {
            let (first, last) = (footage.first, footage.last);
            problems
                .warning(format!("recolours[{k}]"), format!("it holds on no frame of the footage, {first} to {last}"));
        }
    }
    Ok(())
}
