//! The figures of stretches ([`figure`](super::joint::figure)), which are kept between runs.

use super::Rototoon;
use super::joint::figure::canvas::{Canvas, Plan};
use super::mechanisms::Mechanism;
use super::pooled::Pooled;
use crate::contract::error::TrackError;
use crate::shared::look::{Kind, Looks};
use rototoon_base::scene::{Progress, Span};
use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

/// What is kept, by name and span of the stretches' members.
#[derive(Default)]
pub(super) struct Figures {
    canvases: BTreeMap<(String, Span), (Plan, Arc<Canvas>)>,
}

impl Figures {
    /// Forgets the spans that no longer exist.
    pub fn keep_only(&mut self, present: &BTreeSet<(String, Span)>) {
        self.canvases.retain(|key, _| present.contains(key));
    }
}

impl Rototoon {
    /// The figure on the drawings of a stretch's members. `None` for drawings whose colours do not tell parts from the ground.
    pub(super) fn canvas(
        &mut self,
        members: &[&Pooled],
        frames: &Looks,
        progress: &dyn Progress,
    ) -> Result<Option<Arc<Canvas>>, TrackError> {
        let tells = frames.kind == Kind::Painted && self.mechanisms.has(Mechanism::Figure);
        let (Some(plan), Some(first)) = (Plan::of(members).filter(|_| tells), members.first()) else { return Ok(None) };
        let key = first.key();
        if let Some((_, canvas)) = self.figures.canvases.get(&key).filter(|(known, _)| *known == plan) {
            return Ok(Some(canvas.clone()));
        }
        let canvas = Arc::new(Canvas::new(self.kit(frames, progress), &plan)?);
        self.figures.canvases.insert(key, (plan, canvas.clone()));
        Ok(Some(canvas))
    }
}
