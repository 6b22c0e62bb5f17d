//! The figure on each drawing of a stretch: the blocks in colours that the keys show inside contours only.

use super::blocks::{BLOCK, Blocks};
use crate::contract::error::TrackError;
use crate::rototoon::pooled::Pooled;
use crate::rototoon::stage::Kit;
use crate::shared::features::{LEVELS, WORKING_LINES, working_scale};
use rayon::prelude::{IndexedParallelIterator, IntoParallelIterator, ParallelIterator};
use rototoon_base::geometry::{Point, polygon};
use rototoon_base::scene::FrameNumber;
use std::collections::{BTreeMap, BTreeSet};

/// Steps of each of the three values of a colour.
const STEPS: usize = 16;
/// Level (index in [`LEVELS`]) whose pixels are counted. A block has [`PIXELS`] × [`PIXELS`] of them.
const LEVEL: usize = 2;
const PIXELS: usize = BLOCK as usize / LEVELS[LEVEL];
/// A colour belongs to the figure if at least this share of its pixels at the keys is inside contours.
const OWN: f64 = 0.75;
/// Pixels outside that every colour is taken to have, so that a colour which is rare at the keys says nothing.
const DOUBT: f64 = 3.0;
/// Pixels of a block that must be in colours of the figure.
const MOST_OF_BLOCK: usize = 3;
/// Key frames count on which at least this share of the parts has a key.
const FULL: f64 = 0.8;

/// The figure on each drawing.
#[derive(Debug, PartialEq)]
pub struct Canvas {
    /// Columns and rows of blocks.
    pub size: (usize, usize),
    frames: BTreeMap<FrameNumber, Blocks>,
}

/// What a canvas depends on besides the pictures.
#[derive(Debug, PartialEq)]
pub(in crate::rototoon) struct Plan {
    /// By key frame: the contours of the closed parts with a key there, in working pixels.
    keys: BTreeMap<FrameNumber, Vec<Vec<Point>>>,
    /// The first frame of each drawing.
    drawn: BTreeSet<FrameNumber>,
    /// Width of the picture in working pixels.
    width: f64,
}

impl Plan {
    /// The plan for the members of a stretch. `None` if there is nothing to choose.
    pub(in crate::rototoon) fn of(members: &[&Pooled]) -> Option<Self> {
        let job = &members.first()?.job;
        let scale = working_scale(job.size.1);
        let mut by_part: BTreeMap<FrameNumber, BTreeMap<&str, Vec<Point>>> = BTreeMap::new();
        for job in members.iter().map(|m| &m.job).filter(|job| job.closed && job.keys[0].len() > 2) {
            for (frame, key) in [job.span.first, job.span.last].into_iter().zip(&job.keys) {
                let working = key.iter().map(|&p| p / scale).collect();
                by_part.entry(frame).or_default().insert(&job.name, working);
            }
        }
        let most = by_part.values().map(BTreeMap::len).max()?;
        by_part.retain(|_, parts| parts.len() as f64 >= FULL * most as f64);
        let keys = by_part.into_iter().map(|(frame, parts)| (frame, parts.into_values().collect())).collect();
        let first = |m: &&&Pooled| m.models.is_some();
        let drawings = |m: &&Pooled| {
            let start = m.job.span.first;
            m.drawings.iter().map(move |d| start + d.first as FrameNumber).collect::<Vec<_>>()
        };
        let drawn: BTreeSet<FrameNumber> = members.iter().filter(first).flat_map(drawings).collect();
        (!drawn.is_empty()).then(|| Self { keys, drawn, width: job.size.0 as f64 / scale })
    }
}

impl Canvas {
    /// The figure on the drawings of a plan.
    ///
    /// # Errors
    ///
    /// The error of a picture that cannot be read, or the cancellation by the progress listener.
    pub(in crate::rototoon) fn new(kit: Kit, plan: &Plan) -> Result<Self, TrackError> {
        let size = ((plan.width / BLOCK).ceil() as usize, (WORKING_LINES / BLOCK).ceil() as usize);
        let own = own_colours(kit, plan, size)?;
        let figure = |frame: FrameNumber| {
            let colours = colours(kit, frame, size)?;
            let pixels = |block: &[u16]| block.iter().filter(|&&c| own[usize::from(c)]).count();
            let shows = |x: usize, y: usize| {
                let first = (y * size.0 + x) * PIXELS * PIXELS;
                pixels(&colours[first..first + PIXELS * PIXELS]) >= MOST_OF_BLOCK
            };
            Ok((frame, Blocks::where_true(size, shows)))
        };
        let drawn = Vec::from_iter(plan.drawn.iter().copied());
        let frames = drawn.into_par_iter().with_max_len(1).map(figure).collect::<Result<_, TrackError>>()?;
        Ok(Self { size, frames })
    }

    /// The figure on the drawing that begins at a frame.
    pub fn at(&self, frame: FrameNumber) -> Option<&Blocks> {
        self.frames.get(&frame)
    }

    /// The first frame of each drawing.
    pub fn frames(&self) -> impl Iterator<Item = FrameNumber> {
        self.frames.keys().copied()
    }

    /// A canvas with these figures, for tests.
    #[cfg(test)]
    pub fn made(size: (usize, usize), frames: BTreeMap<FrameNumber, Blocks>) -> Self {
        Self { size, frames }
    }
}

/// By colour: whether it belongs to the figure.
fn own_colours(kit: Kit, plan: &Plan, size: (usize, usize)) -> Result<Vec<bool>, TrackError> {
    let (mut inside, mut all) = (vec![0.0; STEPS.pow(3)], vec![DOUBT; STEPS.pow(3)]);
    for (&frame, contours) in &plan.keys {
        let mut covered = vec![false; size.0 * size.1 * PIXELS * PIXELS];
        for contour in contours {
            let scaled: Vec<Point> = contour.iter().map(|&p| p / LEVELS[LEVEL] as f64).collect();
            polygon::for_each_span(&scaled, size.0 * PIXELS, size.1 * PIXELS, |y, x0, x1| {
                (x0..x1).for_each(|x| covered[index(x, y, size.0)] = true);
            });
        }
        for (colour, covered) in colours(kit, frame, size)?.into_iter().zip(covered) {
            all[usize::from(colour)] += 1.0;
            inside[usize::from(colour)] += f64::from(u8::from(covered));
        }
    }
    Ok(inside.iter().zip(&all).map(|(inside, all)| *inside >= OWN * all).collect())
}

/// Index of a pixel: those of a block are together.
fn index(x: usize, y: usize, columns: usize) -> usize {
    ((y / PIXELS) * columns + x / PIXELS) * PIXELS * PIXELS + (y % PIXELS) * PIXELS + x % PIXELS
}

/// The colour of each pixel as a number below [`STEPS`]³, in the order of [`index`].
fn colours(kit: Kit, frame: FrameNumber, (columns, rows): (usize, usize)) -> Result<Vec<u16>, TrackError> {
    let features = kit.store.features(kit.frames, frame)?;
    let level = features.level(LEVEL);
    let mut colours = vec![0; columns * rows * PIXELS * PIXELS];
    for y in 0..rows * PIXELS {
        for x in 0..columns * PIXELS {
            let colour = level.colour(Point::new(x as f64 + 0.5, y as f64 + 0.5) * level.pixel()).to_array();
            let step = |v: f32| ((v * STEPS as f32).max(0.0) as usize).min(STEPS - 1);
            colours[index(x, y, columns)] =
                ((step(colour[0]) * STEPS + step(colour[1])) * STEPS + step(colour[2])) as u16;
        }
    }
    Ok(colours)
}
