//! In-betweens of fragmented drawings: each contour is cut into pieces, differently on each key, as automatic tracing does.
//!
//! The strokes are matched, nothing is told about which piece is which. The in-betweens are compared with the true ink on each
//! frame, as is a rival that draws nothing: it holds the earlier key.

use super::Set;
use super::ink::{InkErrors, ink};
use super::matching::Chance;
use anyhow::Result;
use rototoon::geometry::{Point, polyline};
use rototoon::scene::Silent;
use rototoon::tween::Stroke;
use rototoon::tween::between::{GivenPegs, Key, Options, Sequence};
use rototoon::tween::matching::{self, match_strokes};

/// Measures the frames between two keys. `cuts` is the greatest number of pieces of a contour.
pub fn measure(set: &Set, (from, to): (i32, i32), cuts: usize, chance: &mut Chance) -> Result<InkErrors> {
    let there: Vec<usize> = (0..set.parts.len())
        .filter(|&i| (from..=to).all(|f| set.parts[i].points.get(&f).is_some_and(|p| p.len() > 3)))
        .collect();
    let mut drawn = |frame: i32| -> Vec<(usize, Stroke)> {
        let pieces = there.iter().flat_map(|&i| {
            let part = &set.parts[i];
            pieces(&part.points[&frame], part.closed, cuts, chance).into_iter().map(move |stroke| (i, stroke))
        });
        let pieces: Vec<(usize, Stroke)> = pieces.collect();
        let order = chance_order(pieces.len(), frame);
        order.into_iter().map(|k| pieces[k].clone()).collect()
    };
    let (first, second) = (drawn(from), drawn(to));
    let strokes = |of: &[(usize, Stroke)]| of.iter().map(|(_, stroke)| stroke.clone()).collect::<Vec<_>>();
    let (a, b) = (strokes(&first), strokes(&second));
    let matching = match_strokes(&a, &b, &[], &matching::Options::default(), &Silent)?;
    let mut pairs = (0, 0);
    for pair in &matching.pairs {
        let right = first[pair.from].0 == second[pair.to].0;
        *(if right { &mut pairs.0 } else { &mut pairs.1 }) += 1;
    }
    let keys = vec![
        Key { frame: from, strokes: a.clone(), ..Key::default() },
        Key { frame: to, strokes: b.clone(), ..Key::default() },
    ];
    let sequence = Sequence::new(keys, &[matching], &GivenPegs::default(), &Options::default())?;
    let lines = |frame: i32| ink(there.iter().map(|&i| (&set.parts[i].points[&frame][..], set.parts[i].closed)));
    let truth: Vec<_> = (from + 1..to).map(|frame| (frame, lines(frame))).collect();
    Ok(InkErrors { pairs, ..InkErrors::of_span(&sequence, [&a, &b], &truth) })
}

fn chance_order(count: usize, frame: i32) -> Vec<usize> {
    Chance(u64::from(frame.unsigned_abs()) + 77).order(count)
}

/// A contour in one to `most` pieces, with gaps of up to an eighth of a piece between them.
fn pieces(points: &[Point], closed: bool, most: usize, chance: &mut Chance) -> Vec<Stroke> {
    let count = 1 + chance.below(most);
    if count == 1 {
        return vec![Stroke::new(points.to_vec(), closed)];
    }
    let dense = polyline::resample(points, closed, 48 * count);
    let shift = if closed { chance.below(dense.len()) } else { 0 };
    let mut turned = dense;
    turned.rotate_left(shift);
    let ends: Vec<usize> =
        (0..=count).map(|k| if k == 0 || k == count { 48 * k } else { 48 * k + chance.below(25) - 12 }).collect();
    ends.windows(2)
        .map(|pair| {
            let gap = chance.below(7);
            let mut piece: Vec<Point> = turned[pair[0]..pair[1] - gap.min(pair[1] - pair[0] - 8)].to_vec();
            if chance.below(2) == 0 {
                piece.reverse();
            }
            Stroke::new(piece, false)
        })
        .collect()
}
