//! Line drawings with the same drawings in colour, from a folder.

use anyhow::{Context, Result, ensure};
use rototoon::pictures::decode::probe;
use rototoon::scene::Raster;
use std::path::{Path, PathBuf};

/// Red, green and blue, sRGB-encoded, 0 to 255.
pub type Tone = [u8; 3];

/// A drawing.
#[derive(Clone, Debug)]
pub struct Drawing {
    /// The brightness of the line drawing, 0 to 255.
    pub lines: Raster<u8>,
    /// The same drawing in colour.
    pub colour: Raster<Tone>,
}

/// A film in lines and in colour.
#[derive(Clone, Debug)]
pub struct Set {
    /// The line drawings, in the order of their names.
    pub lines: Vec<PathBuf>,
    /// The drawing in colour for each of them.
    pub colours: Vec<PathBuf>,
    /// Width and height of all pictures in pixels.
    pub size: (usize, usize),
}

impl Set {
    /// The pictures of a folder. It reads their headers only.
    ///
    /// # Errors
    ///
    /// A folder that is missing, fewer than two drawings, a drawing without its colours, a picture that cannot be read, or one of another
    /// size.
    pub fn find(folder: &Path) -> Result<Self> {
        let frames = folder.join("frames");
        let expected = "a folder with line drawings as PNG files";
        ensure!(frames.is_dir(), "{frames:?}: found no folder, expected {expected}");
        let listed = std::fs::read_dir(&frames).with_context(|| format!("cannot read {frames:?}"))?;
        let mut lines: Vec<PathBuf> = listed.map(|entry| Ok(entry?.path())).collect::<std::io::Result<_>>()?;
        lines.retain(|path| path.extension().is_some_and(|end| end.eq_ignore_ascii_case("png")));
        lines.sort();
        let count = lines.len();
        ensure!(count > 1, "{frames:?}: found {count} PNG files, expected at least 2 line drawings");
        let in_colour = |path: &PathBuf| {
            let colour = folder.join("colour").join(path.file_name().unwrap_or_default());
            ensure!(colour.is_file(), "{colour:?}: found no file, expected the drawing {path:?} in colour");
            Ok(colour)
        };
        let colours: Vec<PathBuf> = lines.iter().map(in_colour).collect::<Result<_>>()?;
        let probed = |path: &PathBuf| probe(path).with_context(|| format!("cannot read {path:?} as a picture"));
        let size = probed(&lines[0])?;
        for path in lines.iter().chain(&colours) {
            let found = probed(path)?;
            let ((w, h), (width, height)) = (found, size);
            ensure!(
                found == size,
                "{path:?}: found {w}x{h} pixels, expected {width}x{height}, the size of {:?}",
                lines[0]
            );
        }
        Ok(Self { lines, colours, size })
    }

    /// Reads drawing `k`, from 0.
    ///
    /// # Errors
    ///
    /// A picture that cannot be read.
    pub fn drawing(&self, k: usize) -> Result<Drawing> {
        let read = |path: &Path| image::open(path).with_context(|| format!("cannot read {path:?}"));
        let lines = read(&self.lines[k])?.into_luma8();
        let colour = read(&self.colours[k])?.into_rgb8();
        let (width, height) = self.size;
        let tones = colour.pixels().map(|pixel| pixel.0).collect();
        let lines = Raster::from_vec(width, height, lines.into_raw());
        let colour = Raster::from_vec(width, height, tones);
        let changed = || format!("{:?} changed its size", self.lines[k]);
        Ok(Drawing { lines: lines.with_context(changed)?, colour: colour.with_context(changed)? })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use image::{GrayImage, RgbImage};

    fn error(folder: &Path) -> String {
        format!("{:#}", Set::find(folder).unwrap_err())
    }

    #[test]
    fn bad_folders_are_named_with_what_was_expected() {
        let folder = tempfile::tempdir().unwrap();
        let at = |name: &str| folder.path().join(name);
        let found = error(folder.path());
        assert!(found.contains("frames\": found no folder, expected a folder with line drawings"), "{found}");
        for name in ["frames", "colour"] {
            std::fs::create_dir(at(name)).unwrap();
        }
        GrayImage::new(8, 6).save(at("frames/a.png")).unwrap();
        let found = error(folder.path());
        assert!(found.contains("frames\": found 1 PNG files, expected at least 2"), "{found}");
        GrayImage::new(8, 6).save(at("frames/b.png")).unwrap();
        RgbImage::new(8, 6).save(at("colour/a.png")).unwrap();
        let found = error(folder.path());
        assert!(found.contains("b.png\": found no file, expected the drawing"), "{found}");
        RgbImage::new(8, 5).save(at("colour/b.png")).unwrap();
        let found = error(folder.path());
        assert!(found.contains("b.png\": found 8x5 pixels, expected 8x6, the size of"), "{found}");
        std::fs::write(at("colour/b.png"), "no picture").unwrap();
        let found = error(folder.path());
        assert!(found.contains("cannot read") && found.contains("b.png"), "{found}");
        RgbImage::new(8, 6).save(at("colour/b.png")).unwrap();
        std::fs::write(at("frames/notes.txt"), "not a drawing").unwrap();
        let set = Set::find(folder.path()).unwrap();
        assert_eq!((set.lines.len(), set.size), (2, (8, 6)));
        assert_eq!(set.drawing(1).unwrap().colour.width(), 8);
    }
}
