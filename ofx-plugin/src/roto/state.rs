//! What an instance stores beside its document: the settings of each part, and what the tracks were made from.
//!
//! OpenFX has no parameters that come and go with the parts. So the page *Selected part* shows the settings of one part, and
//! the hidden text `state` has those of all parts. Keys that the user set in the host are stored with their times. Hosts
//! interpolate differently, so the values of all frames between the keys are stored too ([`Curve`]).
//!
//! The text is JSON with a version, encoded as the document is ([`super::stored`]).

use super::stored;
use rototoon::render::composite::Blend;
use rototoon::scene::{Falloff, FalloffCurve, FrameNumber, Part};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// The version of the stored form.
const VERSION: u32 = 1;
/// Most frames of which a curve has values.
pub const MOST_FRAMES: i32 = 100_000;

/// What stands for the sum of a part's input where its tracks were made with another order of the parts.
const OTHER_ORDER: &str = "other order";
/// What stands for it where they were made from a source that has changed since.
const OTHER_SOURCE: &str = "other source";

/// First and last frame of a span.
pub type Span = [FrameNumber; 2];

/// A number that may have keys.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Curve {
    /// The value without keys.
    pub value: f64,
    /// The keys: time and value.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub keys: Vec<[f64; 2]>,
    /// The frame of the first of `frames`.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub first: i32,
    /// The values of the frames from the first to the last key.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub frames: Vec<f64>,
}

fn is_zero(value: &i32) -> bool {
    *value == 0
}

impl Curve {
    /// A value without keys.
    pub fn still(value: f64) -> Self {
        Self { value, keys: Vec::new(), first: 0, frames: Vec::new() }
    }

    /// The value at a time: that of the frame, linear between frames, constant beyond the first and last one.
    pub fn at(&self, time: f64) -> f64 {
        let Some((before, share)) = self.place(time) else { return self.without_frames(time) };
        let after = self.frames[(before + 1).min(self.frames.len() - 1)];
        self.frames[before] + share * (after - self.frames[before])
    }

    /// The value at a time, held from frame to frame.
    pub fn held(&self, time: f64) -> f64 {
        self.place(time).map_or_else(|| self.without_frames(time), |(before, _)| self.frames[before])
    }

    /// Index of the frame at or before a time, and the share of the way to the next one.
    fn place(&self, time: f64) -> Option<(usize, f64)> {
        let last = self.frames.len().checked_sub(1)?;
        let place = (time - f64::from(self.first)).clamp(0.0, last as f64);
        (!place.is_nan()).then(|| (place.floor() as usize, place.fract()))
    }

    fn without_frames(&self, time: f64) -> f64 {
        self.keys.first().filter(|_| !time.is_nan()).map_or(self.value, |key| key[1])
    }
}

/// The settings of a part.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct PartSettings {
    /// Whether the part is drawn; above ½ it is.
    pub on: Curve,
    /// Whether the part is what lies outside of its outline.
    pub invert: Curve,
    /// Opacity, 0 to 1.
    pub opacity: Curve,
    /// Pixels by which the outline moves outward.
    pub grow: Curve,
    /// Pixels over which the border fades.
    pub feather: Curve,
    /// Index of the blend mode in [`Blend::ALL`], where it has no keys.
    pub mode: usize,
    /// The index at each time, if it has keys. Earlier versions keep to the mode without keys.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub modes: Option<Curve>,
    /// Whether the pen cannot change the part.
    pub lock: bool,
    /// The rate at which the border falls off.
    #[serde(skip_serializing_if = "is_one")]
    pub falloff: Curve,
    /// The curve of the border: 0 is that of all parts, others are one more than their index in [`FalloffCurve::ALL`].
    #[serde(skip_serializing_if = "is_none")]
    pub falloff_curve: Curve,
    /// The colour in the viewer and in files, if the user has chosen one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub colour: Option<[f64; 3]>,
}

fn is_one(curve: &Curve) -> bool {
    *curve == Curve::still(1.0)
}

fn is_none(curve: &Curve) -> bool {
    *curve == Curve::still(0.0)
}

impl Default for PartSettings {
    fn default() -> Self {
        Self {
            on: Curve::still(1.0),
            invert: Curve::still(0.0),
            opacity: Curve::still(1.0),
            grow: Curve::still(0.0),
            feather: Curve::still(0.0),
            mode: 0,
            modes: None,
            lock: false,
            falloff: Curve::still(1.0),
            falloff_curve: Curve::still(0.0),
            colour: None,
        }
    }
}

/// The settings of a part at a time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PartLook {
    /// Whether the part is drawn.
    pub on: bool,
    /// Whether it is what lies outside of its outline.
    pub invert: bool,
    /// Opacity, 0 to 1.
    pub opacity: f64,
    /// Pixels by which the outline moves outward.
    pub grow: f64,
    /// Pixels over which the border fades.
    pub feather: f64,
    /// How the part changes those behind it.
    pub blend: Blend,
    /// How the border falls off.
    pub falloff: Falloff,
}

impl Default for PartLook {
    fn default() -> Self {
        let falloff = Falloff::default();
        Self { on: true, invert: false, opacity: 1.0, grow: 0.0, feather: 0.0, blend: Blend::Add, falloff }
    }
}

impl PartLook {
    /// Whether the part is drawn like one without settings.
    pub fn is_plain(&self) -> bool {
        *self == Self::default()
    }
}

impl PartSettings {
    /// The settings at a time.
    pub fn at(&self, time: f64) -> PartLook {
        PartLook {
            on: self.on.at(time) > 0.5,
            invert: self.invert.at(time) > 0.5,
            opacity: self.opacity.at(time).clamp(0.0, 1.0),
            grow: self.grow.at(time),
            feather: self.feather.at(time).max(0.0),
            blend: blend(self.modes.as_ref().map_or(self.mode, |modes| modes.held(time).max(0.0) as usize)),
            falloff: falloff(self.falloff.at(time), self.falloff_curve.held(time).max(0.0) as usize),
        }
    }
}

/// The blend mode of an index.
pub fn blend(index: usize) -> Blend {
    Blend::ALL.get(index).map_or(Blend::Add, |(blend, _)| *blend)
}

/// The falloff of a rate and of an index of a curve, in which 0 is that of all parts.
pub fn falloff(rate: f64, index: usize) -> Falloff {
    let rate = if rate.is_finite() { rate.clamp(Falloff::LEAST, Falloff::MOST) } else { 1.0 };
    let curve = index.checked_sub(1).and_then(|index| FalloffCurve::ALL.get(index));
    Falloff { rate, curve: curve.map(|(curve, ..)| *curve) }
}

/// A file, and a mark of what it held ([`rototoon::pipeline::unchanged`]).
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct FileMark {
    /// The path as the user chose it.
    pub path: String,
    /// The mark as text.
    pub mark: String,
}

/// What an instance stores beside its document.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct State {
    version: u32,
    /// The part whose settings the page shows; empty if it shows none.
    #[serde(default)]
    pub page: String,
    /// The file whose shapes are in the document. The host's undo reports a change of Project like a choice of the user; a
    /// file that is loaded already must not replace what was made since.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub loaded: String,
    /// The document that the shapes were taken from, and what it held then.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub read: Option<FileMark>,
    /// Settings by part name. Parts without an entry have the defaults.
    #[serde(default)]
    pub parts: BTreeMap<String, PartSettings>,
    /// For each tracked part a sum of the keys and corrections that its tracks were made from, [`OTHER_ORDER`] or [`OTHER_SOURCE`].
    #[serde(default)]
    pub tracked: BTreeMap<String, String>,
    /// The spans of parts that were changed since they were tracked ([`super::spans`]).
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub changed: BTreeMap<String, Vec<Span>>,
}

impl Default for State {
    fn default() -> Self {
        Self {
            version: VERSION,
            page: String::new(),
            loaded: String::new(),
            read: None,
            parts: BTreeMap::new(),
            tracked: BTreeMap::new(),
            changed: BTreeMap::new(),
        }
    }
}

impl State {
    /// Reads a stored text. An empty one is a state without settings. The error is a message for the user.
    pub fn parse(text: &str) -> Result<Self, String> {
        if text.trim().is_empty() {
            return Ok(Self::default());
        }
        let read = || {
            let json = stored::decode(text)?;
            let state: Self = serde_json::from_str(&json).map_err(|error| error.to_string())?;
            if state.version > VERSION {
                let found = state.version;
                return Err(format!("found version {found} of a newer Rototoon, expected at most {VERSION}"));
            }
            Ok(state)
        };
        read().map_err(|error: String| format!("the composition's settings of parts: {error}"))
    }

    /// The text to store.
    pub fn to_text(&self) -> String {
        // Only maps with other than text keys cannot be written.
        stored::encode(&serde_json::to_string(self).unwrap_or_default())
    }

    /// Whether the tracks of a part were made from other keys or corrections than it has now. A part whose tracks came with
    /// a project, and that has not been tracked here, is taken as up to date.
    pub fn is_old(&self, part: &Part) -> bool {
        match self.tracked.get(&part.name) {
            Some(sum) => *sum != inputs(part),
            None => part.tracks.is_empty() && part.keys.len() > 1,
        }
    }

    /// Notes that the tracks of these parts are made from their keys and corrections as they are now.
    pub fn note_tracked<'a>(&mut self, parts: impl IntoIterator<Item = &'a Part>) {
        for part in parts {
            self.changed.remove(&part.name);
            if part.tracks.is_empty() {
                self.tracked.remove(&part.name);
            } else {
                self.tracked.insert(part.name.clone(), inputs(part));
            }
        }
    }

    /// Whether the tracks of a part were made with another order of the parts, or from another source.
    pub fn has_other_input(&self, part: &Part) -> bool {
        self.tracked.get(&part.name).is_some_and(|sum| [OTHER_ORDER, OTHER_SOURCE].contains(&sum.as_str()))
    }

    /// Makes all of a part's tracks old, for a reason.
    fn make_old(&mut self, part: &Part, reason: &str) {
        self.changed.remove(&part.name);
        self.tracked.insert(part.name.clone(), reason.into());
    }

    /// Before an edit: notes what tracks that came with a project were made from, so that the edit makes them old.
    pub fn note_known(&mut self, parts: &[Part]) {
        for part in parts.iter().filter(|part| !part.tracks.is_empty()) {
            self.tracked.entry(part.name.clone()).or_insert_with(|| inputs(part));
        }
    }

    /// Before an edit: makes the tracks of parts old that have other parts in front of them after it. Nearer parts hide
    /// farther ones from the tracker. Parts that come or go do not count, as they have no order in both documents.
    pub fn note_order(&mut self, before: &[Part], after: &[Part]) {
        let earlier: BTreeMap<&str, f64> = before.iter().map(|part| (part.name.as_str(), part.depth)).collect();
        let both: Vec<(&Part, f64)> =
            after.iter().filter_map(|part| Some((part, *earlier.get(part.name.as_str())?))).collect();
        if both.iter().all(|(part, was)| part.depth == *was) {
            return;
        }
        for (part, was) in both.iter().filter(|(part, _)| !part.tracks.is_empty()) {
            let changed = |(other, its): &(&Part, f64)| other.closed && (other.depth > part.depth) != (its > was);
            if both.iter().any(changed) {
                self.make_old(part, OTHER_ORDER);
            }
        }
    }

    /// Gives what belongs to a part to its new name.
    pub fn rename(&mut self, old: &str, new: &str) {
        if let Some(settings) = self.parts.remove(old) {
            self.parts.insert(new.to_owned(), settings);
        }
        if let Some(sum) = self.tracked.remove(old) {
            self.tracked.insert(new.to_owned(), sum);
        }
        if let Some(spans) = self.changed.remove(old) {
            self.changed.insert(new.to_owned(), spans);
        }
        if self.page == old {
            new.clone_into(&mut self.page);
        }
    }

    /// Makes the tracks of parts old because the source has changed since.
    pub fn note_stale<'a>(&mut self, parts: impl IntoIterator<Item = &'a Part>) {
        parts.into_iter().for_each(|part| self.make_old(part, OTHER_SOURCE));
    }

    /// Notes that the shapes are those of a file.
    pub fn note_file(&mut self, file: &FileMark) {
        file.path.clone_into(&mut self.loaded);
        self.read = Some(file.clone());
    }

    /// Drops what belongs to parts that are gone.
    pub fn keep_only(&mut self, parts: &[Part]) {
        let known = |name: &String| parts.iter().any(|part| part.name == *name);
        self.parts.retain(|name, _| known(name));
        self.tracked.retain(|name, _| known(name));
        self.changed.retain(|name, _| known(name));
        if !known(&self.page) {
            self.page.clear();
        }
    }
}

/// A sum of a part's keys, corrections and hidden frames (FNV-1a, 64 bits). Coordinates count as documents round them.
fn inputs(part: &Part) -> String {
    let mut sum = 0xcbf2_9ce4_8422_2325u64;
    let mut add = |value: i64| {
        for byte in value.to_le_bytes() {
            sum = (sum ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3);
        }
    };
    let rounded = |value: f64| (value * 1e4).round() as i64;
    add(part.closed.into());
    for (frame, points) in &part.keys {
        add((*frame).into());
        add(points.len() as i64);
        points.iter().for_each(|p| [p.x, p.y].map(rounded).into_iter().for_each(&mut add));
    }
    for (frame, pins) in &part.pins {
        add(i64::from(*frame) + (1 << 40));
        for (index, p) in pins {
            add(*index as i64);
            [p.x, p.y].map(rounded).into_iter().for_each(&mut add);
        }
    }
    for (frame, p) in &part.centers {
        add(i64::from(*frame) + (1 << 41));
        [p.x, p.y].map(rounded).into_iter().for_each(&mut add);
    }
    for [first, last] in &part.absent {
        add(i64::from(*first) + (1 << 42));
        add((*last).into());
    }
    format!("{sum:016x}")
}

#[cfg(test)]
mod tests {
    use super::*;
    use rototoon::geometry::Point;

    #[test]
    fn a_curve_has_its_frames() {
        let curve = Curve { value: 9.0, keys: vec![[2.0, 0.0], [4.0, 1.0]], first: 2, frames: vec![0.0, 0.3, 1.0] };
        for (time, value) in
            [(-5.0, 0.0), (2.0, 0.0), (2.5, 0.15), (3.0, 0.3), (4.0, 1.0), (99.0, 1.0), (f64::NAN, 9.0)]
        {
            assert!((curve.at(time) - value).abs() < 1e-12, "{time}");
        }
        assert_eq!(Curve::still(0.25).at(7.0), 0.25);
        assert_eq!([-5.0, 3.0, 3.9, 4.0].map(|time| curve.held(time)), [0.0, 0.3, 0.3, 1.0]);
    }

    #[test]
    fn what_is_stored_is_read_and_newer_states_are_refused() {
        let mut state = State { page: "größe".into(), ..State::default() };
        let settings = PartSettings { opacity: Curve::still(0.5), mode: 2, lock: true, ..PartSettings::default() };
        state.parts.insert("größe".into(), settings);
        assert_eq!(State::parse(&state.to_text()).unwrap(), state);
        assert_eq!(State::parse("").unwrap(), State::default());
        assert!(State::parse(&stored::encode("{\"version\": 2}")).unwrap_err().contains("newer"));
        assert!(State::parse("nonsense").unwrap_err().contains("settings of parts"));
        assert_eq!(state.parts["größe"].at(3.0).blend, Blend::Intersect);
        assert!(PartSettings::default().at(1.0).is_plain());
    }

    #[test]
    fn tracks_are_old_after_a_change_and_new_after_undo() {
        let points = vec![Point::new(1.0, 2.0), Point::new(3.0, 4.0), Point::new(5.0, 1.0)];
        let keys = [(0, points.clone()), (4, points.clone())].into();
        let mut part = Part { name: "a".into(), closed: true, keys, ..Part::default() };
        let mut state = State::default();
        assert!(state.is_old(&part), "it was never tracked");
        part.tracks = (0..=4).map(|frame| (frame, points.clone())).collect();
        assert!(!state.is_old(&part), "tracks of a project");
        state.note_known(std::slice::from_ref(&part));
        let before = part.clone();
        part.pins.entry(2).or_default().insert(1, Point::ONE);
        assert!(state.is_old(&part) && !state.is_old(&before));
        state.note_tracked([&part]);
        assert!(!state.is_old(&part));
        part.set_absent(2, 3);
        assert!(state.is_old(&part), "hidden frames count");
        let behind = Part { name: "b".into(), depth: -1.0, ..part.clone() };
        let before = [part.clone(), behind.clone()];
        state.note_tracked(&before);
        let after = [part.clone(), Part { depth: 1.0, ..behind.clone() }];
        let same = [part.clone(), Part { depth: -0.5, ..behind }];
        state.note_order(&before, &same);
        assert!(same.iter().all(|part| !state.is_old(part)));
        state.note_order(&before, &after);
        assert!(after.iter().all(|part| state.is_old(part)), "one comes in front of the other");
        state.keep_only(&[]);
        assert!(state.tracked.is_empty());
    }
}
