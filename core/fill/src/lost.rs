//! Things that are lost: regions of the last drawing that are found in no region of their colour, though a region of another colour may
//! be one of them.
//!
//! A boot hangs behind the other one on the clicked drawing. On the next drawing it is whole, and looks more like the leg beside it. Then a boot is lost and a leg is
//! too many. Each of both alone is common: things go behind others, and fall to pieces. Together they are a mistake more often than not.
//!
//! With M and u' of [`relax`](crate::relax), region i of the last drawing is *lost* if its colour is known with [`HALF`] or more, and Σ M of i over all regions that
//! have its colour here is below that. Region j is in doubt if a lost region i of another colour
//!
//! - has its place there: more than half of Σ u' of i over all regions is that of j;
//! - is what j most probably is, of all regions with other colours than its own, with M of [`LIKELY`] or more.
//!
//! Then its colour has a confidence of [`DOUBT`] at most.
//!
//! # Why the last drawing alone
//!
//! On drawings beside each other little is hidden, so what is lost says much. On a drawing far away half of the things are hidden, and the clicked drawing puts two
//! right regions in doubt for each wrong one.
//!
//! # Limits
//!
//! What has gone behind something just where a new thing comes up puts that in doubt. Where the two have one colour, nothing is seen.

use crate::page::Paint;
use crate::said::Said;

/// The share from which something is so rather than not.
const HALF: f64 = 0.5;
/// Least probability that a region is a lost one.
const LIKELY: f32 = 0.05;
/// The largest confidence in a colour in whose place another one is lost.
const DOUBT: f64 = 0.4;

/// For each region of a drawing the most that its colour can have, by what the last painted drawing says.
pub(crate) fn bounds(last: &Said, paint: &Paint) -> Vec<f64> {
    let lost = lost(last, paint);
    let of = |region: usize| {
        let Some(colour) = paint.colour(region) else { return 1.0 };
        let sure = &last.relaxed.sure[region];
        let others = (1..sure.len()).filter(|&i| last.paint.colour(i).is_some_and(|own| own != colour));
        // Of equal ones the first is taken.
        let best = others.rev().max_by(|&a, &b| sure[a].total_cmp(&sure[b]));
        let doubted = best.is_some_and(|i| lost[i] && sure[i] >= LIKELY && has_place(last, i, region));
        if doubted { DOUBT } else { 1.0 }
    };
    (0..paint.colours.len()).map(of).collect()
}

/// For each region of the last drawing whether its colour is known, and no region here that has it is probably this one.
fn lost(last: &Said, paint: &Paint) -> Vec<bool> {
    let is_lost = |i: usize| {
        let colour = last.paint.colour(i);
        let same = (1..paint.colours.len()).filter(|&j| paint.colour(j) == colour);
        let placed: f32 = same.map(|j| last.relaxed.sure[j][i]).sum();
        colour.is_some() && last.paint.confidence[i] >= HALF && f64::from(placed) < HALF
    };
    (0..last.paint.colours.len()).map(|i| i > 0 && is_lost(i)).collect()
}

/// Whether a region of the last drawing is in one place here rather than in all others.
fn has_place(last: &Said, source: usize, region: usize) -> bool {
    let all: f32 = last.relaxed.all.iter().skip(1).map(|row| row[source]).sum();
    f64::from(last.relaxed.all[region][source]) > HALF * f64::from(all)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::meet::Table;
    use crate::relax::Relaxed;

    /// Regions with colours, from 1 on.
    fn painted(colours: &[usize]) -> Paint {
        let mut paint = Paint::nothing(colours.len(), 3);
        for (k, &colour) in colours.iter().enumerate() {
            (paint.colours[k + 1][colour], paint.confidence[k + 1]) = (1.0, 1.0);
        }
        paint
    }

    /// The bounds of three regions, of which the last drawing with as many says that they are its regions by `all`.
    fn found(all: [[f32; 3]; 3], source: &Paint, colours: [usize; 3]) -> Vec<f64> {
        let row = |row: [f32; 3], by: f32| [0.0].into_iter().chain(row.map(|u| u / by)).collect::<Vec<f32>>();
        let table = |sure: bool| -> Table {
            let rows = all.into_iter().map(|own| row(own, if sure { own.iter().sum() } else { 1.0 }));
            std::iter::once(vec![0.0; 4]).chain(rows).collect()
        };
        let relaxed = Relaxed { all: table(false), sure: table(true) };
        let said = Said { paint: source, relaxed, colours: Vec::new(), unpainted: vec![0.0; 4], silent: vec![0.0; 4] };
        bounds(&said, &painted(&colours))[1..].to_vec()
    }

    /// A leg, its other piece and a boot. The third region here looks more like the piece than like the boot.
    const BOOT: [[f32; 3]; 3] = [[90.0, 1.0, 0.0], [4.0, 5.0, 0.1], [1.0, 6.0, 3.0]];

    #[test]
    fn a_region_in_whose_place_another_colour_is_lost_is_in_doubt() {
        let source = painted(&[0, 0, 1]);
        assert_eq!(found(BOOT, &source, [0, 0, 0]), [1.0, 1.0, DOUBT]);
        assert_eq!(found(BOOT, &source, [0, 0, 1])[2], 1.0, "it has the boot's colour: nothing is lost");
        let mut unsure = source.clone();
        unsure.confidence[3] = 0.3;
        assert_eq!(found(BOOT, &unsure, [0, 0, 0])[2], 1.0, "that a boot was there is not known");
    }

    #[test]
    fn what_went_behind_something_puts_nothing_in_doubt() {
        let source = painted(&[0, 0, 1]);
        let hidden = [[90.0, 1.0, 1.0], [4.0, 5.0, 1.2], [1.0, 6.0, 1.1]];
        assert_eq!(found(hidden, &source, [0, 0, 0]), [1.0; 3], "it is as much in one place as in others");
        let unlike = [BOOT[0], BOOT[1], [1.0, 90.0, 3.0]];
        assert_eq!(found(unlike, &source, [0, 0, 0]), [1.0; 3], "the region is surely the piece");
    }
}
