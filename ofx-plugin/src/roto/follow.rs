//! Follows an edit at once, on what the last Track has left in memory (*Live*).

use super::film::Film;
use super::instance;
use super::job::{Job, Tracked, run};
use crate::ofx::Effect;
use crate::ofx::progress::Bar;
use rototoon::project::Document;
use std::sync::Arc;

/// Tracks an edited document again without a call for images: the actions of the pen must not make one. Only the spans that
/// the edit touches are tracked; the result is that of a complete Track.
///
/// `None` if *Live* is off, a frame is not in memory, the host has no progress display to cancel in, the user cancels, or the
/// source has changed meanwhile. The tracks then stay old, and the overlay says so.
pub fn follow(effect: &Effect, document: &Document, time: f64) -> Option<Tracked> {
    let (instance, parameters) = (instance(effect).ok()?, effect.parameters().ok()?);
    if parameters.int(c"live", time).ok()? == 0 || !Bar::exists(effect) {
        return None;
    }
    let film = instance.film()?;
    let job = Job::of(effect, document, time).ok()?;
    if film.terms != job.terms() {
        return None;
    }
    let busy = instance.begin_tracking()?;
    let result = run(effect, None, &job, film.kept.clone(), &mut film.tracker());
    drop(busy);
    let (tracking, _) = result.ok()?;
    // The host may have drawn frames or sent events while the progress was shown.
    let same = instance.film().is_some_and(|now: Arc<Film>| Arc::ptr_eq(&now, &film));
    if same { job.merged(document, tracking).ok() } else { None }
}
