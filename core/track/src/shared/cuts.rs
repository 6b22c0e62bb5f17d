//! Finds cuts: where the footage changes to another shot.
//!
//! From one drawing to the next of the same shot most of the picture stays, or moves a little with the camera. At a cut
//! almost no pixel has a similar one nearby. So each pixel of the coarsest level is compared with the pixels around its
//! place in the other picture. It is a cut if more than half of the pixels have no similar one there, in both
//! directions: an area that a part covers or uncovers has no match in one direction only.
//!
//! Limits: a whip pan or a flash looks like a cut. Two shots with the same plain background do not.

use super::features::{Features, Level, Padded, difference};
use rototoon_base::geometry::Point;
use rototoon_base::numeric::vector::vectorised;

/// Level (index in `LEVELS`) that is compared.
const LEVEL: usize = 0;
/// Pixels around a place that are searched for a similar one.
const REACH: isize = 2;
/// Largest squared colour difference (three channels of 0 to 1) of similar pixels.
const ALIKE: f32 = 0.02;
/// Share of pixels without a similar one above which it is a cut.
const MOST: f64 = 0.5;

/// Whether two neighbouring pictures belong to different shots.
pub fn is_cut(a: &Features, b: &Features) -> bool {
    let (a, b) = (a.level(LEVEL), b.level(LEVEL));
    a.dimensions() != b.dimensions() || changed(a, b).min(changed(b, a)) > MOST
}

/// Share of the pixels of one picture that have no similar pixel around their place in another of the same size.
fn changed(from: &Level, to: &Level) -> f64 {
    let (width, height) = from.dimensions();
    let (seen, known) = (colours(from), colours(to));
    let alike = |x: usize, y: usize| {
        let colour = seen[y * width + x];
        let around = |at: usize, most: usize| at.saturating_sub(REACH as usize)..(at + REACH as usize + 1).min(most);
        around(y, height).any(|v| around(x, width).any(|u| difference(colour, known[v * width + u]) <= ALIKE))
    };
    let missed = (0..height).map(|y| (0..width).filter(|&x| !alike(x, y)).count()).sum::<usize>();
    missed as f64 / (width * height).max(1) as f64
}

fn colours(level: &Level) -> Vec<Padded> {
    let (width, height) = level.dimensions();
    let center = |x: usize, y: usize| Point::new(x as f64 + 0.5, y as f64 + 0.5) * level.pixel();
    let all = (0..height).flat_map(|y| (0..width).map(move |x| (x, y)));
    vectorised(
        #[inline(always)]
        || all.map(|(x, y)| level.colour(center(x, y))).collect(),
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use rototoon_base::scene::Raster;

    /// Stripes of many colours, shifted by `shift` px.
    fn stripes(shift: f32, turned: bool) -> Features {
        Features::new(&Raster::from_fn(160, 120, |x, y| {
            let t = (if turned { y } else { x }) as f32 + shift;
            [(t * 0.09).sin() * 0.5 + 0.5, (t * 0.05).cos() * 0.5 + 0.5, if turned { 0.9 } else { 0.1 }]
        }))
    }

    #[test]
    fn a_camera_move_is_no_cut_and_another_shot_is() {
        assert!(!is_cut(&stripes(0.0, false), &stripes(0.0, false)));
        assert!(!is_cut(&stripes(0.0, false), &stripes(3.0, false)));
        assert!(is_cut(&stripes(0.0, false), &stripes(0.0, true)));
    }

    #[test]
    fn a_large_part_that_appears_is_no_cut() {
        let plain = |size: usize| {
            Features::new(&Raster::from_fn(160, 120, |x, _| if x < size { [0.8, 0.2, 0.1] } else { [0.9, 0.9, 0.8] }))
        };
        assert!(!is_cut(&plain(0), &plain(70)));
        assert!(is_cut(&plain(0), &plain(160)));
    }
}
