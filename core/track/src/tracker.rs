//! The tracker: it chooses the preset's solver, checks the scene, and keeps the solver from one run to the next.
//!
//! A solver keeps what it computed, so that after an edit only what the edit touches is solved again. A result depends on
//! nothing but the scene and the pictures, whatever was solved before and whatever the number of threads.

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

/// Which method tracks.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Preset {
    /// The best that Rototoon knows.
    #[default]
    Rototoon,
    /// Zhou & Xiao 2011 as printed.
    Zhou2011,
    /// Agarwala et al. 2004.
    Agarwala2004,
    /// Agarwala et al. 2004 with the ribbon and the colour penalty of Liang et al. 2012.
    Liang2012,
}

impl Preset {
    /// Every preset with its id in documents, parameters and on the command line.
    pub const ALL: [(Self, &str); 4] = [
        (Self::Rototoon, "rototoon"),
        (Self::Zhou2011, "zhou2011"),
        (Self::Agarwala2004, "agarwala2004"),
        (Self::Liang2012, "liang2012"),
    ];

    /// The preset of an id.
    pub fn from_id(id: &str) -> Option<Self> {
        Self::ALL.iter().find(|(_, name)| *name == id).map(|(preset, _)| *preset)
    }

    fn solver(self, mechanisms: Mechanisms) -> Box<dyn SceneSolver> {
        match self {
            Self::Rototoon => Box::new(Rototoon::new(mechanisms)),
            Self::Zhou2011 => Box::new(PartByPart::new(Box::new(Zhou2011::default()))),
            Self::Agarwala2004 => Box::new(PartByPart::new(Box::new(Agarwala2004::default()))),
            Self::Liang2012 => Box::new(PartByPart::new(Box::new(Liang2012::default()))),
        }
    }
}

/// How to track.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct TrackOptions {
    /// The method.
    pub preset: Preset,
    /// What the default preset uses; the others do not listen.
    pub mechanisms: Mechanisms,
}

/// Tracks scenes, and remembers what it solved from one run to the next.
pub struct Tracker {
    solver: Box<dyn SceneSolver>,
    footage: Option<Footage>,
}

impl Tracker {
    /// A tracker that knows nothing yet.
    pub fn new(options: TrackOptions) -> Self {
        Self { solver: options.preset.solver(options.mechanisms), footage: None }
    }

    /// A tracker that solves part by part with a solver of the caller's.
    pub fn with_solver(solver: Box<dyn SpanSolver>) -> Self {
        Self { solver: Box::new(PartByPart::new(solver)), footage: None }
    }

    /// Tracks every part of `scene` between its first and its last key. Runs on the caller's rayon pool.
    ///
    /// The default preset follows parts with one key outward, as far as they can be trusted; with the others they have a
    /// track on that frame only. After an error the tracker still knows what it knew before.
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
            for (&frame, key) in &part.keys {
                track.tracks.insert(frame, key.clone());
                track.confidence.insert(frame, vec![1.0; key.len()]);
            }
        }
        Ok(tracking)
    }

    /// Forgets all results and pictures, since the files of the footage have changed.
    pub fn forget(&mut self) {
        self.solver.forget();
    }
}

/// Largest coordinate that is still taken for a place: a hundred times the width of an 8k picture.
const FURTHEST: f64 = 1e6;

fn check(part: &Part) -> Result<(), TrackError> {
    let name = || part.name.clone();
    let expected = part.point_count();
    let in_range = |frame: FrameNumber, points: Vec<Point>| {
        // A comparison that NaN fails.
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
