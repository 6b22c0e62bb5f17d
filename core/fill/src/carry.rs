//! The colours of a drawing, from drawings that are painted.
//!
//! Each source says what colour a region has: the sum over the source's regions of [u'](crate::relax) times their colours. The
//! sum over the sources, squared and divided by its total, is the probability of a colour. Sources are the artist's
//! own drawings before and behind, and the last drawing that was painted: own drawings are right but far away, the last one is near
//! but may be wrong. How sure each colour is says [`confidence`](crate::confidence).
//!
//! An artist's click on a drawing that was carried corrects a thing from there on. Its region is marked, and the mark is carried with the last
//! drawing: the share q in M of marked regions, sharpened to q² ∕ (q² + (1 − q)²). About such a region the artist's other drawings have as much
//! less to say.

use crate::confidence::{evidence, of_one_colour, probability, witnessed};
use crate::layout::Layout;
use crate::leaks::{leaks, swallowed};
use crate::lost;
use crate::meet::{Table, meeting};
use crate::opens::Opens;
use crate::page::{Lines, Page, Paint};
use crate::relax::relax;
use crate::said::Said;
use crate::shifts::Shifts;
use rototoon_base::geometry::Point;
use rototoon_lines::{Displaced, displaced};
use serde::{Deserialize, Serialize};

/// Most places of a drawing's lines. Drawings have about 800, and one for each stroke beyond that.
const MOST: usize = 1 << 20;

/// A painted drawing from which colours come.
pub struct Source<'a> {
    /// The drawing.
    pub page: &'a Page,
    /// Its colours.
    pub paint: &'a Paint,
    /// Whether an artist clicked there.
    pub own: bool,
    /// Where its lines are on the drawing that is to be painted.
    pub ways: &'a Ways,
}

/// Where the lines of two drawings are on each other. It depends on their pictures alone, not on paint or clicks.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Ways {
    /// The lines of the painted drawing on the other one.
    pub ahead: Displaced,
    /// The lines of the other drawing on the painted one.
    pub back: Displaced,
}

impl Ways {
    /// Registers two drawings with each other.
    pub fn new(from: &Page, to: &Page) -> Self {
        // Before the tasks below: of two that wait for one value, one may be done by the thread that makes it.
        let (from, to) = (from.lines(), to.lines());
        let displaced = |from: &Lines, to: &Lines| displaced(&from.drawing, &from.strokes, &to.drawing);
        let (ahead, back) = rayon::join(|| displaced(from, to), || displaced(to, from));
        Self { ahead, back }
    }

    /// Whether these are places, as those that are found. What comes from a file may be anything.
    pub fn fits(&self) -> bool {
        let all = self.ahead.places.iter().chain(&self.back.places);
        all.clone().count() <= 2 * MOST && all.into_iter().all(|(place, shift)| place.is_finite() && shift.is_finite())
    }

    /// Whether the drawings show the same thing.
    pub fn related(&self) -> bool {
        self.ahead.related || self.back.related
    }
}

/// The colours of a page from painted ones, of which the last one gives the numbers of regions. Regions that are new
/// get numbers from `next` on, which is raised. Regions that [leak](crate::leaks) are split before. `None` where no source
/// shows the same thing.
pub fn carry(sources: &[Source], page: &mut Page, next: &mut usize) -> Option<Paint> {
    let shifts: Vec<Option<Both>> = sources.iter().map(|source| both(source, page)).collect();
    for (source, both) in sources.iter().zip(&shifts) {
        if let Some(both) = both {
            page.close(&leaks(&source.page.layout, source.paint, &page.layout, &both.back));
        }
    }
    let page = &*page;
    let mut known: Vec<Said> =
        sources.iter().zip(&shifts).filter_map(|(source, both)| Some(said(source, page, both.as_ref()?))).collect();
    let corrected = corrected(known.last()?);
    if let Some((_, others)) = known.split_last_mut() {
        others.iter_mut().for_each(|said| said.silent.clone_from(&corrected));
    }
    let last = known.last()?;
    let palette = last.paint.blank;
    let mut paint = Paint::nothing(page.regions.count, palette);
    for j in 1..=page.regions.count {
        if let Some(row) = probabilities(&known, j, palette + 1) {
            paint.colours[j] = row;
        }
    }
    paint.evidence = evidence(&known, &page.layout, &paint);
    paint.confidence = paint.evidence.iter().map(|own| own.as_ref().map_or(0.0, probability)).collect();
    paint.bound(witnessed(&known, &paint));
    paint.bound(lost::bounds(last, &paint));
    let seen = sources.iter().zip(&shifts).filter_map(|(source, both)| {
        let back = &both.as_ref()?.back;
        Some(swallowed(&source.page.layout, source.paint, (&page.layout, &paint), back))
    });
    // A thing that one of the sources does not show either has gone before.
    let least = |a: Vec<f64>, b: Vec<f64>| a.iter().zip(&b).map(|(a, b)| a.min(*b)).collect();
    if let Some(shares) = seen.reduce(least) {
        paint.bound(shares.into_iter().map(of_one_colour));
    }
    number(&mut paint, last.paint, &last.relaxed.all, &page.layout, next);
    paint.corrected = corrected;
    Some(paint)
}

/// For each region the probability that it is one which the artist corrected.
fn corrected(last: &Said) -> Vec<f32> {
    let marked = &last.paint.corrected;
    let share = |row: &Vec<f32>| row.iter().zip(marked).map(|(m, marked)| m * marked).sum::<f32>().min(1.0);
    let sharp = |q: f32| q * q / (q * q + (1.0 - q) * (1.0 - q));
    last.relaxed.sure.iter().map(|row| sharp(share(row))).collect()
}

/// The probability of each colour of a region, no paint being one. `None` if no source has a colour for it.
fn probabilities(known: &[Said], region: usize, palette: usize) -> Option<Vec<f32>> {
    let loud = |said: &Said| 1.0 - said.silent[region];
    let sum = |c: usize| known.iter().map(|said| loud(said) * said.colours[region][c]).sum::<f32>();
    // Divided by the largest, so that their squares stay finite.
    let sums: Vec<f32> = (0..palette).map(sum).collect();
    let most = sums.iter().copied().fold(0.0, f32::max);
    if most <= 0.0 {
        return None;
    }
    let squares: Vec<f32> = sums.iter().map(|sum| (sum / most).powi(2)).collect();
    let total: f32 = squares.iter().sum();
    Some(squares.iter().map(|square| square / total).collect())
}

/// The shifts from a source to a page, and back.
struct Both {
    ahead: Shifts,
    back: Shifts,
}

/// The shifts between two pages; `None` if they do not show the same thing.
fn both(source: &Source, to: &Page) -> Option<Both> {
    let shifts = |page: &Page, places: &[(Point, Point)]| {
        let picture = &page.regions.inside;
        Shifts::new(places, picture.width(), picture.height(), page.regions.unit)
    };
    let Source { page: from, ways, .. } = source;
    ways.related().then(|| Both { ahead: shifts(from, &ways.ahead.places), back: shifts(to, &ways.back.places) })
}

fn said<'a>(source: &Source<'a>, page: &Page, shifts: &Both) -> Said<'a> {
    let (from, to) = (&source.page.layout, &page.layout);
    let meeting = meeting(from, to, &shifts.ahead, &shifts.back);
    let opens = Opens::new(from, source.paint, to, &shifts.back);
    let relaxed = relax(from, to, &meeting, &source.paint.colours, opens.as_ref());
    let colours = relaxed.all.iter().map(|row| weighted(row, &source.paint.colours)).collect();
    let bare = |sure: &f64| if source.own { (1.0 - sure) as f32 } else { 0.0 };
    let bare: Vec<f32> = source.paint.confidence.iter().map(bare).collect();
    let unpainted = relaxed.sure.iter().map(|row| row.iter().zip(&bare).skip(1).map(|(m, bare)| m * bare).sum());
    let unpainted = unpainted.collect();
    let silent = vec![0.0; page.regions.count + 1];
    Said { paint: source.paint, relaxed, colours, unpainted, silent }
}

fn weighted(row: &[f32], colours: &Table) -> Vec<f32> {
    let mut out = vec![0.0; colours.first().map_or(0, Vec::len)];
    for (weight, own) in row.iter().zip(colours).skip(1) {
        out.iter_mut().zip(own).for_each(|(sum, colour)| *sum += weight * colour);
    }
    out
}

/// Gives each painted region the number of the source's region of its colour that it meets best. Of several regions that meet the
/// same one, the one that meets it best has its number; the others get new ones.
fn number(paint: &mut Paint, source: &Paint, all: &Table, layout: &Layout, next: &mut usize) {
    let mut pairs: Vec<(f32, usize, usize)> = Vec::new();
    for j in 1..layout.figures.len() {
        let Some(colour) = paint.painted(j) else { continue };
        let same = |i: &usize| source.colour(*i) == Some(colour) && source.tracks[*i].is_some();
        let best = (1..all[j].len()).filter(same).max_by(|&a, &b| all[j][a].total_cmp(&all[j][b]).then(b.cmp(&a)));
        if let Some(i) = best {
            // What covers more of it counts more.
            pairs.push((all[j][i] * layout.figures[j].area as f32, j, i));
        }
    }
    pairs.sort_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));
    let mut taken = vec![false; source.tracks.len()];
    for (_, j, i) in pairs {
        if !std::mem::replace(&mut taken[i], true) {
            paint.tracks[j] = source.tracks[i];
        }
    }
    for j in 1..layout.figures.len() {
        if paint.tracks[j].is_none() && paint.painted(j).is_some() {
            paint.tracks[j] = Some(*next);
            *next += 1;
        }
    }
}
