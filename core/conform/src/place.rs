//! Where the old picture lies in the new one, before it is known which frames show the same drawing.
//!
//! A few old pictures with much ink are correlated with new ones, for each likely scale: 1, what makes the widths or the heights
//! of both pictures equal, and, unless one of these agrees by 0.75 or more, what plates are usually scaled by. Of each correlation the highest place is a candidate, beside those that a facility makes most often:
//! both pictures on each other, corner on corner, and centre on centre. Each candidate is judged by what both pictures show there,
//!
//! ```text
//! a = Σ n · n' / √(Σ |n|² Σ |n'|²)
//! ```
//!
//! with directions blurred by one place, so that half a place does not matter. Few places agree by chance, so what is compared is a · c^¼, with the share c of
//! the new picture that both show. The best one over all pairs of pictures wins. A background that stands still pulls to the right place also where the drawings differ.

use crate::grid::{Grid, directions};
use rayon::prelude::{IntoParallelRefIterator, ParallelIterator};
use rototoon_base::geometry::Point;
use rototoon_base::scene::conform::Placement;
use rototoon_base::scene::{Cancelled, Colour, Progress, Raster};
use rototoon_image::correlation::{Correlator, Spectrum};
use rototoon_image::gaussian::{Border, blur};

/// Places of the grid of the search. Of a coarser one, a place is wider than a pencil line, and a candidate some pixels beside agrees as well.
const PLACES: f64 = 57_600.0;
/// Standard deviation of the blur of directions, in places.
const SOFTNESS: f64 = 1.0;
/// What a plain candidate may be worse by than one that correlation found.
const PLAIN: f32 = 0.02;
/// Agreement from which no further scale is tried.
const ENOUGH: f32 = 0.75;
/// Number of scales that are tried in any case.
const FIRST: usize = 3;
/// Least share of the smaller picture that both pictures must show.
const OVERLAP: f64 = 0.25;

/// How many times as large as the new picture the old one may be at a scale. A plate that shows less of the old picture is none that people make, and the search
/// would take memory and minutes.
const MOST_TIMES: f64 = 40.0;

/// A placement and how well the pictures agree there.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Found {
    /// The placement.
    pub placement: Placement,
    /// The agreement, at most 1.
    pub agreement: f32,
    /// What is compared of it: the agreement, less where the pictures show little of each other.
    pub score: f32,
}

/// The scales that are likely for pictures of these sizes, each once: first those that make heights or widths equal, and 1.
pub fn scales(old: [usize; 2], new: [usize; 2], given: Option<f64>) -> Vec<f64> {
    let all = match given {
        Some(scale) => vec![scale],
        None => {
            let fitting = [new[1] as f64 / old[1] as f64, new[0] as f64 / old[0] as f64, 1.0];
            // With a border too, a plate is of another size by one of these.
            let usual = [2.0, 0.5, 1.5, 2.0 / 3.0, 4.0 / 3.0, 0.75, 3.0, 1.0 / 3.0, 4.0, 0.25];
            fitting.into_iter().chain(usual).collect()
        }
    };
    let mut distinct: Vec<f64> = Vec::new();
    for scale in all {
        if distinct.iter().all(|known| (known / scale - 1.0).abs() > 1e-9) {
            distinct.push(scale);
        }
    }
    distinct
}

/// The best placement of old pictures in new ones. `shift` is given or searched.
///
/// # Errors
///
/// [`Cancelled`].
pub fn found(
    old: &[&Raster<Colour>],
    new: &[&Raster<Colour>],
    scales: &[f64],
    shift: Option<Point>,
    progress: &dyn Progress,
) -> Result<Option<Found>, Cancelled> {
    let (Some(first), Some(target)) = (old.first(), new.first()) else { return Ok(None) };
    let size = [first.width(), first.height()];
    let grid = Grid::of(target.width(), target.height(), PLACES);
    let soft = |luma: &Raster<f32>| blur(&directions(luma), SOFTNESS, Border::Replicate);
    let news: Vec<Raster<[f32; 2]>> = new.par_iter().map(|picture| soft(&grid.of_new(picture))).collect();
    let mut best: Option<Found> = None;
    for (tried, &scale) in scales.iter().enumerate() {
        if tried >= FIRST && best.is_some_and(|best| best.agreement >= ENOUGH) {
            break;
        }
        progress.report("Placing", tried as f64 / scales.len() as f64)?;
        if grid.places_of(size, scale) > MOST_TIMES * grid.places_of([target.width(), target.height()], 1.0) {
            continue;
        }
        let plain = plain(scale, size, [target.width(), target.height()], shift);
        let placed = old.iter().map(|picture| soft(&grid.of_old_alone(picture, scale))).collect::<Vec<_>>();
        let mut candidates: Vec<(Placement, f32)> = plain.into_iter().map(|placement| (placement, PLAIN)).collect();
        if shift.is_none() {
            let peaks = peaks(&news, &placed);
            candidates.extend(peaks.into_iter().map(|at| (Placement { scale, shift: at * grid.step }, 0.0)));
        }
        let judged: Vec<Option<Found>> = candidates
            .par_iter()
            .map(|&(placement, bonus)| {
                let own = |new| placed.iter().map(move |old| agreement(old, new, &grid, &placement));
                let best = |a: [f32; 2], b: [f32; 2]| if b[0] > a[0] { b } else { a };
                let [agreement, share] = news.iter().flat_map(own).fold([0.0; 2], best);
                let score = agreement * share.powf(0.25) + bonus;
                (agreement > 0.0).then_some(Found { placement, agreement, score })
            })
            .collect();
        for found in judged.into_iter().flatten() {
            if best.is_none_or(|best| found.score > best.score) {
                best = Some(found);
            }
        }
    }
    Ok(best)
}

/// The placements that are tried in any case.
fn plain(scale: f64, old: [usize; 2], new: [usize; 2], shift: Option<Point>) -> Vec<Placement> {
    let room = |k: usize| new[k] as f64 - scale * old[k] as f64;
    let shifts = match shift {
        Some(shift) => vec![shift],
        None => vec![Point::ZERO, (Point::new(room(0), room(1)) / 2.0).round()],
    };
    shifts.into_iter().map(|shift| Placement { scale, shift }).collect()
}

/// Where each old picture correlates best with each new one, as a shift in places of the grid.
fn peaks(news: &[Raster<[f32; 2]>], olds: &[Raster<[f32; 2]>]) -> Vec<Point> {
    let side = |of: fn(&Raster<[f32; 2]>) -> usize, all: &[Raster<[f32; 2]>]| all.iter().map(of).max().unwrap_or(1);
    // Padded by the old picture, so that nothing wraps round.
    let correlator = Correlator::new(
        side(Raster::width, news) + side(Raster::width, olds),
        side(Raster::height, news) + side(Raster::height, olds),
    );
    let plane = |field: &Raster<[f32; 2]>, k: usize| field.map(|n| n[k]);
    let patterns: Vec<[Spectrum; 2]> = olds
        .chunks(2)
        .map(|pair| {
            [0, 1].map(|k| {
                let planes: Vec<Raster<f32>> = pair.iter().map(|field| plane(field, k)).collect();
                let second = planes.get(1).unwrap_or(&planes[0]);
                correlator.patterns([&planes[0], second])
            })
        })
        .collect();
    let per_new = |field: &Raster<[f32; 2]>| -> Vec<Point> {
        let own = [0, 1].map(|k| correlator.picture(&plane(field, k)));
        let sums = patterns.iter().flat_map(|pattern| correlator.correlate(&own, pattern));
        sums.map(|sum| peak(&sum, [field.width(), field.height()])).collect()
    };
    let all: Vec<Vec<Point>> = news.par_iter().map(per_new).collect();
    let mut all = all.concat();
    // Neighbouring frames have the same peaks.
    all.sort_by(|a, b| a.x.total_cmp(&b.x).then(a.y.total_cmp(&b.y)));
    all.dedup_by(|a, b| a.distance(*b) < 0.05);
    all
}

/// The highest place, to a fraction by parabolas. Places beyond the new picture are negative shifts.
fn peak(sum: &Raster<f32>, new: [usize; 2]) -> Point {
    let highest = (0..sum.data().len()).fold(0, |best, k| if sum.data()[k] > sum.data()[best] { k } else { best });
    let (x, y) = (highest % sum.width(), highest / sum.width());
    let (w, h) = (sum.width() as isize, sum.height() as isize);
    let at = |dx: isize, dy: isize| {
        sum.get((x as isize + dx).rem_euclid(w) as usize, (y as isize + dy).rem_euclid(h) as usize)
    };
    let vertex = |before: f32, here: f32, after: f32| {
        let bend = before - 2.0 * here + after;
        if bend < 0.0 { f64::from((before - after) / (2.0 * bend)).clamp(-0.5, 0.5) } else { 0.0 }
    };
    let unwrapped = |k: usize, side: isize, new: usize| if k < new { k as f64 } else { k as f64 - side as f64 };
    Point::new(
        unwrapped(x, w, new[0]) + vertex(at(-1, 0), at(0, 0), at(1, 0)),
        unwrapped(y, h, new[1]) + vertex(at(0, -1), at(0, 0), at(0, 1)),
    )
}

/// How well an old picture agrees with a new one at a placement, and the share of the new one that both show. The agreement is 0 where that is too little.
fn agreement(old: &Raster<[f32; 2]>, new: &Raster<[f32; 2]>, grid: &Grid, placement: &Placement) -> [f32; 2] {
    let shift = (placement.shift / grid.step).round();
    let (dx, dy) = (shift.x as isize, shift.y as isize);
    let range = |shift: isize, old: usize, new: usize| {
        let (from, to) = (shift.clamp(0, new as isize), (shift + old as isize).clamp(0, new as isize));
        from as usize..to as usize
    };
    let columns = range(dx, old.width(), new.width());
    let rows = range(dy, old.height(), new.height());
    let smaller = old.data().len().min(new.data().len()) as f64;
    let overlap = (columns.len() * rows.len()) as f64;
    if overlap < OVERLAP * smaller {
        return [0.0; 2];
    }
    let (mut both, mut ours, mut theirs) = (0.0f32, 0.0f32, 0.0f32);
    for (y, x) in rows.flat_map(|y| columns.clone().map(move |x| (y, x))) {
        let b = new.get(x, y);
        let a = old.get((x as isize - dx) as usize, (y as isize - dy) as usize);
        both += a[0] * b[0] + a[1] * b[1];
        ours += a[0] * a[0] + a[1] * a[1];
        theirs += b[0] * b[0] + b[1] * b[1];
    }
    let agreement = if ours > 0.0 && theirs > 0.0 { both / (ours * theirs).sqrt() } else { 0.0 };
    [agreement, (overlap / new.data().len() as f64) as f32]
}

#[cfg(test)]
mod tests {
    use super::*;
    use rototoon_base::scene::Silent;

    /// Some lines of a drawing, which is not like itself elsewhere, seen through a placement.
    fn drawing(size: [usize; 2], placement: &Placement) -> Raster<Colour> {
        let dark = |p: Point| {
            let ring = (p.distance(Point::new(40.0, 30.0)) - 14.0).abs() < 1.6;
            let stick = (p.x - 64.0).abs() < 1.6 && (20.0..60.0).contains(&p.y);
            ring || stick
        };
        Raster::from_fn(size[0], size[1], |x, y| {
            let p = placement.old_place(Point::new(x as f64 + 0.5, y as f64 + 0.5));
            [if dark(p) { 0.1 } else { 0.9 }; 3]
        })
    }

    fn search(truth: Placement, size: [usize; 2]) -> Placement {
        let old = drawing([96, 72], &Placement::SAME);
        let new = drawing(size, &truth);
        let scales = scales([96, 72], size, None);
        found(&[&old], &[&new], &scales, None, &Silent).unwrap().unwrap().placement
    }

    #[test]
    fn plain_placements_are_found() {
        assert_eq!(search(Placement::SAME, [96, 72]), Placement::SAME);
        let double = Placement { scale: 2.0, shift: Point::ZERO };
        assert_eq!(search(double, [192, 144]), double);
        let centred = Placement { scale: 1.0, shift: Point::new(12.0, 8.0) };
        assert_eq!(search(centred, [120, 88]), centred);
    }

    #[test]
    fn a_picture_that_was_moved_or_cut_is_found() {
        let moved = Placement { scale: 1.0, shift: Point::new(31.0, 5.0) };
        let placement = search(moved, [130, 90]);
        assert!(placement.shift.distance(moved.shift) < 1.0, "{placement:?}");
        let cut = Placement { scale: 1.0, shift: Point::new(-14.0, -9.0) };
        let placement = search(cut, [70, 60]);
        assert!(placement.shift.distance(cut.shift) < 1.0, "{placement:?}");
    }

    #[test]
    fn the_scale_of_wider_pictures_is_that_of_their_heights() {
        let wide = Placement { scale: 2.0, shift: Point::new(34.0, 0.0) };
        let placement = search(wide, [260, 144]);
        assert!(placement.scale == 2.0 && placement.shift.distance(wide.shift) < 1.5, "{placement:?}");
    }

    #[test]
    fn a_larger_plate_with_a_border_is_found() {
        let truth = Placement { scale: 2.0, shift: Point::new(23.0, 11.0) };
        let placement = search(truth, [250, 170]);
        assert!(placement.scale == 2.0 && placement.shift.distance(truth.shift) < 1.5, "{placement:?}");
    }

    #[test]
    fn pictures_that_would_be_far_too_large_are_not_drawn() {
        let (old, new) = (drawing([96, 72], &Placement::SAME), drawing([48, 36], &Placement::SAME));
        assert_eq!(found(&[&old], &[&new], &[100.0], None, &Silent), Ok(None));
        assert!(found(&[&old], &[&new], &[3.0], None, &Silent).unwrap().is_some());
    }

    #[test]
    fn each_likely_scale_is_tried_once() {
        let first = |old, new| scales(old, new, None)[..3].to_vec();
        assert_eq!(first([96, 72], [96, 72]), [1.0, 2.0, 0.5]);
        assert_eq!(first([96, 72], [192, 144]), [2.0, 1.0, 0.5]);
        assert_eq!(first([96, 72], [192, 108]), [1.5, 2.0, 1.0]);
        assert_eq!(scales([96, 72], [192, 108], Some(1.7)), [1.7]);
    }

    #[test]
    fn blank_pictures_are_nowhere() {
        let blank = Raster::new(96, 72, [0.9; 3]);
        assert_eq!(found(&[&blank], &[&blank], &[1.0], None, &Silent), Ok(None));
    }
}
