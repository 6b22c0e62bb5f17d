//! Paints a film by clicks on its first drawing, and scores all others.

use super::paint::pixels;
use super::score::{First, Score, score};
use super::set::Set;
use super::sheet::{self, Scored};
use super::truth::Truth;
use crate::memory::peak_mb;
use anyhow::{Context, Result, ensure};
use rototoon::pipeline::{FillOptions, fill};
use rototoon::project::Document;
use rototoon::project::fills::{FillClick, FillClicks, FilledDrawing};
use rototoon::scene::{Footage, Scene, Silent};
use serde::{Deserialize, Serialize};
use std::path::Path;
use std::time::Instant;
use tempfile::TempDir;

/// The results of a set.
#[derive(Clone, Debug, Deserialize, PartialEq, Serialize)]
pub struct Outcome {
    /// The set's name.
    pub set: String,
    /// The number of drawings, the first one too.
    pub drawings: usize,
    /// The number of clicks on the first drawing.
    pub clicks: usize,
    /// The counts of all drawings but the first.
    pub score: Score,
    /// Seconds of painting for each drawing but the first, with reading the pictures from files.
    pub seconds: f64,
    /// The process's largest resident size up to the end of painting, in MB of 10⁶ bytes; `None` if the system does not report it.
    pub peak_mb: Option<f64>,
}

/// Measures the set in a folder. Writes the sheet of its worst drawings to the file `sheet`.
///
/// # Errors
///
/// Those of [`Set::find`], a first drawing without regions, and errors of painting and of writing.
pub fn measure(folder: &Path, name: &str, sheet: &Path) -> Result<Outcome> {
    let set = Set::find(folder)?;
    let first = set.drawing(0)?;
    let truth = Truth::of(&first);
    let clicks = truth.clicks();
    ensure!(!clicks.is_empty(), "{:?}: found no region that ink encloses and one colour fills", set.lines[0]);
    let first = First { colours: truth.regions.iter().map(|region| region.colour).collect(), picture: first.colour };
    let count = clicks.len();
    let start = Instant::now();
    let filled = filled(&set, clicks)?;
    let seconds = start.elapsed().as_secs_f64() / (set.lines.len() - 1) as f64;
    // Memory never falls in this figure, so it is read before the pictures of the truth are.
    let peak_mb = peak_mb();
    let mut all = Score::default();
    let mut scored = Vec::new();
    for k in 1..set.lines.len() {
        let drawing = set.drawing(k)?;
        let truth = Truth::of(&drawing);
        let regions = filled.iter().find(|own| own.frame as usize == k).map_or(&[][..], |own| &own.regions);
        let paint = pixels(regions, set.size);
        let (own, marks) = score(&truth, &paint, &first);
        all.add(&own);
        scored.push(Scored { number: k, drawing, truth, paint, marks });
        sheet::keep_worst(&mut scored);
    }
    sheet::draw(&scored)?.save(sheet).with_context(|| format!("cannot write {sheet:?}"))?;
    Ok(Outcome { set: name.to_owned(), drawings: set.lines.len(), clicks: count, score: all, seconds, peak_mb })
}

/// The painted regions of all drawings. The first drawing is frame 0.
fn filled(set: &Set, clicks: Vec<FillClick>) -> Result<Vec<FilledDrawing>> {
    let (mut document, folder) = document(set)?;
    document.set_fills(&[FillClicks { frame: 0, clicks }]);
    fill(&mut document, folder.path(), None, &FillOptions::default(), None, &Silent)?;
    Ok(document.filled()?)
}

/// A document with the set's line drawings as footage, and the temporary folder with their pictures. The first drawing is frame 0.
pub(super) fn document(set: &Set) -> Result<(Document, TempDir)> {
    let folder = tempfile::tempdir().context("cannot make a temporary folder")?;
    for (k, path) in set.lines.iter().enumerate() {
        // A document wants numbered pictures; those of a set may have any names.
        std::fs::copy(path, folder.path().join(format!("{k}.png"))).with_context(|| format!("cannot copy {path:?}"))?;
    }
    let (width, height) = set.size;
    let last = i32::try_from(set.lines.len() - 1).context("too many drawings")?;
    let footage = Footage { pattern: "%d.png".into(), first: 0, last, fps: 12.0, width, height, held: false };
    Ok((Document::new(Scene { footage, parts: Vec::new() }), folder))
}

#[cfg(test)]
mod tests {
    use super::super::own;
    use super::super::shapes::write;
    use super::*;

    #[test]
    fn the_drawn_film_is_painted_and_scored() {
        let folder = tempfile::tempdir().unwrap();
        write(folder.path(), 270, &own::drawings(5)).unwrap();
        let sheet = folder.path().join("sheet.png");
        let found = measure(folder.path(), "drawn", &sheet).unwrap();
        let score = found.score;
        assert_eq!((found.drawings, found.set.as_str()), (5, "drawn"));
        assert!(found.clicks >= 15 && score.regions >= 4 * 15, "{found:?}");
        assert!(score.known < score.regions, "the first drawing does not have every colour");
        let share = |part: usize, of: usize| part as f64 / of as f64;
        let (right, held) = (share(score.right, score.regions), share(score.held, score.regions));
        assert!(right > 0.55 && held < right - 0.2, "{right} right, {held} by colours left where they are");
        assert!(share(score.right_area, score.area) > 0.8, "{score:?}");
        assert_eq!(score.bands.iter().map(|band| band.0).sum::<usize>(), score.regions);
        assert!(image::open(sheet).unwrap().width() > 480);
    }

    #[test]
    fn a_blank_first_drawing_is_named() {
        let folder = tempfile::tempdir().unwrap();
        for name in ["frames", "colour"] {
            std::fs::create_dir(folder.path().join(name)).unwrap();
            for k in 0..2 {
                // Each pixel of the colours differs from its neighbours, so no region has one colour.
                let noisy = |x: u32, y: u32| image::Rgb([(97 * x + 57 * y) as u8, 255, 255]);
                let tone = |x, y| if name == "frames" { image::Rgb([255; 3]) } else { noisy(x, y) };
                let path = folder.path().join(name).join(format!("{k}.png"));
                image::RgbImage::from_fn(40, 30, tone).save(path).unwrap();
            }
        }
        let error = measure(folder.path(), "blank", &folder.path().join("sheet.png")).unwrap_err().to_string();
        assert!(error.contains("0.png\": found no region that ink encloses"), "{error}");
    }
}
