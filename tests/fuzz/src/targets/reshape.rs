//! Reshaping: a document's drawing follows a clip; and back, a clip from its contours.

use crate::given::clips::clips;
use crate::given::{self, frame, number, points};
use arbitrary::{Result, Unstructured};
use rototoon::pipeline::{self, ClipJob, ReshapeJob};
use rototoon::project::Document;
use rototoon::reshape::puppet::Options;
use rototoon::scene::{Footage, Silent};
use std::collections::BTreeMap;

/// Most frames of a footage. More are as slow as they are many.
const MOST_FRAMES: i64 = 32;

/// Captures a clip of a document, and reshapes the document after a clip.
pub fn reshape(data: &[u8]) {
    let (text, mut u) = given::text_and_rest(data, "{", given::document::document);
    let Ok(document) = Document::parse(&text, "fuzz") else { return };
    if frames(&document.scene.footage) > MOST_FRAMES {
        return;
    }
    let job = ClipJob { character: "anna".into(), motion: "walk".into(), frames: None };
    if let Ok(captured) = pipeline::clip(&document, &job) {
        reshaped(document.clone(), &captured.clips.clips[0], &ReshapeAsked::default());
    }
    let _ = decoded(document, &mut u);
}

/// What is asked for beside the clip.
#[derive(Default)]
struct ReshapeAsked {
    rest: Option<i32>,
    fps: f64,
    points: BTreeMap<String, Vec<rototoon::geometry::Point>>,
}

fn decoded(document: Document, u: &mut Unstructured) -> Result<()> {
    let known = clips(u, 1, 3)?;
    let Some(clip) = known.clips.first() else { return Ok(()) };
    let mut asked = ReshapeAsked { fps: 12.0, ..ReshapeAsked::default() };
    if u.ratio(1u8, 4)? {
        (asked.rest, asked.fps) = (Some(frame(u)?), number(u)?);
    }
    if u.ratio(1u8, 4)? {
        asked.points.insert("near arm".into(), points(u, 0, 6)?);
    }
    reshaped(document, clip, &asked);
    Ok(())
}

fn reshaped(mut document: Document, clip: &rototoon::scene::Clip, asked: &ReshapeAsked) {
    let job = ReshapeJob {
        clip,
        fps: asked.fps,
        rest: asked.rest,
        over: None,
        chains: Vec::new(),
        mirror: Default::default(),
        options: Options::default(),
        points: asked.points.clone(),
    };
    if pipeline::reshape(&mut document, &job, &Silent).is_ok() {
        let tracks = document.scene.parts.iter().flat_map(|part| part.tracks.values());
        assert!(tracks.flatten().all(|p| p.is_finite()), "a reshaped point is not finite");
        let _ = document.to_json();
    }
}

fn frames(footage: &Footage) -> i64 {
    i64::from(footage.last) - i64::from(footage.first)
}
