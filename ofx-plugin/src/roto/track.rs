//! The button *Track*.

use super::film::{Film, Kept};
use super::instance::NO_SHAPES;
use super::job::{Job, run};
use super::{edits, instance, reach};
use crate::description::SOURCE;
use crate::ofx::{Effect, Failure};
use rototoon::track::Tracker;
use std::sync::Arc;

/// What is told where only one thing can be tracked at a time.
pub const BUSY: &str = "the node is tracking: wait until it is done, or cancel it";

/// Tracks the document's parts through the source's frames and stores the result in the document.
///
/// With *Live* the frames and what the tracker has computed stay in memory, for [`follow`](super::follow::follow).
pub fn track(effect: &Effect, time: f64) -> Result<(), Failure> {
    let (instance, parameters) = (instance(effect)?, effect.parameters()?);
    let document = instance.document(&parameters)?;
    let document = document.ok_or_else(|| Failure::Told(NO_SHAPES.into()))?;
    let job = Job::of(effect, &document, time)?;
    let busy = instance.begin_tracking().ok_or_else(|| Failure::Told(BUSY.into()))?;
    let drops = instance.drop_frames();
    let mut tracker = Tracker::new(job.terms().options);
    let (tracking, kept) = run(effect, Some(effect.clip(SOURCE)?), &job, Kept::new(job.most()), &mut tracker)?;
    drop(busy);
    if instance.document(&parameters)?.is_none_or(|now| !Arc::ptr_eq(&now, &document)) {
        let text = "the shapes were changed while they were tracked, so the tracks are not stored: track again";
        return Err(Failure::Told(text.into()));
    }
    if job.stays(&kept) {
        instance.keep_frames(Film::new(job.terms(), kept, tracker), drops);
    }
    let tracked = job.merged(&document, tracking)?;
    instance.replace_stale(&document.scene.parts, &tracked);
    let longer = reach::told(&document.scene.footage, &tracked.document.scene.footage);
    edits::store_tracked(effect, &document.scene.parts, tracked)?;
    if let Some(text) = longer {
        instance.note(effect, &text, false);
    }
    Ok(())
}
