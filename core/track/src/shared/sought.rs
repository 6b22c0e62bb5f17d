//! A picture made ready to be searched for templates: its spectra, with a margin all round.

use super::features::{Level, total};
use rototoon_base::geometry::Point;
use rototoon_base::numeric::vector::vectorised;
use rototoon_base::scene::Raster;
use rototoon_image::correlation::{Correlator, Spectrum};

/// Pixels by which the picture is continued beyond its edges, so that parts that are half outside are found.
pub const MARGIN: usize = 12;

/// A picture made ready to be searched on one level: it is so for all parts.
pub struct Sought {
    /// Of Σ colour² and of each colour.
    pub(crate) spectra: Vec<Spectrum>,
    pub(crate) columns: usize,
    pub(crate) rows: usize,
}

impl Sought {
    /// Prepares a level's picture, with its margin.
    pub fn new(level: &Level) -> Self {
        let (columns, rows) = searched_size(level);
        let pixel = level.pixel();
        let colours = vectorised(
            #[inline(always)]
            || {
                Raster::from_fn(columns, rows, |x, y| {
                    level.colour(Point::new(x as f64 + 0.5 - MARGIN as f64, y as f64 + 0.5 - MARGIN as f64) * pixel)
                })
            },
        );
        let correlator = Correlator::new(columns, rows);
        let mut spectra = vec![correlator.picture(&colours.map(|c| total(c * c)))];
        spectra.extend((0..3).map(|k| correlator.picture(&colours.map(|c| c[k]))));
        Self { spectra, columns, rows }
    }

    /// Bytes of memory.
    pub fn bytes(&self) -> usize {
        self.spectra.iter().map(Spectrum::bytes).sum()
    }
}

/// Width and height of a level's picture with its margin.
pub fn searched_size(level: &Level) -> (usize, usize) {
    let (columns, rows) = level.dimensions();
    (columns + 2 * MARGIN, rows + 2 * MARGIN)
}
