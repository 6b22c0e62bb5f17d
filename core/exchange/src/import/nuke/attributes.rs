//! Attributes of a shape or a layer.
//!
//! A list `a` has names, each followed by its value. Blending modes (`bm`) are numbers: 0 lays a shape over those below, 4 takes
//! the greater of both, 5 keeps what is inside of both, 12 subtracts, 13 takes the difference.
//!
//! The lifetime has a kind (`ltt`), a first frame (`ltn`) and a last one (`ltm`). The kinds are numbered in the order of Nuke's menu: all frames, start to
//! frame, single frame, frame to end, frame range. Public scripts set 0 for the first and 4 for the last; the numbers between follow from the
//! order.
//!
//! Source: M. Borgo's exporter for Silhouette (NukeFXSExporter) names these modes; the other numbers are not public.

use super::number::{channel, number};
use super::words::Item;

/// The value of an attribute.
pub(super) fn attribute<'a>(item: &'a Item<'a>, name: &str) -> Option<&'a Item<'a>> {
    let attributes = item.items().iter().filter(|list| list.name() == Some("a")).flat_map(Item::items);
    attributes.skip_while(|word| word.word() != Some(name)).nth(1)
}

/// Whether a shape or a layer is invisible on all frames.
pub(super) fn is_invisible(text: &str, item: &Item) -> bool {
    attribute(item, "vis").and_then(|value| channel(text, value, "a").ok()).is_some_and(|visible| visible.is(0.0))
}

/// What a shape does beside adding its area to those below, in words; `None` for nothing.
pub(super) fn lost(text: &str, item: &Item) -> Option<String> {
    let inverted = attribute(item, "inv").and_then(|value| channel(text, value, "a").ok());
    let inverted = inverted.is_some_and(|inverted| !inverted.is(0.0)).then(|| "is inverted".to_owned());
    let blended = match attribute(item, "bm").and_then(|value| number(text, value, "a").ok()).unwrap_or(0.0) {
        // The greatest of several coverages and their sum have the same outline.
        0.0 | 4.0 => None,
        5.0 => Some("keeps only what is inside of it".to_owned()),
        12.0 => Some("subtracts its area".to_owned()),
        mode => Some(format!("has the blending mode {mode}")),
    };
    let told: Vec<String> = inverted.into_iter().chain(blended).collect();
    (!told.is_empty()).then(|| told.join(" and "))
}

/// The times in which a shape is not shown because its lifetime has not begun or is over.
pub(super) fn outside_of_lifetime(text: &str, item: &Item) -> Vec<[f64; 2]> {
    let still = |name: &str| attribute(item, name).and_then(|value| number(text, value, "a").ok());
    let (first, last) = (still("ltn"), still("ltm"));
    let (first, last) = match still("ltt") {
        Some(1.0) => (None, last),
        Some(2.0) => (first, first),
        Some(3.0) => (first, None),
        Some(4.0) => (first, last),
        _ => return Vec::new(),
    };
    let before = first.map(|first| [f64::NEG_INFINITY, first - 1.0]);
    before.into_iter().chain(last.map(|last| [last + 1.0, f64::INFINITY])).collect()
}

/// Whether the knobs of a node say that it is disabled on all frames.
pub(super) fn is_disabled(knobs: &Item) -> bool {
    let value = knobs.items().windows(2).find(|pair| pair[0].word() == Some("disable")).and_then(|pair| pair[1].word());
    value.is_some_and(|value| ["true", "1"].contains(&value))
}
