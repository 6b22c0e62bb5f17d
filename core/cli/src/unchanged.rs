//! What this command read: a document that another program wrote meanwhile is not written over ([`pipeline::unchanged`]).

use crate::failure::Failure;
use rototoon::pipeline::unchanged::Known;
use rototoon::project::Document;
use std::path::Path;
use std::sync::{Mutex, PoisonError};

static KNOWN: Mutex<Known> = Mutex::new(Known::new());

/// Remembers what a file holds. To be called before it is read.
pub fn remember(path: &Path) {
    KNOWN.lock().unwrap_or_else(PoisonError::into_inner).remember(path);
}

/// Writes a document over a file, unless another program wrote the file after this command read it.
///
/// # Errors
///
/// The file was changed: the result is in a new file, which the error names. The document cannot be written.
pub fn save(document: &Document, to: &Path) -> Result<(), Failure> {
    Ok(KNOWN.lock().unwrap_or_else(PoisonError::into_inner).save(document, to)?)
}
