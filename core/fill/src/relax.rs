//! Who is who, by the company that regions keep.
//!
//! A region that was carried to the wrong place still lies among the same neighbours: a pupil in the white of an eye, a cuff between sleeve and
//! hand. With M the probability that region j is region i, and h_j(k) the share of its border that j has with regions that are k by M,
//! a pair agrees by Σ_k min(h_j(k), h_i(k)), from 0 to 1. So it does by colours, with the colours of k in place of k itself. Then
//!
//! u' = u exp(6 (agreement by regions + agreement by colours)),   M = u' ∕ Σ u'
//!
//! is repeated five times (relaxation labelling; Rosenfeld, Hummel & Zucker 1976). The edge of the picture is a neighbour too. A region may also be a piece of the
//! [paper](crate::opens).
//!
//! # Competition
//!
//! Two regions are seldom the same one: a thing that falls to pieces is rarer than a thing that is mistaken. So after each round, three times, the u' of
//! all pairs with a region i are divided by Σ_j M ∕ 0.8 where that is more than 1, and M is worked out again. Softassign makes a one-to-one table by
//! such normalisation of columns (Gold & Rangarajan 1996). Here it is for regions alone that are wanted too often: a region that is hidden on
//! the other drawing may stay without a partner. The bound of 0.8 leaves each region some room for what is new. The parts of a thing that fell to
//! pieces share its column, and each still prefers it where nothing else is alike.

use crate::layout::Layout;
use crate::meet::Table;
use crate::opens::Opens;
use rayon::prelude::{
    IndexedParallelIterator, IntoParallelIterator, IntoParallelRefIterator, IntoParallelRefMutIterator,
    ParallelIterator,
};

/// Strength of both agreements.
const STRENGTH: f32 = 6.0;
/// Rounds.
const ROUNDS: usize = 5;
/// How often columns are brought to their bound after a round.
const TURNS: usize = 3;
/// The largest Σ M of a region of the source.
const ROOM: f32 = 0.8;

/// How regions meet after they looked at their neighbours.
pub struct Relaxed {
    /// u' of each pair.
    pub all: Table,
    /// The probability of each pair: the rows of u', each with the sum of 1.
    pub sure: Table,
}

/// Relaxes how the regions of `to` meet those of `from`, whose colours are given by probabilities: a row for each region. Regions may be pieces of
/// the paper if that is given.
pub fn relax(from: &Layout, to: &Layout, meeting: &Table, colours: &Table, opens: Option<&Opens>) -> Relaxed {
    let seen: Table = from.borders.par_iter().map(|own| of_colours(own, colours)).collect();
    let mut all = meeting.clone();
    let mut sure = normalised(&all);
    for _ in 0..ROUNDS {
        let relaxed = (0..meeting.len()).into_par_iter().map(|j| {
            let around = around(&to.borders[j], &sure, from.borders.len());
            let colours = around_colours(&around, colours);
            let agree = |i: usize| {
                let regions: f32 = from.borders[i].iter().map(|&(k, share)| share.min(around[k])).sum();
                let colours: f32 = seen[i].iter().zip(&colours).map(|(a, b)| a.min(*b)).sum();
                // The edge has no colour, but is as good as one.
                let edge = from.borders[i].first().filter(|own| own.0 == 0).map_or(0.0, |own| own.1.min(around[0]));
                regions + colours + edge
            };
            let raised = |(i, u): (usize, &f32)| if *u > 0.0 { u * (STRENGTH * agree(i)).exp() } else { 0.0 };
            let mut row: Vec<f32> = meeting[j].iter().enumerate().map(raised).collect();
            if let Some(opens) = opens {
                // By regions and by colours.
                let piece = opens.met[j] * (STRENGTH * 2.0 * opens.agreement(&around)).exp();
                row[opens.paper] = row[opens.paper].max(piece);
            }
            row
        });
        all = relaxed.collect();
        sure = normalised(&all);
        for _ in 0..TURNS {
            compete(&mut all, &sure, opens);
            sure = normalised(&all);
        }
    }
    Relaxed { all, sure }
}

/// Lowers the pairs with each region of the source that too many regions want to be. Any number may be pieces of the paper.
fn compete(all: &mut Table, sure: &Table, opens: Option<&Opens>) {
    let mut wanted = vec![0.0f32; sure.first().map_or(0, Vec::len)];
    for row in sure.iter().skip(1) {
        wanted.iter_mut().zip(row).for_each(|(sum, sure)| *sum += sure);
    }
    let less: Vec<f32> = wanted.iter().map(|sum| ROOM / sum.max(ROOM)).collect();
    all.par_iter_mut().enumerate().for_each(|(j, row)| {
        let piece = opens.filter(|opens| opens.met[j] > 0.0).map(|opens| (opens.paper, row[opens.paper]));
        row.iter_mut().zip(&less).for_each(|(u, less)| *u *= less);
        piece.into_iter().for_each(|(paper, u)| row[paper] = u);
    });
}

fn normalised(table: &Table) -> Table {
    let row = |row: &Vec<f32>| {
        let total = row.iter().sum::<f32>().max(1e-30);
        row.iter().map(|value| value / total).collect()
    };
    table.par_iter().map(row).collect()
}

/// The colours of which a border consists.
fn of_colours(border: &[(usize, f32)], colours: &Table) -> Vec<f32> {
    let mut out = vec![0.0; colours.first().map_or(0, Vec::len)];
    for &(other, share) in border.iter().filter(|own| own.0 > 0) {
        out.iter_mut().zip(&colours[other]).for_each(|(sum, own)| *sum += share * own);
    }
    out
}

/// The regions of the other drawing of which a border consists.
fn around(border: &[(usize, f32)], sure: &Table, count: usize) -> Vec<f32> {
    let mut out = vec![0.0; count];
    for &(other, share) in border {
        match other {
            0 => out[0] += share,
            _ => out.iter_mut().zip(&sure[other]).for_each(|(sum, own)| *sum += share * own),
        }
    }
    out
}

/// The colours of the regions of which a border consists.
fn around_colours(around: &[f32], colours: &Table) -> Vec<f32> {
    let mut out = vec![0.0; colours.first().map_or(0, Vec::len)];
    for (share, own) in around.iter().zip(colours).skip(1).filter(|found| *found.0 > 0.0) {
        out.iter_mut().zip(own).for_each(|(sum, colour)| *sum += share * colour);
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::regions::Regions;
    use rototoon_base::geometry::Point;
    use rototoon_base::scene::Raster;

    /// A ring with a disc in it, and a disc alone.
    fn layout(swapped: bool) -> Layout {
        let circle = |x: f64, radius: f64, at: Point| (at.distance(Point::new(x, 30.0)) - radius).abs() < 0.8;
        let (ring, alone) = if swapped { (90.0, 30.0) } else { (30.0, 90.0) };
        let ink = Raster::from_fn(120, 60, |x, y| {
            let at = Point::new(x as f64, y as f64);
            circle(ring, 20.0, at) || circle(ring, 8.0, at) || circle(alone, 8.0, at)
        });
        Layout::new(&Regions::new(&ink))
    }

    #[test]
    fn regions_that_want_to_be_the_same_one_compete() {
        let sure = |all: &Table| normalised(all);
        // All three want to be 1. The second is as like 2, the third is like nothing else.
        let mut all = vec![vec![0.0; 4], vec![0.0, 0.9, 0.01, 0.0], vec![0.0, 0.5, 0.4, 0.0], vec![0.0, 0.3, 0.0, 0.0]];
        let before = sure(&all);
        for _ in 0..TURNS {
            let now = sure(&all);
            compete(&mut all, &now, None);
        }
        let after = sure(&all);
        assert!(before[2][1] > 0.5 && after[2][1] < 0.4, "{after:?}");
        assert!(after[1][1] > 0.7, "the likest one keeps it: {after:?}");
        assert_eq!(after[3][1], 1.0, "what is like nothing else keeps it too");
        // Any number of regions may be pieces of the paper.
        let paper = all.clone();
        let opens = Opens { paper: 1, met: vec![0.0, 0.1, 0.1, 0.0], beside: vec![0.0; 4] };
        compete(&mut all, &after, Some(&opens));
        assert_eq!(all[1][1], paper[1][1]);
        assert!(all[3][1] < paper[3][1], "what can be no piece of it competes for it");
        // A region that one alone wants is left as it is.
        let mut alone = vec![vec![0.0; 3], vec![0.0, 0.5, 0.1]];
        let now = vec![vec![0.0; 3], vec![0.0, 0.7, 0.1]];
        compete(&mut alone, &now, None);
        assert_eq!(alone[1], [0.0, 0.5, 0.1]);
    }

    #[test]
    fn a_disc_is_known_by_the_ring_around_it() {
        let (before, after) = (layout(false), layout(true));
        let named = |layout: &Layout| {
            // By area: paper, ring; the discs by what they border on.
            let mut order: Vec<usize> = (1..layout.figures.len()).collect();
            order.sort_by(|&a, &b| layout.figures[b].area.total_cmp(&layout.figures[a].area));
            let (paper, ring) = (order[0], order[1]);
            let inner = *order[2..].iter().find(|&&k| layout.borders[k].iter().any(|own| own.0 == ring)).unwrap();
            let alone = *order[2..].iter().find(|&&k| k != inner).unwrap();
            [paper, ring, inner, alone]
        };
        let (a, b) = (named(&before), named(&after));
        // Nothing but the areas of paper and ring is known; the discs meet equally.
        let mut meeting = vec![vec![0.0; 5]; 5];
        for (&j, &i) in b.iter().zip(&a) {
            a.iter().for_each(|&other| meeting[j][other] = 0.1);
            if j == b[0] || j == b[1] {
                meeting[j][i] = 1.0;
            }
        }
        let colours = vec![vec![0.0; 0]; 5];
        let relaxed = relax(&before, &after, &meeting, &colours, None);
        for k in 0..4 {
            assert!(relaxed.sure[b[k]][a[k]] > 0.75, "{k}: {:?}", relaxed.sure[b[k]]);
        }
    }
}
