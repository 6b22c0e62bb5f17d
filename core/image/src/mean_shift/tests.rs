//! Mean shift against its definition, and at its limits.

use super::*;
use proptest::prelude::*;

/// A walk by its definition.
fn naive(picture: &Raster<Levels>, x: usize, y: usize, radius: usize, range: i32, steps: usize) -> Levels {
    let (mut x, mut y, mut colour) = (x, y, picture.get(x, y));
    for _ in 0..steps {
        let mut near = Vec::new();
        for j in y.saturating_sub(radius)..(y + radius + 1).min(picture.height()) {
            for i in x.saturating_sub(radius)..(x + radius + 1).min(picture.width()) {
                if distance(picture.get(i, j), colour) <= range * range {
                    near.push((i, j));
                }
            }
        }
        if near.is_empty() {
            break;
        }
        let mean = |f: &dyn Fn(&(usize, usize)) -> usize| {
            (near.iter().map(f).sum::<usize>() as f64 * (1.0 / near.len() as f64)).round_ties_even() as usize
        };
        let to = (mean(&|p| p.0), mean(&|p| p.1));
        let to_colour = [0, 1, 2].map(|c| mean(&|p| picture.get(p.0, p.1)[c] as usize) as u8);
        let moved = to.0.abs_diff(x) + to.1.abs_diff(y);
        let still = moved == 0 || moved as i32 + distance(to_colour, colour) <= 1;
        (x, y, colour) = (to.0, to.1, to_colour);
        if still {
            break;
        }
    }
    colour
}

/// Noise around a few colours, so that windows are partly near.
fn pictures() -> impl Strategy<Value = Raster<Levels>> {
    (1usize..26, 1usize..26, 1u8..60).prop_flat_map(|(w, h, noise)| {
        let pixel = (prop::array::uniform3(0..noise), prop::sample::select(vec![[0u8, 0, 0], [120, 40, 190]]));
        let pixel = pixel.prop_map(|(n, base)| [n[0] + base[0], n[1] + base[1], n[2] + base[2]]);
        prop::collection::vec(pixel, w * h).prop_map(move |data| Raster::from_vec(w, h, data).unwrap())
    })
}

proptest! {
    #[test]
    fn equals_the_definition(
        picture in pictures(), radius in 1usize..12, range in 0usize..101, steps in 0usize..6
    ) {
        let options = MeanShiftOptions { radius, range, levels: 0, steps };
        let wanted = Raster::from_fn(picture.width(), picture.height(), |x, y| {
            naive(&picture, x, y, radius, range as i32, steps)
        });
        prop_assert_eq!(mean_shift_levels(&picture, &options), wanted);
    }

    #[test]
    fn finer_level_walks_at_borders_only(picture in pictures(), radius in 2usize..7, range in 1usize..40) {
        let options = MeanShiftOptions { radius, range, levels: 1, steps: 5 };
        prop_assume!(picture.width() > 1 && picture.height() > 1);
        let half_radius = (radius as f64 / 2.0).round_ties_even() as usize;
        let half = MeanShiftOptions { radius: half_radius, levels: 0, ..options };
        let coarse = mean_shift_levels(&halve(&picture), &half);
        let (w, h) = (picture.width(), picture.height());
        let enlarged = double(&coarse, w, h);
        let pixels = || (0..coarse.height()).flat_map(|y| (0..coarse.width()).map(move |x| (x, y)));
        let limit = (range * range).max(16) as i32;
        let borders: Vec<_> = pixels()
            .filter(|&(x, y)| {
                pixels().any(|(i, j)| {
                    i.abs_diff(x).max(j.abs_diff(y)) == 1 && distance(coarse.get(i, j), coarse.get(x, y)) >= limit
                })
            })
            .collect();
        let wanted = Raster::from_fn(w, h, |x, y| {
            if borders.iter().any(|(i, j)| (2 * i).abs_diff(x) <= 1 && (2 * j).abs_diff(y) <= 1) {
                naive(&picture, x, y, radius, range as i32, 5)
            } else {
                enlarged.get(x, y)
            }
        });
        prop_assert_eq!(mean_shift_levels(&picture, &options), wanted);
    }

    #[test]
    fn halving_is_the_double_sum(picture in pictures()) {
        let half = halve(&picture);
        for y in 0..half.height() {
            for x in 0..half.width() {
                let mut sum = 0;
                for j in 0..5 {
                    for i in 0..5 {
                        let column = mirrored((2 * x + i) as isize - 2, picture.width());
                        let row = mirrored((2 * y + j) as isize - 2, picture.height());
                        sum += KERNEL[i] * KERNEL[j] * picture.get(column, row)[1] as i32;
                    }
                }
                prop_assert_eq!(half.get(x, y)[1] as i32, (sum + 128) / 256);
            }
        }
    }
}

#[test]
fn doubling_keeps_slopes() {
    let coarse = Raster::from_fn(8, 6, |x, y| [(20 * x) as u8, (20 * y) as u8, 77]);
    let fine = double(&coarse, 15, 12);
    for y in 2..10 {
        for x in 2..13 {
            assert_eq!(fine.get(x, y), [(10 * x) as u8, (10 * y) as u8, 77]);
        }
    }
}

#[test]
fn noise_disappears_and_the_edge_stays() {
    let noisy = Raster::from_fn(40, 30, |x, y| {
        let noise = ((x * 7 + y * 13 + x * y) % 9) as u8;
        if x < 20 { [30 + noise, 40, 60 + noise] } else { [200, 180 + noise, 90] }
    });
    let flat = mean_shift_levels(&noisy, &MeanShiftOptions::default());
    let spread = |columns: std::ops::Range<usize>, c: usize| {
        let values: Vec<_> =
            columns.flat_map(|x| (0..30).map(move |y| (x, y))).map(|(x, y)| flat.get(x, y)[c]).collect();
        values.iter().max().unwrap() - values.iter().min().unwrap()
    };
    assert!(spread(0..20, 0) <= 3, "{}", spread(0..20, 0));
    assert!(spread(20..40, 1) <= 3, "{}", spread(20..40, 1));
}

#[test]
fn sizes_and_options_at_their_limits() {
    for (w, h) in [(1, 1), (1, 9), (9, 1), (2, 2), (3, 5)] {
        let picture = Raster::new(w, h, [9, 8, 7]);
        for levels in [0, 1, 9] {
            let options = MeanShiftOptions { radius: 1000, range: 1000, levels, steps: 5 };
            assert_eq!(mean_shift_levels(&picture, &options), picture);
        }
    }
    let empty = Raster::new(0, 3, [0.0; 3]);
    assert_eq!(mean_shift(&empty, &MeanShiftOptions::default()), empty);
}
