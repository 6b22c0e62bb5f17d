//! Dense optical flow by inverse search.
//!
//! The search runs from coarse to fine. On each level, overlapping patches of the first picture on a grid search their
//! places in the second one by gradient descent. Each starts from the coarser level's flow or from a neighbour's,
//! whichever fits better. The patches' shifts are blended into a dense field; each is weighted by how well it explains
//! the pixel. A variational step then smooths the field where the pictures carry little information, and keeps it where
//! they carry much.
//!
//! Source: Kroeger, Timofte, Dai & Van Gool, "Fast Optical Flow using Dense Inverse Search" (2016): patches §2.1,
//! densification eq. 3, parameters of the second operating point. The refinement is in [`refine`].
//!
//! Limits: luma only. Movements of more than about twice a patch at the coarsest level are not found.

mod patches;
mod plane;
mod refine;
mod terms;

use glam::Vec2;
use patches::{Level, search};
use rototoon_base::numeric::vector::vectorised;
use rototoon_base::scene::Raster;
use std::ops::{Add, Mul};

/// Shift of each pixel from the first picture to the second: x, y in pixels.
pub type Flow = Raster<[f32; 2]>;

/// Smallest side of a picture in the search. Below it the patches would cover most of the picture.
const SMALLEST: usize = 16;

/// A picture at halved sizes, prepared for the flow from it or to it. It is computed once and serves for all
/// neighbouring pictures.
pub struct Pyramid {
    /// From fine to coarse.
    levels: Vec<Level>,
}

impl Pyramid {
    /// The pyramid of a luma picture, 0 to 1.
    pub fn new(luma: &Raster<f32>) -> Self {
        vectorised(
            #[inline(always)]
            || Self::of(luma),
        )
    }

    #[inline(always)]
    fn of(luma: &Raster<f32>) -> Self {
        let mut levels = vec![Level::new(luma.clone())];
        while let Some(last) = levels.last().filter(|last| last.luma.width().min(last.luma.height()) >= 2 * SMALLEST) {
            levels.push(Level::new(halved(&last.luma)));
        }
        Self { levels }
    }

    /// Width and height of the picture in pixels.
    pub fn size(&self) -> (usize, usize) {
        let finest = &self.levels[0].luma;
        (finest.width(), finest.height())
    }

    /// Memory in bytes.
    pub fn bytes(&self) -> usize {
        self.levels.iter().map(Level::bytes).sum()
    }
}

/// The flow from `first` to `second`.
///
/// # Panics
///
/// If the pictures differ in size.
pub fn dense_flow(first: &Pyramid, second: &Pyramid) -> Flow {
    assert_eq!(first.size(), second.size(), "the pictures must have the same size");
    vectorised(
        #[inline(always)]
        || coarse_to_fine(first, second),
    )
}

#[inline(always)]
fn coarse_to_fine(first: &Pyramid, second: &Pyramid) -> Flow {
    let mut flow = Raster::new(0, 0, [0.0; 2]);
    for (a, b) in first.levels.iter().zip(&second.levels).rev() {
        let (width, height) = (a.luma.width(), a.luma.height());
        flow = if flow.width() == 0 { Raster::new(width, height, [0.0; 2]) } else { doubled(&flow, width, height) };
        flow = search(a, b, &flow);
        refine::refine(a, b, &mut flow);
    }
    flow
}

/// Means of 2×2 pixels. An odd last row or column is averaged with itself.
#[inline(always)]
fn halved(picture: &Raster<f32>) -> Raster<f32> {
    let (width, height) = (picture.width().div_ceil(2), picture.height().div_ceil(2));
    Raster::from_fn(width, height, |x, y| {
        let (x, y) = (2 * x as isize, 2 * y as isize);
        let pair = |dy: isize| picture.clamped(x, y + dy) + picture.clamped(x + 1, y + dy);
        0.25 * (pair(0) + pair(1))
    })
}

/// A level's flow at the next finer level: read bilinearly, with doubled shifts.
#[inline(always)]
fn doubled(flow: &Flow, width: usize, height: usize) -> Flow {
    let flow = flow.map(Vec2::from);
    Raster::from_fn(width, height, |x, y| (2.0 * read(&flow, x as f32 / 2.0 - 0.25, y as f32 / 2.0 - 0.25)).to_array())
}

/// Bilinear reading at coordinates in which pixel centres are integers; clamped at the edges.
#[inline(always)]
fn read<T: Copy + Add<Output = T>>(raster: &Raster<T>, x: f32, y: f32) -> T
where
    f32: Mul<T, Output = T>,
{
    let (x0, x1, fx) = neighbours(x, raster.width());
    let (y0, y1, fy) = neighbours(y, raster.height());
    let (a, b) = (raster.get(x0, y0), raster.get(x1, y0));
    let (c, d) = (raster.get(x0, y1), raster.get(x1, y1));
    (1.0 - fy) * ((1.0 - fx) * a + fx * b) + fy * ((1.0 - fx) * c + fx * d)
}

#[inline(always)]
fn neighbours(at: f32, count: usize) -> (usize, usize, f32) {
    let at = at.clamp(0.0, (count - 1) as f32);
    let low = at as usize;
    (low, (low + 1).min(count - 1), at - low as f32)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A smooth texture without repetition.
    fn texture(x: f32, y: f32) -> f32 {
        0.5 + 0.2 * (0.21 * x + 0.05 * y).sin() + 0.15 * (0.13 * y - 0.08 * x).cos() + 0.1 * (0.05 * x * 0.07 * y).sin()
    }

    fn shifted(dx: f32, dy: f32) -> Raster<f32> {
        Raster::from_fn(120, 90, |x, y| texture(x as f32 - dx, y as f32 - dy))
    }

    #[test]
    fn a_shift_is_found_to_a_fraction_of_a_pixel() {
        let flow = dense_flow(&Pyramid::new(&shifted(0.0, 0.0)), &Pyramid::new(&shifted(5.3, -3.6)));
        for y in (12..78).step_by(6) {
            for x in (12..108).step_by(6) {
                let [u, v] = flow.get(x, y);
                assert!((u - 5.3).abs() < 0.3 && (v + 3.6).abs() < 0.3, "{x} {y}: {u} {v}");
            }
        }
    }

    #[test]
    fn equal_pictures_have_no_flow() {
        let flow = dense_flow(&Pyramid::new(&shifted(0.0, 0.0)), &Pyramid::new(&shifted(0.0, 0.0)));
        assert!(flow.data().iter().all(|[u, v]| u.abs() < 1e-3 && v.abs() < 1e-3));
    }

    #[test]
    fn tiny_and_flat_pictures_give_finite_flow() {
        for (width, height) in [(1, 1), (5, 40), (64, 1)] {
            let [first, second] = [0.5, 0.7].map(|grey| Pyramid::new(&Raster::new(width, height, grey)));
            let flow = dense_flow(&first, &second);
            assert!(flow.data().iter().all(|[u, v]| u.is_finite() && v.is_finite()));
        }
    }
}
