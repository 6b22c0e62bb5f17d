//! Reads and writes the documents that the command names.

use crate::failure::{Failure, line};
use crate::unchanged;
use rototoon::pipeline;
use rototoon::project::output::check_writable;
use rototoon::project::place::{folder_for, folder_of};
use rototoon::project::{Document, Inputs, WriteError, is_same_file};
use rototoon::scene::Scene;
use std::path::{Path, PathBuf};

/// Reads a document and prints its warnings.
pub fn load(path: &Path) -> Result<Document, Failure> {
    warned(path, |_| true)
}

/// As [`load`], for work on drawings, which needs no part.
pub fn load_drawn(path: &Path) -> Result<Document, Failure> {
    warned(path, |_| false)
}

/// As [`load`], for work that takes parts and drawings alike: one of both is enough.
pub fn load_either(path: &Path) -> Result<Document, Failure> {
    warned(path, |document| !document.has_drawn())
}

/// Reads a document without a word.
pub fn read(path: &Path) -> Result<Document, Failure> {
    unchanged::remember(path);
    Ok(Document::load(path)?)
}

fn warned(path: &Path, needs_part: impl FnOnce(&Document) -> bool) -> Result<Document, Failure> {
    let document = read(path)?;
    let problems = document.problems();
    let unneeded = document.scene.parts.is_empty() && !needs_part(&document);
    let told = problems.warnings().filter(|warning| !(unneeded && warning.place == "parts"));
    for warning in told.chain(document.misspelt().warnings()) {
        line("warning", &format!("{}: {warning}", path.display()));
    }
    Ok(document)
}

/// Says which frames of a document that was read from `path` have no file and show the one before.
pub fn say_gaps(document: &Document, path: &Path) -> Result<(), Failure> {
    let gaps = pipeline::held_gaps(document, &home(document, path)).map_err(|error| Failure::of(error, path))?;
    gaps.iter().for_each(|told| line("note", &format!("{}: {told}", path.display())));
    Ok(())
}

/// The folder of a file.
pub fn folder(path: &Path) -> &Path {
    path.parent().unwrap_or(Path::new(""))
}

/// The folder that the footage of a document is relative to, which was read from `path`.
pub fn home(document: &Document, path: &Path) -> PathBuf {
    folder_of(path, &document.scene.footage)
}

/// The footage of a document that was read from `from`. No output may be one of its frames; the document itself may be
/// written over by a later state of it.
pub fn inputs(document: &Document, from: &Path) -> Inputs {
    Inputs::default().footage(&document.scene.footage, &home(document, from))
}

/// Refuses a report that would go over what a command reads or over its output. The document that it reads may be written over by a later state of it, but
/// not by a report.
pub fn check_report(report: &Path, inputs: &Inputs, [from, to]: [&Path; 2]) -> Result<(), Failure> {
    inputs.clone().file(from).check(report)?;
    if is_same_file(report, to) {
        return Err(Failure::Use(format!(
            "--report: found {}, expected another file than the output",
            report.display()
        )));
    }
    Ok(check_writable(report)?)
}

/// Writes a document that was read from `from`. A relative footage pattern is rewritten so that it names the same files. What another program wrote to the
/// file meanwhile is not written over ([`unchanged`]).
pub fn save(mut document: Document, from: &Path, to: &Path) -> Result<(), Failure> {
    let home = home(&document, from);
    follow(&mut document, &home, to)?;
    unchanged::save(&document, to)
}

/// Rewrites the relative footage pattern of a document that is to be written at `to`. So far it begins in `home`.
pub fn follow(document: &mut Document, home: &Path, to: &Path) -> Result<(), WriteError> {
    let followed = match std::fs::metadata(to) {
        // A pipe or a device: nobody knows the folder of what reads it.
        Ok(found) if !found.is_file() => pipeline::unfold(document, home),
        _ => pipeline::relocate(document, home, &folder_for(to, home)),
    };
    followed.map_err(|source| WriteError { path: to.to_owned(), source })
}

/// Refuses an output for a document that was read from `from`, if it certainly cannot be written, so that long work fails before it starts.
pub fn check_output(document: &Document, from: &Path, to: &Path) -> Result<(), WriteError> {
    check_writable(to)?;
    let mut bare = Document::new(Scene { footage: document.scene.footage.clone(), parts: Vec::new() });
    follow(&mut bare, &home(document, from), to)
}
