//! Contact sheets: rendered strokes over the frames they were tracked in, side by side.

use anyhow::{Context, Result, ensure};
use image::imageops::{FilterType, overlay, resize};
use image::{Rgba, RgbaImage};
use std::path::{Path, PathBuf};

/// Width of one picture on the sheet in pixels.
const CELL: u32 = 480;
/// Pictures in a row.
const COLUMNS: u32 = 4;
/// Space between pictures in pixels.
const GAP: u32 = 4;

/// One picture of a sheet.
#[derive(Clone, Debug)]
pub struct Picture {
    /// The frame's number, written in a corner.
    pub frame: i32,
    /// The footage's picture.
    pub footage: PathBuf,
    /// What is laid over it: straight alpha, stretched to the footage's size.
    pub strokes: PathBuf,
}

/// Path of a frame by a pattern with one `%d` or `%0Nd`.
pub fn frame_path(pattern: &str, frame: i32) -> String {
    let Some(start) = pattern.find('%') else { return pattern.to_owned() };
    let Some(length) = pattern[start..].find('d') else { return pattern.to_owned() };
    let width: usize = pattern[start + 1..start + length].parse().unwrap_or(0);
    format!("{}{frame:0width$}{}", &pattern[..start], &pattern[start + length + 1..])
}

/// Writes the pictures, in their order, as one PNG.
pub fn write(pictures: &[Picture], path: &Path) -> Result<()> {
    ensure!(!pictures.is_empty(), "a contact sheet needs a picture");
    let cells = pictures.iter().map(cell).collect::<Result<Vec<_>>>()?;
    let height = cells.iter().map(RgbaImage::height).max().unwrap_or(1);
    let rows = (cells.len() as u32).div_ceil(COLUMNS);
    let columns = COLUMNS.min(cells.len() as u32);
    let mut sheet =
        RgbaImage::from_pixel(columns * (CELL + GAP) + GAP, rows * (height + GAP) + GAP, Rgba([40, 40, 44, 255]));
    for (i, cell) in cells.iter().enumerate() {
        let (column, row) = (i as u32 % COLUMNS, i as u32 / COLUMNS);
        overlay(&mut sheet, cell, (GAP + column * (CELL + GAP)).into(), (GAP + row * (height + GAP)).into());
    }
    sheet.save(path).with_context(|| format!("cannot write {path:?}"))
}

fn cell(picture: &Picture) -> Result<RgbaImage> {
    let read = |path: &Path| {
        Ok::<_, anyhow::Error>(image::open(path).with_context(|| format!("cannot read {path:?}"))?.to_rgba8())
    };
    let footage = read(&picture.footage)?;
    let height = (CELL * footage.height()).div_ceil(footage.width());
    let mut cell = resize(&footage, CELL, height, FilterType::Triangle);
    overlay(&mut cell, &resize(&read(&picture.strokes)?, CELL, height, FilterType::Triangle), 0, 0);
    number(&mut cell, picture.frame);
    Ok(cell)
}

/// Rows of three bits for the digits and the minus sign.
const DIGITS: [[u8; 5]; 11] = [
    [7, 5, 5, 5, 7],
    [2, 6, 2, 2, 7],
    [7, 1, 7, 4, 7],
    [7, 1, 3, 1, 7],
    [5, 5, 7, 1, 1],
    [7, 4, 7, 1, 7],
    [7, 4, 7, 5, 7],
    [7, 1, 1, 2, 2],
    [7, 5, 7, 5, 7],
    [7, 5, 7, 1, 7],
    [0, 0, 7, 0, 0],
];

fn number(cell: &mut RgbaImage, frame: i32) {
    const DOT: u32 = 3;
    for (i, c) in frame.to_string().chars().enumerate() {
        let rows = DIGITS[c.to_digit(10).unwrap_or(10) as usize];
        let left = 6 + i as u32 * 4 * DOT;
        for (x, y) in (0..5 * DOT).flat_map(|x| (0..7 * DOT).map(move |y| (x, y))) {
            let (px, py) = (left + x - DOT, 6 + y - DOT);
            if px >= cell.width() || py >= cell.height() {
                continue;
            }
            let (column, row) = ((x / DOT).wrapping_sub(1), (y / DOT).wrapping_sub(1));
            let ink = column < 3 && row < 5 && rows[row as usize] >> (2 - column) & 1 == 1;
            cell.put_pixel(px, py, if ink { Rgba([255, 255, 255, 255]) } else { Rgba([30, 30, 34, 255]) });
        }
    }
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
    fn strokes_lie_over_the_footage() {
        let folder = tempfile::tempdir().unwrap();
        let at = |name: &str| folder.path().join(name);
        RgbaImage::from_pixel(960, 540, Rgba([0, 0, 255, 255])).save(at("footage.png")).unwrap();
        let half = |x: u32| if x < 480 { Rgba([255, 0, 0, 255]) } else { Rgba([0, 0, 0, 0]) };
        RgbaImage::from_fn(960, 540, |x, _| half(x)).save(at("strokes.png")).unwrap();
        let picture = |frame| Picture { frame, footage: at("footage.png"), strokes: at("strokes.png") };
        write(&(0..5).map(picture).collect::<Vec<_>>(), &at("sheet.png")).unwrap();
        let sheet = image::open(at("sheet.png")).unwrap().to_rgba8();
        assert_eq!(sheet.dimensions(), (4 * 484 + 4, 2 * 274 + 4));
        assert_eq!(sheet.get_pixel(4 + 100, 4 + 200).0, [255, 0, 0, 255]);
        assert_eq!(sheet.get_pixel(4 + 380, 4 + 200).0, [0, 0, 255, 255]);
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
