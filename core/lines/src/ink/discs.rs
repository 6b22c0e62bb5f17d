//! The union of discs of ink: what is nearer to one of some pixels than that pixel is deep in the ink.
//!
//! A black of radius r has about r² such pixels, and their discs have r⁴ pixels in all. So the discs are not drawn. A pixel p
//! is in the disc around c with radius d if |p − c|² − d² is negative. The least such value over all c is a distance
//! transform with weights, which two passes of lower envelopes of parabolas find exactly, in linear time (Felzenszwalb &
//! Huttenlocher 2012). All values are whole numbers.

use rototoon_base::scene::Raster;

/// No parabola here.
const NONE: i32 = i32::MAX;

/// The pixels within the discs around `pixels`, whose radii are their depths, rising. Pixels at a disc's edge are not in it.
pub fn union(depth: &Raster<f32>, pixels: &[usize]) -> Vec<usize> {
    let Some(area) = Area::around(depth, pixels) else { return Vec::new() };
    let columns = depth.width();
    let mut least = Raster::new(area.width, area.height, NONE);
    for &i in pixels {
        let radius = depth.data()[i];
        least.set(i % columns - area.left, i / columns - area.top, -((radius * radius).round() as i32));
    }
    let mut envelope = Envelope::default();
    let mut column = vec![NONE; area.height];
    for x in 0..area.width {
        (0..area.height).for_each(|y| column[y] = least.get(x, y));
        envelope.lower(&mut column);
        (0..area.height).for_each(|y| least.set(x, y, column[y]));
    }
    let mut found = Vec::new();
    for y in 0..area.height {
        let row = least.row_mut(y);
        envelope.lower(row);
        let start = (area.top + y) * columns + area.left;
        found.extend(row.iter().enumerate().filter(|(_, least)| **least < 0).map(|(x, _)| start + x));
    }
    found
}

/// The part of the picture that discs reach.
struct Area {
    left: usize,
    top: usize,
    width: usize,
    height: usize,
}

impl Area {
    fn around(depth: &Raster<f32>, pixels: &[usize]) -> Option<Self> {
        let columns = depth.width();
        let reach = pixels.iter().map(|&i| depth.data()[i].ceil() as usize).max()?;
        let range = |of: &dyn Fn(usize) -> usize, end: usize| {
            let (low, high) = pixels.iter().fold((end, 0), |(low, high), &i| (low.min(of(i)), high.max(of(i))));
            (low.saturating_sub(reach), (high + reach + 1).min(end))
        };
        let (left, right) = range(&|i| i % columns, columns);
        let (top, bottom) = range(&|i| i / columns, depth.height());
        Some(Self { left, top, width: right - left, height: bottom - top })
    }
}

/// The lower envelope of parabolas on a line, with its memory: their places and heights, and where each becomes the lowest.
#[derive(Default)]
struct Envelope(Vec<(i32, i32, f64)>);

impl Envelope {
    /// Puts into each place k the least `value[j] + (k − j)²`.
    fn lower(&mut self, values: &mut [i32]) {
        let parabolas = &mut self.0;
        parabolas.clear();
        for (x, &height) in (0..).zip(values.iter()).filter(|(_, height)| **height != NONE) {
            let mut from = f64::NEG_INFINITY;
            while let Some(&(at, own, start)) = parabolas.last() {
                from = 0.5 * (f64::from(height - own) / f64::from(x - at) + f64::from(x + at));
                if from > start {
                    break;
                }
                parabolas.pop();
                from = f64::NEG_INFINITY;
            }
            parabolas.push((x, height, from));
        }
        let mut k = 0;
        for (x, out) in (0..).zip(values.iter_mut()) {
            while parabolas.get(k + 1).is_some_and(|next| next.2 <= f64::from(x)) {
                k += 1;
            }
            if let Some((at, height, _)) = parabolas.get(k) {
                *out = height + (x - at) * (x - at);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ink::distance;
    use proptest::prelude::*;

    /// Every disc, drawn.
    fn drawn(depth: &Raster<f32>, pixels: &[usize]) -> Vec<usize> {
        let columns = depth.width();
        let within = |p: usize, c: usize| {
            let (dx, dy) = ((p % columns).abs_diff(c % columns), (p / columns).abs_diff(c / columns));
            dx * dx + dy * dy < (depth.data()[c] * depth.data()[c]).round() as usize
        };
        (0..depth.data().len()).filter(|&p| pixels.iter().any(|&c| within(p, c))).collect()
    }

    proptest! {
        #[test]
        fn the_union_is_that_of_discs_that_are_drawn(
            (width, height) in (1usize..24, 1usize..20),
            noise in prop::collection::vec(0.0f64..1.0, 24 * 20),
            (share, level) in (0.5f64..1.0, 1.0f32..5.0),
        ) {
            let mask = Raster::from_fn(width, height, |x, y| noise[y * 24 + x] < share);
            let depth = distance::inside(&mask);
            let pixels: Vec<usize> = (0..width * height).filter(|&i| depth.data()[i] >= level).collect();
            prop_assert_eq!(union(&depth, &pixels), drawn(&depth, &pixels));
        }
    }

    #[test]
    fn a_filled_circle_is_the_union_of_the_discs_in_its_middle() {
        let mask = Raster::from_fn(90, 80, |x, y| (x as f64 - 44.0).hypot(y as f64 - 40.0) < 33.0);
        let depth = distance::inside(&mask);
        let pixels: Vec<usize> = (0..depth.data().len()).filter(|&i| depth.data()[i] >= 6.0).collect();
        let found = union(&depth, &pixels);
        assert_eq!(found, drawn(&depth, &pixels));
        assert!(found.len() > 3300 && found.iter().all(|&i| mask.data()[i]));
        assert!(union(&depth, &[]).is_empty());
    }
}
