//! What a job of the default tracker is solved with: drawings, pictures, occluders, models of both keys.

use super::TrackError;
use super::drawings::{Drawing, group, same_drawing};
use super::features::{Features, working_scale};
use super::job::Job;
use super::lattice::align::Aligner;
use super::lattice::anchors::Anchors;
use super::lattice::mesh::Mesh;
use super::lattice::texture::{Cover, Texture};
use super::propagate::{Model, Pose, Scenery};
use super::store::Store;
use crate::geometry::Point;
use crate::scene::{FrameNumber, FrameSource, Progress};
use rayon::prelude::{IntoParallelRefIterator, ParallelIterator, ParallelSlice};
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

/// Everything that a job is solved with.
pub(super) struct Stage<'a> {
    pub job: &'a Job,
    frames: &'a dyn FrameSource,
    store: &'a Store,
    pub progress: &'a dyn Progress,
    pub scale: f64,
    pub drawings: Vec<Drawing>,
    pub features: Vec<Arc<Features>>,
    pub covers: Vec<Cover>,
    pub models: [Model; 2],
    anchors: [Vec<Anchors>; 2],
    pub steps_done: AtomicUsize,
}

impl<'a> Stage<'a> {
    /// Reads the pictures and builds the models.
    pub fn set(
        store: &'a Store,
        job: &'a Job,
        frames: &'a dyn FrameSource,
        progress: &'a dyn Progress,
    ) -> Result<Self, TrackError> {
        let scale = working_scale(job.size.1);
        let width = job.size.0 as f64 / scale;
        let numbers: Vec<FrameNumber> = job.span.frames().collect();
        let features: Vec<Arc<Features>> = numbers
            .par_iter()
            .map(|&frame| {
                progress.report("Reading frames", 0.0)?;
                store.features(frames, frame)
            })
            .collect::<Result<_, _>>()?;
        let held: Vec<bool> = features.par_windows(2).map(|pair| same_drawing(&pair[0], &pair[1])).collect();
        let drawings = group(job, |i| held[i]);
        let features: Vec<Arc<Features>> = drawings.iter().map(|d| features[d.first].clone()).collect();
        let working = |contour: &[Point]| contour.iter().map(|&p| p / scale).collect::<Vec<_>>();
        let cover_of = |index: usize| {
            let contours: Vec<Vec<Point>> = job.occluders[index].iter().map(|c| working(c)).collect();
            Cover::new(&contours, width)
        };
        let last = job.span.len() - 1;
        let covers: Vec<Cover> = drawings.iter().map(|d| cover_of(d.first)).collect();
        let model = |key: usize| {
            let mesh = Mesh::new(&working(&job.keys[key]), job.closed);
            let (features, cover) =
                if key == 0 { (&features[0], cover_of(0)) } else { (&features[features.len() - 1], cover_of(last)) };
            let texture = Texture::new(mesh, features, &cover, width);
            Model { aligner: Aligner::new(&texture.mesh), texture }
        };
        let models = [model(0), model(1)];
        let anchors = [0, 1].map(|key: usize| {
            let of_drawing = |d: &Drawing| {
                let correction = (d.first..=d.last).find_map(|i| job.corrections.get(&i));
                correction.map_or_else(Anchors::default, |c| Anchors::new(&models[key].texture.mesh, c, scale))
            };
            drawings.iter().map(of_drawing).collect()
        });
        let steps_done = AtomicUsize::new(0);
        Ok(Self { job, frames, store, progress, scale, drawings, features, covers, models, anchors, steps_done })
    }

    /// A drawing as the model of one key sees it.
    pub fn scenery(&self, model: usize, drawing: usize) -> Scenery<'_> {
        Scenery {
            features: &self.features[drawing],
            cover: &self.covers[drawing],
            anchors: &self.anchors[model][drawing],
        }
    }

    /// The key whose drawing this is, as the artist drew it: frames held from a key have its very points.
    pub fn key_of(&self, drawing: usize) -> Option<Vec<Point>> {
        let last = self.drawings.len() - 1;
        (drawing == 0 || drawing == last).then(|| self.job.keys[usize::from(drawing != 0)].clone())
    }

    /// Width of the picture in working pixels.
    pub fn width(&self) -> f64 {
        self.job.size.0 as f64 / self.scale
    }

    fn frame_of(&self, drawing: usize) -> FrameNumber {
        self.job.span.first + self.drawings[drawing].first as FrameNumber
    }

    /// Carries a pose from one drawing to a neighbouring one.
    pub fn carry(
        &self,
        model: usize,
        pose: &[Point],
        moved: Option<&[Point]>,
        from: usize,
        to: usize,
    ) -> Result<Pose, TrackError> {
        let steps = 2 * (self.drawings.len() - 2).max(1);
        let done = self.steps_done.fetch_add(1, Ordering::Relaxed);
        self.progress.report("Tracking", 0.95 * (done as f64 / steps as f64).min(1.0))?;
        let flow = self.store.flow(self.frames, self.frame_of(from), self.frame_of(to))?;
        Ok(self.models[model].carry(pose, &flow, moved, &self.scenery(model, to)))
    }
}
