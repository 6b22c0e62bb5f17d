//! Gaussian derivatives of a window of a picture.
//!
//! The derivatives are separable convolutions with sampled kernels of the Gaussian and its first two derivatives. The
//! samples are scaled so that the derivatives of a constant, a ramp and a parabola are exact. Plain samples are not
//! exact at σ below 1. Outside the picture the border pixels are repeated by the caller's `read` function.
//!
//! Only windows are filtered, because a live wire needs a narrow strip of a large picture.

/// A rectangle of pixels that may reach over the picture's border.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Window {
    /// First column.
    pub x: isize,
    /// First row.
    pub y: isize,
    /// Number of columns.
    pub width: usize,
    /// Number of rows.
    pub height: usize,
}

/// Derivatives of one channel on a window, row by row. The unit of length is the pixel.
pub(super) struct Derivatives {
    /// ∂/∂x.
    pub x: Vec<f32>,
    /// ∂/∂y.
    pub y: Vec<f32>,
    /// ∂²/∂x².
    pub xx: Vec<f32>,
    /// ∂²/∂x∂y.
    pub xy: Vec<f32>,
    /// ∂²/∂y².
    pub yy: Vec<f32>,
}

/// Kernels of one σ, as correlation weights with the centre in the middle.
pub(super) struct Kernels {
    value: Vec<f32>,
    slope: Vec<f32>,
    bend: Vec<f32>,
}

impl Kernels {
    /// Kernels of standard deviation `sigma` pixels, cut off at three σ.
    pub fn new(sigma: f64) -> Self {
        let radius = (3.0 * sigma).ceil().max(1.0) as isize;
        let taps: Vec<f64> = (-radius..=radius).map(|i| i as f64).collect();
        let mut value: Vec<f64> = taps.iter().map(|t| (-t * t / (2.0 * sigma * sigma)).exp()).collect();
        let total: f64 = value.iter().sum();
        value.iter_mut().for_each(|v| *v /= total);
        let moment: f64 = taps.iter().zip(&value).map(|(t, v)| t * t * v).sum();
        let slope: Vec<f64> = taps.iter().zip(&value).map(|(t, v)| t * v / moment).collect();
        let mut bend: Vec<f64> = taps.iter().zip(&value).map(|(t, v)| (t * t - moment) * v).collect();
        let second: f64 = taps.iter().zip(&bend).map(|(t, v)| 0.5 * t * t * v).sum();
        bend.iter_mut().for_each(|v| *v /= second);
        let narrow = |values: Vec<f64>| values.into_iter().map(|v| v as f32).collect();
        Self { value: narrow(value), slope: narrow(slope), bend: narrow(bend) }
    }

    /// Pixels that the kernels reach to each side.
    pub fn radius(&self) -> usize {
        self.value.len() / 2
    }

    /// Derivatives on `window` of the channel that `read(x, y)` gives. `read` is called for each pixel of the window
    /// grown by the radius, so it must accept places outside the picture.
    pub fn derivatives(&self, window: Window, read: impl Fn(isize, isize) -> f32) -> Derivatives {
        let r = self.radius();
        let (wide, tall) = (window.width + 2 * r, window.height + 2 * r);
        let mut source = Vec::with_capacity(wide * tall);
        for y in 0..tall as isize {
            for x in 0..wide as isize {
                source.push(read(window.x + x - r as isize, window.y + y - r as isize));
            }
        }
        let along = |kernel: &[f32]| correlate_rows(&source, wide, tall, kernel);
        let (value, slope, bend) = (along(&self.value), along(&self.slope), along(&self.bend));
        let down = |rows: &[f32], kernel: &[f32]| correlate_columns(rows, window.width, window.height, kernel);
        Derivatives {
            x: down(&slope, &self.value),
            y: down(&value, &self.slope),
            xx: down(&bend, &self.value),
            xy: down(&slope, &self.slope),
            yy: down(&value, &self.bend),
        }
    }
}

/// Correlates each row with `kernel`. The result is narrower by the kernel's length less one.
fn correlate_rows(source: &[f32], width: usize, height: usize, kernel: &[f32]) -> Vec<f32> {
    let narrow = width + 1 - kernel.len();
    let mut result = vec![0.0; narrow * height];
    for (row, out) in source.chunks_exact(width).zip(result.chunks_exact_mut(narrow)) {
        for (i, &k) in kernel.iter().enumerate() {
            for (o, &s) in out.iter_mut().zip(&row[i..i + narrow]) {
                *o += k * s;
            }
        }
    }
    result
}

/// Correlates each column with `kernel`. `source` has `height + kernel.len() - 1` rows of `width` values.
fn correlate_columns(source: &[f32], width: usize, height: usize, kernel: &[f32]) -> Vec<f32> {
    let mut result = vec![0.0; width * height];
    for (y, out) in result.chunks_exact_mut(width).enumerate() {
        for (i, &k) in kernel.iter().enumerate() {
            let row = &source[(y + i) * width..(y + i + 1) * width];
            for (o, &s) in out.iter_mut().zip(row) {
                *o += k * s;
            }
        }
    }
    result
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_quadratic_is_differentiated_exactly() {
        let f = |x: isize, y: isize| {
            let (x, y) = (x as f32, y as f32);
            3.0 + 2.0 * x - y + 0.5 * x * x + 0.25 * x * y - 1.5 * y * y
        };
        for sigma in [0.6, 0.8, 1.5] {
            let window = Window { x: -1, y: 2, width: 3, height: 2 };
            let d = Kernels::new(sigma).derivatives(window, f);
            for i in 0..6 {
                let (x, y) = ((i % 3) as f32 - 1.0, (i / 3) as f32 + 2.0);
                let expected = [2.0 + x + 0.25 * y, -1.0 + 0.25 * x - 3.0 * y, 1.0, 0.25, -3.0];
                for (found, expected) in [d.x[i], d.y[i], d.xx[i], d.xy[i], d.yy[i]].into_iter().zip(expected) {
                    assert!((found - expected).abs() < 2e-3, "σ {sigma} pixel {i}: {found} instead of {expected}");
                }
            }
        }
    }
}
