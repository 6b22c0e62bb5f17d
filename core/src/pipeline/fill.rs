//! Colours of line drawings: from the painter's clicks to the regions of every frame.
//!
//! Work begins on the model drawing: the first frame on which at least half of the regions were clicked, or the one with the largest share of
//! them where no frame has as many. From there the colours go from drawing to drawing, forwards and backwards. Each drawing is painted by the last
//! one, by the model drawing, and by the next drawing with as many clicks. On a frame with fewer clicks, these overrule what was carried there, and
//! about what they correct the artist's other drawings are silent from there on ([`carry()`]): so a mistake is mended by one click, before and after
//! the model drawing, and nothing else changes.
//!
//! What the artist leaves without paint at the edge of a model drawing is the paper around it, and stays without paint on the other drawings. Other
//! regions without a click are guessed there. A click without a colour says that a region has no paint: such regions are followed like painted ones.
//!
//! A colour that becomes another one on some frames ([`crate::project::recolours`]) does so when regions are written. They are carried in the old one.

mod numbers;
mod pages;
#[cfg(test)]
mod tests;
mod told;

pub use told::{FillReport, FilledFrame, LeakingClick, MissedClick, Recoloured, VanishedColour};

use super::holds::{Holds, Stretch};
use super::keeping::Keeping;
use super::seen::Noted;
use super::{PipelineError, frames, frames_of, gaps};
use crate::export::SvgFill;
use crate::fill::{Change, Click, Gap, Page, Paint, carry, changes, fills};
use crate::lines::Options;
use crate::pictures::Sequence;
use crate::project::Document;
use crate::project::fills::{FillClick, FillClicks, FilledDrawing, FilledRegion, Hue};
use crate::project::recolours::Recolours;
use crate::project::seen::Made;
use crate::scene::{Footage, FrameNumber, Progress};
use crate::track::Cache;
use pages::{Known, Painted};
use std::collections::BTreeMap;
use std::ops::RangeInclusive;
use std::path::Path;

/// Share of a frame's regions that must be clicked so that it counts for frames before it.
const WHOLE: f64 = 0.5;
/// Confidence below which a region is in doubt: its colour is probably wrong.
pub const DOUBT: f64 = 0.5;

/// Options of filling.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct FillOptions {
    /// How ink is found.
    pub lines: Options,
    /// Regions whose colour has a lower confidence stay unpainted, 0 to 1.
    pub confidence: f64,
}

/// Paints the drawings of a document in `folder` by the clicks in its field `fills`, and puts the regions into its field `filled`. It runs on
/// the caller's rayon pool; the result does not depend on the pool. Painted regions of frames outside of `range` (the
/// complete footage where it is `None`) stay.
///
/// Regions and registrations that a `cache` knows are not found again. The result is the same.
///
/// # Errors
///
/// [`PipelineError::Option`] for a range outside of the footage; [`PipelineError::Field`] for a document without clicks, for clicks outside of the
/// footage and for fields that cannot be read; an unreadable frame; not enough memory; or [`PipelineError::Cancelled`].
pub fn fill(
    document: &mut Document,
    folder: &Path,
    range: Option<RangeInclusive<FrameNumber>>,
    options: &FillOptions,
    cache: Option<&dyn Cache>,
    progress: &dyn Progress,
) -> Result<FillReport, PipelineError> {
    let footage = &document.scene.footage;
    let range = frames_of(footage, range)?;
    let recolours = document.recolours().map_err(|error| field(&error))?;
    let clicks = clicks(document, &recolours)?;
    super::memory::to_fill(footage)?;
    let earlier = document.filled().map_err(|error| field(&error))?;
    let sequence = frames(document, folder)?;
    let noted = Noted::new(&sequence);
    let mut painting = Painting {
        frames: &sequence,
        noted: &noted,
        holds: Holds::none(&noted),
        keeping: Keeping { cache, frames: &noted, options: &options.lines },
        options,
        progress,
        palette: palette(&clicks),
        next: 0,
        all: range.clone().count() + 2 * clicks.len(),
        done: 0,
        found: Vec::new(),
        report: FillReport::default(),
    };
    painting.run(&clicks, &range)?;
    let Painting { mut found, mut report, .. } = painting;
    report.missed.sort_by_key(|missed| (missed.entry, missed.click));
    report.overruled.sort_by_key(|missed| (missed.entry, missed.click));
    report.leaking.sort_by_key(|leak| (leak.place.entry, leak.place.click));
    let within = |drawing: &FilledDrawing| range.contains(&drawing.frame);
    let way: Vec<FilledDrawing> = found.extract_if(.., |drawing| !within(drawing)).collect();
    let kept: Vec<FilledDrawing> = earlier.iter().filter(|drawing| !within(drawing)).cloned().collect();
    report.recoloured = recolour(&recolours, &mut found, &kept, &range);
    if !kept.is_empty() {
        numbers::as_before(&mut found, &way, &earlier);
    }
    found.extend(kept);
    found.sort_by_key(|drawing| drawing.frame);
    report.frames.retain(|frame| range.contains(&frame.frame));
    report.vanished.retain(|own| range.contains(&own.frame));
    report.vanished.sort_by_key(|own| own.frame);
    report.frames.sort_by_key(|frame| frame.frame);
    report.mark_bare();
    document.set_seen(Made::Filled, range, &noted.seen()).map_err(|error| field(&error))?;
    document.set_filled(&found);
    Ok(report)
}

/// Changes the colours of painted regions. The new numbers are those of no other region, also of none that was kept. Returns what became of
/// the entries that hold on the painted frames.
fn recolour(
    recolours: &Recolours,
    found: &mut [FilledDrawing],
    kept: &[FilledDrawing],
    range: &RangeInclusive<FrameNumber>,
) -> Vec<Recoloured> {
    let all = found.iter().chain(kept).flat_map(|drawing| &drawing.regions);
    let next = all.map(|region| region.track + 1).max().unwrap_or(0);
    let counts = recolours.change(found, next);
    let told = recolours.list().iter().zip(counts).enumerate();
    told.filter(|(_, (own, _))| range.clone().any(|frame| own.is_on(frame)))
        .map(|(entry, (own, regions))| Recoloured { entry, what: own.to_string(), from: own.from.clone(), regions })
        .collect()
}

/// The frames with clicks, each with its place in the document. Clicks have the colours that they mean.
fn clicks(document: &Document, recolours: &Recolours) -> Result<Vec<(usize, FillClicks)>, PipelineError> {
    let footage = &document.scene.footage;
    let mut clicks = document.fills().map_err(|error| field(&error))?;
    clicks.iter_mut().for_each(|own| recolours.mean(own));
    if let Some((k, found)) = clicks.iter().enumerate().find(|(_, c)| c.frame < footage.first || c.frame > footage.last)
    {
        return Err(field(&format!("fills[{k}].frame: {}", outside(found.frame, footage))));
    }
    let clicks: Vec<(usize, FillClicks)> =
        clicks.into_iter().enumerate().filter(|own| !own.1.clicks.is_empty()).collect();
    if clicks.is_empty() {
        let expected = r#"clicks of the paint bucket on a frame: "fills": [{"frame": 0, "regions": [{"at": [x, y], "colour": [r, g, b]}, …]}]"#;
        return Err(field(&format!("fills: found no click, expected {expected}")));
    }
    Ok(clicks)
}

/// What is told of clicks on a frame outside of the footage.
pub(super) fn outside(frame: FrameNumber, footage: &Footage) -> String {
    format!("found {frame}, expected a frame of the footage, {} to {}", footage.first, footage.last)
}

/// The error of a field.
pub(super) fn field(error: &dyn std::fmt::Display) -> PipelineError {
    PipelineError::Field(error.to_string())
}

/// The painted regions of a document, one for each number.
pub(super) fn fills_to_export(document: &Document) -> Result<Vec<SvgFill>, PipelineError> {
    let filled = document.filled().map_err(|error| field(&error))?;
    let mut fills: BTreeMap<usize, SvgFill> = BTreeMap::new();
    for (frame, region) in filled.into_iter().flat_map(|d| d.regions.into_iter().map(move |region| (d.frame, region))) {
        let FilledRegion { track, colour, name, outline, holes, .. } = region;
        let own = fills.entry(track).or_insert_with(|| SvgFill { track, colour, name, ..SvgFill::default() });
        own.outlines.insert(frame, [outline].into_iter().chain(holes).collect());
    }
    Ok(fills.into_values().collect())
}

/// All colours, each once, in the order in which they come.
fn palette(clicks: &[(usize, FillClicks)]) -> Vec<Hue> {
    let mut palette: Vec<Hue> = Vec::new();
    for hue in clicks.iter().flat_map(|own| &own.1.clicks).filter_map(FillClick::hue) {
        if !palette.iter().any(|own| own.is_same(&hue)) {
            palette.push(hue);
        }
    }
    palette
}

/// The clicks of a frame that paint nothing, by their places among its clicks.
struct InVain {
    /// They lie on a line or outside of the picture.
    missed: Vec<usize>,
    /// A later click fills their region.
    overruled: Vec<usize>,
    /// They leak to the edge of the picture: each with its gap, and with the size of what it paints.
    leaking: Vec<(usize, Gap, [usize; 2])>,
}

/// Painting at work.
struct Painting<'a> {
    frames: &'a Sequence,
    /// The same, which notes the pictures that are read.
    noted: &'a Noted<'a>,
    /// Which frames hold a drawing.
    holds: Holds<'a>,
    keeping: Keeping<'a>,
    options: &'a FillOptions,
    progress: &'a dyn Progress,
    palette: Vec<Hue>,
    /// The next new number of a region.
    next: usize,
    all: usize,
    done: usize,
    found: Vec<FilledDrawing>,
    report: FillReport,
}

impl Painting<'_> {
    fn run(
        &mut self,
        clicks: &[(usize, FillClicks)],
        range: &RangeInclusive<FrameNumber>,
    ) -> Result<(), PipelineError> {
        let (model, key, missed) = self.model(clicks)?;
        let looked_at = key.frame.min(*range.start())..=key.frame.max(*range.end());
        gaps::none(self.frames, looked_at.clone())?;
        self.all = self.done + looked_at.clone().count() + clicks.len();
        let done = self.share();
        let search = Stretch { progress: self.progress, step: "Painting", from: done, to: done };
        self.holds = Holds::of(self.noted, self.frames.footage().first, &looked_at, self.keeping.cache, &search)?;
        self.miss(&clicks[model], &missed);
        self.keep(&key);
        let before: Vec<_> = clicks[..model].iter().rev().collect();
        self.side(key.clone(), &before, Side { ahead: false, end: *range.start() })?;
        let after: Vec<_> = clicks[model + 1..].iter().collect();
        self.side(key, &after, Side { ahead: true, end: *range.end() })?;
        Ok(self.progress.report("Painting", 1.0)?)
    }

    /// The model drawing, its place among the frames with clicks, and its clicks that paint nothing. Its regions have the first numbers.
    fn model(&mut self, clicks: &[(usize, FillClicks)]) -> Result<(usize, Painted, InVain), PipelineError> {
        let none = self.next;
        let mut best: Option<(usize, Painted, InVain, usize)> = None;
        for (k, own) in clicks.iter().enumerate() {
            self.next = none;
            let (key, missed) = self.key(own)?;
            let share = key.paint.clicked();
            if best.as_ref().is_none_or(|best| share > best.1.paint.clicked()) {
                best = Some((k, key, missed, self.next));
            }
            if share >= WHOLE {
                break;
            }
        }
        let (place, mut key, missed, next) = best.ok_or_else(|| field(&"fills: found no click"))?;
        self.next = next;
        // However few regions were clicked: nobody clicks every speck, and paper that nothing is known of would be painted on all other drawings.
        key.page.leave_paper(&mut key.paint);
        Ok((place, key, missed))
    }

    /// Paints the frames on one side of the model drawing. The frames with clicks are in the order in which they come.
    fn side(&mut self, model: Painted, clicks: &[&(usize, FillClicks)], side: Side) -> Result<(), PipelineError> {
        let mut known = Known { key: model.clone(), next: None, last: model, unsure: Vec::new() };
        for own in clicks {
            let frame = own.1.frame;
            if side.is_over(known.last.frame) {
                return Ok(());
            }
            known.next = Some(self.key(own)?.0).filter(|next| next.paint.clicked() >= WHOLE);
            let between = side.between(known.last.frame, frame);
            self.outward(&mut known, between)?;
            known.next = None;
            let (mended, changes) = self.mended(&known, own)?;
            known.last = mended;
            for change in changes {
                self.change(&mut known, change);
            }
            self.keep(&known.last);
            if known.last.paint.clicked() >= WHOLE {
                known.last.paint.settle();
                known.key = known.last.clone();
                known.unsure.clear();
            }
        }
        let rest = side.between(known.last.frame, if side.ahead { side.end + 1 } else { side.end - 1 });
        self.outward(&mut known, rest)
    }

    /// A frame painted by its clicks alone, and the clicks that paint nothing.
    fn key(&mut self, clicks: &(usize, FillClicks)) -> Result<(Painted, InVain), PipelineError> {
        let (mut page, picture) = self.look(clicks.1.frame)?;
        let own = self.clicks(&clicks.1);
        page.split(&own);
        let gaps = page.part_from_outside(&own);
        let (mut paint, missed) = page.painted(&own, self.palette.len(), &mut self.next);
        if paint.clicked() >= WHOLE {
            page.leave_paper(&mut paint);
        }
        let in_vain = InVain { missed, ..in_vain(&page, &mut paint, &own, gaps) };
        Ok((Painted { frame: clicks.1.frame, picture, page: page.into(), paint }, in_vain))
    }

    /// A colour becomes another one: the model drawing says so from here on, and what was not clicked on the last drawing has it too.
    fn change(&mut self, known: &mut Known, change: Change) {
        if change.whole {
            known.last.paint.becomes(change, &mut self.next);
            // The numbers of the model drawing are not written from here on.
            known.key.paint.becomes(change, &mut self.next);
        } else {
            known.unsure.push(change.from);
        }
    }

    /// A frame painted by what is known beside it, and then by its own clicks, and the colours that these have changed.
    fn mended(&mut self, known: &Known, clicks: &(usize, FillClicks)) -> Result<(Painted, Vec<Change>), PipelineError> {
        let (mut page, picture) = self.look(clicks.1.frame)?;
        let own = self.clicks(&clicks.1);
        page.split(&own);
        let gaps = page.part_from_outside(&own);
        let numbers = self.next;
        let ways = self.ways(known, &page, picture);
        let mut carried = carry(&known.sources(&ways), &mut page, &mut self.next);
        if carried.as_ref().is_some_and(|paint| page.part_from_paper(paint, &own)) {
            self.next = numbers;
            carried = carry(&known.sources(&ways), &mut page, &mut self.next);
        }
        let before = carried.clone();
        let (mut paint, missed) = match carried {
            Some(paint) => page.clicked(paint, &own, &mut self.next),
            None => page.painted(&own, self.palette.len(), &mut self.next),
        };
        let in_vain = InVain { missed, ..in_vain(&page, &mut paint, &own, gaps) };
        self.miss(clicks, &in_vain);
        // What a click takes away was meant.
        let gone = before.iter().flat_map(|before| before.lacks(&known.last.paint));
        let still: Vec<usize> = paint.lacks(&known.last.paint);
        self.vanish(clicks.1.frame, gone.filter(|colour| still.contains(colour)));
        let sources = [&known.key.paint, &known.last.paint];
        let changes = before.map_or_else(Vec::new, |before| changes(&page, &before, &paint, &sources));
        Ok((Painted { frame: clicks.1.frame, picture, page: page.into(), paint }, changes))
    }

    /// Paints frames one after the other, beginning beside the last painted one.
    fn outward(&mut self, known: &mut Known, frames: impl Iterator<Item = FrameNumber>) -> Result<(), PipelineError> {
        for frame in frames {
            if self.holds.first(frame) == self.holds.first(known.last.frame) {
                self.progress()?;
                known.last.frame = frame;
                self.keep(&known.last);
                continue;
            }
            let (mut page, picture) = self.look(frame)?;
            let ways = self.ways(known, &page, picture);
            match carry(&known.sources(&ways), &mut page, &mut self.next) {
                Some(mut paint) => {
                    known.unsure.iter().for_each(|&colour| paint.doubt_returns(colour, &known.last.paint));
                    self.vanish(frame, paint.lacks(&known.last.paint).into_iter());
                    known.last = Painted { frame, picture, page: page.into(), paint };
                    self.keep(&known.last);
                }
                None => {
                    let found = page.regions();
                    self.report.frames.push(FilledFrame { frame, found, ..FilledFrame::default() });
                }
            }
        }
        Ok(())
    }

    fn progress(&mut self) -> Result<(), PipelineError> {
        self.progress.report("Painting", self.share())?;
        self.done += 1;
        Ok(())
    }

    /// The share of the work that is done.
    fn share(&self) -> f64 {
        (self.done as f64 / self.all.max(1) as f64).min(1.0)
    }

    fn clicks(&self, clicks: &FillClicks) -> Vec<Click> {
        let number = |hue: Hue| self.palette.iter().position(|own| own.is_same(&hue));
        clicks.clicks.iter().map(|click| Click { at: click.at, colour: click.hue().and_then(number) }).collect()
    }

    fn miss(&mut self, clicks: &(usize, FillClicks), in_vain: &InVain) {
        let (entry, frame) = (clicks.0, clicks.1.frame);
        let one = |&click: &usize| MissedClick { frame, at: clicks.1.clicks[click].at, entry, click };
        self.report.missed.extend(in_vain.missed.iter().map(one));
        self.report.overruled.extend(in_vain.overruled.iter().map(one));
        let leak = |&(click, gap, size): &(usize, Gap, [usize; 2])| LeakingClick { place: one(&click), gap, size };
        self.report.leaking.extend(in_vain.leaking.iter().map(leak));
        self.report.clicks.insert(frame, clicks.1.clicks.len());
    }

    /// Notes colours that no region of a frame has any more.
    fn vanish(&mut self, frame: FrameNumber, colours: impl Iterator<Item = usize>) {
        let one = |colour: usize| VanishedColour { frame, hue: self.palette[colour].clone() };
        self.report.vanished.extend(colours.map(one));
    }

    /// Puts a painted drawing down.
    fn keep(&mut self, painted: &Painted) {
        let region = |fill: crate::fill::Fill| FilledRegion {
            colour: self.palette[fill.colour].colour,
            name: self.palette[fill.colour].name.clone(),
            outline: fill.outline,
            holes: fill.holes,
            track: fill.track,
            confidence: fill.confidence,
        };
        let sure = |fill: &crate::fill::Fill| fill.confidence >= self.options.confidence;
        let regions: Vec<FilledRegion> =
            fills(&painted.page, &painted.paint).into_iter().filter(sure).map(region).collect();
        let doubtful = regions.iter().filter(|region| region.confidence < DOUBT).count();
        let frame = painted.frame;
        let (related, found) = (true, painted.page.regions());
        self.report.frames.push(FilledFrame { frame, regions: regions.len(), doubtful, related, found, bare: false });
        self.found.push(FilledDrawing { frame, regions });
    }
}

/// What became of clicks into a page. Regions that leak through a gap that cannot be closed are put in doubt.
fn in_vain(page: &Page, paint: &mut Paint, own: &[Click], gaps: Vec<(usize, Gap)>) -> InVain {
    gaps.iter().filter(|(_, gap)| !gap.closes).for_each(|&(k, _)| page.doubt(paint, &own[k]));
    let sized = |(k, gap): (usize, Gap)| Some((k, gap, page.extent(own[k].at)?));
    InVain {
        missed: Vec::new(),
        overruled: page.overruled(paint, own),
        leaking: gaps.into_iter().filter_map(sized).collect(),
    }
}

/// The frames on one side of the model drawing.
#[derive(Clone, Copy)]
struct Side {
    /// Whether they come after it.
    ahead: bool,
    /// The last one to paint.
    end: FrameNumber,
}

impl Side {
    /// Whether nothing is left to paint beyond a frame.
    fn is_over(self, frame: FrameNumber) -> bool {
        if self.ahead { frame >= self.end } else { frame <= self.end }
    }

    /// The frames between two, from the first one on.
    fn between(self, from: FrameNumber, to: FrameNumber) -> Box<dyn Iterator<Item = FrameNumber>> {
        if self.ahead { Box::new(from + 1..to) } else { Box::new((to + 1..from).rev()) }
    }
}
