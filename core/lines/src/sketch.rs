//! Rough drawings: one line sketched with several strokes of the pencil.
//!
//! Between such strokes lie slivers of paper. They are narrower than the lines themselves, and a person who inks the
//! drawing does not see them. The fill makes them ink, so that the strokes have one centre line.
//!
//! A drawing is rough if it has many slivers for the number of its lines.

use crate::ink::{Ink, distance};
use rototoon_base::scene::Raster;

/// Greatest half width of a sliver, in widths of lines.
const SLIVER: f32 = 0.5;
/// Slivers in a length of line of this many widths, from which a drawing is rough.
const LENGTH: f64 = 100.0;

/// The pixels of all slivers, and their number.
pub struct Slivers {
    pixels: Vec<usize>,
    count: usize,
}

impl Slivers {
    /// Finds slivers: regions of paper enclosed by ink and nowhere wider than lines are.
    pub fn new(ink: &Ink, width: f64) -> Self {
        let (columns, rows) = (ink.mask.width(), ink.mask.height());
        let paper = ink.mask.map(|is_ink| !is_ink);
        let depth = distance::inside(&paper);
        let mut seen = Raster::new(columns, rows, false);
        let mut found = Self { pixels: Vec::new(), count: 0 };
        let most = (SLIVER * width as f32).max(1.5);
        // A region that is wide somewhere is no sliver, and most pixels of paper are in one.
        for start in (0..columns * rows).filter(|&i| paper.data()[i] && depth.data()[i] <= most) {
            if seen.data()[start] {
                continue;
            }
            let (mut region, mut next, mut narrow) = (vec![start], 0, true);
            seen.data_mut()[start] = true;
            while next < region.len() {
                let (x, y) = (region[next] % columns, region[next] / columns);
                next += 1;
                narrow &= x > 0 && y > 0 && x + 1 < columns && y + 1 < rows;
                for (u, v) in [(x + 1, y), (x, y + 1), (x.wrapping_sub(1), y), (x, y.wrapping_sub(1))] {
                    if u >= columns || v >= rows || !paper.get(u, v) {
                        continue;
                    }
                    if depth.get(u, v) > most {
                        narrow = false;
                    } else if !seen.get(u, v) {
                        seen.set(u, v, true);
                        region.push(v * columns + u);
                    }
                }
            }
            if narrow {
                found.count += 1;
                found.pixels.extend(region);
            }
        }
        found
    }

    /// Whether a drawing with these slivers is rough; `length` is that of its lines in pixels.
    pub fn are_many(&self, length: f64, width: f64) -> bool {
        self.count >= 4 && self.count as f64 * LENGTH * width > length
    }

    /// The ink with all slivers filled.
    pub fn filled(&self, ink: Ink) -> Ink {
        let mut mask = ink.mask.clone();
        self.pixels.iter().for_each(|&i| mask.data_mut()[i] = true);
        ink.with_mask(mask)
    }
}
