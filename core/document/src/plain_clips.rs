//! The fast way to read and write valid files of clips: text directly into numbers and back.
//!
//! A tree of JSON values allocates memory for every point, which costs ten times as much as parsing its digits. Here
//! the types of the format ([`super::clips`]) are parsed directly. Any unexpected value makes [`read`] fail without a
//! reason; the slow way then finds the error.

use super::schema::{MAX_FPS, MIN_FPS};
use super::skeleton;
use rototoon_base::scene::skeleton::{NAMES, Posture};
use rototoon_base::scene::{Clip, Template};
use serde::{Deserialize, Serialize, Serializer};
use serde_json::Value;
use std::borrow::Cow;
use std::collections::{BTreeMap, BTreeSet};

/// Latest version of the form. Version 2 has other bodies than the human one.
pub(super) const VERSION: u64 = 2;
/// Version of files that hold human clips only.
const HUMAN_VERSION: u64 = 1;

#[derive(Deserialize)]
struct File<'a> {
    rototoon_clips: u64,
    #[serde(default = "usual_rate")]
    fps: f64,
    #[serde(borrow, default)]
    keypoints: Option<Vec<Cow<'a, str>>>,
    #[serde(borrow)]
    clips: Vec<Moves<'a>>,
}

#[derive(Deserialize)]
struct Moves<'a> {
    #[serde(borrow)]
    character: Cow<'a, str>,
    #[serde(borrow)]
    motion: Cow<'a, str>,
    points: Vec<Posture>,
    #[serde(default)]
    deviation: Vec<Vec<f64>>,
    #[serde(borrow, default)]
    guessed: BTreeMap<Cow<'a, str>, Vec<[usize; 2]>>,
}

impl Moves<'_> {
    /// The clip; none if what is guessed names no key point or no frame, or if deviations are not those of the points.
    fn clip(self) -> Option<Clip> {
        let frames = self.points.len();
        if !self.deviation.is_empty() && !super::clips::deviates(&self.deviation, frames, NAMES.len()) {
            return None;
        }
        let guess = |(name, times): (Cow<'_, str>, Vec<[usize; 2]>)| {
            let point = NAMES.iter().position(|known| *known == name)?;
            super::clips::rises(&times, frames).then_some((point, times))
        };
        let guessed = self.guessed.into_iter().map(guess).collect::<Option<_>>()?;
        Some(Clip { guessed, deviation: self.deviation, ..Clip::new(self.character, self.motion, self.points) })
    }
}

/// Frames per second of a file without `fps`.
fn usual_rate() -> f64 {
    25.0
}

/// The clips of a text and their frames a second; none where anything is not as it must be.
pub(super) fn read(text: &str) -> Option<(Vec<Clip>, f64)> {
    let file: File = serde_json::from_str(text).ok()?;
    let named = match &file.keypoints {
        Some(names) => names.iter().eq(NAMES.iter()),
        None => !text.contains("\"keypoints\""),
    };
    // Other bodies are read the slow way.
    if text.contains("\"skeleton\"") {
        return None;
    }
    let mut seen = BTreeSet::new();
    let whole = file.clips.iter().all(|clip| {
        let labelled = !clip.character.is_empty() && !clip.motion.is_empty();
        labelled && !clip.points.is_empty() && seen.insert((&clip.character, &clip.motion))
    });
    if !(1..=VERSION).contains(&file.rototoon_clips) || !(MIN_FPS..=MAX_FPS).contains(&file.fps) || !named || !whole {
        return None;
    }
    let clips = file.clips.into_iter().map(Moves::clip).collect::<Option<_>>()?;
    Some((clips, file.fps))
}

#[derive(Serialize)]
struct Written<'a> {
    rototoon_clips: u64,
    fps: Rounded,
    #[serde(skip_serializing_if = "Option::is_none")]
    skeleton: Option<Value>,
    keypoints: Vec<&'a str>,
    clips: Vec<WrittenClip<'a>>,
}

#[derive(Serialize)]
struct WrittenClip<'a> {
    character: &'a str,
    motion: &'a str,
    /// Only where it is another than the file's.
    #[serde(skip_serializing_if = "Option::is_none")]
    skeleton: Option<Value>,
    points: Vec<Vec<[Rounded; 2]>>,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    deviation: Vec<Vec<Rounded>>,
    #[serde(skip_serializing_if = "BTreeMap::is_empty")]
    guessed: BTreeMap<&'a str, &'a [[usize; 2]]>,
}

/// Numbers are written with six decimals, far below what is visible, in torso lengths as well as in pixels.
#[derive(Clone, Copy)]
struct Rounded(f64);

impl Serialize for Rounded {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let rounded = (self.0 * 1e6).round() / 1e6;
        // The largest numbers have no decimals, and a million of them is infinite, which JSON cannot say.
        let rounded = if rounded.is_finite() { rounded } else { self.0 };
        serializer.serialize_f64(if rounded == 0.0 { 0.0 } else { rounded })
    }
}

/// The text of clips.
pub(super) fn written(clips: &[Clip], fps: f64) -> String {
    let template = clips.first().map_or_else(Template::human, |clip| clip.template.clone());
    let own = |clip: &Clip| {
        let named = || skeleton::written(&clip.template).unwrap_or_else(|| clip.template.name().into());
        (clip.template != template).then(named)
    };
    let clip = |clip: &'_ Clip| -> (Vec<Vec<[Rounded; 2]>>, Vec<Vec<Rounded>>) {
        let points = clip.postures.iter().map(|p| p.iter().map(|p| [Rounded(p.x), Rounded(p.y)]).collect()).collect();
        (points, clip.deviation.iter().map(|frame| frame.iter().copied().map(Rounded).collect()).collect())
    };
    let list = clips.iter().map(|c| {
        let (points, deviation) = clip(c);
        let guessed = c.guessed.iter().map(|(point, times)| (c.template.point_name(*point), &times[..])).collect();
        WrittenClip { character: &c.character, motion: &c.motion, skeleton: own(c), points, deviation, guessed }
    });
    let human = clips.iter().all(|clip| clip.template.is_human());
    let file = Written {
        rototoon_clips: if human { HUMAN_VERSION } else { VERSION },
        fps: Rounded(fps),
        skeleton: skeleton::written(&template),
        keypoints: template.names(),
        clips: list.collect(),
    };
    // Numbers, names and lists always have a text.
    serde_json::to_string(&file).unwrap_or_default()
}
