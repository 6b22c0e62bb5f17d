//! Fields that nobody reads and that are almost the name of one that is read: `center` for `centers`.
//!
//! A document may hold any further fields: notes of other tools are kept. So an unknown name is no mistake in itself. A
//! name that is within one or two letters of a known one probably is: the artist's corrections would have no effect, and
//! nothing would say so.

use super::Document;
use super::problem::Problems;
use super::schema::{FOOTAGE, Field, GAPS, PART, TOP};
use super::shape::part_place;
use rototoon_base::scene::spelling::letters_apart;

/// The document's fields that other stages read.
const OTHERS: &[&str] = &[
    "drawings",
    "pairs",
    "pegs",
    "matches",
    "in_betweens",
    "limbs",
    "limb_swaps",
    "skeleton",
    "depth_marks",
    "follows",
    "traced",
    "fills",
    "filled",
    "palette",
    "recolours",
    "clips",
    "seen",
    "reshaped",
];

impl Document {
    /// A warning for each unknown field with almost the name of a known one.
    pub fn misspelt(&self) -> Problems {
        let mut problems = Problems::default();
        let top = [&TOP[..], OTHERS].concat();
        warn("", &self.layout.top, &top, &mut problems);
        warn("footage", &self.layout.footage, &[&FOOTAGE[..], &[GAPS]].concat(), &mut problems);
        for (index, part) in self.scene.parts.iter().enumerate() {
            let fields = self.layout.parts.get(&part.name).map_or(&[][..], Vec::as_slice);
            warn(&part_place(index, Some(&part.name)), fields, &PART, &mut problems);
        }
        problems
    }
}

fn warn(place: &str, fields: &[Field], known: &[&str], problems: &mut Problems) {
    let unknown = fields.iter().filter(|field| matches!(field, Field::Unknown { .. })).map(Field::name);
    for name in unknown.filter(|name| !known.contains(name)) {
        if let Some(meant) = known.iter().find(|known| alike(name, known)) {
            let place = if place.is_empty() { name.to_owned() } else { format!("{place}.{name}") };
            problems
                .warning(place, format!("no field has this name, so it has no effect; probably {meant:?} is meant"));
        }
    }
}

/// Whether one or two letters make the difference, whatever the case and the joints of the words.
fn alike(name: &str, known: &str) -> bool {
    let plain = |text: &str| text.to_lowercase().chars().filter(|c| c.is_alphanumeric()).collect::<String>();
    let (name, known) = (plain(name), plain(known));
    let allowed = if known.len() > 5 { 2 } else { 1 };
    name.chars().count().abs_diff(known.chars().count()) <= allowed && letters_apart(&name, &known) <= allowed
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn almost_known_names_are_warned_of_and_notes_are_not() {
        let text = r#"{"rototoon": 1, "note": "x", "drawing": [], "traced": 1, "author": "a",
            "footage": {"pattern": "%d.png", "first": 0, "last": 9, "fps": 24, "width": 64, "height": 48, "frames": 3},
            "parts": [{"name": "arm", "keys": {}, "center": {}, "wantsKey": [], "label": 1, "colour": 2, "pin": {}}]}"#;
        let found: Vec<_> =
            Document::parse(text, "a").unwrap().misspelt().warnings().map(ToString::to_string).collect();
        let told = |place: &str, meant: &str| {
            format!("{place}: no field has this name, so it has no effect; probably {meant:?} is meant")
        };
        let part = |name: &str| format!("parts[0] \"arm\".{name}");
        let expected = [
            told("drawing", "drawings"),
            told(&part("center"), "centers"),
            told(&part("wantsKey"), "wants_key"),
            told(&part("colour"), "color"),
            told(&part("pin"), "pins"),
        ];
        assert_eq!(found, expected);
    }

    #[test]
    fn other_words_are_not_alike() {
        assert!(!alike("note", "name") && !alike("title", "tracks") && !alike("colour", "curves"));
    }
}
