//! The parameters of the effects for compositing hosts, described once: the plugin makes its parameters from these lists.
//!
//! An id is fixed for ever: compositions of users name it. What the command line and the add-on have too is shared with
//! [`super::parameters`].

mod lines;
mod roto;

pub use lines::LINES;
pub use roto::ROTO;

/// Which values a parameter takes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum EffectKind {
    /// The path of a file.
    File,
    /// A line of text.
    Text,
    /// Text that the user does not see.
    Hidden,
    /// The same, of which no change is a step of undo. The picture does not depend on it.
    Note,
    /// A line of text that the effect sets and the user reads. The picture does not depend on it.
    Shown,
    /// A button.
    Button,
    /// On or off.
    Flag(bool),
    /// A whole number: default, least, greatest, and the ends of the slider.
    Integer(i32, [i32; 2], [i32; 2]),
    /// A whole number that the effect itself sets with keys, which are marks in the host's timeline. The picture does not
    /// depend on it.
    Mark,
    /// A number: default, least, greatest, and the ends of the slider.
    Number(f64, [f64; 2], [f64; 2]),
    /// One of several, by index: labels.
    Choice(&'static [&'static str]),
    /// The same, with keys in hosts that have them for choices.
    KeyedChoice(&'static [&'static str]),
    /// A choice whose options the effect sets: the first option. The picture does not depend on it, and it is not stored.
    Menu(&'static str),
    /// One of the choices of a parameter in [`super::parameters`], by its id.
    Shared(&'static str),
    /// A colour with opacity.
    Colour([f64; 4]),
    /// A colour without opacity, and without keys.
    Shade([f64; 3]),
    /// Two numbers, x and y.
    Pair([f64; 2]),
    /// A group, open or not.
    Group(bool),
}

/// A parameter of an effect.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EffectParameter {
    /// Its id, that of no other parameter of the effect.
    pub id: &'static str,
    /// A few words, for people.
    pub label: &'static str,
    /// A sentence, for people.
    pub help: &'static str,
    /// Which values it takes.
    pub kind: EffectKind,
    /// The group that shows it.
    pub group: Option<&'static str>,
}

const fn parameter(
    id: &'static str,
    label: &'static str,
    kind: EffectKind,
    group: Option<&'static str>,
    help: &'static str,
) -> EffectParameter {
    EffectParameter { id, label, help, kind, group }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::parameters::{self, Kind};
    use std::collections::BTreeSet;

    #[test]
    fn ids_are_unique_and_groups_come_before_what_they_hold() {
        for list in [&ROTO[..], &LINES[..]] {
            let mut known = BTreeSet::new();
            for parameter in list {
                assert!(known.insert(parameter.id), "{}", parameter.id);
                assert!(parameter.group.is_none_or(|group| known.contains(group)), "{}", parameter.id);
                match parameter.kind {
                    EffectKind::Integer(default, [low, high], [from, to]) => {
                        assert!((low..=high).contains(&default) && low <= from && from < to && to <= high);
                    }
                    EffectKind::Number(default, [low, high], [from, to]) => {
                        assert!((low..=high).contains(&default) && low <= from && from < to && to <= high);
                    }
                    EffectKind::Shared(id) => {
                        let shared = parameters::find(id).map(|parameter| parameter.kind);
                        assert!(matches!(shared, Some(Kind::Choice { .. })), "{id}");
                    }
                    _ => {}
                }
            }
        }
    }
}
