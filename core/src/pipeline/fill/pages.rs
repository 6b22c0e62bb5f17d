//! Drawings that are looked at to be painted, and from which others are painted.
//!
//! What depends on pictures alone is [kept](super::super::keeping): the regions that a drawing has before anybody clicks, and where the lines of two drawings are on each
//! other. Clicks split regions, and paint goes from one to the other; both are done in each run.

use super::super::PipelineError;
use super::super::keeping::Pictured;
use super::Painting;
use crate::fill::{Page, Paint, Regions, Source, Ways};
use crate::scene::{FrameNumber, FrameSource};
use std::sync::Arc;

/// A painted drawing.
#[derive(Clone)]
pub(super) struct Painted {
    /// The frame that shows it.
    pub frame: FrameNumber,
    /// The picture that was looked at.
    pub picture: Pictured,
    pub page: Arc<Page>,
    pub paint: Paint,
}

/// The painted drawings from which the next one is painted.
pub(super) struct Known {
    /// The model drawing, or a later one with as many clicks.
    pub key: Painted,
    /// The next one with as many clicks as a model drawing.
    pub next: Option<Painted>,
    /// The last painted one.
    pub last: Painted,
    /// Colours that have become others in part.
    pub unsure: Vec<usize>,
}

impl Known {
    /// The painted drawings, each with whether an artist clicked there. The last one gives the numbers.
    fn all(&self) -> impl Iterator<Item = (&Painted, bool)> {
        let is_last = |painted: &Painted| Arc::ptr_eq(&painted.page, &self.last.page);
        let others = [Some(&self.key), self.next.as_ref()];
        let before =
            others.into_iter().flatten().filter(move |painted| !is_last(painted)).map(|painted| (painted, true));
        before.chain([(&self.last, is_last(&self.key))])
    }

    /// The sources of the next drawing, each with its way there.
    pub fn sources<'a>(&'a self, ways: &'a [Ways]) -> Vec<Source<'a>> {
        let all = self.all().zip(ways);
        all.map(|((Painted { page, paint, .. }, own), ways)| Source { page, paint, own, ways }).collect()
    }
}

impl Painting<'_> {
    /// The drawing of a frame, with its regions.
    pub(super) fn look(&mut self, frame: FrameNumber) -> Result<(Page, Pictured), PipelineError> {
        self.progress()?;
        let own = self.noted.picture(frame)?;
        let picture = Pictured { frame, mark: self.keeping.mark(frame) };
        let (width, height) = (own.width(), own.height());
        let runs: Option<Vec<(u32, u32)>> = self.keeping.recall("regions", &[picture]);
        self.report.earlier.all += 1;
        if let Some(regions) = runs.and_then(|runs| Regions::from_runs(&runs, width, height)) {
            self.report.earlier.known += 1;
            return Ok((Page::known(own, &self.options.lines, regions), picture));
        }
        let page = Page::new(own, &self.options.lines);
        self.keeping.keep("regions", &[picture], &page.own().runs());
        Ok((page, picture))
    }

    /// Where the lines of the painted drawings are on another one.
    pub(super) fn ways(&mut self, known: &Known, page: &Page, picture: Pictured) -> Vec<Ways> {
        let all = known.all().map(|(painted, _)| {
            let both = [painted.picture, picture];
            self.report.earlier.all += 1;
            if let Some(ways) = self.keeping.recall("ways", &both).filter(Ways::fits) {
                self.report.earlier.known += 1;
                return ways;
            }
            let ways = Ways::new(&painted.page, page);
            self.keeping.keep("ways", &both, &ways);
            ways
        });
        all.collect()
    }
}
