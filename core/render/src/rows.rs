//! A mask row by row, from top to bottom. So a picture that is made of rows needs no second picture for the mask.

use super::coverage::{Rows, Window};
use super::feather::{Feather, Ramp};
use rototoon_base::scene::Raster;
use std::ops::Range;

/// Where the values of a mask come from.
pub(super) enum Source<'a> {
    /// Sides, scanned row by row.
    Sides(Rows<'a>),
    /// Sides that are scanned ahead by twice the reach of a blur.
    Soft(Box<Feather>, Rows<'a>),
    /// A picture of the mask within its bounds.
    Picture(Raster<f32>),
}

/// The rows of a mask in a window.
pub struct MaskRows<'a> {
    window: Window,
    /// What the mask covers of the window, and its values there.
    own: Option<(Window, Source<'a>)>,
    /// The falloff, if it is not that of the blur.
    ramp: Option<&'a Ramp>,
    next: i64,
    row: Vec<f32>,
    drawn: Range<usize>,
}

impl<'a> MaskRows<'a> {
    /// The rows of a window of which a mask covers a part.
    pub(super) fn new(window: Window, own: Option<(Window, Source<'a>)>) -> Self {
        Self { window, own, ramp: None, next: window.top, row: vec![0.0; window.width()], drawn: 0..0 }
    }

    /// The same with a falloff.
    pub(super) fn with_ramp(mut self, ramp: Option<&'a Ramp>) -> Self {
        self.ramp = ramp;
        self
    }

    /// Coverage, 0 to 1, of the pixels of the next row. `None` if `go_on` returns false.
    pub fn next(&mut self, go_on: &mut dyn FnMut() -> bool) -> Option<&[f32]> {
        let mut row = std::mem::take(&mut self.row);
        row[self.drawn.clone()].fill(0.0);
        let done = self.next_into(&mut row, go_on);
        self.row = row;
        done.map(|()| &self.row[..])
    }

    /// Writes the next row over zeros. `None` if `go_on` returns false.
    pub fn next_into(&mut self, row: &mut [f32], go_on: &mut dyn FnMut() -> bool) -> Option<()> {
        if !go_on() {
            return None;
        }
        let y = self.next;
        self.next += 1;
        self.drawn = 0..0;
        let Some((own, source)) = &mut self.own else { return Some(()) };
        if !(own.top..own.bottom).contains(&y) {
            return Some(());
        }
        self.drawn = (own.left - self.window.left) as usize..(own.right - self.window.left) as usize;
        let row = &mut row[self.drawn.clone()];
        fill(source, (y - own.top) as usize, row, go_on)?;
        if let Some(ramp) = self.ramp {
            ramp.apply(row);
        }
        Some(())
    }

    /// The latest row of [`Self::next`].
    pub fn latest(&self) -> &[f32] {
        &self.row
    }

    /// The columns of the latest row outside of which all is 0.
    pub fn drawn(&self) -> Range<usize> {
        self.drawn.clone()
    }
}

/// Writes row `y` of a mask within its bounds over zeros.
fn fill(source: &mut Source, y: usize, row: &mut [f32], go_on: &mut dyn FnMut() -> bool) -> Option<()> {
    match source {
        Source::Sides(rows) => rows.fill(row),
        Source::Soft(feather, rows) => loop {
            feather.changes.clear();
            rows.next(|column, value| feather.changes.push((column, value)));
            if let Some(soft) = feather.take() {
                row.copy_from_slice(soft);
                break;
            }
            if !go_on() {
                return None;
            }
        },
        Source::Picture(picture) => row.copy_from_slice(picture.row(y)),
    }
    Some(())
}
