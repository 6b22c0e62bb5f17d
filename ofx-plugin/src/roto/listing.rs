//! The list of the parts: a menu that selects one, and their names as text. [`super::choosing`] selects.
//!
//! OpenFX has no list of things that a user can choose from, only a choice between options. Natron lets an effect change
//! them; Nuke and Resolve do not. So the choice is only for hosts of the first kind. The text, and buttons that go from part
//! to part, serve in all of them.
//!
//! The menu holds nothing of its own: the parameter Part has the selection, and the document has the names. The menu is
//! made anew where they have changed, also after the host's undo. Natron takes new options only after a reset, and one by
//! one at the end.

use super::edit::order;
use super::instance;
use super::parts::meant;
use crate::ofx::{Effect, Failure, host};
use openfx::sys::image_effect_v1::param::kOfxParamPropChoiceOption;
use rototoon::project::Document;
use std::ffi::CStr;

/// The choice.
pub const MENU: &CStr = c"partList";
/// Its first option.
const NONE: &str = "No part";
/// Most letters of the names as text.
const MOST_LETTERS: usize = 4000;

/// The names of the parts, the nearest first.
pub fn names(document: &Document) -> Vec<&str> {
    let nearest_first = order::farthest_first(&document.scene).into_iter().rev();
    nearest_first.map(|part| document.scene.parts[part].name.as_str()).collect()
}

/// The names as a text to read. Nuke runs what is in brackets, so they are round here.
pub fn text(document: &Document) -> String {
    let names = names(document);
    let (mut text, mut count) = (String::new(), 0);
    for name in &names {
        if text.chars().count() + name.chars().count() > MOST_LETTERS {
            break;
        }
        let comma = if text.is_empty() { "" } else { ", " };
        text += &format!("{comma}{name}");
        count += 1;
    }
    if count < names.len() {
        text += &format!(" and {} more", names.len() - count);
    }
    text.chars()
        .map(|letter| {
            if letter == '[' {
                '('
            } else if letter == ']' {
                ')'
            } else {
                letter
            }
        })
        .collect()
}

/// Makes the menu show the parts and the selection. Hosts without such menus keep theirs. A document that cannot be read is
/// reported by rendering.
pub fn refresh(effect: &Effect) {
    if host::changes_menus() {
        // A menu that a host refuses is no reason to refuse an edit.
        let _ = menu(effect);
    }
}

fn menu(effect: &Effect) -> Result<(), Failure> {
    let (instance, parameters) = (instance(effect)?, effect.parameters()?);
    let document = instance.document(&parameters).ok().flatten();
    let names = document.as_deref().map(|document| names(document)).unwrap_or_default();
    if instance.replace_menu(&names) {
        let properties = parameters.properties(MENU)?;
        properties.reset(kOfxParamPropChoiceOption)?;
        for (index, name) in std::iter::once(&NONE).chain(&names).enumerate() {
            properties.set_text(kOfxParamPropChoiceOption, index as i32, name)?;
        }
    }
    let part = parameters.text(c"part")?;
    let part = document.as_ref().map_or("", |document| meant(&document.scene.parts, &part));
    let index = names.iter().position(|name| *name == part).map_or(0, |index| index as i32 + 1);
    if parameters.int(MENU, 0.0)? == index { Ok(()) } else { parameters.set_int(MENU, index) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rototoon::scene::{Footage, Part, Scene};

    fn document(names: &[&str]) -> Document {
        let footage =
            Footage { pattern: "%d.png".into(), first: 0, last: 9, fps: 24.0, width: 8, height: 8, held: false };
        let part = |name: &&str| Part { name: (*name).into(), ..Part::default() };
        Document::new(Scene { footage, parts: names.iter().map(part).collect() })
    }

    #[test]
    fn the_nearest_part_is_named_first_and_brackets_are_round() {
        let mut document = document(&["body", "arm [left]", "head"]);
        document.scene.parts[0].depth = 3.0;
        assert_eq!(names(&document), ["body", "head", "arm [left]"]);
        assert_eq!(text(&document), "body, head, arm (left)");
    }

    #[test]
    fn a_long_list_says_how_many_names_it_leaves_out() {
        let names: Vec<String> = (0..1000).map(|k| format!("part number {k}")).collect();
        let text = text(&document(&names.iter().map(String::as_str).collect::<Vec<_>>()));
        assert!(text.len() < 8100 && text.starts_with("part number 999, ") && text.ends_with(" more"), "{text}");
        let left: usize = text.rsplit(' ').nth(1).unwrap().parse().unwrap();
        assert_eq!(text.matches("part number").count() + left, 1000);
    }
}
