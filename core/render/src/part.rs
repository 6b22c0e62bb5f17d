//! A rectangle of a raster, to draw into. So a mask that fills most of a picture is drawn without a second picture.

use rototoon_base::scene::Raster;

/// A rectangle of a raster.
pub struct Part<'a> {
    raster: &'a mut Raster<f32>,
    left: usize,
    top: usize,
    width: usize,
}

impl<'a> Part<'a> {
    /// The whole raster.
    pub fn whole(raster: &'a mut Raster<f32>) -> Self {
        let width = raster.width();
        Self { raster, left: 0, top: 0, width }
    }

    /// A rectangle of this one, from a column and a row on.
    pub fn inner(&mut self, left: usize, top: usize, width: usize) -> Part<'_> {
        Part { left: self.left + left, top: self.top + top, width, raster: self.raster }
    }

    /// A row of the rectangle.
    pub fn row_mut(&mut self, y: usize) -> &mut [f32] {
        &mut self.raster.row_mut(self.top + y)[self.left..self.left + self.width]
    }
}
