//! Follows parts with a single key outward from it.
//!
//! Between two keys a tracker knows where it must arrive. From a single key it can only continue, and the main question
//! is how long the result can be trusted. So a part is followed backwards and forwards, drawing by drawing, until it is
//! lost, the shot ends, or the part leaves the picture. Where it is lost, a key is needed.
//!
//! - [`plan`]: which parts, in which order, and the memory of results
//! - [`arm`]: one direction: hypotheses on each drawing, and the path through them
//! - [`trust`]: how sure a point is with one key, and when a part is lost
//! - `finish`: the track from the chosen poses
//! - `apart`: parts that went to the place of another one are followed again
//!
//! The key is the only source for the part's appearance. Its lattice and its colours ([`super::lattice`]) are carried
//! along ([`super::propagate`]) and always compared with the key, so nothing drifts. Where the fit becomes much worse
//! than before, the complete picture is searched ([`super::search`]). The path over time is chosen as between keys
//! ([`super::select`]). Reading ends a few drawings after the last trusted one, so long footage takes no more time than
//! the found part of it.
//!
//! **Occlusion.** Parts are followed from the nearest to the farthest, after the parts with two keys or more. Samples
//! under these parts are unseen and have no effect. The reverse is not true: a part that is followed outward hides
//! nothing of parts between keys, except on its key frame (like any key). So a part with a single key does not change
//! the other parts.
//!
//! **Corrections** on any frame other than the key are hard constraints. A corrected frame is trusted: the part is
//! followed at least to it, also through cuts.
//!
//! **Absence.** Frames on which the part is absent are left out. Behind them it may be anywhere: the whole picture is searched, and
//! the way there costs nothing.
//!
//! **Limits.** Parts choose one by one, so only occlusion distinguishes equal limbs that cross. A part that turns its
//! other side to the viewer is lost there; it needs a new key.

mod apart;
pub mod arm;
mod finish;
pub mod plan;
pub mod trust;

use crate::contract::job::Correction;
use crate::contract::tracking::TrackEnd;
use rototoon_base::geometry::Point;
use rototoon_base::scene::FrameNumber;
use std::collections::BTreeMap;

/// One part with a single key.
#[derive(Clone, Debug, PartialEq)]
pub struct OutwardJob {
    /// Name of the part, for messages.
    pub name: String,
    /// Whether the contour is closed.
    pub closed: bool,
    /// The key's frame.
    pub frame: FrameNumber,
    /// The key's control points.
    pub key: Vec<Point>,
    /// First and last frame of the footage.
    pub footage: [FrameNumber; 2],
    /// The artist's corrections by frame. The key has none.
    pub corrections: BTreeMap<FrameNumber, Correction>,
    /// Frames on which the part is not there, by the artist's word, as first and last frames.
    pub absent: Vec<[FrameNumber; 2]>,
    /// By frame: closed contours of the nearer parts, keyed or tracked.
    pub occluders: BTreeMap<FrameNumber, Vec<Vec<Point>>>,
    /// By frame: contours of other parts on whose place this part cannot be ([`twins`](crate::shared::twins)).
    pub taken: BTreeMap<FrameNumber, Vec<Vec<Point>>>,
    /// Size of the pictures in pixels.
    pub size: (usize, usize),
}

/// The result for a part with a single key.
#[derive(Clone, Debug, PartialEq)]
pub struct OutwardTrack {
    /// Control points on every frame from the first trusted one to the last, in pixels of the picture. The key and the
    /// corrections are exact.
    pub tracks: BTreeMap<FrameNumber, Vec<Point>>,
    /// Confidence by frame and point, 0 to 1. It is 1 on the key.
    pub confidence: BTreeMap<FrameNumber, Vec<f64>>,
    /// Ends of the track that are not ends of the footage, the backward one first.
    pub ends: Vec<TrackEnd>,
    /// Number of aligned poses.
    pub steps: usize,
    /// Mean energy of the chosen poses.
    pub cost: f64,
}
