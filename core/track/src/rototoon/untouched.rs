//! Parts that nobody corrected keep their tracks, unless corrections of other parts make them clearly surer.
//!
//! **Why.** All parts choose their places together, so a correction of one part can move every other one, also where it was
//! right. On twelve films 279 correct new keys of one part alone turned 49 contours of other parts wrong, and 31 right (half
//! of their points or more). An artist who corrects one thing after the other has looked at the rest, and left it.
//!
//! **How.** A scene with corrections is tracked a second time without them. A part without corrections of its own in a span
//! takes the track with the corrections on a drawing if its odds of being good there, by the
//! [confidence](super::confidence) of its points, are at least [`CLEARLY`] times as high. Else it has the track without. Keys
//! that end spans are not corrections: they are in both.
//!
//! **Speed.** The tracks without corrections do not change while corrections are made. They are kept, and those of a scene
//! that has none yet are kept too. So a correction costs no second run, but the first one after other input has changed.
//!
//! **Limits.** A part that the corrections would have moved to its right place, but with little confidence, stays wrong.

use super::corrective::{Corrective, as_corrections};
use super::finer::{Film, keep_unless_surer};
use super::finish::Finished;
use super::pooled::Pooled;
use super::{Looks, Mended, Rototoon};
use crate::contract::error::TrackError;
use crate::contract::job::SpanTrack;
use crate::contract::tasks::Task;
use rototoon_base::scene::{Part, Progress, Scene, Span};
use std::collections::{BTreeMap, BTreeSet};
use std::f64::consts::E;
use std::sync::Arc;

/// How many times as high the odds with the corrections of other parts have to be. More is asked than of a part's own key
/// ([`finer`](super::finer)), which is a reason for its change.
const CLEARLY: f64 = E * E;

/// For each task the track, and whether it was found in this run.
pub(super) type Done = Vec<Option<(SpanTrack, bool)>>;

/// What is remembered of runs without corrections.
#[derive(Default)]
pub(super) struct Untouched {
    corrected: BTreeMap<(String, Span), Arc<Pooled>>,
    mended: BTreeMap<(String, Span), Mended>,
    finished: BTreeMap<(String, Span), Finished>,
    last: Option<(Scene, Arc<Done>)>,
}

/// The scene without corrections; `None` if it has none. Corrective keys are corrections here already.
pub(super) fn uncorrected(broad: &Scene) -> Option<Scene> {
    let corrected = |part: &Part| !part.pins.is_empty() || !part.centers.is_empty();
    broad.parts.iter().any(corrected).then(|| {
        let mut scene = as_corrections(broad, &Corrective::new());
        for part in &mut scene.parts {
            part.pins.clear();
            part.centers.clear();
        }
        scene
    })
}

impl Untouched {
    /// Remembers the tracks of a scene that has no corrections.
    pub fn keep(&mut self, scene: &Scene, done: &Done) {
        self.last = Some((as_corrections(scene, &Corrective::new()), Arc::new(done.clone())));
    }

    /// The pools without corrections.
    pub fn pooled(&self) -> impl Iterator<Item = &Arc<Pooled>> {
        self.corrected.values().chain(self.mended.values().map(|mended| &mended.result))
    }

    /// Forgets the spans that are not among these.
    pub fn keep_only(&mut self, present: &BTreeSet<(String, Span)>) {
        self.corrected.retain(|key, _| present.contains(key));
        self.mended.retain(|key, _| present.contains(key));
        self.finished.retain(|key, _| present.contains(key));
    }
}

impl Rototoon {
    /// The tracks without corrections. `None` if the scene has no corrections.
    pub(super) fn untouched(
        &mut self,
        film: &Film,
        tasks: &[Task],
        frames: &Looks,
        progress: &dyn Progress,
    ) -> Result<Option<Arc<Done>>, TrackError> {
        let Some(scene) = film.untouched() else { return Ok(None) };
        if let Some((_, done)) = self.untouched.last.as_ref().filter(|(known, _)| known == scene) {
            return Ok(Some(done.clone()));
        }
        if self.untouched.mended.is_empty() {
            // Most of it is the same.
            self.untouched.corrected.clone_from(&self.corrected);
            self.untouched.mended.clone_from(&self.mended);
            self.untouched.finished.clone_from(&self.finished);
        }
        self.exchange();
        let found = self.run(scene, None, tasks, frames, progress);
        self.exchange();
        let done = Arc::new(found?.0);
        self.untouched.last = Some((scene.clone(), done.clone()));
        Ok(Some(done))
    }

    /// Exchanges what is remembered of the runs with and without corrections.
    fn exchange(&mut self) {
        std::mem::swap(&mut self.corrected, &mut self.untouched.corrected);
        std::mem::swap(&mut self.mended, &mut self.untouched.mended);
        std::mem::swap(&mut self.finished, &mut self.untouched.finished);
    }

    /// Takes the tracks without corrections where no correction is the part's own and those with them are not clearly surer.
    pub(super) fn settle(&self, scene: &Scene, tasks: &[Task], untouched: &Done, done: &mut Done) {
        for ((task, now), before) in tasks.iter().zip(done).zip(untouched) {
            let part = &scene.parts[task.part];
            let drawings = self.drawings(&(part.name.clone(), task.span));
            let (Some((now, _)), Some((before, _)), Some(drawings)) = (now, before, drawings) else { continue };
            if !is_corrected(part, task.span) {
                // The key drawings are the same in both.
                keep_unless_surer(now, before, (0, drawings), CLEARLY);
            }
        }
    }
}

fn is_corrected(part: &Part, span: Span) -> bool {
    let range = span.first..=span.last;
    part.pins.range(range.clone()).next().is_some() || part.centers.range(range).next().is_some()
}

#[cfg(test)]
mod tests {
    use super::*;
    use rototoon_base::geometry::Point;

    #[test]
    fn a_correction_counts_in_its_own_span() {
        let mut part = Part::default();
        part.pins.insert(5, BTreeMap::new());
        part.centers.insert(20, Point::ZERO);
        let spans =
            [(0, 4), (0, 5), (5, 9), (6, 19), (12, 30)].map(|(first, last)| is_corrected(&part, Span { first, last }));
        assert_eq!(spans, [false, true, true, false, true]);
    }
}
