//! Fields that nobody reads and that are almost the name of one that is read: `center` for `centers`.
//!
//! A document may hold any further fields: notes of other tools are kept. So an unknown name is no mistake in itself. A
//! name that is within one or two letters of a known one probably is: the artist's corrections would have no effect, and
//! nothing would say so.
//!
//! Fields of drawings, clicks and the like are in lists. Of many that are misspelt in one way the first is named.

use super::Document;
use super::problem::Problems;
use super::schema::{FOOTAGE, Field, GAPS, PART, TOP};
use super::shape::part_place;
use rototoon_base::scene::spelling::letters_apart;
use serde_json::value::RawValue;
use std::collections::BTreeMap;

/// The document's fields that other stages read.
pub(super) const OTHERS: &[&str] = &[
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

/// Fields of objects within others: the way to the object, through lists and fields, and the names that are read there.
const WITHIN: &[(&[&str], &[&str])] = &[
    (&["drawings"], &["frame", "strokes", "spacing", "corner"]),
    (
        &["drawings", "strokes"],
        &["points", "closed", "fill", "fill_colour", "widths", "colour", "material", "layer", "peg"],
    ),
    (&["pairs"], &["frame", "from", "to"]),
    (&["pegs"], &["name", "parent", "pivot", "keys"]),
    (&["pegs", "keys"], &["frame", "shift", "turn", "scale", "timing"]),
    (&["traced", "strokes"], &["track", "points", "closed", "fill", "fill_colour", "widths", "colour", "confidence"]),
    (&["fills"], &["frame", "regions"]),
    (&["fills", "regions"], &["at", "colour", "name"]),
    (&["recolours"], &["from", "to", "first", "last"]),
    (&["recolours", "from"], &["name", "colour"]),
    (&["recolours", "to"], &["name", "colour"]),
    (&["filled", "regions"], &["outline", "holes", "colour", "name", "track", "confidence"]),
    (&["limbs"], &["from", "to", "start", "end", "carries", "bends", "rigidity"]),
    (&["limbs", "start"], &["points", "share"]),
    (&["limbs", "end"], &["points", "share"]),
    (&["limbs", "start", "points"], &["part", "at", "drawn"]),
    (&["limbs", "end", "points"], &["part", "at", "drawn"]),
    (&["limbs", "carries"], &["part", "turn"]),
    (&["depth_marks"], &["front", "behind", "first", "last"]),
    (&["follows"], &["part", "what", "of"]),
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
        self.misspelt_within(&mut problems);
        problems
    }

    fn misspelt_within(&self, problems: &mut Problems) {
        for (way, known) in WITHIN {
            let Some((first, rest)) = way.split_first() else { continue };
            let Some(text) = self.other_field(first) else { continue };
            let mut found = BTreeMap::new();
            search(text, first, rest, known, &mut found);
            for (name, (place, count)) in found {
                let Some(meant) = known.iter().find(|known| alike(&name, known)) else { continue };
                let more = if count > 1 { format!(", here and in {} more places", count - 1) } else { String::new() };
                let told = format!("no field has this name, so it has no effect{more}; probably {meant:?} is meant");
                problems.warning(place, told);
            }
        }
    }
}

/// Looks for misspelt fields of the objects at the end of a way through JSON. Finds for each name the first place and the number of places. Points and the like
/// are passed over as text: a film has millions of them, and every command looks.
fn search(text: &str, place: &str, way: &[&str], known: &[&str], found: &mut BTreeMap<String, (String, usize)>) {
    if let Ok(list) = serde_json::from_str::<Vec<&RawValue>>(text) {
        for (k, value) in list.iter().enumerate() {
            search(value.get(), &format!("{place}[{k}]"), way, known, found);
        }
        return;
    }
    let Ok(fields) = serde_json::from_str::<BTreeMap<String, &RawValue>>(text) else { return };
    if let Some((next, rest)) = way.split_first() {
        if let Some(value) = fields.get(*next) {
            search(value.get(), &format!("{place}.{next}"), rest, known, found);
        }
        return;
    }
    for name in fields.into_keys() {
        if !known.contains(&name.as_str()) && known.iter().any(|known| alike(&name, known)) {
            found.entry(name).or_insert_with_key(|name| (format!("{place}.{name}"), 0)).1 += 1;
        }
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

/// Whether one or two letters make the difference, or two neighbours in each other's places, whatever the case and the joints of the words.
fn alike(name: &str, known: &str) -> bool {
    let plain = |text: &str| text.to_lowercase().chars().filter(|c| c.is_alphanumeric()).collect::<String>();
    let (name, known) = (plain(name), plain(known));
    let allowed = if known.len() > 5 { 2 } else { 1 };
    let near = name.chars().count().abs_diff(known.chars().count()) <= allowed;
    near && (letters_apart(&name, &known) <= allowed || is_swapped(&name, &known))
}

/// Whether names are the same but for two neighbouring letters in each other's places.
fn is_swapped(name: &str, known: &str) -> bool {
    let (name, known): (Vec<char>, Vec<char>) = (name.chars().collect(), known.chars().collect());
    let first = name.iter().zip(&known).position(|(a, b)| a != b);
    first.is_some_and(|k| {
        let mut swapped = name.clone();
        k + 1 < swapped.len() && {
            swapped.swap(k, k + 1);
            swapped == known
        }
    })
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
    fn fields_within_lists_are_looked_at_and_told_once() {
        let text = r#"{"rototoon": 1,
            "footage": {"pattern": "%d.png", "first": 0, "last": 9, "fps": 24, "width": 64, "height": 48}, "parts": [],
            "drawings": [{"frame": 0, "strokes": [{"points": [], "color": [0, 0, 0]}, {"points": [], "color": 1, "width": [], "note": 1}]},
                {"frame": 4, "strokes": [{"points": [], "color": 1}]}],
            "pegs": [{"name": "a", "keys": [{"frame": 1, "shifts": [0, 0], "anchor": 3}]}],
            "recolours": [{"from": {"name": "a", "color": 1}, "to": {}, "frist": 3}],
            "fills": [{"frame": 0, "regions": {"at": 1}}], "limbs": 5, "depth_marks": [{"front": "a", "behind": "b", "lasts": 3}]}"#;
        let found: Vec<_> =
            Document::parse(text, "a").unwrap().misspelt().warnings().map(ToString::to_string).collect();
        let told = |place: &str, more: &str, meant: &str| {
            format!("{place}: no field has this name, so it has no effect{more}; probably {meant:?} is meant")
        };
        let expected = [
            told("drawings[0].strokes[0].color", ", here and in 2 more places", "colour"),
            told("drawings[0].strokes[1].width", "", "widths"),
            told("pegs[0].keys[0].shifts", "", "shift"),
            told("recolours[0].frist", "", "first"),
            told("recolours[0].from.color", "", "colour"),
            told("depth_marks[0].lasts", "", "last"),
        ];
        assert_eq!(found, expected);
    }

    #[test]
    fn other_words_are_not_alike() {
        assert!(alike("frist", "first") && alike("kyes", "keys") && !alike("ksey", "keys"));
        assert!(!alike("note", "name") && !alike("title", "tracks") && !alike("colour", "curves"));
    }
}
