//! The evidence about every tracked point beside the truth, as a table from which the model of confidence is fitted
//! (`tests/confidence.py`).
//!
//! Each set gives up to three tables: with its own keys, with keys on its first and last frame only, and with keys on four
//! frames at equal distances. So parts are lost more often than with good keys, as they are in an artist's first try.

use crate::measure::{Row, rows};
use crate::truth::Truth;
use anyhow::{Context, Result};
use rototoon::geometry::Point;
use rototoon::pipeline::{frames, in_effect, store};
use rototoon::project::{Document, write_whole};
use rototoon::scene::{FrameNumber, Part, Scene, Silent};
use rototoon::track::SceneSolver;
use rototoon::track::rototoon::Rototoon;
use rototoon::track::rototoon::evidence::{BySpan, NAMES};
use std::fmt::Write;
use std::path::Path;

/// Names of the tables of a set.
const VARIANTS: [&str; 3] = ["own", "ends", "thirds"];
/// Spans with fewer frames are not keyed otherwise.
const SHORTEST: FrameNumber = 4;

/// Writes the tables of the set in `folder` to files `SET.VARIANT.csv` in `out`.
pub fn write(set: &str, folder: &Path, out: &Path) -> Result<()> {
    let truth = Truth::load(&folder.join("truth.json"))?;
    for variant in VARIANTS {
        let mut document = Document::load(&folder.join("project.json"))?;
        if variant != "own" && !key_anew(&mut document.scene, &truth, variant == "ends") {
            continue;
        }
        let pictures = frames(&document, folder)?;
        let mut solver = Rototoon::default();
        let tracking = solver.track(&in_effect(&document.scene), &pictures, &Silent)?;
        store(&mut document.scene, &tracking);
        let table = table(&document.scene, &truth, &solver.evidence())?;
        write_whole(&out.join(format!("{set}.{variant}.csv")), table.as_bytes())?;
    }
    Ok(())
}

/// Gives every part keys from the truth, where the truth shows it there. Returns whether any part has other keys now.
fn key_anew(scene: &mut Scene, truth: &Truth, ends: bool) -> bool {
    let mut changed = false;
    for (part, truth) in scene.parts.iter_mut().zip(&truth.parts) {
        let (Some(&first), Some(&last)) = (part.keys.keys().next(), part.keys.keys().next_back()) else { continue };
        let steps: &[FrameNumber] = if ends { &[0, 3] } else { &[0, 1, 2, 3] };
        let wanted: Vec<FrameNumber> = steps.iter().map(|step| first + (last - first) * step / 3).collect();
        let points = |frame: &FrameNumber| -> Option<Vec<Point>> {
            let shown = truth.scored.get(frame).is_some_and(|scored| scored.contains('1'));
            let true_points = truth.points.get(frame).filter(|points| shown && points.len() == part.point_count());
            part.keys.get(frame).or(true_points).cloned()
        };
        let found: Option<Vec<Vec<Point>>> = wanted.iter().map(points).collect();
        if let Some(found) = found
            && last - first >= SHORTEST
            && !part.keys.keys().eq(wanted.iter())
        {
            part.keys = wanted.into_iter().zip(found).collect();
            changed = true;
        }
    }
    changed
}

/// One line for each point between keys. Lengths are in pixels at 540 lines.
fn table(scene: &Scene, truth: &Truth, evidence: &BySpan) -> Result<String> {
    let mut text = format!("part,frame,index,contour,point,scored,x,y,true_x,true_y,between,{}\n", NAMES.join(","));
    let scale = scene.footage.height as f64 / 540.0;
    for row in rows(scene, truth)? {
        let part = &scene.parts[row.part];
        let Some(found) = of_row(part, &row, evidence) else { continue };
        let at = part.tracks[&row.frame][row.index] / scale;
        let right = truth.parts[row.part].points[&row.frame][row.index] / scale;
        let Row { part, frame, index, scored, .. } = row;
        let (contour, point) = (row.contour / scale, row.point / scale);
        let (scored, between) = (u8::from(scored), u8::from(found.is_some()));
        write!(
            text,
            "{part},{frame},{index},{contour:.3},{point:.3},{scored},{:.3},{:.3},{:.3},{:.3},{between}",
            at.x, at.y, right.x, right.y
        )
        .context("a text cannot be written")?;
        let values = found.copied().unwrap_or_default();
        values.iter().for_each(|value| text.push_str(&format!(",{value:.5}")));
        text.push('\n');
    }
    Ok(text)
}

/// The evidence of a row; `Some(None)` on the drawing of a key. `None` if the part was not tracked there.
fn of_row<'a>(part: &Part, row: &Row, evidence: &'a BySpan) -> Option<Option<&'a [f64; NAMES.len()]>> {
    let span = part.spans().into_iter().find(|span| span.first <= row.frame && row.frame <= span.last)?;
    let (_, points) = evidence.get(&(part.name.clone(), span))?.get((row.frame - span.first) as usize)?;
    Some(points.get(row.index))
}
