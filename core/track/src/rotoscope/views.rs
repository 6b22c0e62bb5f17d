//! Views: pictures as the rotoscoping energies read them, with colours and edge strength on a pyramid.
//!
//! All lengths are in **working pixels**. Pictures of more than 540 lines are reduced to 540 lines first, because the
//! weights of the energy were chosen for television frames. Colours are smoothed by a Gaussian of σ = 1.3 before the
//! pyramid is built. Channel 3 is the **edge measure** of Agarwala et al. (2004), which is small on edges:
//!
//! ```text
//! G = K − min(K, 0.30 ‖∇R‖ + 0.59 ‖∇G‖ + 0.11 ‖∇B‖),   K = 70 levels per pixel
//! ```
//!
//! The gradients are taken at σ = 1. (In the authors' system G is negative on the hardest edges, so its square grows
//! again on cartoon ink. Here it ends at zero.) The edge measure goes through the pyramid like a colour.
//!
//! Colours and G are in 8-bit levels, 0 to 255, which is the unit of the weights.

use crate::contract::error::TrackError;
use rototoon_base::geometry::{Point, polygon};
use rototoon_base::scene::{Colour, FrameNumber, FrameSource, Raster};
use rototoon_image::gaussian::{Border, blur};
use rototoon_image::pyramid::Pyramid;
use rototoon_image::resize::reduce;
use std::collections::BTreeMap;
use std::sync::{Arc, Mutex, MutexGuard};

/// Number of levels of the pyramid.
pub const LEVELS: usize = 4;
/// K: the gradient of the strongest edge, in levels per pixel.
pub const STRONGEST: f32 = 70.0;
/// Largest number of lines of a picture in working pixels.
const WORKING_LINES: f64 = 540.0;
/// σ of the smoothing of the colours before the pyramid, in working pixels.
const SMOOTHING: f64 = 1.3;
/// σ of the smoothing before the gradient, in working pixels.
const GRADIENT_SIGMA: f64 = 1.0;
/// σ of the pyramid's blur, in pixels of the level.
const SOFTNESS: f64 = 0.9;
/// Bytes of views kept for the next job.
const BUDGET: usize = 400 << 20;

/// Picture pixels per working pixel, at least 1, for a picture of `height` lines.
pub fn working_scale(height: usize) -> f64 {
    (height as f64 / WORKING_LINES).max(1.0)
}

/// Colour (channels 0 to 2) and edge measure (channel 3) at a place.
pub type Look = [f32; 4];

/// A picture as the energies read it, by level.
pub type View = Pyramid<Look>;

/// The view of a picture. The picture must have at least one pixel.
pub fn view(picture: &Raster<Colour>) -> View {
    let scale = working_scale(picture.height());
    let levels = picture.map(|colour| colour.map(|v| 255.0 * v));
    let levels = if scale > 1.0 { reduce(&levels, scale) } else { levels };
    let sharp = blur(&levels, GRADIENT_SIGMA, Border::Replicate);
    let smooth = blur(&levels, SMOOTHING, Border::Replicate);
    let look = Raster::from_fn(smooth.width(), smooth.height(), |x, y| {
        let [r, g, b] = smooth.get(x, y);
        [r, g, b, edge_measure(&sharp, x, y)]
    });
    Pyramid::new(look, LEVELS, SOFTNESS)
}

fn edge_measure(picture: &Raster<Colour>, x: usize, y: usize) -> f32 {
    let (x, y) = (x as isize, y as isize);
    let (left, right) = (picture.clamped(x - 1, y), picture.clamped(x + 1, y));
    let (above, below) = (picture.clamped(x, y - 1), picture.clamped(x, y + 1));
    let strength = |c: usize| 0.5 * (right[c] - left[c]).hypot(below[c] - above[c]);
    (STRONGEST - (0.30 * strength(0) + 0.59 * strength(1) + 0.11 * strength(2))).max(0.0)
}

/// The views of a job's frames, and the occlusion of its part on each.
pub struct Scenery {
    views: Vec<Arc<View>>,
    hidden: Vec<Option<Raster<bool>>>,
    size: Point,
}

impl Scenery {
    /// Combines the views of all frames with the contours that hide the part: `occluders` by frame, in working pixels.
    pub fn new(views: Vec<Arc<View>>, occluders: &[Vec<Vec<Point>>]) -> Self {
        let (width, height) = views.first().map_or((0, 0), |v| (v.levels()[0].width(), v.levels()[0].height()));
        let hidden = occluders.iter().map(|contours| {
            let mut mask = (!contours.is_empty()).then(|| Raster::new(width, height, false))?;
            for contour in contours {
                polygon::for_each_span(contour, width, height, |y, x0, x1| mask.row_mut(y)[x0..x1].fill(true));
            }
            Some(mask)
        });
        Self { hidden: hidden.collect(), views, size: Point::new(width as f64, height as f64) }
    }

    /// Number of levels that every view has.
    pub fn levels(&self) -> usize {
        self.views.iter().map(|view| view.levels().len()).min().unwrap_or(0)
    }

    /// The view of a frame on a level.
    pub fn look(&self, frame: usize, level: usize) -> &Raster<Look> {
        &self.views[frame].levels()[level]
    }

    /// Whether the picture shows the part's surroundings at `p`, in working pixels: `p` is in the picture and not under
    /// a nearer part.
    pub fn shows(&self, frame: usize, p: Point) -> bool {
        // Written so that NaN is not shown.
        let inside = p.x >= 0.0 && p.y >= 0.0 && p.x < self.size.x && p.y < self.size.y;
        inside && !self.hidden[frame].as_ref().is_some_and(|mask| mask.get(p.x as usize, p.y as usize))
    }
}

/// Views of frames, kept within a budget of bytes. A view depends on its picture alone, so the cache never changes a
/// result.
#[derive(Default)]
pub struct Views {
    kept: Mutex<Kept>,
}

#[derive(Default)]
struct Kept {
    clock: u64,
    views: BTreeMap<FrameNumber, (u64, Arc<View>)>,
}

impl Views {
    /// The view of a frame. An empty picture counts as one black pixel.
    ///
    /// # Errors
    ///
    /// The error of the picture, if it cannot be read.
    pub fn get(&self, frames: &dyn FrameSource, frame: FrameNumber) -> Result<Arc<View>, TrackError> {
        if let Some(known) = self.known(frame) {
            return Ok(known);
        }
        let picture = frames.picture(frame)?;
        let made =
            Arc::new(if picture.data().is_empty() { view(&Raster::new(1, 1, [0.0; 3])) } else { view(&picture) });
        let mut kept = self.lock();
        kept.clock += 1;
        let now = kept.clock;
        kept.views.insert(frame, (now, made.clone()));
        let most = (BUDGET / bytes(&made).max(1)).max(1);
        while kept.views.len() > most {
            let Some(oldest) = kept.views.iter().min_by_key(|(_, (used, _))| *used).map(|(&frame, _)| frame) else {
                break;
            };
            kept.views.remove(&oldest);
        }
        Ok(made)
    }

    /// Forgets everything.
    pub fn clear(&self) {
        *self.lock() = Kept::default();
    }

    fn known(&self, frame: FrameNumber) -> Option<Arc<View>> {
        let mut kept = self.lock();
        kept.clock += 1;
        let now = kept.clock;
        let (used, view) = kept.views.get_mut(&frame)?;
        *used = now;
        Some(view.clone())
    }

    fn lock(&self) -> MutexGuard<'_, Kept> {
        // The map is only changed between complete states, so a panic elsewhere cannot leave it half changed.
        self.kept.lock().unwrap_or_else(|poisoned| poisoned.into_inner())
    }
}

fn bytes(view: &View) -> usize {
    view.levels().iter().map(|level| size_of_val(level.data())).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_hard_edge_measures_zero_and_a_flat_area_the_most() {
        let picture = Raster::from_fn(40, 30, |x, _| if x < 20 { [0.0; 3] } else { [1.0; 3] });
        let view = view(&picture);
        let level = &view.levels()[0];
        assert_eq!((level.get(19, 15)[3], level.get(3, 15)[3]), (0.0, STRONGEST));
        assert!(level.get(16, 15)[3] > 50.0 && (level.get(39, 15)[0] - 255.0).abs() < 1e-3);
        assert_eq!(view.levels().len(), LEVELS);
    }

    #[test]
    fn large_pictures_are_reduced_and_small_ones_are_not() {
        let of = |h| view(&Raster::new(8, h, [0.5; 3])).levels()[0].height();
        assert_eq!([of(100), of(540), of(1080)], [100, 540, 540]);
    }

    #[test]
    fn nearer_parts_and_the_border_hide() {
        let view = Arc::new(view(&Raster::new(20, 10, [0.5; 3])));
        let square = [(5.0, 2.0), (9.0, 2.0), (9.0, 6.0), (5.0, 6.0)].map(|(x, y)| Point::new(x, y)).to_vec();
        let scenery = Scenery::new(vec![view.clone(), view], &[vec![square], Vec::new()]);
        let p = Point::new(7.2, 3.1);
        assert_eq!((scenery.shows(0, p), scenery.shows(1, p)), (false, true));
        for p in [Point::new(-0.1, 3.0), Point::new(20.0, 3.0), Point::new(f64::NAN, 3.0), Point::new(3.0, 1e300)] {
            assert!(!scenery.shows(1, p), "{p}");
        }
    }
}
