//! A stage: the prepared data of a job of the default tracker. It contains the drawings, pictures, occluders and the
//! models of both keys.

use super::lattice::align::{Aligner, settle};
use super::lattice::anchors::Anchors;
use super::lattice::limb::Limb;
use super::lattice::mesh::Mesh;
use super::lattice::necks::Necks;
use super::lattice::shape;
use super::lattice::texture::{Cover, Texture};
use super::mechanisms::{Mechanism, Mechanisms};
use super::propagate::{Model, Pose, Scenery};
use crate::contract::error::TrackError;
use crate::contract::job::{Correction, Job};
use crate::shared::drawings::{Drawing, group};
use crate::shared::features::{Features, working_scale};
use crate::shared::store::Store;
use rayon::prelude::{IntoParallelRefIterator, ParallelIterator};
use rototoon_base::geometry::similarity::Similarity;
use rototoon_base::geometry::{Point, polygon};
use rototoon_base::scene::{FrameNumber, FrameSource, Progress};
use std::collections::BTreeMap;
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

/// Access to the pictures, and the listener for the progress.
#[derive(Clone, Copy)]
pub(super) struct Kit<'a> {
    /// The looks of the pictures.
    pub frames: &'a dyn FrameSource,
    /// What was computed from the looks.
    pub store: &'a Store,
    /// The pictures themselves, and what was computed from them.
    pub plain: (&'a Store, &'a dyn FrameSource),
    pub progress: &'a dyn Progress,
    /// The mechanisms in use.
    pub mechanisms: Mechanisms,
}

impl Kit<'_> {
    /// For each of several frames but the last: whether the next one shows the same drawing ([`Store::held`]).
    pub fn held(
        &self,
        numbers: &[FrameNumber],
        report: &(impl Fn() -> Result<(), TrackError> + Sync),
    ) -> Result<Vec<bool>, TrackError> {
        let (store, frames) = self.plain;
        store.held(frames, numbers, report)
    }

    /// The colours of a frame, whatever the kind of its drawing.
    pub fn colours(&self, frame: FrameNumber) -> Result<Arc<Features>, TrackError> {
        let (store, frames) = self.plain;
        store.features(frames, frame)
    }
}

/// Everything that is needed to solve a job. Indices of drawings refer to `drawings`.
pub(super) struct Stage<'a> {
    pub job: &'a Job,
    pub kit: Kit<'a>,
    pub scale: f64,
    pub drawings: Vec<Drawing>,
    pub features: Vec<Arc<Features>>,
    pub covers: Vec<Cover>,
    pub models: Arc<[Model; 2]>,
    /// By drawing: how far the part may be from its corrected centre, in working pixels.
    pub center_reach: Vec<f64>,
    anchors: [Vec<Anchors>; 2],
    /// Like `anchors`, but without centres.
    pins: [Vec<Anchors>; 2],
    pub steps_done: AtomicUsize,
}

impl<'a> Stage<'a> {
    /// Reads the pictures, and builds the models if none are given. At first nothing hides the part between the keys.
    ///
    /// # Errors
    ///
    /// The error of a picture that cannot be read, or the cancellation by the progress listener.
    pub fn set(kit: Kit<'a>, job: &'a Job, models: Option<Arc<[Model; 2]>>) -> Result<Self, TrackError> {
        let scale = working_scale(job.size.1);
        let width = job.size.0 as f64 / scale;
        let (drawings, features) = read(kit, job)?;
        let last = features.len() - 1;
        let models = models.unwrap_or_else(|| {
            let model = |key: usize| model(job, key, &features[key * last], (scale, width), kit.mechanisms);
            let mut pair = [model(0), model(1)];
            Texture::weigh(&mut pair.each_mut().map(|model| &mut model.texture));
            Arc::new(pair)
        });
        let anchors = |of: fn(&Correction) -> Correction| anchors(job, &drawings, &models, scale, of);
        let (anchors, pins) = (anchors(Correction::clone), anchors(Correction::pins_only));
        let covers = drawings.iter().map(|_| Cover::none(width)).collect();
        let center_reach = vec![0.0; drawings.len()];
        Ok(Self {
            job,
            kit,
            scale,
            drawings,
            features,
            covers,
            models,
            center_reach,
            anchors,
            pins,
            steps_done: AtomicUsize::new(0),
        })
    }

    /// A drawing as input for the model of one key.
    pub fn scenery(&self, model: usize, drawing: usize) -> Scenery<'_> {
        Scenery {
            features: &self.features[drawing],
            cover: &self.covers[drawing],
            weighed: false,
            anchors: &self.anchors[model][drawing],
        }
    }

    /// The same as [`Stage::scenery`], with pins as the only corrections.
    pub fn released(&self, model: usize, drawing: usize) -> Scenery<'_> {
        Scenery { anchors: &self.pins[model][drawing], ..self.scenery(model, drawing) }
    }

    /// Whether the centre of control points (working pixels) is within reach of the corrected centre. True if there is
    /// none.
    pub fn near_center(&self, drawing: usize, points: &[Point]) -> bool {
        let center = self.correction(drawing).and_then(|c| c.center);
        center.is_none_or(|c| polygon::center(points).distance(c / self.scale) <= self.center_reach[drawing])
    }

    /// The artist's correction of a drawing.
    pub fn correction(&self, drawing: usize) -> Option<&Correction> {
        let Drawing { first, last } = self.drawings[drawing];
        (first..=last).find_map(|i| self.job.corrections.get(&i))
    }

    /// Whether the artist corrected a drawing.
    pub fn corrected(&self, drawing: usize) -> bool {
        !self.anchors[0][drawing].is_empty()
    }

    /// Width of the picture in working pixels.
    pub fn width(&self) -> f64 {
        self.job.size.0 as f64 / self.scale
    }

    /// Share of the time from the first key to the second at which a drawing begins.
    pub fn share(&self, drawing: usize) -> f64 {
        self.drawings[drawing].first as f64 / (self.job.span.len() - 1) as f64
    }

    /// The first frame of a drawing.
    pub fn frame_of(&self, drawing: usize) -> FrameNumber {
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
        self.kit.progress.report("Tracking", 0.8 * (done as f64 / steps as f64).min(1.0))?;
        let flow = || self.kit.store.flow(self.kit.frames, self.frame_of(from), self.frame_of(to));
        let flow = self.kit.mechanisms.has(Mechanism::Flow).then(flow).transpose()?;
        Ok(self.models[model].carry(pose, flow.as_deref(), moved, &self.scenery(model, to)))
    }
}

/// The drawings of a job, and the features of each.
fn read(kit: Kit, job: &Job) -> Result<(Vec<Drawing>, Vec<Arc<Features>>), TrackError> {
    let numbers: Vec<FrameNumber> = job.span.frames().collect();
    let features: Vec<Arc<Features>> = numbers
        .par_iter()
        .map(|&frame| {
            kit.progress.report("Reading frames", 0.0)?;
            kit.store.features(kit.frames, frame)
        })
        .collect::<Result<_, _>>()?;
    let report = || Ok(kit.progress.report("Reading frames", 0.0)?);
    let held = kit.held(&numbers, &report)?;
    let drawings = group(job, |i| held[i]);
    let features = drawings.iter().map(|d| features[d.first].clone()).collect();
    Ok((drawings, features))
}

/// The corrections of each drawing as anchors of both models; `of` is what of a correction they hold to.
fn anchors(
    job: &Job,
    drawings: &[Drawing],
    models: &[Model; 2],
    scale: f64,
    of: fn(&Correction) -> Correction,
) -> [Vec<Anchors>; 2] {
    [0, 1].map(|key: usize| {
        let of_drawing = |d: &Drawing| {
            let correction = (d.first..=d.last).find_map(|i| job.corrections.get(&i));
            let anchors = |c: &Correction| Anchors::new(&models[key].texture.mesh, &of(c), scale);
            correction.map_or_else(Anchors::default, anchors)
        };
        drawings.iter().map(of_drawing).collect()
    })
}

/// The model of a key: its texture is not taken from where a nearer part hides the key.
fn model(job: &Job, key: usize, features: &Features, (scale, width): (f64, f64), mechanisms: Mechanisms) -> Model {
    let working = |contour: &[Point]| contour.iter().map(|&p| p / scale).collect::<Vec<_>>();
    let occluders = &job.occluders[if key == 0 { 0 } else { job.span.len() - 1 }];
    let contours: Vec<Vec<Point>> = occluders.iter().map(|c| working(c)).collect();
    let cover = Cover::new(&contours, width);
    let (own, other) = (working(&job.keys[key]), working(&job.keys[1 - key]));
    let mut mesh = Mesh::new(&own, job.closed);
    // The other key's contour, moved onto this one by a similarity: the remaining difference is bending.
    let motion = Similarity::fit(&other, &own);
    let places: BTreeMap<usize, Point> = other.iter().map(|&p| motion.apply(p) * scale).enumerate().collect();
    let anchors = Anchors::new(&mesh, &Correction { pins: places, center: None }, scale);
    let bent = settle(&mesh, &mesh.rest, &anchors);
    let back = motion.inverse();
    let there = bent.iter().map(|&p| back.apply(p)).collect();
    if mechanisms.has(Mechanism::Stiffness) {
        shape::learn_stiffness(&mut mesh, &bent);
    }
    let mut texture = Texture::new(mesh, features, &cover, width);
    if !mechanisms.has(Mechanism::FigureAndGround) {
        texture.forget_figure();
    }
    let limb = Some(&texture.mesh).filter(|_| job.closed && mechanisms.has(Mechanism::Folds)).and_then(Limb::of);
    let turns = job.closed && mechanisms.has(Mechanism::Branches);
    let necks = if turns { Necks::of(&texture.mesh) } else { Necks::default() };
    Model { aligner: Aligner::new(&texture.mesh), texture, cover, there, bent, limb, necks }
}
