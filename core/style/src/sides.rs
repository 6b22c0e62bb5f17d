//! The sides to which clips look, and clips brought to the side of the content's.
//!
//! A library has shots of both directions. Two clips that look to different sides share nothing by their numbers: a lean
//! forwards is a lean backwards there, and what one side teaches is false on the other. So all clips are brought to the
//! side of the content's clip before anything is learned, in a mirror ([`in_a_mirror`]): x is turned round, and left and
//! right are exchanged, as the viewer sees them. The content's clip is never touched, since the result has its way through
//! the picture. So the result looks to where the content looks, and goes to where the content goes.
//!
//! A clip whose side cannot be told ([`of_clip`]) stays as it is, and all do if the content's side cannot be told. That is said
//! if any clip of the library has a side: a library that is seen from the front needs no mirror.
//!
//! A pose that is drawn for the result is met as it is drawn. If it looks to the other side, that is said too.
//!
//! Limits: a clip that was mirrored before, without its left and right exchanged, has the other leg in front after this.

use super::{KeyPose, Request};
use rototoon_base::scene::facing::{Side, in_a_mirror, of_clip};
use rototoon_base::scene::{Clip, Template};
use std::borrow::Cow;

/// At most so many clips are named in a sentence.
const NAMED: usize = 8;

/// What was found out about the sides of clips.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Sides {
    /// The content's side; none if it cannot be told.
    pub content: Option<Side>,
    /// The clips that were mirrored, by character and motion.
    pub mirrored: Vec<(String, String)>,
    /// The clips that may have to be mirrored, but were not, since their side or the content's cannot be told.
    pub untold: Vec<(String, String)>,
    /// Frames of the poses drawn for the result that look to the other side.
    pub keys: Vec<usize>,
}

/// Brings the clips that a translation learns from to the side of the content's.
pub(super) fn to_content<'a>(clips: Cow<'a, [Clip]>, request: &Request) -> (Cow<'a, [Clip]>, Sides) {
    let is_content = |clip: &Clip| clip.character == request.content && clip.motion == request.motion;
    let is_target = |clip: &Clip| clip.character == request.style && clip.motion == request.motion;
    let sides: Vec<Option<Side>> = clips.iter().map(|clip| of_clip(&clip.template, &clip.postures)).collect();
    let content = clips.iter().position(is_content).and_then(|k| sides[k]);
    let mut found = Sides { content, keys: other_keys(request.keys, content), ..Sides::default() };
    let name = |clip: &Clip| (clip.character.clone(), clip.motion.clone());
    let learned = |k: &usize| !is_target(&clips[*k]) && !is_content(&clips[*k]);
    let of = |wanted: &dyn Fn(Option<Side>) -> bool| -> Vec<usize> {
        (0..clips.len()).filter(learned).filter(|k| wanted(sides[*k])).collect()
    };
    let Some(content) = content else {
        found.untold = of(&|side| side.is_some()).iter().map(|&k| name(&clips[k])).collect();
        return (clips, found);
    };
    found.untold = of(&|side| side.is_none()).iter().map(|&k| name(&clips[k])).collect();
    let other = of(&|side| side.is_some_and(|side| side != content));
    found.mirrored = other.iter().map(|&k| name(&clips[k])).collect();
    if other.is_empty() {
        return (clips, found);
    }
    let mut clips = clips.into_owned();
    for k in other {
        clips[k].postures = in_a_mirror(&clips[k].template, &clips[k].postures);
    }
    (Cow::Owned(clips), found)
}

/// The frames of drawn poses that look to the other side than the content.
fn other_keys(keys: &[KeyPose], content: Option<Side>) -> Vec<usize> {
    let side = |key: &KeyPose| of_clip(&Template::human(), &[key.posture.to_vec()]);
    let other = keys.iter().filter(|key| side(key).zip(content).is_some_and(|(a, b)| a != b));
    other.map(|key| key.frame).collect()
}

impl Sides {
    /// What a person should know, a sentence each.
    pub(super) fn notes(&self) -> Vec<String> {
        let mut said = Vec::new();
        if let Some(side) = self.content.filter(|_| !self.mirrored.is_empty()) {
            said.push(format!("mirrored, to look {} as the content's clip does: {}", side.id(), named(&self.mirrored)));
        }
        if !self.untold.is_empty() {
            said.push(match self.content {
                Some(side) => format!(
                    "not mirrored, since it cannot be told whether they look {} as the content's clip does: {}",
                    side.id(),
                    named(&self.untold)
                ),
                None => format!(
                    "it cannot be told to which side the content's clip looks, so no clip was mirrored; these look to a side: {}",
                    named(&self.untold)
                ),
            });
        }
        if let Some(side) = self.content.filter(|_| !self.keys.is_empty()) {
            let frames: Vec<String> = self.keys.iter().map(ToString::to_string).collect();
            said.push(format!(
                "the drawn pose of frame {} looks to the other side than the content's clip, which looks {}; it is met as it is drawn",
                frames.join(", "),
                side.id()
            ));
        }
        said
    }
}

/// Clips by name, the first few of many.
fn named(clips: &[(String, String)]) -> String {
    let named = clips.iter().take(NAMED).map(|(character, motion)| format!("{character:?} {motion:?}"));
    let mut named: Vec<String> = named.collect();
    if clips.len() > NAMED {
        named.push(format!("and {} more", clips.len() - NAMED));
    }
    named.join(", ")
}
