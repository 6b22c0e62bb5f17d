//! The hypotheses of a job, and what they were made from.

use super::pool::{Carried, Pools};
use super::propagate::Model;
use crate::contract::job::{Correction, Job};
use crate::shared::drawings::Drawing;
use crate::shared::features::working_scale;
use rototoon_base::geometry::Point;
use rototoon_base::scene::Span;
use std::sync::Arc;

/// The hypotheses of a job.
pub(super) struct Pooled {
    pub job: Job,
    pub drawings: Vec<Drawing>,
    pub models: Option<Arc<[Model; 2]>>,
    pub pools: Arc<Pools>,
    /// The hypotheses that were carried from drawing to drawing when the pools were filled.
    pub carried: Arc<Carried>,
    /// The choice of the part alone, before the joint choice.
    pub path: Vec<usize>,
    pub steps: usize,
    /// By drawing: how far the part may be from its corrected centre, in working pixels.
    pub center_reach: Vec<f64>,
}

impl Pooled {
    /// By what its job is remembered.
    pub fn key(&self) -> (String, Span) {
        (self.job.name.clone(), self.job.span)
    }

    /// The drawing that a frame of the span shows. `None` where the part is absent.
    pub fn drawing_at(&self, index: usize) -> Option<usize> {
        self.drawings.iter().position(|d| d.first <= index && index <= d.last)
    }

    /// Whether the artist has corrected the part on a drawing.
    pub fn corrected(&self, drawing: usize) -> bool {
        self.corrections(drawing).iter().any(Option::is_some)
    }

    /// The artist's corrections of the frames of a drawing.
    pub fn corrections(&self, drawing: usize) -> Vec<Option<&Correction>> {
        let Drawing { first, last } = self.drawings[drawing];
        (first..=last).map(|index| self.job.corrections.get(&index)).collect()
    }

    /// Where the part alone would put its control points on a frame of the span, in pixels of the picture.
    pub fn own_points(&self, index: usize) -> Vec<Point> {
        let drawing = self.drawing_at(index);
        let scale = working_scale(self.job.size.1);
        match drawing.filter(|_| !self.pools.is_empty()) {
            Some(d) => self.pools[d][self.path[d]].points.iter().map(|&p| p * scale).collect(),
            None => self.job.interpolated(index),
        }
    }
}
