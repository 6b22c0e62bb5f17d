//! Selects a part from the list of the parts: by its menu, or with buttons that go from one part to the next.

use super::edit::Selection;
use super::instance::NO_SHAPES;
use super::listing::{MENU, names, refresh};
use super::parts::meant;
use super::{edits, instance};
use crate::ofx::{Effect, Failure, Parameters};

/// An option of the menu has been chosen.
pub fn chosen(effect: &Effect) -> Result<(), Failure> {
    let (instance, parameters) = (instance(effect)?, effect.parameters()?);
    let index = usize::try_from(parameters.int(MENU, 0.0)?).unwrap_or(0);
    // The name is that of the menu that the user saw.
    let name = index.checked_sub(1).and_then(|index| instance.menu(index)).unwrap_or_default();
    let document = instance.document(&parameters)?;
    if !name.is_empty() && !document.is_some_and(|all| all.scene.parts.iter().any(|part| part.name == name)) {
        // A host may undo a step without saying so.
        refresh(effect);
        return Err(Failure::Told(format!("{name:?} is gone, the menu is made anew")));
    }
    select(effect, &parameters, &name)
}

/// Selects the part before or after the selected one.
pub fn step(effect: &Effect, forward: bool) -> Result<(), Failure> {
    let parameters = effect.parameters()?;
    let document = instance(effect)?.document(&parameters)?;
    let names = document.as_deref().map(|document| names(document)).unwrap_or_default();
    let part = parameters.text(c"part")?;
    let part = document.as_ref().map_or("", |document| meant(&document.scene.parts, &part));
    let place = names.iter().position(|name| *name == part);
    let next = match (place, forward) {
        (Some(place), true) => names.get(place + 1).or(names.first()),
        (Some(place), false) => place.checked_sub(1).and_then(|before| names.get(before)).or(names.last()),
        (None, true) => names.first(),
        (None, false) => names.last(),
    };
    let next = next.ok_or_else(|| Failure::Told(NO_SHAPES.into()))?;
    select(effect, &parameters, next)
}

/// Selects a part and its points.
fn select(effect: &Effect, parameters: &Parameters, name: &str) -> Result<(), Failure> {
    let instance = instance(effect)?;
    let document = instance.document(parameters)?;
    let part = document.as_ref().and_then(|all| all.scene.parts.iter().position(|part| part.name == name));
    match (part, &document) {
        (Some(part), Some(document)) => {
            instance.editor().select(Selection::part(part, &document.scene), &document.scene);
        }
        _ => instance.editor().selection = Selection::default(),
    }
    edits::select(effect, name)
}
