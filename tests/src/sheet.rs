//! Contact sheets: pictures side by side, such as rendered strokes over their frames.

use crate::lettering;
use anyhow::{Context, Result, ensure};
use image::imageops::{FilterType, overlay, resize};
use image::{Rgba, RgbaImage};
use std::path::{Path, PathBuf};
use tiny_skia::{Color, Pixmap};

/// Width of one picture on the sheet in pixels.
const CELL: u32 = 480;
/// Number of pictures in a row.
const COLUMNS: u32 = 4;
/// Space between pictures in pixels.
const GAP: u32 = 4;
/// Height of the bar with the caption in pixels.
const BAR: u32 = 28;

/// One picture of a sheet.
#[derive(Clone, Debug)]
pub struct Picture {
    /// The frame's number, which is the caption.
    pub frame: i32,
    /// The footage's picture.
    pub footage: PathBuf,
    /// The picture over it, with straight alpha. It is stretched to the footage's size.
    pub strokes: PathBuf,
}

/// The path of a frame, from a pattern with one `%d` or `%0Nd`.
pub fn frame_path(pattern: &str, frame: i32) -> String {
    let Some(start) = pattern.find('%') else { return pattern.to_owned() };
    let Some(length) = pattern[start..].find('d') else { return pattern.to_owned() };
    let width: usize = pattern[start + 1..start + length].parse().unwrap_or(0);
    format!("{}{frame:0width$}{}", &pattern[..start], &pattern[start + length + 1..])
}

/// Writes the pictures, in their order, as one PNG.
pub fn write(pictures: &[Picture], path: &Path) -> Result<()> {
    let cells = pictures.iter().map(cell).collect::<Result<Vec<_>>>()?;
    arrange(&cells)?.save(path).with_context(|| format!("cannot write {path:?}"))
}

/// Arranges cells in rows, beginning at the top left.
pub fn arrange(cells: &[RgbaImage]) -> Result<RgbaImage> {
    ensure!(!cells.is_empty(), "found no pictures, but a contact sheet needs at least one");
    let width = cells.iter().map(RgbaImage::width).max().unwrap_or(1);
    let height = cells.iter().map(RgbaImage::height).max().unwrap_or(1);
    let rows = (cells.len() as u32).div_ceil(COLUMNS);
    let columns = COLUMNS.min(cells.len() as u32);
    let mut sheet =
        RgbaImage::from_pixel(columns * (width + GAP) + GAP, rows * (height + GAP) + GAP, Rgba([40, 40, 44, 255]));
    for (i, cell) in cells.iter().enumerate() {
        let (column, row) = (i as u32 % COLUMNS, i as u32 / COLUMNS);
        overlay(&mut sheet, cell, (GAP + column * (width + GAP)).into(), (GAP + row * (height + GAP)).into());
    }
    Ok(sheet)
}

/// Scales a picture to the width of a cell.
pub fn shrunk(footage: &RgbaImage) -> RgbaImage {
    let height = (CELL * footage.height()).div_ceil(footage.width());
    resize(footage, CELL, height, FilterType::Triangle)
}

/// Puts a bar with the caption `text` above a cell.
pub fn captioned(cell: &RgbaImage, text: &str) -> Result<RgbaImage> {
    let mut bar = Pixmap::new(cell.width(), BAR).context("a cell without pixels")?;
    bar.fill(Color::from_rgba8(30, 30, 34, 255));
    lettering::draw(&mut bar, text, [8.0, BAR as f32 - 9.0], BAR as f32 - 16.0, Color::WHITE, false);
    let bar = RgbaImage::from_raw(cell.width(), BAR, bar.data().to_vec()).context("a bar of another size")?;
    let mut whole = RgbaImage::new(cell.width(), cell.height() + BAR);
    overlay(&mut whole, &bar, 0, 0);
    overlay(&mut whole, cell, 0, BAR.into());
    Ok(whole)
}

fn cell(picture: &Picture) -> Result<RgbaImage> {
    let read = |path: &Path| {
        Ok::<_, anyhow::Error>(image::open(path).with_context(|| format!("cannot read {path:?}"))?.to_rgba8())
    };
    let mut cell = shrunk(&read(&picture.footage)?);
    let (width, height) = cell.dimensions();
    overlay(&mut cell, &resize(&read(&picture.strokes)?, width, height, FilterType::Triangle), 0, 0);
    captioned(&cell, &picture.frame.to_string())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn patterns_give_paths() {
        assert_eq!(frame_path("a/frame_%03d.png", 7), "a/frame_007.png");
        assert_eq!(frame_path("%d.png", 12), "12.png");
        assert_eq!(frame_path("still.png", 12), "still.png");
    }

    #[test]
    fn strokes_are_drawn_over_the_footage() {
        let folder = tempfile::tempdir().unwrap();
        let at = |name: &str| folder.path().join(name);
        RgbaImage::from_pixel(960, 540, Rgba([0, 0, 255, 255])).save(at("footage.png")).unwrap();
        let half = |x: u32| if x < 480 { Rgba([255, 0, 0, 255]) } else { Rgba([0, 0, 0, 0]) };
        RgbaImage::from_fn(960, 540, |x, _| half(x)).save(at("strokes.png")).unwrap();
        let picture = |frame| Picture { frame, footage: at("footage.png"), strokes: at("strokes.png") };
        write(&(0..5).map(picture).collect::<Vec<_>>(), &at("sheet.png")).unwrap();
        let sheet = image::open(at("sheet.png")).unwrap().to_rgba8();
        assert_eq!(sheet.dimensions(), (4 * 484 + 4, 2 * (274 + BAR) + 4));
        assert_eq!(sheet.get_pixel(4 + 100, 4 + 200).0, [255, 0, 0, 255]);
        assert_eq!(sheet.get_pixel(4 + 380, 4 + 200).0, [0, 0, 255, 255]);
        let inked = |y: u32| (4..484).filter(|&x| sheet.get_pixel(x, y).0[0] > 200).count();
        assert!((4..4 + BAR).map(inked).sum::<usize>() > 5, "the number of the frame");
    }

    #[test]
    fn a_missing_picture_is_named() {
        let folder = tempfile::tempdir().unwrap();
        let gone = folder.path().join("gone.png");
        let picture = Picture { frame: 3, footage: gone.clone(), strokes: gone };
        let error = format!("{:#}", write(&[picture], &folder.path().join("sheet.png")).unwrap_err());
        assert!(error.contains("gone.png"), "{error}");
    }
}
