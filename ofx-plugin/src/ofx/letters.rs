//! Text as rows of pixels, for hosts whose overlay is OpenGL, which has no text.
//!
//! The letters are those of the fixed-width fonts of `embedded-graphics`, 9 × 15 pixels. There is one font for each
//! standard set of characters. A text is written in the first of them that has all of its letters; a letter that it lacks is
//! a question mark.

use embedded_graphics::Drawable;
use embedded_graphics::Pixel;
use embedded_graphics::draw_target::DrawTarget;
use embedded_graphics::geometry::{OriginDimensions, Point, Size};
use embedded_graphics::mono_font::{MonoFont, MonoTextStyle};
use embedded_graphics::mono_font::{iso_8859_1, iso_8859_2, iso_8859_5, iso_8859_7, jis_x0201};
use embedded_graphics::pixelcolor::BinaryColor;
use embedded_graphics::text::{Baseline, Text};
use std::convert::Infallible;

/// West European, East European, Cyrillic, Greek, and Japanese half-width letters.
const FONTS: [&MonoFont; 5] = [
    &iso_8859_1::FONT_9X15,
    &iso_8859_2::FONT_9X15,
    &iso_8859_5::FONT_9X15,
    &iso_8859_7::FONT_9X15,
    &jis_x0201::FONT_9X15,
];
/// Most letters of a text that are written.
const MOST_LETTERS: usize = 200;

/// Neighbouring pixels of a row, from the left border of the first to the right border of the last one. Counted right and up
/// from the lower left corner of the text.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Row {
    /// Left border.
    pub from: i32,
    /// Right border.
    pub to: i32,
    /// Lower border.
    pub y: i32,
}

/// The pixels of a text.
pub fn rows(text: &str) -> Vec<Row> {
    let text: String = text.chars().take(MOST_LETTERS).collect();
    let style = MonoTextStyle::new(font(&text), BinaryColor::On);
    let mut dots = Dots(Vec::new());
    let Ok(_) = Text::with_baseline(&text, Point::zero(), style, Baseline::Bottom).draw(&mut dots);
    dots.0.sort_unstable();
    let joined = dots.0.chunk_by(|a, b| a.0 == b.0 && a.1 + 1 == b.1);
    joined.filter_map(|run| Some(Row { from: run.first()?.1, to: run.last()?.1 + 1, y: -run.first()?.0 })).collect()
}

fn font(text: &str) -> &'static MonoFont<'static> {
    let has = |font: &&&MonoFont| {
        let unknown = font.glyph_mapping.index('\u{10ffff}');
        text.chars().all(|letter| letter == '?' || font.glyph_mapping.index(letter) != unknown)
    };
    FONTS.iter().find(has).unwrap_or(&FONTS[0])
}

/// Row and column of each pixel that is drawn.
struct Dots(Vec<(i32, i32)>);

impl OriginDimensions for Dots {
    fn size(&self) -> Size {
        Size::new(u32::MAX, u32::MAX)
    }
}

impl DrawTarget for Dots {
    type Color = BinaryColor;
    type Error = Infallible;

    fn draw_iter<I: IntoIterator<Item = Pixel<BinaryColor>>>(&mut self, pixels: I) -> Result<(), Infallible> {
        self.0.extend(pixels.into_iter().filter(|pixel| pixel.1.is_on()).map(|pixel| (pixel.0.y, pixel.0.x)));
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The text as rows of characters, from the top.
    fn shown(text: &str) -> Vec<String> {
        let rows = rows(text);
        let width = rows.iter().map(|row| row.to).max().unwrap_or(0);
        let is = |x: i32, y: i32| rows.iter().any(|row| row.y == y && (row.from..row.to).contains(&x));
        (0..15).rev().map(|y| (0..width).map(|x| if is(x, y) { '#' } else { '.' }).collect()).collect()
    }

    #[test]
    fn letters_stand_upright_from_the_lower_left() {
        let lines = shown("L");
        let filled: Vec<&String> = lines.iter().filter(|line| line.contains('#')).collect();
        let last = filled.last().unwrap().matches('#').count();
        assert!(filled.len() >= 9, "{lines:#?}");
        assert!(filled[..filled.len() - 1].iter().all(|line| line.matches('#').count() < last), "{lines:#?}");
        let left = filled[0].find('#').unwrap();
        assert!(filled.iter().all(|line| line.find('#') == Some(left)), "{lines:#?}");
        assert!(rows("LLL").iter().map(|row| row.to).max() > rows("L").iter().map(|row| row.to + 17).max());
    }

    #[test]
    fn letters_of_other_alphabets_are_written_and_unknown_ones_are_question_marks() {
        for text in ["größe", "łapa", "рука", "χέρι", "ｱｼ"] {
            assert_ne!(shown(text), shown(&"?".repeat(text.chars().count())), "{text}");
        }
        assert_eq!(shown("头"), shown("?"));
        assert!(rows("").is_empty());
    }
}
