//! In-betweens of whole line drawings. Every drawing of a film is traced for itself, so its strokes are cut in other places
//! on each, and nothing is told about which is which. The drawings between two keys are compared with the true ink there.

use super::ink::{InkErrors, ink};
use anyhow::{Context, Result};
use rototoon::geometry::Point;
use rototoon::lines::{Drawing, Options as LineOptions};
use rototoon::pictures::decode::decode;
use rototoon::scene::Silent;
use rototoon::tween::Stroke;
use rototoon::tween::between::{GivenPegs, Key, Options, Sequence};
use rototoon::tween::matching::{self, match_strokes};
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// A film of line drawings.
#[derive(Clone, Debug)]
pub struct Film {
    /// Name of its folder.
    pub name: String,
    /// The traced strokes of each drawing, in order.
    pub drawings: Vec<Vec<Stroke>>,
}

impl Film {
    /// Traces every picture in `frames` of a folder, in the order of their names.
    pub fn trace(folder: &Path) -> Result<Self> {
        let frames = folder.join("frames");
        let listed = std::fs::read_dir(&frames).with_context(|| format!("cannot read {frames:?}"))?;
        let mut paths: Vec<PathBuf> = listed.map(|entry| Ok(entry?.path())).collect::<std::io::Result<_>>()?;
        paths.sort();
        let name = folder.file_name().map_or_else(String::new, |name| name.to_string_lossy().into_owned());
        Ok(Self { name, drawings: paths.iter().map(|path| traced(path)).collect::<Result<_>>()? })
    }

    /// Two keys with one to three drawings between: every span of two to four frames.
    pub fn spans(&self) -> Vec<(usize, usize)> {
        let last = self.drawings.len().saturating_sub(1);
        (2..=4)
            .flat_map(|gap| (0..=last.saturating_sub(gap)).step_by(gap).map(move |k| (k, k + gap)))
            .filter(|s| s.1 <= last)
            .collect()
    }
}

fn traced(path: &Path) -> Result<Vec<Stroke>> {
    let picture = decode(path, None)?;
    let strokes = Drawing::new(Arc::new(picture), &LineOptions::default()).strokes();
    Ok(strokes.into_iter().map(|s| Stroke::new(s.points, s.closed)).collect())
}

/// Measures the drawings between two keys.
pub fn measure(film: &Film, (from, to): (usize, usize)) -> Result<InkErrors> {
    let (a, b) = (&film.drawings[from], &film.drawings[to]);
    let found = match_strokes(a, b, &[], &matching::Options::default(), &Silent)?;
    let key = |k: usize| Key { frame: k as i32, strokes: film.drawings[k].clone(), ..Key::default() };
    let sequence = Sequence::new(vec![key(from), key(to)], &[found], &GivenPegs::default(), &Options::default())?;
    let lines = |strokes: &[Stroke]| ink(strokes.iter().map(|s| (&s.points[..], s.closed)));
    let truth: Vec<(i32, Vec<Point>)> = (from + 1..to).map(|k| (k as i32, lines(&film.drawings[k]))).collect();
    Ok(InkErrors::of_span(&sequence, [a, b], &truth))
}
