//! The JSON options of stroke matching and in-betweens. `rototoon_draw_in_betweens` documents them.

use crate::status::Failure;
use rototoon::tween::between::{Captured, Leaving, Options};
use rototoon::tween::matching::Options as MatchingOptions;
use serde::Deserialize;
use serde_json::Value;
use std::collections::BTreeMap;
use std::sync::Arc;

/// Largest absolute coordinate of a captured point, in pixels.
const FARTHEST: f64 = 1e9;

/// The options, as read from JSON.
#[derive(Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Asked {
    max_cost: f64,
    max_turn: f64,
    max_scale: f64,
    /// Number of threads; 0 for one per core.
    pub threads: usize,
    arcs: f64,
    rigid: bool,
    contacts: bool,
    rest: bool,
    leaving: AskedLeaving,
    /// For each drawing the spacing of the movement to the next one, in the form of documents.
    pub spacing: Vec<Value>,
    /// Drawings at which the velocity may jump.
    pub corners: Vec<usize>,
    /// The spans to draw.
    pub spans: Vec<AskedSpan>,
    /// Pegs, in the form of documents.
    pub pegs: Vec<Value>,
    /// For each stroke the name of its peg.
    pub hung: Vec<Option<String>>,
    captured: Vec<AskedCaptured>,
}

/// A captured contour: its points on each frame, beginning with frame `first`.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct AskedCaptured {
    closed: bool,
    first: i32,
    contours: Vec<Vec<[f64; 2]>>,
}

#[derive(Deserialize)]
#[serde(rename_all = "snake_case")]
enum AskedLeaving {
    Grow,
    Fade,
    Leave([f64; 2]),
}

/// The frames to draw between two drawings.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub struct AskedSpan {
    /// Index of the earlier drawing.
    pub key: usize,
    /// Frames between it and the next drawing.
    pub frames: Vec<i32>,
}

impl Default for Asked {
    fn default() -> Self {
        let (matching, between) = (MatchingOptions::default(), Options::default());
        Self {
            max_cost: matching.max_cost,
            max_turn: matching.max_turn,
            max_scale: matching.max_scale,
            threads: 0,
            arcs: between.arcs,
            rigid: between.rigid,
            contacts: between.contacts,
            rest: between.rest,
            leaving: AskedLeaving::Grow,
            spacing: Vec::new(),
            corners: Vec::new(),
            spans: Vec::new(),
            pegs: Vec::new(),
            hung: Vec::new(),
            captured: Vec::new(),
        }
    }
}

impl Asked {
    /// Reads a caller's JSON. Options that are left out have their defaults, and so have all in an empty text.
    pub fn parse(json: &str) -> Result<Self, Failure> {
        match json {
            "" => Ok(Self::default()),
            _ => serde_json::from_str(json).map_err(|error| Failure::Error(format!("options: {error}"))),
        }
    }

    /// The options of stroke matching.
    pub fn matching(&self) -> MatchingOptions {
        MatchingOptions { max_cost: self.max_cost, max_turn: self.max_turn, max_scale: self.max_scale }
    }

    /// The options of in-betweens.
    pub fn between(&self) -> Options {
        let leaving = match self.leaving {
            AskedLeaving::Grow => Leaving::Grow,
            AskedLeaving::Fade => Leaving::Fade,
            AskedLeaving::Leave(size) => Leaving::Leave { size: size.into() },
        };
        Options { arcs: self.arcs, rigid: self.rigid, contacts: self.contacts, leaving, rest: self.rest }
    }

    /// The captured contours, checked.
    pub fn captured(&self) -> Result<Arc<[Captured]>, Failure> {
        self.captured.iter().enumerate().map(|(k, part)| part.checked(k)).collect()
    }
}

impl AskedCaptured {
    /// The contour, checked. `k` is its index, for messages.
    fn checked(&self, k: usize) -> Result<Captured, Failure> {
        let wrong = |text: String| Failure::Error(format!("captured[{k}].{text}"));
        let mut contours = BTreeMap::new();
        for (i, points) in self.contours.iter().enumerate() {
            let frame = i32::try_from(i).ok().and_then(|i| self.first.checked_add(i));
            let frame =
                frame.ok_or_else(|| wrong(format!("first: found {}, expected an earlier frame", self.first)))?;
            if let Some([x, y]) = points.iter().find(|p| !p.iter().all(|v| v.abs() <= FARTHEST)) {
                let expected = "numbers between -1e9 and 1e9";
                return Err(wrong(format!("contours[{i}] (frame {frame}): found ({x}, {y}), expected {expected}")));
            }
            contours.insert(frame, points.iter().map(|&p| p.into()).collect());
        }
        Ok(Captured { closed: self.closed, contours })
    }
}
