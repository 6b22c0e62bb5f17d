//! Marks on a contact sheet: colours, the number of a frame, those of the strokes to look at, and what stands for a picture that cannot be read.
//!
//! `trace` names doubtful and lost strokes by their numbers, which no picture shows otherwise. So each of them has its number beside the middle of its line,
//! in the colour of the verdict. Where numbers would cover each other, lost strokes come first, and what finds no place is left out.

use crate::scene::{Colour, FrameNumber, Raster, Scene, Verdict};
use std::cmp::Reverse;

/// Colour behind the pictures, and of the border of a frame that needs no look.
pub(super) const PLAIN: Colour = [0.16, 0.16, 0.17];
/// Colours of what is lost and of what is doubtful.
pub(super) const LOST: Colour = [0.9, 0.1, 0.1];
pub(super) const DOUBTFUL: Colour = [0.95, 0.65, 0.1];
/// Colours of the stripes of a picture that cannot be read, their width in pixels of the small picture, and the colour of the words in it.
const STRIPES: [Colour; 2] = [[0.3; 3], [0.42; 3]];
const STRIPE: f64 = 10.0;
const WORDS: Colour = [0.95; 3];
/// Greatest side of a dot of these words in pixels.
const LARGE: usize = 3;
/// Side of a dot of a stroke's number in pixels.
const SMALL: usize = 2;
/// Dots around a stroke's number, and rows and columns of a digit.
const AROUND: usize = 1;
const ROWS: usize = 5;
const COLUMNS: usize = 3;

/// Copies a picture into a larger one, as far as it fits.
pub(super) fn put(whole: &mut Raster<Colour>, picture: &Raster<Colour>, (left, top): (usize, usize)) {
    let width = picture.width().min(whole.width().saturating_sub(left));
    let left = left.min(whole.width());
    for y in 0..picture.height().min(whole.height().saturating_sub(top)) {
        whole.row_mut(top + y)[left..left + width].copy_from_slice(&picture.row(y)[..width]);
    }
}

/// A picture of this size with slanted stripes, in place of one that cannot be read. `zoom` is how many times smaller it will be shown.
pub(super) fn hatched(width: usize, height: usize, zoom: f64) -> Raster<Colour> {
    let mut picture = Raster::new(width, height, STRIPES[0]);
    for y in 0..height {
        for (x, colour) in picture.row_mut(y).iter_mut().enumerate() {
            *colour = STRIPES[((x + y) as f64 / (STRIPE * zoom)) as usize % 2];
        }
    }
    picture
}

/// What stands for a small picture of this size that cannot be read.
pub fn no_picture(width: usize, height: usize) -> Raster<Colour> {
    let mut small = hatched(width, height, 1.0);
    say_no_picture(&mut small);
    small
}

/// Writes onto a small picture that there is none.
pub(super) fn say_no_picture(small: &mut Raster<Colour>) {
    say(small, "NO PICTURE", LARGE);
}

/// Writes words into the middle of a small picture, in the largest dots up to a size for which there is room.
fn say(small: &mut Raster<Colour>, words: &str, size: usize) {
    let (width, height) = (small.width(), small.height());
    let box_of = |size: usize| [length(words, size) + 2 * AROUND * size, (ROWS + 2 * AROUND) * size];
    let fits = |size: &usize| box_of(*size)[0] <= width && box_of(*size)[1] <= height;
    let Some(size) = (1..=size).rev().find(fits) else { return };
    let [wide, high] = box_of(size);
    let (left, top) = ((width - wide) / 2, (height - high) / 2);
    put(small, &Raster::new(wide, high, PLAIN), (left, top));
    write(small, words, (left + AROUND * size, top + AROUND * size), size, WORDS);
}

/// The digits, the letters that the sheet needs, and the minus sign in dots, five rows of three.
fn dots(sign: char) -> [u8; ROWS] {
    match sign {
        '0' => [0b111, 0b101, 0b101, 0b101, 0b111],
        '1' => [0b010, 0b110, 0b010, 0b010, 0b111],
        '2' => [0b111, 0b001, 0b111, 0b100, 0b111],
        '3' => [0b111, 0b001, 0b111, 0b001, 0b111],
        '4' => [0b101, 0b101, 0b111, 0b001, 0b001],
        '5' => [0b111, 0b100, 0b111, 0b001, 0b111],
        '6' => [0b111, 0b100, 0b111, 0b101, 0b111],
        '7' => [0b111, 0b001, 0b010, 0b010, 0b010],
        '8' => [0b111, 0b101, 0b111, 0b101, 0b111],
        '9' => [0b111, 0b101, 0b111, 0b001, 0b111],
        'C' => [0b011, 0b100, 0b100, 0b100, 0b011],
        'D' => [0b110, 0b101, 0b101, 0b101, 0b110],
        'E' => [0b111, 0b100, 0b110, 0b100, 0b111],
        'H' => [0b101, 0b101, 0b111, 0b101, 0b101],
        'I' => [0b111, 0b010, 0b010, 0b010, 0b111],
        'L' => [0b100, 0b100, 0b100, 0b100, 0b111],
        'N' => [0b110, 0b101, 0b101, 0b101, 0b101],
        'O' => [0b010, 0b101, 0b101, 0b101, 0b010],
        'P' => [0b110, 0b101, 0b110, 0b100, 0b100],
        'R' => [0b110, 0b101, 0b110, 0b101, 0b101],
        'S' => [0b011, 0b100, 0b010, 0b001, 0b110],
        'T' => [0b111, 0b010, 0b010, 0b010, 0b010],
        'U' => [0b101, 0b101, 0b101, 0b101, 0b111],
        ' ' => [0; ROWS],
        _ => [0, 0, 0b111, 0, 0],
    }
}

/// The width of a text in dots of a size.
pub(super) fn length(text: &str, size: usize) -> usize {
    ((COLUMNS + 1) * text.chars().count()).saturating_sub(1) * size
}

/// Writes a number or words of [`dots`] in dots of a size, from the top left corner.
pub(super) fn write(
    picture: &mut Raster<Colour>,
    text: &str,
    (left, top): (usize, usize),
    size: usize,
    colour: Colour,
) {
    let dot = Raster::new(size, size, colour);
    for (i, sign) in text.chars().enumerate() {
        for (row, bits) in dots(sign).into_iter().enumerate() {
            for column in (0..COLUMNS).filter(|column| bits & (0b100 >> column) != 0) {
                put(picture, &dot, (left + ((COLUMNS + 1) * i + column) * size, top + row * size));
            }
        }
    }
}

/// Writes the numbers of lost and doubtful strokes onto the small picture of a frame, whose size is `scale` times that of the frame.
pub(super) fn write_strokes(small: &mut Raster<Colour>, scene: &Scene, frame: FrameNumber, scale: f64) {
    let mut named: Vec<(Reverse<Verdict>, &str, [f64; 2])> = Vec::new();
    for part in &scene.parts {
        let Some(number) = part.name.strip_prefix("stroke ") else { continue };
        let verdict = Verdict::on(part, frame).filter(|verdict| *verdict != Verdict::Sure);
        let middle = part.points_at(frame).and_then(|points| points.get(points.len() / 2));
        if let (Some(verdict), Some(middle)) = (verdict, middle) {
            named.push((Reverse(verdict), number, [middle.x * scale, middle.y * scale]));
        }
    }
    // Among equals the order of the strokes stays.
    named.sort_by_key(|own| own.0);
    let mut taken: Vec<[usize; 4]> = Vec::new();
    for (Reverse(verdict), number, at) in named {
        let size = [length(number, SMALL) + 2 * AROUND * SMALL, (ROWS + 2 * AROUND) * SMALL];
        if size[0] > small.width() || size[1] > small.height() {
            continue;
        }
        let [left, top] = [0, 1].map(|k| {
            let most = [small.width(), small.height()][k] - size[k];
            (at[k] - size[k] as f64 / 2.0).clamp(0.0, most as f64) as usize
        });
        let own = [left, top, left + size[0], top + size[1]];
        if taken.iter().any(|other| own[0] < other[2] && other[0] < own[2] && own[1] < other[3] && other[1] < own[3]) {
            continue;
        }
        taken.push(own);
        put(small, &Raster::new(size[0], size[1], PLAIN), (left, top));
        let colour = if verdict == Verdict::Lost { LOST } else { DOUBTFUL };
        write(small, number, (left + AROUND * SMALL, top + AROUND * SMALL), SMALL, colour);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Point;
    use crate::scene::{Footage, Part};

    /// Lines by name, place of the middle and confidence.
    fn scene(lines: &[(&str, [f64; 2], f64)]) -> Scene {
        let footage =
            Footage { pattern: "%d.png".into(), first: 0, last: 9, fps: 24.0, width: 400, height: 300, held: false };
        let part = |&(name, [x, y], confidence): &(&str, [f64; 2], f64)| Part {
            name: name.into(),
            tracks: [(1, [-9.0, 0.0, 9.0].map(|by| Point::new(x + by, y)).to_vec())].into(),
            confidence: [(1, vec![confidence; 3])].into(),
            ..Part::default()
        };
        Scene { footage, parts: lines.iter().map(part).collect() }
    }

    /// How many pixels have the colours of lost and doubtful strokes.
    fn inked(lines: &[(&str, [f64; 2], f64)], width: usize) -> [usize; 2] {
        let mut small = Raster::new(width, width * 3 / 4, [1.0; 3]);
        write_strokes(&mut small, &scene(lines), 1, width as f64 / 400.0);
        [LOST, DOUBTFUL].map(|colour| small.data().iter().filter(|own| **own == colour).count())
    }

    const DOT: usize = SMALL * SMALL;

    #[test]
    fn lost_and_doubtful_strokes_have_their_numbers() {
        let at = [200.0, 150.0];
        assert_eq!(inked(&[("stroke 1", at, 0.2)], 200), [8 * DOT, 0]);
        assert_eq!(inked(&[("stroke 17", at, 0.6)], 200), [0, (8 + 7) * DOT], "8 and 7 dots");
        assert_eq!(inked(&[("stroke 1", at, 0.9), ("arm", at, 0.1)], 200), [0, 0]);
        assert_eq!(inked(&[("stroke 1", [-50.0, 900.0], 0.2)], 200), [8 * DOT, 0], "within the picture");
        assert_eq!(inked(&[("stroke 1000", at, 0.2)], 20), [0, 0], "no room");
    }

    #[test]
    fn of_numbers_in_one_place_the_lost_stroke_has_its_own() {
        let near = [204.0, 152.0];
        assert_eq!(inked(&[("stroke 7", [200.0, 150.0], 0.6), ("stroke 1", near, 0.2)], 200), [8 * DOT, 0]);
        assert_eq!(inked(&[("stroke 7", [50.0, 50.0], 0.6), ("stroke 1", near, 0.2)], 200), [8 * DOT, 7 * DOT]);
    }
}
