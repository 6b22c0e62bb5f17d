//! In-betweens of a document's drawings.

use crate::given::{self, number};
use arbitrary::{Result, Unstructured};
use rototoon::geometry::Point;
use rototoon::pipeline;
use rototoon::project::Document;
use rototoon::scene::Silent;
use rototoon::tween::between::{Leaving, Options};
use serde_json::value::RawValue;
use std::collections::BTreeMap;

/// Most frames from the first to the last drawing. More are as slow as they are many.
const MOST_FRAMES: i64 = 32;
/// Most strokes of a drawing, and most points of all strokes of a document.
const MOST: [usize; 2] = [12, 400];

/// Matches the strokes of a document's drawings and draws between them.
pub fn tween(data: &[u8]) {
    let (text, mut u) = given::text_and_rest(data, "{", given::document::document);
    let Ok(mut document) = Document::parse(&text, "fuzz") else { return };
    let _ = pipeline::drawing_problems(&document);
    if !small(&document) {
        return;
    }
    let options = options(&mut u).unwrap_or_default();
    let follow = u.arbitrary().unwrap_or(true);
    if pipeline::tween(&mut document, &options, follow, &Silent).is_ok() {
        let written = document.to_json();
        let again = Document::parse(&written, "again").unwrap_or_else(|error| panic!("not readable: {error}"));
        // Fields that are not known are kept as they are, even with numbers that no program can read.
        let fields: BTreeMap<String, Box<RawValue>> =
            serde_json::from_str(&again.to_json()).expect("a document is JSON");
        let drawn = fields["in_betweens"].get();
        assert!(!drawn.contains("null,") && !drawn.contains("null]"), "a point is not finite: {drawn}");
    }
}

/// Whether a run is short. What a document of more strokes or frames costs is measured elsewhere.
fn small(document: &Document) -> bool {
    let (read, _) = document.drawings_and_problems();
    let frames = match (read.drawings.first(), read.drawings.last()) {
        (Some(first), Some(last)) => i64::from(last.frame) - i64::from(first.frame),
        _ => 0,
    };
    let strokes = read.drawings.iter().map(|drawing| drawing.strokes.len()).max().unwrap_or(0);
    let points: usize = read.drawings.iter().flat_map(|d| &d.strokes).map(|stroke| stroke.points.len()).sum();
    frames <= MOST_FRAMES && strokes <= MOST[0] && points <= MOST[1]
}

fn options(u: &mut Unstructured) -> Result<Options> {
    let mut options = Options::default();
    if u.ratio(1u8, 4)? {
        options.arcs = number(u)?;
    }
    (options.rigid, options.contacts, options.rest) = (u.arbitrary()?, u.arbitrary()?, u.arbitrary()?);
    options.leaving = match u.int_in_range(0..=2u8)? {
        0 => Leaving::Leave { size: Point::new(number(u)?, number(u)?) },
        1 => Leaving::Fade,
        _ => Leaving::Grow,
    };
    Ok(options)
}
