//! The grey behind transparent pixels.
//!
//! A painted figure may have black lines and white gloves. On white or black paper one of them would vanish, so it is blended with a mid grey,
//! sRGB-encoded 0.5. Lines alone are another matter: on grey, lines of a middle grey, and of most colours, can hardly be seen. They are
//! drawn on the paper on which they stand out: white for dark lines, black for bright ones, grey where there are both.
//!
//! A picture shows lines alone if its opaque pixels lie in short runs, along rows and columns: half of the runs are at most 1/50 of
//! its height long. Lines stand out if nine tenths of their pixels differ from the paper by a quarter or more, in luma (Rec. 709, encoded).
//!
//! All frames of a footage are blended with the same grey, that of its first frame that shows anything: paper that changed would look like motion.

use super::stored::Stored;
use rototoon_image::colour::encode;

/// The grey for what is painted, sRGB-encoded.
pub const GREY: f32 = 0.5;
/// Paper for lines. White is taken where they stand out by so much: lines are drawn for white paper.
const PAPERS: [f32; 2] = [1.0, 0.0];
const ON_WHITE: f32 = 0.4;
/// Length of the middle run of lines, as a share of the height, and the least number of runs that say anything.
const THIN: f32 = 0.02;
const FEW: usize = 64;
/// Least difference from the paper, and the share of pixels that may differ less.
const CONTRAST: f32 = 0.25;
const PALER: f64 = 0.1;
/// Opaque pixels have this alpha or more.
const OPAQUE: f32 = 0.5;

/// The grey, sRGB-encoded, for a picture of this width; `None` for one that shows next to nothing, such as an empty cel.
pub(crate) fn of(picture: &Stored, width: usize) -> Option<f32> {
    if picture.has_alpha() { of_layer(&picture.layer(), width) } else { Some(GREY) }
}

/// The grey, sRGB-encoded, for pixels of linear light multiplied by alpha, in rows of this width; `None` for a picture that shows next to
/// nothing, such as an empty cel.
pub fn of_layer(pixels: &[[f32; 4]], width: usize) -> Option<f32> {
    if width == 0 {
        return Some(GREY);
    }
    let opaque: Vec<bool> = pixels.iter().map(|p| p[3] >= OPAQUE).collect();
    let height = opaque.len() / width;
    let run = middle(runs(&opaque, width))?;
    if run > (THIN * height as f32).max(2.0) {
        return Some(GREY);
    }
    let lumas: Vec<f32> = pixels.iter().zip(&opaque).filter(|(_, opaque)| **opaque).map(|(p, _)| luma(p)).collect();
    let pale = |paper: f32| {
        let mut apart: Vec<f32> = lumas.iter().map(|luma| (luma - paper).abs()).collect();
        let at = (PALER * apart.len() as f64) as usize;
        *apart.select_nth_unstable_by(at, f32::total_cmp).1
    };
    let [white, black] = PAPERS.map(pale);
    Some(match white.max(black) {
        best if best < CONTRAST => GREY,
        best if white >= ON_WHITE.min(best) => PAPERS[0],
        _ => PAPERS[1],
    })
}

/// The luma of light that is multiplied by alpha.
fn luma(&[r, g, b, alpha]: &[f32; 4]) -> f32 {
    [(r, 0.2126), (g, 0.7152), (b, 0.0722)].map(|(v, share)| share * encode((v / alpha).clamp(0.0, 1.0))).iter().sum()
}

/// The lengths of the runs of opaque pixels along rows and columns.
fn runs(opaque: &[bool], width: usize) -> Vec<usize> {
    let height = opaque.len() / width;
    let mut runs = Vec::new();
    let mut along = |line: &mut dyn Iterator<Item = bool>| {
        let mut length = 0;
        for opaque in line.chain([false]) {
            if opaque {
                length += 1;
            } else if length > 0 {
                runs.push(std::mem::take(&mut length));
            }
        }
    };
    (0..height).for_each(|y| along(&mut opaque[y * width..(y + 1) * width].iter().copied()));
    (0..width).for_each(|x| along(&mut (0..height).map(|y| opaque[y * width + x])));
    runs
}

/// The middle length; `None` where there are too few.
fn middle(mut lengths: Vec<usize>) -> Option<f32> {
    let at = lengths.len() / 2;
    (lengths.len() >= FEW).then(|| *lengths.select_nth_unstable(at).1 as f32)
}

#[cfg(test)]
mod tests {
    use super::*;
    use image::{DynamicImage, ImageBuffer, Rgba};

    const SIZE: u32 = 200;

    /// Where it is opaque, each with its own colour.
    fn picture(colour: impl Fn(u32, u32) -> Option<[u8; 3]>) -> Stored {
        let pixel = |x, y| Rgba(colour(x, y).map_or([0; 4], |[r, g, b]| [r, g, b, 255]));
        Stored::new(DynamicImage::ImageRgba8(ImageBuffer::from_fn(SIZE, SIZE, pixel)), false)
    }

    fn chosen(colour: impl Fn(u32, u32) -> Option<[u8; 3]>) -> f32 {
        of(&picture(colour), SIZE as usize).unwrap()
    }

    /// The outline of a box, three pixels wide.
    fn is_line(x: u32, y: u32) -> bool {
        let away = x.abs_diff(100).max(y.abs_diff(100));
        (60..63).contains(&away)
    }

    #[test]
    fn lines_get_the_paper_on_which_they_stand_out() {
        let lines = |colour: [u8; 3]| chosen(|x, y| is_line(x, y).then_some(colour));
        for dark in [[0, 0, 0], [128, 128, 128], [150, 90, 40], [30, 60, 220], [220, 0, 0]] {
            assert_eq!(lines(dark), 1.0, "{dark:?}");
        }
        for bright in [[255, 255, 255], [240, 220, 60]] {
            assert_eq!(lines(bright), 0.0, "{bright:?}");
        }
    }

    #[test]
    fn lines_of_black_and_white_and_what_is_painted_stay_on_grey() {
        assert_eq!(chosen(|x, y| is_line(x, y).then_some(if x < 100 { [0; 3] } else { [255; 3] })), GREY);
        assert_eq!(chosen(|x, y| (x.abs_diff(100) < 40 && y.abs_diff(100) < 40).then_some([40; 3])), GREY);
        assert_eq!(of(&picture(|_, _| None), SIZE as usize), None);
        let opaque = DynamicImage::ImageRgb8(ImageBuffer::from_pixel(SIZE, SIZE, image::Rgb([0; 3])));
        assert_eq!(of(&Stored::new(opaque, false), SIZE as usize), Some(GREY));
    }
}
