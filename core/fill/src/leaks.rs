//! Regions that leak: two areas of different colours that a gap in a line makes one.
//!
//! The painted drawing, carried onto the new one, shows them. If most of two of its regions of different colours comes to lie in one region
//! there, either one of them vanished behind something, or a line has a gap. A gap is narrow: on the way from the deepest
//! place of the one to that of the other, a place comes that is nearer to the ink than [`GAP`], and less than half as deep
//! as both ends. Such a region is [split](crate::regions::Regions::split) there.
//!
//! A gap may be nearly as wide as what leaks through it: a hand, an eye. A place that is [nearly](NEARLY) as deep as the ends is a gap up to twice as wide,
//! if what it parts from the region is [what leaked](crate::piece).

use crate::layout::Layout;
use crate::levels::{GAP, levels};
use crate::page::Paint;
use crate::piece::has_leaked;
use crate::regions::summit;
use crate::shifts::Shifts;
use rototoon_base::geometry::Point;
use rototoon_base::scene::Raster;
use rototoon_lines::ink::distance;
use std::collections::BTreeMap;

/// Half the width of the widest gap that parts what leaked, in pixels at 540 lines.
const WIDE: f64 = 10.0;
/// Depth of a gap, as a share of that of the shallower end: of any gap, and of one that parts what leaked.
const NARROW: f32 = 0.5;
const NEARLY: f32 = 0.95;
/// Share of a region that must come to lie in the one that leaks.
const MOST: f64 = 0.7;
/// Smallest area of it there, in pixels at 540 lines: where any gap counts, and where what it parts must be what leaked.
const LEAST: f64 = 150.0;
const SMALL: f64 = 30.0;

/// A cell and how deep it is.
type Deep = (f32, usize);

/// For each region the painted ones that lie in it: colour, region and area.
type Within = BTreeMap<usize, Vec<(usize, usize, f64)>>;

/// The regions of `to` that leak, each with the places in pixels between which it is to be split. `back` are the shifts from `to` to
/// the drawing `from`, which is painted by `paint`.
pub fn leaks(from: &Layout, paint: &Paint, to: &Layout, back: &Shifts) -> Vec<(usize, Vec<Point>)> {
    let (seen, within) = within(from, paint, to, back, SMALL);
    let mixed = within.into_iter().filter(|(_, own)| own.iter().any(|other| other.0 != own[0].0));
    mixed.filter_map(|(region, own)| Some((region, places(region, &own, to, &seen)?))).collect()
}

/// For each region of `to` the share of it that came from regions of other colours than its own in `paint`, most of which it covers. They have
/// vanished, or it leaks where no narrow gap is.
pub fn swallowed(from: &Layout, known: &Paint, (to, paint): (&Layout, &Paint), back: &Shifts) -> Vec<f64> {
    let (_, within) = within(from, known, to, back, LEAST);
    let mut inside = vec![0.0f64; to.figures.len()];
    to.inside.data().iter().for_each(|&region| inside[region as usize] += 1.0);
    let mut shares = vec![0.0; to.figures.len()];
    for (region, own) in within {
        let other = own.iter().filter(|&&(colour, source, area)| {
            paint.colour(region).is_some_and(|painted| painted != colour) && area >= MOST * from.figures[source].area
        });
        shares[region] = other.map(|found| found.2).sum::<f64>() / inside[region].max(1.0);
    }
    shares
}

/// The painted regions of `from` of which most comes to lie in one region of `to`, `least` pixels of 540 lines or more, by that region: each with
/// its colour and its area there. Also the region of `from` that is seen in each cell of `to`.
fn within(from: &Layout, paint: &Paint, to: &Layout, back: &Shifts, least: f64) -> (Raster<u32>, Within) {
    let (width, height) = (to.inside.width(), to.inside.height());
    let seen = Raster::from_fn(width, height, |x, y| from.nearest_at(back.carry(to.place(x, y))));
    let mut came: BTreeMap<(usize, usize), f64> = BTreeMap::new();
    let mut whole = vec![0.0f64; from.figures.len()];
    for (&region, &source) in to.inside.data().iter().zip(seen.data()).filter(|cell| *cell.0 > 0) {
        *came.entry((region as usize, source as usize)).or_default() += 1.0;
        whole[source as usize] += 1.0;
    }
    let least = least * to.unit * to.unit;
    let mut within = Within::new();
    for (&(region, source), &area) in &came {
        if let Some(colour) = paint.colour(source).filter(|_| area >= least && area >= MOST * whole[source]) {
            within.entry(region).or_default().push((colour, source, area));
        }
    }
    (seen, within)
}

/// The places between which a region is split: the deepest one of each of its areas, from the largest on, that gaps part from all
/// larger ones. Areas that no gap parts are one, and the largest speaks for it. `None` if there is only one.
fn places(region: usize, own: &[(usize, usize, f64)], to: &Layout, seen: &Raster<u32>) -> Option<Vec<Point>> {
    let depth = distance::inside(&to.inside.map(|label| label as usize == region));
    let ends = deepest(&depth, seen);
    let mut own = own.to_vec();
    own.sort_by(|a, b| b.2.total_cmp(&a.2).then(a.1.cmp(&b.1)));
    let main = own.first()?.0;
    let mut found: Vec<(Deep, Vec<f32>)> = Vec::new();
    for &(colour, source, area) in &own {
        // Other areas of the largest one's colour need no part of their own.
        if colour == main && !found.is_empty() {
            continue;
        }
        let Some(&end) = ends.get(&source) else { continue };
        let parted = |widest: f64, share: f32| {
            found.iter().all(|(start, levels)| {
                let level = levels[end.1];
                f64::from(level) <= widest && level < share * start.0.min(end.0)
            })
        };
        let is_wide = || {
            let places: Vec<usize> = found.iter().map(|(start, _)| start.1).chain([end.1]).collect();
            let summits: Vec<usize> = places.into_iter().map(|at| summit(&depth, at)).collect();
            parted(WIDE * to.unit, NEARLY) && has_leaked(source, &summits, &depth, to, seen)
        };
        let is_large = area >= LEAST * to.unit * to.unit;
        if found.is_empty() || (is_large && parted(GAP * to.unit, NARROW)) || is_wide() {
            found.push((end, levels(&depth, end.1)));
        }
    }
    let place = |at: usize| to.place(at % seen.width(), at / seen.width());
    (found.len() > 1).then(|| found.iter().map(|(end, _)| place(end.1)).collect())
}

/// The deepest cell of each painted region that is seen in what has a depth.
fn deepest(depth: &Raster<f32>, seen: &Raster<u32>) -> BTreeMap<usize, Deep> {
    let mut deepest: BTreeMap<usize, Deep> = BTreeMap::new();
    for (at, (&depth, &source)) in depth.data().iter().zip(seen.data()).enumerate().filter(|cell| *cell.1.0 > 0.0) {
        let end = deepest.entry(source as usize).or_insert((depth, at));
        if depth > end.0 {
            *end = (depth, at);
        }
    }
    deepest
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::page::Paint;
    use crate::regions::Regions;

    /// Two rooms of 540 lines; the wall between them has a door of a height.
    fn rooms(door: usize) -> Layout {
        let ink = Raster::from_fn(400, 540, |x, y| {
            let outer = x.abs_diff(200).max(y.abs_diff(270)) == 150;
            outer || (x == 200 && y.abs_diff(270) < 150 && 2 * y.abs_diff(270) >= door)
        });
        Layout::new(&Regions::new(&ink))
    }

    fn painted(layout: &Layout) -> Paint {
        let mut paint = Paint::nothing(layout.figures.len() - 1, 3);
        (1..layout.figures.len()).for_each(|region| paint.colours[region][region - 1] = 1.0);
        paint
    }

    #[test]
    fn a_room_with_a_narrow_door_is_split_and_one_with_a_wide_door_is_not() {
        let closed = rooms(0);
        assert_eq!(closed.figures.len(), 4, "outside and two rooms");
        let (paint, still) = (painted(&closed), Shifts::new(&[], 400, 540, 1.0));
        let found = leaks(&closed, &paint, &rooms(6), &still);
        assert_eq!(found.len(), 1);
        let (region, places) = &found[0];
        assert_eq!((*region, places.len()), (2, 2));
        assert!((places[0].x < 200.0) != (places[1].x < 200.0), "one place in each room: {places:?}");
        let wide = rooms(120);
        assert!(leaks(&closed, &paint, &wide, &still).is_empty(), "a wide opening is no gap");
        // Both rooms have the colour of one of them.
        let mut one = Paint::nothing(2, 3);
        (one.colours[1][0], one.colours[2][1]) = (1.0, 1.0);
        let shares = swallowed(&closed, &paint, (&wide, &one), &still);
        assert!(shares[1] == 0.0 && (shares[2] - 0.5).abs() < 0.02, "{shares:?}");
        assert_eq!(swallowed(&closed, &paint, (&closed, &paint), &still), [0.0; 4]);
        assert!(leaks(&closed, &paint, &closed, &still).is_empty());
    }

    /// A box with a disc of a radius in it, whose outline has a gap of a width, or is not there at all.
    fn disc(radius: f64, gap: Option<f64>) -> Layout {
        let ink = Raster::from_fn(300, 540, |x, y| {
            let at = Point::new(x as f64 - 150.0, y as f64 - 270.0);
            let on = (at.length() - radius).abs() < 0.8;
            let outer = at.x.abs().max(at.y.abs()) == 100.0;
            outer || (on && gap.is_some_and(|gap| at.x < 0.0 || 2.0 * at.y.abs() >= gap))
        });
        Layout::new(&Regions::new(&ink))
    }

    #[test]
    fn what_leaks_through_a_gap_nearly_as_wide_as_itself_is_known_by_its_outline() {
        let still = Shifts::new(&[], 300, 540, 1.0);
        for (radius, gap) in [(9.0, 4.0), (9.0, 8.0), (9.0, 11.0), (6.0, 6.0)] {
            let closed = disc(radius, Some(0.0));
            let paint = painted(&closed);
            let open = disc(radius, Some(gap));
            assert_eq!(open.figures.len(), 3, "outside and one room");
            let found = leaks(&closed, &paint, &open, &still);
            let [(_, places)] = found.as_slice() else { panic!("{radius}, {gap}: {found:?}") };
            let in_disc = |p: &&Point| p.distance(Point::new(150.5, 270.5)) < 6.0;
            assert_eq!(places.iter().filter(in_disc).count(), 1, "{radius}, {gap}: {places:?}");
            assert!(leaks(&closed, &paint, &disc(radius, None), &still).is_empty(), "it has gone behind something");
        }
    }

    #[test]
    fn a_bay_of_another_form_is_not_what_has_gone_there() {
        let (closed, still) = (disc(9.0, Some(0.0)), Shifts::new(&[], 300, 540, 1.0));
        // Two lines to both sides of where the disc was, open at one end.
        let bay = Raster::from_fn(300, 540, |x, y| {
            let (u, v) = (x.abs_diff(150), y.abs_diff(270));
            u.max(v) == 100 || (v == 10 && u <= 40) || (x == 110 && v <= 10) || (x == 190 && (5..=10).contains(&v))
        });
        let open = Layout::new(&Regions::new(&bay));
        assert_eq!(open.figures.len(), 3, "outside and one room");
        assert!(leaks(&closed, &painted(&closed), &open, &still).is_empty());
    }

    #[test]
    fn areas_of_one_room_do_not_split_it_among_them() {
        // The painted drawing has a second wall, in the right room. It has gone.
        let ink = |second: bool| {
            move |x: usize, y: usize| {
                let outer = x.abs_diff(200).max(y.abs_diff(270)) == 150;
                let wall = x == 200 && y.abs_diff(270) < 150 && (second || 2 * y.abs_diff(270) >= 6);
                outer || wall || (second && y == 200 && (200..350).contains(&x))
            }
        };
        let closed = Layout::new(&Regions::new(&Raster::from_fn(400, 540, ink(true))));
        let open = Layout::new(&Regions::new(&Raster::from_fn(400, 540, ink(false))));
        assert_eq!([closed.figures.len(), open.figures.len()], [5, 3]);
        let mut paint = Paint::nothing(4, 4);
        (1..5).for_each(|region| paint.colours[region][region - 1] = 1.0);
        let found = leaks(&closed, &paint, &open, &Shifts::new(&[], 400, 540, 1.0));
        let [(_, places)] = found.as_slice() else { panic!("{found:?}") };
        assert_eq!(places.len(), 2, "one place in each room: {places:?}");
    }

    #[test]
    fn rooms_of_one_colour_stay_together() {
        let closed = rooms(0);
        let mut paint = painted(&closed);
        paint.colours[3] = paint.colours[2].clone();
        assert!(leaks(&closed, &paint, &rooms(6), &Shifts::new(&[], 400, 540, 1.0)).is_empty());
    }
}
