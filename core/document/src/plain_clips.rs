//! Clips straight from text into numbers, and back: the quick way for files that are as they must be.
//!
//! A tree of JSON values makes an allocation for every point, ten times the work of reading its digits. Here the types of the form
//! ([`super::clips`]) are read directly; anything unexpected makes the whole text unreadable this way, and nothing is said about
//! it: that is the slow way's business.

use rototoon_base::scene::Clip;
use rototoon_base::scene::skeleton::{COUNT, NAMES, Posture};
use serde::{Deserialize, Serialize, Serializer};
use std::borrow::Cow;
use std::collections::BTreeSet;

/// Version of the form.
pub(super) const VERSION: u64 = 1;

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
}

/// Frames a second of a file that does not say.
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
    let mut seen = BTreeSet::new();
    let whole = file.clips.iter().all(|clip| {
        let labelled = !clip.character.is_empty() && !clip.motion.is_empty();
        labelled && !clip.points.is_empty() && seen.insert((&clip.character, &clip.motion))
    });
    if !(1..=VERSION).contains(&file.rototoon_clips) || file.fps <= 0.0 || !named || !whole {
        return None;
    }
    let clips = file.clips.into_iter().map(|clip| Clip::new(clip.character, clip.motion, clip.points)).collect();
    Some((clips, file.fps))
}

#[derive(Serialize)]
struct Written<'a> {
    rototoon_clips: u64,
    fps: Rounded,
    keypoints: [&'static str; COUNT],
    clips: Vec<WrittenClip<'a>>,
}

#[derive(Serialize)]
struct WrittenClip<'a> {
    character: &'a str,
    motion: &'a str,
    points: Vec<[[Rounded; 2]; COUNT]>,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    deviation: Vec<[Rounded; COUNT]>,
}

/// Places are written to a millionth: far below what can be seen, in torso lengths as in pixels.
#[derive(Clone, Copy)]
struct Rounded(f64);

impl Serialize for Rounded {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let rounded = (self.0 * 1e6).round() / 1e6;
        serializer.serialize_f64(if rounded == 0.0 { 0.0 } else { rounded })
    }
}

/// The text of clips.
pub(super) fn written(clips: &[Clip], fps: f64) -> String {
    let of = |clip: &'_ Clip| -> (Vec<[[Rounded; 2]; COUNT]>, Vec<[Rounded; COUNT]>) {
        let points = clip.postures.iter().map(|posture| posture.map(|p| [Rounded(p.x), Rounded(p.y)])).collect();
        (points, clip.deviation.iter().map(|frame| frame.map(Rounded)).collect())
    };
    let list = clips.iter().map(|clip| {
        let (points, deviation) = of(clip);
        WrittenClip { character: &clip.character, motion: &clip.motion, points, deviation }
    });
    let file = Written { rototoon_clips: VERSION, fps: Rounded(fps), keypoints: NAMES, clips: list.collect() };
    // Numbers, names and lists always have a text.
    serde_json::to_string(&file).unwrap_or_default()
}
