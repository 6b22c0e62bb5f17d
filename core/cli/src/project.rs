//! Documents from and to the files that the command names.

use crate::failure::{Failure, line};
use rototoon::pipeline;
use rototoon::project::Document;
use std::path::Path;

/// Reads a document and says what has no effect in it.
pub fn load(path: &Path) -> Result<Document, Failure> {
    let document = Document::load(path)?;
    for warning in document.problems().warnings() {
        line("warning", &format!("{}: {warning}", path.display()));
    }
    Ok(document)
}

/// The folder that a document's footage is relative to.
pub fn folder(path: &Path) -> &Path {
    path.parent().unwrap_or(Path::new(""))
}

/// Writes a document that was read from `from`; its footage stays the same.
pub fn save(mut document: Document, from: &Path, to: &Path) -> Result<(), Failure> {
    pipeline::relocate(&mut document, folder(from), folder(to));
    Ok(document.save(to)?)
}
