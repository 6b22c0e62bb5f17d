//! The placement to a fraction of a pixel.
//!
//! Frames that show the same drawing are laid over each other. Scale and shift are found by Gauss–Newton on the directions of [`super::grid`], from a coarse
//! grid to a fine one, with the robust weights of Geman & McClure (1 + e/σ²)⁻², σ² = 0.25. Plates are scaled and moved by whole numbers far more
//! often than by others. So a plain scale within a hundredth is taken if the cost is larger by at most 3 %, and so is then a shift of whole pixels within 0.3 px.

use crate::grid::{Grid, directions};
use nalgebra::{Matrix3, Vector3};
use rayon::prelude::{IntoParallelRefIterator, ParallelIterator};
use rototoon_base::geometry::Point;
use rototoon_base::scene::conform::Placement;
use rototoon_base::scene::{Colour, Raster};
use rototoon_image::gaussian::{Border, blur};
use rototoon_image::sample::read_slope;
use std::ops::Range;

/// Numbers of places of the grids, from coarse to fine.
const GRIDS: [f64; 3] = [57_600.0, 230_400.0, 921_600.0];
/// Steps on each grid.
const STEPS: usize = 30;
/// Standard deviation of the first blur, in places of the coarsest grid.
const SOFTNESS: f64 = 2.0;
/// How often a step that makes nothing better is halved.
const HALVINGS: u32 = 4;
/// σ² of the robust weight.
const SPREAD: f64 = 0.25;
/// How near a plain scale must be to be tried, as a share.
const NEAR: f64 = 0.01;
/// How much larger the cost of a plain placement may be.
const WORSE: f64 = 1.03;
/// Greatest distance from whole pixels of a shift that is one of whole pixels.
const WHOLE: f64 = 0.3;

/// An old picture and the new picture of the same drawing.
pub type Pair<'a> = [&'a Raster<Colour>; 2];

/// The placement of pairs of pictures, from one that is right to a place of the coarse grid. `plain` are the scales that are likely.
pub fn refined(pairs: &[Pair], from: Placement, plain: &[f64], fixed: [bool; 2]) -> Placement {
    let Some([old, new]) = pairs.first() else { return from };
    let size = [old.width(), old.height()];
    let mut placement = from;
    for places in GRIDS {
        let grid = Grid::of(new.width(), new.height(), places);
        let levels: Vec<Level> = pairs.iter().map(|pair| Level::of(&grid, pair, &placement)).collect();
        if places == GRIDS[0] {
            let soft: Vec<Level> = levels.iter().map(Level::softened).collect();
            placement = descended(&soft, &grid, size, placement, fixed);
        }
        placement = descended(&levels, &grid, size, placement, fixed);
        if places == GRIDS[GRIDS.len() - 1] {
            placement = plainer(&levels, &grid, size, placement, plain, fixed);
        }
    }
    placement
}

/// A placement of a plain scale, and of whole pixels too, if it costs hardly more.
fn plainer(
    levels: &[Level],
    grid: &Grid,
    size: [usize; 2],
    free: Placement,
    plain: &[f64],
    fixed: [bool; 2],
) -> Placement {
    let cost = |placement: &Placement| equations(levels, grid, size, placement).mean();
    let most = WORSE * cost(&free);
    let near = plain.iter().find(|scale| (*scale / free.scale - 1.0).abs() < NEAR);
    let scaled = match near {
        Some(&scale) if !fixed[0] => Some(descended(levels, grid, size, Placement { scale, ..free }, [true, fixed[1]])),
        _ => fixed[0].then_some(free),
    };
    // A shift of whole pixels is one of the corner: a scale that is off a little moves the corner too.
    let Some(scaled) = scaled.filter(|own| cost(own) <= most) else { return free };
    let whole = Placement { shift: scaled.shift.round(), ..scaled };
    if !fixed[1] && (whole.shift - scaled.shift).abs().max_element() < WHOLE && cost(&whole) <= most {
        return whole;
    }
    scaled
}

/// The directions of a pair: the new ones on the grid, the old ones of the complete old picture, on places of `factor` old pixels.
struct Level {
    new: Raster<[f32; 2]>,
    old: Raster<[f32; 2]>,
    factor: f64,
}

impl Level {
    fn of(grid: &Grid, [old, new]: &Pair, placement: &Placement) -> Self {
        let old = directions(&grid.of_old_alone(old, placement.scale));
        Self { new: directions(&grid.of_new(new)), old, factor: grid.step / placement.scale }
    }

    /// The same, blurred: across a thin line directions turn round, and from beyond it nothing pulls to it.
    fn softened(&self) -> Self {
        let soft = |field| blur(field, SOFTNESS, Border::Replicate);
        Self { new: soft(&self.new), old: soft(&self.old), factor: self.factor }
    }
}

/// The placement after some steps of Gauss–Newton. A step that makes nothing better is halved.
fn descended(levels: &[Level], grid: &Grid, size: [usize; 2], from: Placement, fixed: [bool; 2]) -> Placement {
    let mut placement = from;
    let mut sums = equations(levels, grid, size, &placement);
    for _ in 0..STEPS {
        let Some(step) = step(&sums, fixed) else { break };
        let better = (0..=HALVINGS).find_map(|halvings| {
            let step = step / f64::from(1 << halvings);
            let shift = placement.shift + Point::new(step[1], step[2]);
            let next = Placement { scale: placement.scale + step[0], shift };
            let sane = next.scale > 0.0 && next.scale.is_finite() && next.shift.is_finite();
            let after = sane.then(|| equations(levels, grid, size, &next))?;
            (after.mean() < sums.mean()).then_some((next, after))
        });
        let Some(better) = better else { break };
        (placement, sums) = better;
    }
    placement
}

/// The step of scale and shift; what is fixed does not move.
fn step(sums: &Sums, fixed: [bool; 2]) -> Option<Vector3<f64>> {
    let (mut normal, mut pull) = (sums.normal, sums.pull);
    for k in [0, 1, 2].into_iter().filter(|&k| fixed[k.min(1)]) {
        normal.row_mut(k).fill(0.0);
        normal.column_mut(k).fill(0.0);
        normal[(k, k)] = 1.0;
        pull[k] = 0.0;
    }
    Some(normal.cholesky()?.solve(&pull))
}

/// The robust cost of one pair or of all, and the normal equations of a step of scale and shift.
struct Sums {
    cost: f64,
    count: usize,
    normal: Matrix3<f64>,
    pull: Vector3<f64>,
}

impl Sums {
    /// The mean cost of a place.
    fn mean(&self) -> f64 {
        self.cost / self.count.max(1) as f64
    }
}

/// The sums over all pairs at a placement.
fn equations(levels: &[Level], grid: &Grid, size: [usize; 2], placement: &Placement) -> Sums {
    let covered = grid.covered(size, placement);
    let each: Vec<Sums> = levels.par_iter().map(|level| level.sums(grid, &covered, placement)).collect();
    // In the order of the pairs, so that the sums do not depend on the number of threads.
    Sums {
        cost: each.iter().map(|own| own.cost).sum(),
        count: each.iter().map(|own| own.count).sum(),
        normal: each.iter().map(|own| own.normal).sum(),
        pull: each.iter().map(|own| own.pull).sum(),
    }
}

impl Level {
    fn sums(&self, grid: &Grid, [columns, rows]: &[Range<usize>; 2], placement: &Placement) -> Sums {
        let mut sums = Sums { cost: 0.0, count: 0, normal: Matrix3::zeros(), pull: Vector3::zeros() };
        // An old place p = (at − shift) / scale moves by −p / scale with the scale, and by −1 / scale with the shift.
        let unit = -1.0 / (placement.scale * self.factor);
        for (y, x) in rows.clone().flat_map(|y| columns.clone().map(move |x| (y, x))) {
            let old = placement.old_place(Point::new(x as f64 + 0.5, y as f64 + 0.5) * grid.step);
            let new = self.new.get(x, y);
            let slope = read_slope(&self.old, old / self.factor);
            let error = [slope.value[0] - new[0], slope.value[1] - new[1]].map(f64::from);
            let squared = error[0] * error[0] + error[1] * error[1];
            let weight = (1.0 + squared / SPREAD).powi(-2);
            sums.cost += squared / (1.0 + squared / SPREAD);
            sums.count += 1;
            for (channel, error) in error.into_iter().enumerate() {
                let (dx, dy) = (f64::from(slope.dx[channel]) * unit, f64::from(slope.dy[channel]) * unit);
                let row = Vector3::new(dx * old.x + dy * old.y, dx, dy);
                sums.normal += weight * row * row.transpose();
                sums.pull -= weight * error * row;
            }
        }
        sums
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A drawing of lines whose pixels show it at a scale and a shift.
    fn drawing(width: usize, height: usize, placement: &Placement) -> Raster<Colour> {
        let line = |at: Point, from: Point, to: Point| {
            let share = ((at - from).dot(to - from) / (to - from).length_squared()).clamp(0.0, 1.0);
            at.distance(from + share * (to - from))
        };
        let corners = [(20.0, 15.0), (170.0, 30.0), (95.0, 80.0), (145.0, 120.0), (25.0, 105.0), (20.0, 15.0)];
        let points = corners.map(|(x, y)| Point::new(x, y));
        Raster::from_fn(width, height, |x, y| {
            let at = placement.old_place(Point::new(x as f64 + 0.5, y as f64 + 0.5));
            let distance = points.windows(2).map(|ends| line(at, ends[0], ends[1])).fold(f64::INFINITY, f64::min);
            [((distance - 1.2) * placement.scale + 0.5).clamp(0.05, 0.95) as f32; 3]
        })
    }

    fn found(truth: Placement, from: Placement, fixed: [bool; 2]) -> Placement {
        let old = drawing(192, 144, &Placement::SAME);
        let new = drawing(420, 320, &truth);
        refined(&[[&old, &new]], from, &[1.0, 2.0], fixed)
    }

    #[test]
    fn whole_pixels_and_plain_scales_are_found_exactly() {
        let truth = Placement { scale: 2.0, shift: Point::new(14.0, 13.0) };
        let from = Placement { scale: 2.0, shift: Point::new(15.6, 11.9) };
        assert_eq!(found(truth, from, [false, false]), truth);
    }

    #[test]
    fn other_scales_and_shifts_are_found_to_less_than_a_pixel() {
        let truth = Placement { scale: 1.93, shift: Point::new(14.4, 13.5) };
        let from = Placement { scale: 1.95, shift: Point::new(13.0, 12.0) };
        let placement = found(truth, from, [false, false]);
        for corner in [(20.0, 15.0), (170.0, 30.0), (25.0, 105.0), (145.0, 120.0)].map(|(x, y)| Point::new(x, y)) {
            let off = placement.place(corner).distance(truth.place(corner));
            assert!(off < 0.7, "{off} px at {corner}: {placement:?}");
        }
    }

    #[test]
    fn what_is_given_stays() {
        let truth = Placement { scale: 2.0, shift: Point::new(14.0, 13.0) };
        let given = Placement { scale: 2.0, shift: Point::new(14.25, 13.0) };
        assert_eq!(found(truth, given, [true, true]), given);
        assert_eq!(found(truth, Placement { scale: 1.99, ..given }, [true, false]).scale, 1.99);
    }
}
