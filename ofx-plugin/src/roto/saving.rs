//! *Save*: writes the composition's shapes to the project's file, but not over what another program wrote there.
//!
//! A composition holds its shapes for days, on several machines, while the file that they were taken from may get other ones. So the hidden text `state` names
//! the file and has a mark of what it held when the shapes were taken ([`FileMark`]). Undo and redo change the shapes and the mark together: shapes that come back never take a file
//! for theirs that was written since. What *Save* itself wrote is noted in the hidden text `saved`, which is no step of undo, because undo takes no file back. A
//! file that holds neither was written by another program. It stays as it is, and the shapes go into a new file beside it.
//!
//! Limits: a file from which no shapes were taken is replaced, because the user chose its name. Compositions of earlier versions have no marks until they load
//! or save. Hosts that do not know parameters without undo make a step of *Save*.

use super::buttons::{chosen, foreign};
use super::instance::{NO_SHAPES, ORIGIN};
use super::state::FileMark;
use super::{footage, instance, stored};
use crate::ofx::{Effect, Failure};
use rototoon::pipeline::unchanged::{self, Mark};
use rototoon::project::Document;
use rototoon::project::path::real;
use serde::{Deserialize, Serialize};
use std::path::Path;

/// Most files of which a node notes what it saved.
const MOST_SAVED: usize = 16;

/// Writes the composition's shapes to the project's file. Footage below the file's folder gets a relative path.
pub fn save(effect: &Effect) -> Result<(), Failure> {
    let path = chosen(effect)?;
    if foreign(&path).is_some() {
        let shown = path.display();
        return Err(Failure::Told(format!(
            "project: found {shown}, expected a project document; Export writes other files"
        )));
    }
    let (instance, parameters) = (instance(effect)?, effect.parameters()?);
    let told = |error: &dyn std::fmt::Display| Failure::Told(error.to_string());
    let text = document(&parameters.text(c"document")?, &path)?.to_save(&path).map_err(|error| told(&error))?;
    let mut saved = notes(&parameters.text(c"saved")?);
    let from = instance.state(&parameters)?.read.clone();
    let known = marks(from.iter().chain(saved.iter().map(|saved| &saved.file)), &path);
    let mark = unchanged::replace(&path, &text, &known).map_err(|error| told(&error))?;
    saved.retain(|saved| !is_same(&saved.file.path, &path));
    let file = FileMark { path: path.to_string_lossy().into_owned(), mark: mark.to_string() };
    saved.push(Saved { file, from });
    saved.drain(..saved.len().saturating_sub(MOST_SAVED));
    parameters.set_text(c"saved", &serde_json::to_string(&saved).unwrap_or_default())
}

/// What is noted of a file that was saved.
#[derive(Clone, Debug, Serialize, Deserialize)]
struct Saved {
    #[serde(flatten)]
    file: FileMark,
    /// The document that the shapes were taken from. Shapes of another one are no later state of what was saved.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    from: Option<FileMark>,
}

/// Whether a file holds an earlier state of the composition's shapes, because they were saved to it.
pub fn has_saved(effect: &Effect, path: &Path) -> Result<bool, Failure> {
    let parameters = effect.parameters()?;
    let Ok(state) = instance(effect)?.state(&parameters) else { return Ok(false) };
    let ours = |saved: &Saved| is_same(&saved.file.path, path) && saved.from == state.read;
    Ok(notes(&parameters.text(c"saved")?).iter().any(ours))
}

/// The document to write, from the composition's text.
fn document(text: &str, path: &Path) -> Result<Document, Failure> {
    if text.trim().is_empty() {
        return Err(Failure::Told(NO_SHAPES.into()));
    }
    let json = stored::decode(text).map_err(|error| Failure::Told(format!("{ORIGIN}: {error}")))?;
    let mut document = Document::parse(&json, ORIGIN).map_err(|error| Failure::Told(error.to_string()))?;
    footage::make_relative(&mut document, path);
    Ok(document)
}

/// The files that were saved. A text that cannot be read notes none: then *Save* rather makes one more file.
fn notes(text: &str) -> Vec<Saved> {
    serde_json::from_str(text).unwrap_or_default()
}

/// The marks of a file.
fn marks<'a>(known: impl Iterator<Item = &'a FileMark>, path: &Path) -> Vec<Mark> {
    known.filter(|file| is_same(&file.path, path)).filter_map(|file| Mark::parse(&file.mark)).collect()
}

/// Whether two paths lead to one file.
pub fn is_same(one: &str, other: &Path) -> bool {
    let one = Path::new(one);
    one == other || matches!((real(one), real(other)), (Ok(one), Ok(other)) if one == other)
}
