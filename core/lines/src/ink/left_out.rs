//! Pencils that are left out, such as the non-photo blue of a construction.
//!
//! What a pencil takes from the light is told by its *density*, the logarithm of paper to pixel, in each channel. Densities of pencils that lie on each
//! other add up. A density has a grey part, that of its least channel, and a *hue*, what the other channels have more. Graphite has a grey part only, so
//! where it crosses light blue, the sum's hue is that of the blue, and its strength tells how much blue there is. That much of the blue is
//! taken away, in all channels, and graphite is left.
//!
//! A pencil is not one colour: a heavy hand makes it darker and shifts the hue. So somewhat more is taken away than the given colour has, for the same
//! strength. Hues up to about 20 degrees beside the given one are left out completely, and those beyond 35 degrees are kept as they are.
//!
//! **Limits.** A wanted line of the same hue goes too. What is very dark and has a little of the hue, such as navy ink, keeps its grey part and stays. Lines lighter than their paper
//! are treated as their negative.

use rototoon_base::scene::Colour;

/// Least value of a channel, so that densities stay finite.
const FLOOR: f32 = 1.0 / 255.0;
/// Cosines of the differences of hue up to which a pencil is left out, and from which it stays.
const SAME: f32 = 0.94;
const OTHER: f32 = 0.82;
/// What is taken away beside the given colour for a unit of hue: in the channels of the hue, and in the others.
const SLACK: f32 = 0.25;
const SLACK_GREY: f32 = 0.12;
/// Least hue of a pencil: below it the colour is a grey, which cannot be told from the lines.
const LEAST: f32 = 0.06;

/// A pencil that is left out.
#[derive(Clone, Copy, Debug)]
pub(super) struct Pencil {
    /// Direction of its hue.
    hue: [f32; 3],
    /// What is taken away for a unit of hue.
    taken: [f32; 3],
}

impl Pencil {
    /// A pencil that looks like `colour` on white paper, or on black paper if lines are light. A grey has no hue to be told by.
    pub fn new(colour: Colour, dark: bool) -> Option<Self> {
        let density = colour.map(|value| if dark { 1.0 - value } else { value }).map(|value| density(1.0, value));
        let (chroma, size) = hue(density);
        if size < LEAST {
            return None;
        }
        let hue = chroma.map(|value| value / size);
        let taken = [0, 1, 2].map(|c| density[c] / size + if hue[c] > 0.05 { SLACK } else { SLACK_GREY });
        Some(Self { hue, taken })
    }

    /// A density without the pencil.
    pub fn without(&self, density: [f32; 3]) -> [f32; 3] {
        let (chroma, size) = hue(density);
        if size < 1e-4 {
            return density;
        }
        let along: f32 = chroma.iter().zip(self.hue).map(|(a, b)| a * b).sum();
        let share = ((along / size - OTHER) / (SAME - OTHER)).clamp(0.0, 1.0);
        [0, 1, 2].map(|c| (density[c] - share * along * self.taken[c]).max(0.0))
    }
}

/// A pixel's colour without some pencils. `paper` is the colour behind it.
pub(super) fn without(pencils: &[Pencil], paper: Colour, pixel: Colour) -> Colour {
    let found =
        pencils.iter().fold([0, 1, 2].map(|c| density(paper[c], pixel[c])), |found, pencil| pencil.without(found));
    [0, 1, 2].map(|c| paper[c] * (-found[c]).exp())
}

fn density(paper: f32, pixel: f32) -> f32 {
    let found = (paper.max(FLOOR) / pixel.max(FLOOR)).ln().max(0.0);
    if found.is_finite() { found } else { 0.0 }
}

/// What each channel has more than the least one, and the length of that.
fn hue(density: [f32; 3]) -> ([f32; 3], f32) {
    let least = density[0].min(density[1]).min(density[2]);
    let chroma = density.map(|value| value - least);
    (chroma, chroma.iter().map(|value| value * value).sum::<f32>().sqrt())
}

#[cfg(test)]
mod tests {
    use super::*;

    const PAPER: Colour = [0.96, 0.95, 0.92];
    const BLUE: Colour = [0.64, 0.87, 0.93];

    /// How dark a pencil on the paper is without blue or red pencils.
    fn left(drop: Colour, pixel: Colour) -> f32 {
        let pencil = Pencil::new(drop, false).unwrap();
        let found = without(&[pencil], PAPER, pixel);
        (0..3).map(|c| PAPER[c] - found[c]).fold(0.0, f32::max)
    }

    fn on_paper(pencil: Colour) -> Colour {
        [0, 1, 2].map(|c| PAPER[c] * pencil[c])
    }

    fn over(above: Colour, below: Colour) -> Colour {
        [0, 1, 2].map(|c| above[c] * below[c])
    }

    #[test]
    fn light_and_dark_blue_go_and_other_pencils_stay() {
        for blue in [BLUE, [0.55, 0.75, 1.0], [0.8, 0.92, 1.0], [0.3, 0.55, 0.9], [0.25, 0.45, 0.85]] {
            assert!(left(BLUE, on_paper(blue)) < 0.07, "{blue:?}: {}", left(BLUE, on_paper(blue)));
        }
        let kept =
            [[0.05; 3], [0.5; 3], [0.75; 3], [0.45, 0.3, 0.15], [0.8, 0.1, 0.1], [0.1, 0.5, 0.2], [1.0, 0.6, 0.2]];
        for other in kept {
            let before = (0..3).map(|c| PAPER[c] * (1.0 - other[c])).fold(0.0, f32::max);
            assert!(
                left(BLUE, on_paper(other)) > 0.75 * before,
                "{other:?}: {} of {before}",
                left(BLUE, on_paper(other))
            );
        }
    }

    #[test]
    fn red_goes_and_other_pencils_stay() {
        let red = [0.9, 0.35, 0.3];
        for other in [red, [0.95, 0.6, 0.55], [0.8, 0.2, 0.2]] {
            assert!(left(red, on_paper(other)) < 0.06, "{other:?}: {}", left(red, on_paper(other)));
        }
        for other in [[0.05; 3], [0.5; 3], [0.2, 0.35, 0.8], BLUE, [0.1, 0.5, 0.2], [0.45, 0.3, 0.15]] {
            assert!(left(red, on_paper(other)) > 0.2, "{other:?}: {}", left(red, on_paper(other)));
        }
    }

    #[test]
    fn what_crosses_the_pencil_stays_as_dark_as_beside_it() {
        for blue in [BLUE, [0.4, 0.65, 0.95]] {
            for line in [[0.1; 3], [0.5; 3], [0.7; 3], [0.85, 0.2, 0.15]] {
                let [beside, across] = [on_paper(line), on_paper(over(line, blue))].map(|pixel| left(BLUE, pixel));
                assert!(across > 0.65 * beside, "{line:?} over {blue:?}: {across} and {beside}");
            }
        }
    }

    #[test]
    fn a_grey_cannot_be_left_out() {
        assert!(Pencil::new([0.5; 3], false).is_none() && Pencil::new([0.9, 0.92, 0.9], false).is_none());
        assert!(Pencil::new([1.0, 1.0, 0.4], true).is_some());
    }
}
