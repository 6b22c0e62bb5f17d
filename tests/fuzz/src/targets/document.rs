//! Project documents: read, checked, written, and read again.

use crate::given;
use rototoon::pipeline;
use rototoon::project::Document;

/// Reads a document. What can be read must be written so that it can be read again, without a loss.
pub fn document(data: &[u8]) {
    let text = given::text(data, "{", given::document::document);
    let Ok(read) = Document::parse(&text, "fuzz") else { return };
    assert_eq!(read.problems().error_count(), 0, "a document with errors was read");
    let _ = read.limbs();
    let _ = pipeline::drawing_problems(&read);
    let written = read.to_json();
    let again = Document::parse(&written, "again").unwrap_or_else(|error| panic!("written, but not readable: {error}"));
    assert_eq!(again.scene.footage, read.scene.footage);
    for (before, after) in read.scene.parts.iter().zip(&again.scene.parts) {
        // The artist's data are written as they are; only results are rounded.
        assert_eq!((&before.name, before.closed, before.depth), (&after.name, after.closed, after.depth));
        assert_eq!((&before.keys, &before.pins, &before.centers), (&after.keys, &after.pins, &after.centers));
        assert_eq!((&before.depths, &before.wants_key), (&after.depths, &after.wants_key));
        assert_eq!(before.absent, after.absent);
        assert!(before.tracks.keys().eq(after.tracks.keys()) && before.curves.keys().eq(after.curves.keys()));
    }
    assert_eq!(again.to_json(), written, "written once more, the text is another one");
}
