//! Contours keyed on one frame only, followed outward from it.
//!
//! Between two keys a tracker knows where it has to arrive. From a single key it can only go on, and the question is less
//! where the part goes than how long that is believed. So a part is followed backwards and forwards, one drawing after
//! the other, until it is lost, the shot ends, or the part leaves the picture; and where it was lost a key is wanted.
//!
//! - [`plan`]: which parts, in which order, and what is remembered of them
//! - [`arm`]: one direction: hypotheses drawing by drawing, the path through them
//! - [`trust`]: how sure a point is with one key, and when a part is lost
//! - `finish`: the chosen poses made into a track
//!
//! What is believed of each drawing comes from the key alone: its lattice and its colours ([`super::lattice`]) are
//! carried along ([`super::propagate`]), always compared with the key, so that nothing drifts; where that fits much worse
//! than before the whole picture is searched ([`super::search`]); the path over time is chosen as between keys
//! ([`super::select`]). Reading ends a few drawings behind the last one that is trusted: footage of any length costs no
//! more than what is found in it.
//!
//! **Occlusion.** Parts are followed from the nearest to the farthest, after the parts with two keys or more; what those
//! hide is unseen and says nothing. The reverse does not hold: what is followed outward hides nothing of parts between
//! keys but on its key frame (as any key does), so that a single-key part changes nothing of the others.
//!
//! **Corrections** on any frame outside the key are hard constraints, and a frame that the artist corrected is trusted:
//! the part is followed at least so far, through cuts too.
//!
//! Limits: parts choose one by one, so equal limbs that cross are told apart by what hides them alone; a part that turns
//! its other side to the viewer is lost there, and rightly.

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
    /// The artist's corrections; none on the key.
    pub corrections: BTreeMap<FrameNumber, Correction>,
    /// Closed contours of the nearer parts on each frame, as keyed or tracked.
    pub occluders: BTreeMap<FrameNumber, Vec<Vec<Point>>>,
    /// Size of the pictures in pixels.
    pub size: (usize, usize),
}

/// What was found for a part with a single key.
#[derive(Clone, Debug, PartialEq)]
pub struct OutwardTrack {
    /// Control points on every frame from the first trusted one to the last, the key and corrections exactly.
    pub tracks: BTreeMap<FrameNumber, Vec<Point>>,
    /// By frame and point, 0 to 1; 1 on the key.
    pub confidence: BTreeMap<FrameNumber, Vec<f64>>,
    /// Where it ends before the footage does, backwards first.
    pub ends: Vec<TrackEnd>,
    /// Poses aligned.
    pub steps: usize,
    /// Mean energy of the chosen poses.
    pub cost: f64,
}
