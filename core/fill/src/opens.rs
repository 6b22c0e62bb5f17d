//! Paper that opens: a space between limbs that no painted drawing shows.
//!
//! A hand goes to the hip, or the boots of a walk meet, and paper shows between them. It was paper before, but in one piece with all around the figure. By
//! [meeting](crate::meet) alone it can hardly be that: it is a tiny part of the paper, and keeps none of its shape. So it would take a limb for itself, and push what
//! is beside it to wrong partners too.
//!
//! So a region may be a *piece of the paper*, beside the partners that it has. With a the share of region j that came from the paper, this pair has in
//! [relaxation](crate::relax)
//!
//! u = a + 0.1,   agreement = 2 Σ_k h_j(k) b(k)
//!
//! - 0.1 is for paper that opens where limbs lay on each other: no place of it was paper before.
//! - h_j(k) is the share of j's border with what is k by M, and b(k) the share of k's border that is paper on the painted drawing, or of the picture's edge. So
//!   it is how probable it is that a place of j's border has paper beyond it. The borders of the paper itself do not count: a piece of it may lie anywhere along them. It counts for
//!   regions and for colours, as other agreements do.
//!
//! What one region alone encloses, such as a pocket or a button, lies within a thing, and is no piece.
//!
//! The pair has the larger one of this and what it has otherwise. What may be a piece of the paper does not compete for it: it shows in many places at once.
//!
//! # What paper is
//!
//! The region that has most of the picture's edge, if the artist left it without paint, or if it has [`AROUND`] of the edge or more. A sky that is painted and ends at
//! hills is a thing as others are, and has other things in front of it everywhere.
//!
//! # Why so
//!
//! The share of the place alone does not find paper between limbs that lay on each other. The 0.1 alone calls things paper that are new. b as a share of the longest border of k in place of
//! all of it calls a boot paper.
//!
//! # Limits
//!
//! A thing at the outline of a figure that no painted drawing shows, such as a hand that comes out of a sleeve, may be taken for paper.

use crate::layout::Layout;
use crate::meet::came;
use crate::page::Paint;
use crate::shifts::Shifts;

/// Least share of the picture's edge from which a region with paint is the paper.
const AROUND: f32 = 0.75;
/// u of paper where none was.
const NEW: f32 = 0.1;

/// What regions are as pieces of the paper.
pub struct Opens {
    /// The region that is the paper on the painted drawing.
    pub paper: usize,
    /// For each region of the drawing u of being a piece of it.
    pub met: Vec<f32>,
    /// For each region of the painted drawing the share of its border that is paper. Index 0 is the edge of the picture.
    pub beside: Vec<f32>,
}

impl Opens {
    /// Pieces of the paper of `from`, which is painted by `paint`, on the drawing `to`. `back` are the shifts from `to` to `from`. `None` where no
    /// region is the paper.
    pub fn new(from: &Layout, paint: &Paint, to: &Layout, back: &Shifts) -> Option<Self> {
        let edge = edge(from);
        // Of equal ones the first is taken.
        let paper = (1..edge.len()).rev().max_by(|&a, &b| edge[a].total_cmp(&edge[b]))?;
        if paint.colour(paper) != Some(paint.blank) && edge[paper] < AROUND {
            return None;
        }
        let share = |own: &Vec<(usize, f32)>| own.iter().find(|other| other.0 == paper).map_or(0.0, |other| other.1);
        let mut beside: Vec<f32> = from.borders.iter().map(share).collect();
        beside[0] = edge[paper];
        // What one thing encloses lies within it: nothing opens there.
        let between = |around: &Vec<(usize, f32)>| around.len() > 1;
        let piece = |(row, around): (&Vec<f32>, _)| if between(around) { row[paper] + NEW } else { 0.0 };
        let met = came(from, to, back).iter().zip(&to.borders).map(piece).collect();
        Some(Self { paper, met, beside })
    }

    /// How well a region agrees with being paper, by the regions of the painted drawing that are around it: 0 to 1.
    pub fn agreement(&self, around: &[f32]) -> f32 {
        around.iter().zip(&self.beside).map(|(share, beside)| share * beside).sum()
    }
}

/// The share of the picture's edge that each region has.
fn edge(layout: &Layout) -> Vec<f32> {
    let cells = &layout.nearest;
    let (width, height) = (cells.width(), cells.height());
    let mut shares = vec![0.0f32; layout.figures.len()];
    for x in 0..width {
        shares[cells.get(x, 0) as usize] += 1.0;
        shares[cells.get(x, height - 1) as usize] += 1.0;
    }
    for y in 0..height {
        shares[cells.get(0, y) as usize] += 1.0;
        shares[cells.get(width - 1, y) as usize] += 1.0;
    }
    shares.iter().map(|share| share / (2 * (width + height)) as f32).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::regions::Regions;
    use rototoon_base::scene::Raster;

    /// A box on paper, with a wall across the picture at its side if it is cut.
    fn layout(cut: bool) -> Layout {
        let boxed = |x: usize, y: usize| x.abs_diff(30).max(y.abs_diff(30)) == 12;
        Layout::new(&Regions::new(&Raster::from_fn(120, 60, |x, y| boxed(x, y) || (cut && x == 66))))
    }

    fn found(layout: &Layout, colours: &[usize], blank: usize) -> Option<Opens> {
        let mut paint = Paint::nothing(colours.len(), blank);
        colours.iter().enumerate().for_each(|(k, &colour)| paint.colours[k + 1][colour] = 1.0);
        Opens::new(layout, &paint, layout, &Shifts::new(&[], 120, 60, 60.0 / 540.0))
    }

    #[test]
    fn paper_is_what_is_around_all_or_has_no_paint() {
        let whole = layout(false);
        let opens = found(&whole, &[0, 1], 2).unwrap();
        assert_eq!((opens.paper, opens.beside[0], opens.beside[2]), (1, 1.0, 1.0), "all that is around is paper");
        assert_eq!((opens.met[1], opens.met[2]), (1.0 + NEW, 0.0), "the box lies within one region");
        // A wall halves it.
        let cut = layout(true);
        let largest = found(&cut, &[2, 2, 2], 2).unwrap();
        assert!(largest.beside[0] < AROUND, "{}", largest.beside[0]);
        assert!(found(&cut, &[0, 0, 1], 2).is_none(), "a painted half is no paper");
    }

    #[test]
    fn what_borders_on_paper_agrees_with_it() {
        let opens = Opens { paper: 1, met: vec![NEW; 4], beside: vec![1.0, 0.0, 0.8, 0.1] };
        assert!((opens.agreement(&[0.2, 0.0, 0.8, 0.0]) - 0.84).abs() < 1e-6);
        assert!((opens.agreement(&[0.0, 0.0, 0.0, 1.0]) - 0.1).abs() < 1e-6, "what lies within a figure does not");
    }
}
