//! The evidence about the colour of every true region, as a table from which the confidence is fitted
//! (`tests/fill_confidence.py`).
//!
//! A film is painted by clicks on its first drawing, as the benchmark does ([`super::run`]). A true region that the program
//! sees as several ones has the evidence of the largest.

use super::set::{Set, Tone};
use super::truth::{Region, Truth};
use anyhow::Result;
use rototoon::fill::evidence::NAMES;
use rototoon::fill::{Click, Page, Paint, Source, Ways, carry};
use rototoon::geometry::Point;
use rototoon::lines::Options;
use rototoon::scene::FrameSource;
use std::collections::BTreeMap;
use std::path::PathBuf;
use std::sync::Arc;

/// Largest difference of a channel at which two colours are the same, of 255.
const SAME: u8 = 6;
/// Fewest drawings of a film that has variants.
const LONG: usize = 12;

/// A film as it is painted for a table.
#[derive(Clone, Debug)]
pub struct Variant {
    /// The end of its name.
    pub name: &'static str,
    /// Its drawings.
    pub set: Set,
    /// Whether every fourth region of the first drawing is left unpainted.
    pub bare: bool,
}

/// A film as it is and with unpainted regions; if it is long also every third drawing of it, and those from the middle on.
pub fn variants(set: &Set) -> Vec<Variant> {
    let picked = |from: usize, step: usize| {
        let pick = |paths: &[PathBuf]| paths.iter().skip(from).step_by(step).cloned().collect();
        Set { lines: pick(&set.lines), colours: pick(&set.colours), size: set.size }
    };
    let of = |name, set, bare| Variant { name, set, bare };
    let mut variants = vec![of("", set.clone(), false), of(".bare", set.clone(), true)];
    if set.lines.len() >= LONG {
        variants.push(of(".thirds", picked(0, 3), false));
        variants.push(of(".late", picked(set.lines.len() / 2, 1), false));
    }
    variants
}

/// The table of a film: a line for each true region of all drawings but the first.
///
/// # Errors
///
/// A picture that cannot be read.
pub fn table(variant: &Variant) -> Result<String> {
    let set = &variant.set;
    let truth = Truth::of(&set.drawing(0)?);
    let mut tones: Vec<Tone> = truth.regions.iter().map(|region| region.colour).collect();
    tones.sort_unstable();
    tones.dedup();
    let clicked = truth.clicks().into_iter().zip(&truth.regions).enumerate();
    let clicks = clicked
        .filter(|(k, _)| !variant.bare || k % 4 != 3)
        .map(|(_, (click, region))| Click { at: click.at, colour: tones.binary_search(&region.colour).ok() });
    let clicks: Vec<Click> = clicks.collect();
    let (document, pictures) = super::run::document(set)?;
    let frames = rototoon::pipeline::frames(&document, pictures.path())?;
    let mut next = 0;
    let mut key = Page::new(frames.picture(0)?, &Options::default());
    let (paint, _) = key.painted(&clicks, tones.len(), &mut next);
    let key = (Arc::new(key), paint);
    let mut last = key.clone();
    let mut text = format!("drawing,area,confidence,right,{}\n", NAMES.join(","));
    for k in 1..set.lines.len() {
        let mut page = Page::new(frames.picture(k as i32)?, &Options::default());
        let ways = [&key, &last].map(|own| Ways::new(&own.0, &page));
        let mut sources = vec![Source { page: &key.0, paint: &key.1, own: true, ways: &ways[0] }];
        if !Arc::ptr_eq(&last.0, &key.0) {
            sources.push(Source { page: &last.0, paint: &last.1, own: false, ways: &ways[1] });
        }
        let Some(paint) = carry(&sources, &mut page, &mut next) else { continue };
        for region in Truth::of(&set.drawing(k)?).regions {
            let Some(row) = row(&region, &tones, (&page, &paint), set.size.0) else { continue };
            text += &format!("{k},{row}\n");
        }
        last = (Arc::new(page), paint);
    }
    Ok(text)
}

/// The values of a region. `None` if it is not painted.
fn row(region: &Region, tones: &[Tone], (page, paint): (&Page, &Paint), width: usize) -> Option<String> {
    let mut counts: BTreeMap<usize, usize> = BTreeMap::new();
    for &at in &region.pixels {
        let place = Point::new((at % width) as f64 + 0.5, (at / width) as f64 + 0.5);
        page.at(place).into_iter().for_each(|own| *counts.entry(own).or_default() += 1);
    }
    let same = |tone: &Tone| (0..3).all(|c| tone[c].abs_diff(region.colour[c]) <= SAME);
    let painted_right = |own: &usize| paint.painted(*own).is_some_and(|colour| same(&tones[colour]));
    let right: usize = counts.iter().filter(|own| painted_right(own.0)).map(|own| own.1).sum();
    let area = region.pixels.len();
    // Of equal ones the first is taken.
    let (own, _) = counts.into_iter().rev().max_by_key(|own| own.1)?;
    let values: String = paint.evidence(own)?.iter().map(|value| format!(",{value:.5}")).collect();
    Some(format!("{area},{:.4},{}{values}", paint.confidence(own), u8::from(2 * right > area)))
}

#[cfg(test)]
mod tests {
    use super::super::own;
    use super::super::shapes::write;
    use super::*;

    #[test]
    fn tables_have_a_row_for_each_region_and_unpainted_ones_are_doubted() {
        let folder = tempfile::tempdir().unwrap();
        write(folder.path(), 270, &own::drawings(3)).unwrap();
        let variants = variants(&Set::find(folder.path()).unwrap());
        let names: Vec<&str> = variants.iter().map(|variant| variant.name).collect();
        assert_eq!(names, ["", ".bare"], "too few drawings for more");
        let rows = |variant: &Variant| -> Vec<Vec<f64>> {
            let table = table(variant).unwrap();
            let mut lines = table.lines();
            assert!(lines.next().unwrap().ends_with(&NAMES.join(",")));
            lines.map(|line| line.split(',').map(|value| value.parse().unwrap()).collect()).collect()
        };
        let (whole, bare) = (rows(&variants[0]), rows(&variants[1]));
        assert!(whole.len() >= 40 && whole.iter().all(|row| row.len() == 4 + NAMES.len()), "{}", whole.len());
        let mean = |rows: &[Vec<f64>], k: usize| rows.iter().map(|row| row[k]).sum::<f64>() / rows.len() as f64;
        let (right, sure) = (3, 2);
        assert!(mean(&bare, right) < mean(&whole, right) - 0.05, "{}, {}", mean(&bare, right), mean(&whole, right));
        assert!(mean(&bare, sure) < mean(&whole, sure) - 0.05, "{}, {}", mean(&bare, sure), mean(&whole, sure));
    }

    #[test]
    fn long_films_are_painted_in_more_ways() {
        let paths: Vec<PathBuf> = (0..LONG).map(|k| format!("{k:02}.png").into()).collect();
        let set = Set { lines: paths.clone(), colours: paths, size: (8, 6) };
        let counts: Vec<(&str, usize)> = variants(&set).iter().map(|own| (own.name, own.set.lines.len())).collect();
        assert_eq!(counts, [("", 12), (".bare", 12), (".thirds", 4), (".late", 6)]);
    }
}
