//! Marks in the host's timeline: the key frames of the shapes, and where parts are doubtful, lost or hidden.
//!
//! OpenFX has no markers. Hosts show the keys of an effect's parameters in their timelines, dope sheets and curve editors.
//! So four parameters of whole numbers carry the marks as keys, which the node sets itself.
//!
//! Why whole numbers: every host animates them. A custom parameter needs a host property for its keys
//! (`OfxParamHostPropSupportsCustomAnimation`), and flags and choices need one too. Why visible: Natron shows the keys of all
//! parameters that are not secret, and Nuke keeps a parameter secret for ever. Why keys on both sides of a change: OpenFX
//! cannot say that a key holds, and hosts interpolate differently.
//!
//! The marks belong to the edit that changes the document, so the host's undo takes them back with it. They are marks only:
//! nothing is read from them, and an edit puts back what a user has changed in them.
//!
//! Limits: a document that is only named by Project, and not loaded, has no marks. Parameters may not be set while it is
//! read. An animated frame offset counts as it is at time 0.

use super::instance;
use super::standing::{Standing, counts};
use crate::ofx::{Effect, Failure, Parameters};
use rototoon::project::Document;
use rototoon::scene::{FrameNumber, Part};
use std::collections::BTreeMap;
use std::ffi::CStr;

/// Sets the marks of a document. A host that has no keys shows none, and that is no error.
pub fn set(parameters: &Parameters, document: &Document) {
    let offset = parameters.int(c"frameOffset", 0.0).unwrap_or(0);
    let (parts, footage) = (&document.scene.parts, &document.scene.footage);
    let stands = |standing| counts(parts, standing, footage);
    let all = [
        (c"keyMarks", keyed(parts)),
        (c"lostMarks", stands(Standing::Lost)),
        (c"doubtfulMarks", stands(Standing::Doubtful)),
        (c"hiddenMarks", stands(Standing::Hidden)),
    ];
    for (id, marks) in all {
        let _ = write(parameters, id, &marks, offset);
    }
}

/// Sets the marks again after the frame offset has changed.
pub fn moved(effect: &Effect) -> Result<(), Failure> {
    let parameters = effect.parameters()?;
    let document = instance(effect)?.document_of_text(&parameters)?.ok_or(Failure::Default)?;
    parameters.edit("Frame offset", || {
        set(&parameters, &document);
        Ok(())
    })
}

/// The number of parts with a key, by key frame.
fn keyed(parts: &[Part]) -> BTreeMap<FrameNumber, i32> {
    let mut keyed = BTreeMap::new();
    parts.iter().flat_map(|part| part.keys.keys()).for_each(|frame| *keyed.entry(*frame).or_default() += 1);
    keyed
}

/// Makes the keys of a parameter these marks. Keys that are there already are left, so that a small edit is a small step of
/// the host's undo.
fn write(parameters: &Parameters, id: &CStr, marks: &BTreeMap<FrameNumber, i32>, offset: i32) -> Result<(), Failure> {
    let mut missing: BTreeMap<i64, i32> =
        marks.iter().map(|(frame, count)| (i64::from(*frame) + i64::from(offset), *count)).collect();
    let known = parameters.keys(id)?;
    if marks.is_empty() && !known.is_empty() {
        parameters.delete_keys(id)?;
        return parameters.set_int(id, 0);
    }
    for time in known {
        let wanted = (time.fract() == 0.0).then(|| missing.get(&(time as i64)).copied()).flatten();
        match wanted {
            Some(count) if parameters.int(id, time)? == count => {
                missing.remove(&(time as i64));
            }
            Some(_) => {}
            None => parameters.delete_key(id, time)?,
        }
    }
    missing.into_iter().try_for_each(|(time, count)| parameters.set_int_at(id, time as f64, count))
}
