//! Colours of paint that become others from a drawing on: a character gets wet, a lamp is switched on.
//!
//! ```json
//! "recolours": [{"from": {"name": "coat"}, "to": {"name": "wet coat", "colour": [r, g, b]}, "first": 24, "last": 40}, "…"]
//! ```
//!
//! - `from` and `to` are colours as clicks have them: by `name`, or by `colour` where there is no name. A `name` needs no `colour` if the
//!   palette, a click or an entry before it says how it looks.
//! - Without `first` or `last` the range of frames is open at that end.
//! - Each entry changes what the entries before it have left. So "coat" becomes "wet coat" from 24 on, and "wet coat" becomes "icy coat" from 40 on.
//!
//! # How
//!
//! Regions are carried from drawing to drawing in the old colour, and change it when they are written. So nothing that painting knows is lost: after `last`
//! the old colour is back, and without the entry the paint is as if it had never been there.
//!
//! A painter who mends a region between `first` and `last` sees the new colour and clicks with it. Such a click *means* the old colour
//! ([`Recolours::meant`]), so that the region is right on all frames. The new colour may be one of its own, too: a red lamp becomes blue beside the blue sky. It is
//! if a click has it on a frame on which no entry makes it, or beside a click of the old colour. Then a click with it means what it says.
//!
//! A number has one colour. So a region whose colour changes has another number from there on, the same on all frames.
//!
//! # Limits
//!
//! Two colours that change places need a third one between them.

use super::Document;
use super::drawings::lines;
use super::fields::{FieldError, colour, described, frame, given, object, share, wrong};
use super::fills::{FillClick, FillClicks, FilledDrawing, Hue, colour_name, written_colour};
use rototoon_base::scene::{Colour, FrameNumber};
use serde_json::{Value, json};
use std::collections::BTreeMap;
use std::fmt;

/// A colour that becomes another one on some frames.
#[derive(Clone, Debug, PartialEq)]
pub struct Recolour {
    /// The old colour.
    pub from: Hue,
    /// The new one.
    pub to: Hue,
    /// The first frame; `None` for all before `last`.
    pub first: Option<FrameNumber>,
    /// The last frame; `None` for all from `first` on.
    pub last: Option<FrameNumber>,
}

impl Recolour {
    /// Whether it holds on a frame.
    pub fn is_on(&self, frame: FrameNumber) -> bool {
        self.first.is_none_or(|first| first <= frame) && self.last.is_none_or(|last| frame <= last)
    }

    /// The entry of the document's field.
    pub fn to_json(&self) -> Value {
        let hue = |hue: &Hue| {
            let mut out = json!({"colour": written_colour(hue.colour)});
            if let Some(name) = &hue.name {
                out["name"] = json!(name);
            }
            out
        };
        let mut out = json!({"from": hue(&self.from), "to": hue(&self.to)});
        for (name, frame) in [("first", self.first), ("last", self.last)] {
            if let Some(frame) = frame {
                out[name] = json!(frame);
            }
        }
        out
    }
}

/// In words: `"coat" becomes "wet coat" from frame 24 on`.
impl fmt::Display for Recolour {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} becomes {}", self.from, self.to)?;
        match (self.first, self.last) {
            (None, None) => Ok(()),
            (Some(first), None) => write!(f, " from frame {first} on"),
            (None, Some(last)) => write!(f, " up to frame {last}"),
            (Some(first), Some(last)) if first == last => write!(f, " on frame {first}"),
            (Some(first), Some(last)) => write!(f, " on frames {first}-{last}"),
        }
    }
}

/// The entries of a document, and what clicks say of their colours.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Recolours {
    list: Vec<Recolour>,
    /// For each entry: whether clicks with its new colour mean what they say.
    literal: Vec<bool>,
}

impl Recolours {
    /// Entries beside the clicks of a document.
    pub fn new(list: Vec<Recolour>, clicks: &[FillClicks]) -> Self {
        let literal = list.iter().map(|entry| is_own(entry, &list, clicks)).collect();
        Self { list, literal }
    }

    /// The entries.
    pub fn list(&self) -> &[Recolour] {
        &self.list
    }

    /// The colour that a click on a frame means.
    pub fn meant(&self, frame: FrameNumber, hue: Hue) -> Hue {
        let on = self.list.iter().zip(&self.literal).rev().filter(|(entry, literal)| entry.is_on(frame) && !**literal);
        on.fold(hue, |hue, (entry, _)| if entry.to.is_same(&hue) { entry.from.clone() } else { hue })
    }

    /// Gives clicks the colours that they mean.
    pub fn mean(&self, clicks: &mut FillClicks) {
        for click in &mut clicks.clicks {
            if let Some(hue) = click.hue() {
                let Hue { name, colour } = self.meant(clicks.frame, hue);
                (click.name, click.colour) = (name, Some(colour));
            }
        }
    }

    /// Changes the colours of painted regions. Changed ones get numbers from `next` on. Returns for each entry how many regions it has changed.
    pub fn change(&self, drawings: &mut [FilledDrawing], next: usize) -> Vec<usize> {
        let mut counts = vec![0; self.list.len()];
        // By old number, the new colours with their numbers.
        let mut numbers: BTreeMap<usize, Vec<(Hue, usize)>> = BTreeMap::new();
        let mut next = next;
        for drawing in drawings {
            for region in &mut drawing.regions {
                let mut hue = region.hue();
                for (entry, count) in self.list.iter().zip(&mut counts) {
                    if entry.is_on(drawing.frame) && entry.from.is_same(&hue) {
                        hue = entry.to.clone();
                        *count += 1;
                    }
                }
                if hue.is_same(&region.hue()) {
                    continue;
                }
                let known = numbers.entry(region.track).or_default();
                region.track = match known.iter().find(|own| own.0.is_same(&hue)) {
                    Some((_, number)) => *number,
                    None => {
                        known.push((hue.clone(), next));
                        next += 1;
                        next - 1
                    }
                };
                (region.name, region.colour) = (hue.name, hue.colour);
            }
        }
        counts
    }
}

fn has(clicks: &FillClicks, hue: &Hue) -> bool {
    clicks.clicks.iter().filter_map(FillClick::hue).any(|own| own.is_same(hue))
}

/// Whether the new colour of an entry is also one of its own: a click has it where no entry makes it, or beside one of the old colour.
fn is_own(entry: &Recolour, list: &[Recolour], clicks: &[FillClicks]) -> bool {
    let made = |frame| list.iter().any(|other| other.to.is_same(&entry.to) && other.is_on(frame));
    clicks
        .iter()
        .any(|own| has(own, &entry.to) && (!made(own.frame) || entry.is_on(own.frame) && has(own, &entry.from)))
}

impl Document {
    /// The colours that become others; empty if there are none.
    ///
    /// # Errors
    ///
    /// The first invalid field, also of clicks and palette.
    pub fn recolours(&self) -> Result<Recolours, FieldError> {
        let clicks = self.fills()?;
        let mut looks = self.palette()?;
        for click in clicks.iter().flat_map(|own| &own.clicks) {
            if let (Some(name), Some(colour)) = (&click.name, click.colour) {
                looks.entry(name.clone()).or_insert(colour);
            }
        }
        let mut list = Vec::new();
        for (k, value) in self.other_list("recolours")?.iter().enumerate() {
            let read = read(value, &looks, &format!("recolours[{k}]"))?;
            for hue in [&read.from, &read.to] {
                if let Some(name) = &hue.name {
                    looks.entry(name.clone()).or_insert(hue.colour);
                }
            }
            list.push(read);
        }
        Ok(Recolours::new(list, &clicks))
    }

    /// Replaces the entries by some in the form of the field `recolours`, as JSON.
    ///
    /// # Errors
    ///
    /// Text that is no JSON, and the first invalid field.
    pub fn set_recolours_json(&mut self, json: &str) -> Result<(), FieldError> {
        let mut other = self.clone();
        other.set_other_field("recolours", json.to_owned());
        other.recolours()?;
        // As it is written, and the field is removed without any entry.
        other.remove_recolours(&[])?;
        *self = other;
        Ok(())
    }

    /// Adds an entry behind all others.
    ///
    /// # Errors
    ///
    /// A field that is no list.
    pub fn add_recolour(&mut self, entry: &Recolour) -> Result<(), FieldError> {
        let list = self.other_list("recolours")?;
        self.set_other_field("recolours", lines(list.into_iter().chain([entry.to_json()])));
        Ok(())
    }

    /// Removes the entries at some places. Without any entry, the field is removed.
    ///
    /// # Errors
    ///
    /// A field that is no list.
    pub fn remove_recolours(&mut self, places: &[usize]) -> Result<(), FieldError> {
        let list = self.other_list("recolours")?.into_iter().enumerate();
        let (dropped, kept): (Vec<_>, Vec<_>) = list.partition(|(k, _)| places.contains(k));
        let mut kept: Vec<Value> = kept.into_iter().map(|(_, value)| value).collect();
        dropped.iter().for_each(|(_, value)| hand_on(value, &mut kept));
        if kept.is_empty() {
            self.remove_other_field("recolours");
        } else {
            self.set_other_field("recolours", lines(kept.into_iter()));
        }
        Ok(())
    }
}

/// Gives the looks that a dropped entry tells to the colours of these names that do not say how they look.
pub(super) fn hand_on(dropped: &Value, kept: &mut [Value]) {
    for (name, look) in ["from", "to"].map(|end| (&dropped[end]["name"], &dropped[end]["colour"])) {
        if !(name.is_string() && look.is_array()) {
            continue;
        }
        let ends =
            kept.iter_mut().filter_map(Value::as_object_mut).flatten().filter_map(|(_, end)| end.as_object_mut());
        for end in ends.filter(|end| end.get("name") == Some(name)) {
            end.entry("colour").or_insert_with(|| look.clone());
        }
    }
}

fn read(value: &Value, looks: &BTreeMap<String, Colour>, place: &str) -> Result<Recolour, FieldError> {
    let fields = object(value, place)?;
    let part = |name: &str| {
        let place = format!("{place}.{name}");
        let found = fields.get(name).ok_or_else(|| wrong(&place, &described(None), "a colour: a name, or a colour"))?;
        hue(found, looks, &place)
    };
    let (from, to) = (part("from")?, part("to")?);
    if from.is_same(&to) {
        return Err(wrong(&format!("{place}.to"), &to.to_string(), "another colour than that of \"from\""));
    }
    let (first, last) = (given(fields, place, "first", frame)?, given(fields, place, "last", frame)?);
    if let (Some(first), Some(last)) = (first, last)
        && first > last
    {
        return Err(wrong(&format!("{place}.last"), &last.to_string(), &format!("at least {first}, the first frame")));
    }
    Ok(Recolour { from, to, first, last })
}

/// Reads a colour. Somebody must say how a name looks.
fn hue(value: &Value, looks: &BTreeMap<String, Colour>, place: &str) -> Result<Hue, FieldError> {
    let fields = object(value, place)?;
    let name = given(fields, place, "name", colour_name)?;
    let own = given(fields, place, "colour", |value, place| colour(value, place, share))?;
    let look = name.as_ref().and_then(|name| looks.get(name).copied()).or(own);
    match (look, &name) {
        (Some(colour), _) => Ok(Hue { name, colour }),
        (None, None) => Err(wrong(place, "no name and no colour", "a name, or a colour")),
        (None, Some(known)) => {
            let expected = "a name of the field palette or of a click, or a colour beside it";
            Err(wrong(&format!("{place}.name"), &format!("{known:?}"), expected))
        }
    }
}

#[cfg(test)]
mod tests;
