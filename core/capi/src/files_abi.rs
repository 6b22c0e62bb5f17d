//! The exported functions for callers that keep a document themselves, and write it over the file that they read it from.

use crate::entry::{clear, entry, give, text};
use crate::status::{Failure, RototoonStatus};
use crate::text::RototoonText;
use rototoon::pipeline::unchanged::{self, Mark};
use std::path::Path;
use std::ptr::null_mut;

/// Returns a mark of what a file holds now, for `rototoon_file_replace`. Take it before you read the file. It is a short text, the same on all machines, and
/// may be kept. It is empty if there is no file, or if it cannot be read.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rototoon_file_mark(
    path: *const u8,
    path_length: usize,
    mark: *mut *mut RototoonText,
    error: *mut *mut RototoonText,
) -> RototoonStatus {
    // SAFETY: the crate's contract.
    unsafe {
        entry(error, || {
            clear(mark, null_mut(), "mark")?;
            let path = text(path, path_length, "path")?;
            let found = Mark::of(Path::new(path)).map_or_else(String::new, |found| found.to_string());
            give(mark, RototoonText::new(found));
            Ok(())
        })
    }
}

/// Writes a text as a file, completely or not at all. `read` is the mark that `rototoon_file_mark` or this function returned before. If another program wrote
/// the file since, it stays as it is: the text goes into a new file beside it, and the call fails with the names of both. With an empty mark the file is
/// replaced, whatever it holds. `mark` is that of the text.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rototoon_file_replace(
    path: *const u8,
    path_length: usize,
    content: *const u8,
    content_length: usize,
    read: *const u8,
    read_length: usize,
    mark: *mut *mut RototoonText,
    error: *mut *mut RototoonText,
) -> RototoonStatus {
    // SAFETY: the crate's contract.
    unsafe {
        entry(error, || {
            clear(mark, null_mut(), "mark")?;
            let path = text(path, path_length, "path")?;
            let content = text(content, content_length, "content")?;
            let read = known(text(read, read_length, "read")?)?;
            let written = unchanged::replace(Path::new(path), content, read.as_slice()).map_err(Failure::error)?;
            give(mark, RototoonText::new(written.to_string()));
            Ok(())
        })
    }
}

fn known(read: &str) -> Result<Option<Mark>, Failure> {
    if read.is_empty() {
        return Ok(None);
    }
    let mark = Mark::parse(read);
    mark.map(Some)
        .ok_or_else(|| Failure::Error(format!("read: found {read:?}, expected a mark of a file, or an empty text")))
}
