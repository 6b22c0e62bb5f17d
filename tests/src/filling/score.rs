//! Which regions have the right colour.
//!
//! A region is right if most of its pixels have its true colour, within 6 of 255 in each channel. Its confidence is the median of
//! its pixels; where nothing is painted, it is 0.

use super::paint::Pixel;
use super::set::Tone;
use super::truth::{Region, Truth};
use rototoon::pipeline::DOUBT;
use rototoon::scene::Raster;
use serde::{Deserialize, Serialize};

/// Largest difference of a channel at which two colours are the same, of 255.
const SAME: f32 = 6.0;
/// The lower ends of the bands of confidence, from the highest band on.
pub const BANDS: [f64; 4] = [0.9, 0.7, DOUBT, 0.0];

/// Counts of true regions and of their pixels.
#[derive(Clone, Copy, Debug, Default, Deserialize, PartialEq, Serialize)]
pub struct Score {
    /// The true regions.
    pub regions: usize,
    /// The regions with the right colour.
    pub right: usize,
    /// The regions whose colour occurs on the first drawing.
    pub known: usize,
    /// The regions that the colours of the first drawing, left where they are, paint right.
    pub held: usize,
    /// The pixels of all regions but the largest one of each drawing, the paper.
    pub area: usize,
    /// Those of right regions.
    pub right_area: usize,
    /// Those of regions that the colours of the first drawing, left where they are, paint right.
    pub held_area: usize,
    /// The wrong regions with a confidence below 0.5.
    pub doubted: usize,
    /// The regions of each band of confidence: all of them, and the right ones.
    pub bands: [(usize, usize); 4],
}

impl Score {
    /// Adds other counts.
    pub fn add(&mut self, other: &Self) {
        self.regions += other.regions;
        self.right += other.right;
        self.known += other.known;
        self.held += other.held;
        self.area += other.area;
        self.right_area += other.right_area;
        self.held_area += other.held_area;
        self.doubted += other.doubted;
        for (own, band) in self.bands.iter_mut().zip(other.bands) {
            *own = (own.0 + band.0, own.1 + band.1);
        }
    }

    /// The number of wrong regions.
    pub fn wrong(&self) -> usize {
        self.regions - self.right
    }
}

/// What is known of the first drawing.
#[derive(Clone, Debug)]
pub struct First {
    /// The colours of its regions.
    pub colours: Vec<Tone>,
    /// The drawing in colour.
    pub picture: Raster<Tone>,
}

/// Scores the paint of a drawing. Returns also for each region, in the order of the truth, whether it is right.
pub fn score(truth: &Truth, paint: &Raster<Option<Pixel>>, first: &First) -> (Score, Vec<bool>) {
    let mut all = Score::default();
    let mut marks = Vec::new();
    for (k, region) in truth.regions.iter().enumerate() {
        let own = |at: usize| paint.data()[at].is_some_and(|pixel| same(pixel.colour, region.colour));
        let held = |at: usize| same(first.picture.data()[at].map(f32::from), region.colour);
        let (right, held) = (most(region, own), most(region, held));
        let known = first.colours.iter().any(|colour| same(colour.map(f32::from), region.colour));
        let sure = confidence(region, paint);
        let count = usize::from;
        let area = if k == 0 { 0 } else { region.pixels.len() };
        let mut bands = [(0, 0); 4];
        let band = BANDS.iter().position(|&low| sure >= low).unwrap_or(BANDS.len() - 1);
        bands[band] = (1, count(right));
        all.add(&Score {
            regions: 1,
            right: count(right),
            known: count(known),
            held: count(held),
            area,
            right_area: area * count(right),
            held_area: area * count(held),
            doubted: count(!right && sure < DOUBT),
            bands,
        });
        marks.push(right);
    }
    (all, marks)
}

fn same(found: [f32; 3], colour: Tone) -> bool {
    // Half a step for colours that were rounded on their way.
    (0..3).all(|c| (found[c] - f32::from(colour[c])).abs() <= SAME + 0.5)
}

/// Whether most pixels of a region hold.
fn most(region: &Region, holds: impl Fn(usize) -> bool) -> bool {
    2 * region.pixels.iter().filter(|&&at| holds(at)).count() > region.pixels.len()
}

fn confidence(region: &Region, paint: &Raster<Option<Pixel>>) -> f64 {
    let own = |&at: &usize| paint.data()[at].map_or(0.0, |pixel| pixel.confidence);
    let mut values: Vec<f64> = region.pixels.iter().map(own).collect();
    let middle = values.len() / 2;
    if values.is_empty() { 0.0 } else { *values.select_nth_unstable_by(middle, f64::total_cmp).1 }
}

#[cfg(test)]
mod tests {
    use super::super::truth::tests::drawing;
    use super::*;

    const PAPER: Tone = [250, 250, 240];
    const RED: Tone = [200, 30, 20];
    const BLUE: Tone = [20, 60, 200];
    const GREEN: Tone = [10, 160, 60];

    /// The boxes of the second drawing: 1596, 896 and 396 pixels, since the corners of a box are ink.
    const BOXES: [([usize; 4], Tone); 3] =
        [([20, 20, 60, 60], RED), ([100, 20, 130, 50], BLUE), ([200, 20, 220, 40], GREEN)];

    /// The first drawing has red and blue, red in its place.
    fn first() -> First {
        let first = drawing(&[BOXES[0], ([100, 200, 130, 230], BLUE)]);
        let colours = Truth::of(&first).regions.iter().map(|region| region.colour).collect();
        First { colours, picture: first.colour }
    }

    /// Paint that has `tones` in the boxes, with a confidence, and paper around.
    fn painted(tones: [Option<(Tone, f64)>; 3]) -> Raster<Option<Pixel>> {
        let pixel = |(tone, confidence): (Tone, f64)| Pixel { colour: tone.map(f32::from), confidence };
        let mut canvas = Raster::new(300, 540, Some(pixel((PAPER, 0.97))));
        for (([left, top, right, bottom], _), tone) in BOXES.into_iter().zip(tones) {
            (top..bottom).for_each(|y| (left..right).for_each(|x| canvas.set(x, y, tone.map(pixel))));
        }
        canvas
    }

    #[test]
    fn right_wrong_and_unknown_colours_are_counted() {
        let truth = Truth::of(&drawing(&BOXES));
        let paint = painted([Some((RED, 0.8)), Some((RED, 0.6)), Some((BLUE, 0.3))]);
        let (found, marks) = score(&truth, &paint, &first());
        assert_eq!(marks, [true, true, false, false]);
        let expected = Score {
            regions: 4,
            right: 2,
            known: 3,
            held: 2,
            area: 896 + 396 + 1596,
            right_area: 1596,
            held_area: 1596,
            doubted: 1,
            bands: [(1, 1), (1, 1), (1, 0), (1, 0)],
        };
        assert_eq!(found, expected);
        assert_eq!(found.wrong(), 2);
    }

    #[test]
    fn a_region_without_paint_is_wrong_and_in_doubt() {
        let truth = Truth::of(&drawing(&BOXES));
        let (found, _) = score(&truth, &painted([None, Some((BLUE, 0.9)), Some((GREEN, 0.2))]), &first());
        assert_eq!((found.right, found.doubted, found.bands), (3, 1, [(2, 2), (0, 0), (0, 0), (2, 1)]));
    }

    #[test]
    fn most_pixels_and_near_colours_decide() {
        let truth = Truth::of(&drawing(&BOXES));
        let near = RED.map(|value| value + 6);
        let mut paint = painted([Some((near, 0.9)), Some((BLUE, 0.9)), Some((GREEN, 0.9))]);
        let right = |paint: &Raster<Option<Pixel>>| score(&truth, paint, &first()).0.right;
        assert_eq!(right(&paint), 4);
        (20..60).for_each(|y| (20..39).for_each(|x| paint.set(x, y, None)));
        assert_eq!(right(&paint), 4, "21 of 40 columns are right");
        (20..60).for_each(|y| paint.set(39, y, None));
        assert_eq!(right(&paint), 3, "half of it is not most of it");
        assert_eq!(right(&painted([Some((RED.map(|v| v + 7), 0.9)), None, None])), 1, "another red");
    }

    #[test]
    fn counts_add_up() {
        let truth = Truth::of(&drawing(&BOXES));
        let (one, _) = score(&truth, &painted([Some((RED, 0.8)), None, Some((GREEN, 0.1))]), &first());
        let mut two = one;
        two.add(&one);
        assert_eq!((two.regions, two.right, two.doubted), (8, 6, 2));
        assert_eq!((two.area, two.right_area, two.bands[3]), (2 * 2888, 2 * (1596 + 396), (4, 2)));
    }
}
