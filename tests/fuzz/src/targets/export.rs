//! Export: a document as SVG, as Nuke's and Silhouette's shapes, and as JSON.

use crate::given::{self, number};
use rototoon::export::{Motion, SvgOptions};
use rototoon::import::{self, ImportError, Shapes};
use rototoon::pipeline::{export_nuke, export_silhouette, export_svg};
use rototoon::project::Document;

/// Most frames of a footage. More are as slow as they are many.
const MOST_FRAMES: i64 = 64;

/// Writes a document in every format. What is XML must be readable as such.
pub fn export(data: &[u8]) {
    let (text, mut u) = given::text_and_rest(data, "{", given::document::document);
    let Ok(document) = Document::parse(&text, "fuzz") else { return };
    let footage = &document.scene.footage;
    if i64::from(footage.last) - i64::from(footage.first) > MOST_FRAMES {
        return;
    }
    let spacing = if u.ratio(1u8, 4).unwrap_or(false) { number(&mut u).unwrap_or(2.0) } else { 2.0 };
    for (motion, _) in Motion::ALL {
        let Ok(svg) = export_svg(&document, &SvgOptions { motion, spacing, ..SvgOptions::default() }) else { return };
        let found = import::svg::svg(&svg, footage, footage.first);
        taken(found, "SVG");
    }
    let shapes = export_silhouette(&document, spacing);
    let found = import::silhouette::silhouette(&shapes, footage);
    taken(found, "file of shapes");
    let node = export_nuke(&document, spacing);
    assert!(!node.contains("NaN") && !node.contains("inf "), "a number of the node is not finite");
    let _ = document.to_json();
}

/// A file without shapes is refused, and a document without contours gives one. Everything else must be taken.
fn taken(found: Result<Shapes, ImportError>, what: &str) {
    let error = found.err().map(|error| error.to_string()).unwrap_or_default();
    assert!(error.is_empty() || error.contains("found no shape"), "the {what} cannot be read: {error}");
}
