//! Planes of values for the pixels of a picture, with a border, for loops that process several neighbouring pixels at
//! once.

use rototoon_base::numeric::lanes::{LANES, Lanes};

/// One value per pixel. A border of one pixel surrounds the picture, and rows are padded to complete [`LANES`].
#[derive(Clone)]
pub(super) struct Plane {
    width: usize,
    height: usize,
    stride: usize,
    data: Vec<f32>,
}

impl Plane {
    /// A plane of zeros.
    pub fn zeros(width: usize, height: usize) -> Self {
        let stride = width.next_multiple_of(LANES) + 2;
        Self { width, height, stride, data: vec![0.0; stride * (height + 2)] }
    }

    /// Memory in bytes.
    pub fn bytes(&self) -> usize {
        size_of_val(&self.data[..])
    }

    /// The index of a pixel. −1 and the picture's size are the border.
    #[inline(always)]
    fn index(&self, x: isize, y: isize) -> usize {
        (y + 1) as usize * self.stride + (x + 1) as usize
    }

    /// The values of [`LANES`] pixels of a row, from column `x` on.
    #[inline(always)]
    pub fn lanes(&self, x: isize, y: isize) -> Lanes {
        Lanes::read(&self.data[self.index(x, y)..])
    }

    /// The same for pixels that may be beyond the edge of the picture, where the nearest pixel counts.
    #[inline(always)]
    pub fn clamped_lanes(&self, x: usize, y: usize) -> Lanes {
        let row = self.row(y.min(self.height - 1));
        if x + LANES <= self.width {
            return Lanes::read(&row[x..]);
        }
        Lanes::from_fn(|v| row[(x + v).min(self.width - 1)])
    }

    /// Sets the values of [`LANES`] pixels of a row, from column `x` on.
    #[inline(always)]
    pub fn set_lanes(&mut self, x: usize, y: usize, values: Lanes) {
        let from = self.index(x as isize, y as isize);
        values.write(&mut self.data[from..]);
    }

    /// The pixels of row `y`.
    #[inline(always)]
    pub fn row(&self, y: usize) -> &[f32] {
        &self.data[self.index(0, y as isize)..][..self.width]
    }

    /// The pixels of row `y`, for writing.
    #[inline(always)]
    pub fn row_mut(&mut self, y: usize) -> &mut [f32] {
        let from = self.index(0, y as isize);
        &mut self.data[from..][..self.width]
    }

    /// Copies the outermost pixels to the border.
    pub fn continue_border(&mut self) {
        let (width, height, stride) = (self.width, self.height, self.stride);
        for y in 1..=height {
            let row = &mut self.data[y * stride..][..stride];
            row[0] = row[1];
            row[width + 1] = row[width];
        }
        self.data.copy_within(stride..2 * stride, 0);
        self.data.copy_within(height * stride..(height + 1) * stride, (height + 1) * stride);
    }
}

/// One value per pixel, with the two colours of a chequerboard stored separately. Values that change together are then
/// next to each other, and so are their neighbours. A border of one pixel surrounds the picture.
///
/// Row y of colour c has the pixels x = 2 k + p, where p = (y + c) mod 2. Their right and left neighbours have the
/// other colour and are at k + p and k + p − 1 of the same row. The lower and upper neighbours are at k of the rows
/// beside it.
#[derive(Clone)]
pub(super) struct Board {
    width: usize,
    height: usize,
    stride: usize,
    colours: [Vec<f32>; 2],
}

impl Board {
    /// A board of zeros.
    pub fn zeros(width: usize, height: usize) -> Self {
        let stride = width.div_ceil(2).next_multiple_of(LANES) + 2;
        Self { width, height, stride, colours: [(); 2].map(|()| vec![0.0; stride * (height + 2)]) }
    }

    /// Values of [`LANES`] pixels of a colour, from the `k`-th of a row on. Rows and pixels are counted from the
    /// border.
    #[inline(always)]
    pub fn lanes(&self, colour: usize, k: usize, y: usize) -> Lanes {
        Lanes::read(&self.colours[colour][y * self.stride + k..])
    }

    /// Sets the values that [`Self::lanes`] reads.
    #[inline(always)]
    pub fn set_lanes(&mut self, colour: usize, k: usize, y: usize, values: Lanes) {
        values.write(&mut self.colours[colour][y * self.stride + k..]);
    }

    /// Sets the values of [`LANES`] pixels of a row, from column `x` (a multiple of [`LANES`]) on. Values beyond the
    /// picture stay zero.
    #[inline(always)]
    pub fn set(&mut self, x: usize, y: usize, values: Lanes) {
        let whole = x + LANES <= self.width;
        let (even, odd) = if whole { values } else { values.first(self.width - x) }.halves();
        let from = (y + 1) * self.stride + 1 + x / 2;
        self.colours[y % 2][from..from + LANES / 2].copy_from_slice(&even);
        self.colours[1 - y % 2][from..from + LANES / 2].copy_from_slice(&odd);
    }

    /// Writes its values to a plane of the same size.
    #[inline(always)]
    pub fn join(&self, plane: &mut Plane) {
        for y in 0..self.height {
            let from = (y + 1) * self.stride + 1;
            let even = &self.colours[y % 2][from..from + self.stride - 2];
            let odd = &self.colours[1 - y % 2][from..from + self.stride - 2];
            let (pairs, last) = plane.row_mut(y).as_chunks_mut::<2>();
            pairs.iter_mut().zip(even.iter().zip(odd)).for_each(|(pair, (a, b))| *pair = [*a, *b]);
            if let [last] = last {
                *last = even[self.width / 2];
            }
        }
    }
}
