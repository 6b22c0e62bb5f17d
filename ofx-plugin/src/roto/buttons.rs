//! The buttons, and parameters whose change has consequences.
//!
//! Only changes by the user are handled. Each value that the plugin sets itself is reported as a change too.

use super::reach::Reach;
use super::state::{FileMark, State};
use super::track::BUSY;
use super::{choosing, edits, footage, fresh, instance, listing, marks, page, saving, taking_out, track, visits};
use crate::description::SOURCE;
use crate::ofx::entry::Action;
use crate::ofx::{Effect, Failure};
use openfx::sys::generic::core::{
    kOfxChangeUserEdited, kOfxPropChangeReason, kOfxPropName, kOfxPropTime, kOfxPropType,
};
use openfx::sys::image_effect_v1::image_effect::kOfxTypeClip;
use openfx::sys::image_effect_v1::param::kOfxTypeParameter;
use rototoon::file;
use rototoon::pipeline::unchanged::Mark;
use rototoon::pipeline::{self, ShapeFormat};
use rototoon::project::Document;
use std::path::{Path, PathBuf};

/// Most warnings of an import that are shown.
const MOST_WARNINGS: usize = 5;

/// The buttons that edit the shapes.
const EDITS: [&str; 13] = [
    "newPart",
    "newKey",
    "deleteKey",
    "insertPoints",
    "deletePoints",
    "smoothPoints",
    "deletePart",
    "featherPoints",
    "hideHere",
    "hideStretch",
    "nearer",
    "farther",
    "moveToPlace",
];

/// Handles a change of a parameter or a clip.
pub fn changed(action: &Action) -> Result<(), Failure> {
    let is = |name: &std::ffi::CStr, text: &str| text.as_bytes() == name.to_bytes();
    let kind = action.input.text(kOfxPropType, 0)?;
    let reason = action.input.text(kOfxPropChangeReason, 0)?;
    let (effect, name) = (&action.effect, action.input.text(kOfxPropName, 0)?);
    if is(kOfxTypeClip, &kind) && is(SOURCE, &name) {
        instance(effect)?.drop_frames();
    }
    if ["document", "part", "project"].contains(&name.as_str()) {
        // Undo changes these too, and hosts differ in whom they name as the one who did it.
        listing::refresh(effect);
    }
    if !is(kOfxChangeUserEdited, &reason) {
        return Err(Failure::Default);
    }
    if is(kOfxTypeClip, &kind) && is(SOURCE, &name) || is(kOfxTypeParameter, &kind) {
        instance(effect)?.changed(effect);
    }
    if !is(kOfxTypeParameter, &kind) {
        return Err(Failure::Default);
    }
    let time = action.input.double(kOfxPropTime, 0).unwrap_or(0.0);
    match used(effect, &name, time) {
        Err(Failure::Told(text)) => {
            effect.complain(&text);
            Err(Failure::Told(text))
        }
        // The user has cancelled it and needs no message.
        Err(Failure::Aborted) => Ok(()),
        other => other,
    }
}

/// Does what a button or a parameter is for, after the user has pressed or changed it.
fn used(effect: &Effect, name: &str, time: f64) -> Result<(), Failure> {
    match name {
        // What is tracked is stored afterwards, and would replace the other shapes.
        "load" | "project" | "track" | "rename" if instance(effect)?.is_tracking() => Err(Failure::Told(BUSY.into())),
        edit if EDITS.contains(&edit) && instance(effect)?.is_tracking() => Err(Failure::Told(BUSY.into())),
        "load" => load(effect, time),
        "project" if is_new_file(effect)? => load(effect, time),
        "save" => saving::save(effect),
        "track" => track::track(effect, time),
        edit if EDITS.contains(&edit) => edits::press(effect, edit, time),
        "rename" => edits::rename(effect, time),
        "previousLost" | "nextLost" | "weakest" => visits::go(effect, name, time),
        "frameOffset" => marks::moved(effect),
        "part" => edits::select(effect, &effect.parameters()?.text(c"part")?),
        "partList" => choosing::chosen(effect),
        "previousPart" | "nextPart" => choosing::step(effect, name == "nextPart"),
        "live" => {
            instance(effect)?.drop_frames();
            Ok(())
        }
        "tool" => {
            instance(effect)?.editor().drop_work();
            Ok(())
        }
        "writeMotion" => taking_out::write_motion(effect, time),
        "export" => taking_out::export(effect, time),
        page if page::IDS.iter().any(|id| id.to_bytes() == page.as_bytes()) => edits::page_changed(effect, page),
        _ => Err(Failure::Default),
    }
}

fn path(effect: &Effect) -> Result<PathBuf, Failure> {
    Ok(PathBuf::from(effect.parameters()?.text(c"project")?.trim()))
}

/// Whether Project names a file of which the composition has no shapes. Those that it has from a file, or has saved to one,
/// may have been changed since; only *Load* replaces them by what the file holds.
fn is_new_file(effect: &Effect) -> Result<bool, Failure> {
    let (path, parameters) = (path(effect)?, effect.parameters()?);
    if !path.is_file() || saving::has_saved(effect, &path)? {
        return Ok(false);
    }
    let is_known = |state: &State| {
        let read = state.read.as_ref().map(|file| file.path.as_str());
        [Some(state.loaded.as_str()), read].into_iter().flatten().any(|known| saving::is_same(known, &path))
    };
    let empty = parameters.is_blank(c"document")?;
    Ok(empty || !instance(effect)?.state(&parameters).is_ok_and(|state| is_known(&state)))
}

/// The project's path, which the user must have chosen.
pub fn chosen(effect: &Effect) -> Result<PathBuf, Failure> {
    let path = path(effect)?;
    if path.as_os_str().is_empty() {
        return Err(Failure::Told("choose a project file first".into()));
    }
    Ok(path)
}

/// Loads the project's shapes into the composition. The footage then gets an absolute path, because the composition has no
/// folder of its own.
///
/// A file of shapes of another program is read too. Its shapes become parts of the composition's document.
fn load(effect: &Effect, time: f64) -> Result<(), Failure> {
    let path = chosen(effect)?;
    if let Some(extension) = foreign(&path) {
        return import(effect, &path, &extension, time);
    }
    // The mark comes first: what is written in between counts as a change.
    let mark = Mark::of(&path).map_or_else(String::new, |mark| mark.to_string());
    let mut document = Document::load(&path).map_err(|error| Failure::Told(error.to_string()))?;
    footage::make_absolute(&mut document, &path);
    edits::store_loaded(effect, &document, &FileMark { path: path.to_string_lossy().into_owned(), mark })
}

/// The extension of a file of shapes of another program.
pub fn foreign(path: &Path) -> Option<String> {
    let extension = path.extension()?.to_str()?.to_ascii_lowercase();
    ShapeFormat::of(&extension, 0).map(|_| extension)
}

fn import(effect: &Effect, path: &Path, extension: &str, time: f64) -> Result<(), Failure> {
    let told = |error: &dyn std::fmt::Display| Failure::Told(format!("{}: {error}", path.display()));
    let mut document = match instance(effect)?.document_of_text(&effect.parameters()?)? {
        Some(document) => Document::clone(&document),
        None => fresh::document(effect, time)?,
    };
    Reach::of(effect)?.widen_own(&mut document.scene.footage);
    // The file has the composition's frames.
    let offset = effect.parameters()?.int(c"frameOffset", 0.0)?;
    let format = ShapeFormat::of(extension, document.scene.footage.first);
    let format = format.ok_or_else(|| told(&"expected a file of shapes"))?;
    let text = file::text(path).map_err(|error| told(&error))?;
    let imported = pipeline::import_shifted(&mut document, &text, format, offset).map_err(|error| told(&error))?;
    let hidden = edits::hidden_new(effect, &document)?;
    edits::store_imported(effect, document, &path.to_string_lossy())?;
    for warning in imported.warnings.iter().take(MOST_WARNINGS).chain(&imported.told()) {
        instance(effect)?.note(effect, warning, false);
    }
    if !hidden.is_empty() {
        let names: Vec<String> = hidden.iter().map(|name| format!("{name:?}")).collect();
        let text = format!("Parts names other parts, so these are not shown: {}", names.join(", "));
        instance(effect)?.note(effect, &text, false);
    }
    Ok(())
}
