//! Presets, options, results and errors of tracking, and the [`Tracker`], which passes the work to the solver of its
//! preset.
//!
//! A solver keeps its results, so that after an edit only the affected jobs are solved again. A result depends only on
//! the scene and the pictures. It does not depend on earlier runs or on the number of threads.

use crate::contract::cache::Cache;
use crate::contract::error::TrackError;
use crate::contract::job::SpanSolver;
use crate::contract::tracking::{SceneSolver, Tracking};
use crate::rotoscope::agarwala2004::Agarwala2004;
use crate::rotoscope::liang2012::Liang2012;
use crate::rototoon::Rototoon;
use crate::rototoon::mechanisms::Mechanisms;
use crate::shared::part_by_part::PartByPart;
use crate::zhou2011::Zhou2011;
use rototoon_base::geometry::Point;
use rototoon_base::scene::{Footage, FrameNumber, FrameSource, Part, Progress, Scene};
use std::sync::Arc;

/// The tracking method.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Preset {
    /// The default method, the best one of Rototoon (module `rototoon`).
    #[default]
    Rototoon,
    /// Zhou & Xiao 2011 as printed (module `zhou2011`).
    Zhou2011,
    /// Agarwala et al. 2004 (module `agarwala2004`).
    Agarwala2004,
    /// Agarwala et al. 2004 with the ribbon and the colour penalty of Liang et al. 2012 (module `liang2012`).
    Liang2012,
}

impl Preset {
    /// Every preset with its id in documents, in parameters and on the command line.
    pub const ALL: [(Self, &str); 4] = [
        (Self::Rototoon, "rototoon"),
        (Self::Zhou2011, "zhou2011"),
        (Self::Agarwala2004, "agarwala2004"),
        (Self::Liang2012, "liang2012"),
    ];

    /// The preset with an id. `None` if there is no such preset.
    pub fn from_id(id: &str) -> Option<Self> {
        Self::ALL.iter().find(|(_, name)| *name == id).map(|(preset, _)| *preset)
    }

    fn solver(self, mechanisms: Mechanisms, cache: Option<Arc<dyn Cache>>) -> Box<dyn SceneSolver> {
        match self {
            Self::Rototoon => Box::new(Rototoon::new(mechanisms, cache)),
            Self::Zhou2011 => Box::new(PartByPart::new(Box::new(Zhou2011::default()))),
            Self::Agarwala2004 => Box::new(PartByPart::new(Box::new(Agarwala2004::default()))),
            Self::Liang2012 => Box::new(PartByPart::new(Box::new(Liang2012::default()))),
        }
    }
}

/// Options of tracking.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct TrackOptions {
    /// The method.
    pub preset: Preset,
    /// The mechanisms of the default preset. The other presets ignore them.
    pub mechanisms: Mechanisms,
}

/// Tracks scenes, and remembers what it solved from one run to the next.
pub struct Tracker {
    solver: Box<dyn SceneSolver>,
    footage: Option<Footage>,
}

impl Tracker {
    /// A tracker without any results yet.
    pub fn new(options: TrackOptions) -> Self {
        Self { solver: options.preset.solver(options.mechanisms, None), footage: None }
    }

    /// A tracker without any results yet that finds results in a cache, and keeps them there. The pictures need
    /// [marks](FrameSource::mark). Only the default preset does so.
    pub fn with_cache(options: TrackOptions, cache: Arc<dyn Cache>) -> Self {
        Self { solver: options.preset.solver(options.mechanisms, Some(cache)), footage: None }
    }

    /// A tracker that solves part by part with the caller's solver.
    pub fn with_solver(solver: Box<dyn SpanSolver>) -> Self {
        Self { solver: Box::new(PartByPart::new(solver)), footage: None }
    }

    /// Tracks every part of `scene` between its first and its last key. It runs on the caller's rayon pool.
    ///
    /// The default preset follows parts with one key outward, as far as they can be trusted. With the other presets
    /// such a part has a track on its key frame only. Where a part is absent it has no track. After an error the tracker still has its earlier results.
    ///
    /// # Errors
    ///
    /// See [`TrackError`]: a picture that cannot be read, cancellation by `progress`, keys with different numbers of
    /// points, coordinates out of range, a pin of a point that does not exist, or, with the default preset, pictures
    /// that are too wide.
    pub fn track(
        &mut self,
        scene: &Scene,
        frames: &dyn FrameSource,
        progress: &dyn Progress,
    ) -> Result<Tracking, TrackError> {
        scene.parts.iter().try_for_each(check)?;
        if self.footage.as_ref() != Some(&scene.footage) {
            self.forget();
            self.footage = Some(scene.footage.clone());
        }
        let mut tracking = self.solver.track(scene, frames, progress)?;
        for (part, track) in scene.parts.iter().zip(&mut tracking.parts) {
            track.tracks.retain(|&frame, _| !part.is_absent(frame));
            track.confidence.retain(|&frame, _| !part.is_absent(frame));
            track.ends.retain(|end| !part.is_absent(end.frame));
            for (&frame, key) in &part.keys {
                track.tracks.insert(frame, key.clone());
                track.confidence.insert(frame, vec![1.0; key.len()]);
            }
        }
        Ok(tracking)
    }

    /// Forgets all results and pictures. Call it if the files of the footage have changed.
    pub fn forget(&mut self) {
        self.solver.forget();
    }
}

/// Largest coordinate that is accepted, in pixels: more than a hundred times the width of an 8k picture.
const FURTHEST: f64 = 1e6;

fn check(part: &Part) -> Result<(), TrackError> {
    let name = || part.name.clone();
    let expected = part.point_count();
    let in_range = |frame: FrameNumber, points: Vec<Point>| {
        // Written so that NaN fails the comparison.
        match points.into_iter().find(|p| !(p.abs().max_element() <= FURTHEST && p.is_finite())) {
            Some(found) => Err(TrackError::OutOfRange { part: name(), frame, found, limit: FURTHEST }),
            None => Ok(()),
        }
    };
    for (&frame, key) in &part.keys {
        if key.len() != expected {
            return Err(TrackError::UnequalKeys { part: name(), frame, found: key.len(), expected });
        }
        in_range(frame, key.clone())?;
    }
    for (&frame, pins) in &part.pins {
        if let Some((&index, _)) = pins.iter().find(|(index, _)| **index >= expected) {
            return Err(TrackError::NoSuchPoint { part: name(), frame, index, count: expected });
        }
        in_range(frame, pins.values().copied().collect())?;
    }
    part.centers.iter().try_for_each(|(&frame, &center)| in_range(frame, vec![center]))
}
