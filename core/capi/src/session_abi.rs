//! The exported functions that make a session, read and replace its document, and free it.
//!
//! Those that edit the document are in [`crate::session_edit_abi`], those that track and snap in [`crate::session_track_abi`].

use crate::entry::{clear, entry, free, give, handle, text};
use crate::session::Session;
use crate::status::{Failure, RototoonStatus};
use crate::text::RototoonText;
use std::path::Path;
use std::ptr::null_mut;
use std::sync::{Mutex, TryLockError};

/// A session: a document, its pictures, and the results that tracking keeps for reuse.
pub struct RototoonSession(Mutex<Session>);

impl RototoonSession {
    fn new(session: Session) -> Self {
        Self(Mutex::new(session))
    }

    /// Runs `body` on the session. Fails at once if another call is using the session.
    pub(crate) fn with<T>(&self, body: impl FnOnce(&mut Session) -> Result<T, Failure>) -> Result<T, Failure> {
        let mut session = match self.0.try_lock() {
            Ok(session) => session,
            Err(TryLockError::WouldBlock) => return Err(Failure::Busy),
            Err(TryLockError::Poisoned(poisoned)) => {
                // A call panicked. The document is intact, because it is replaced in one step. Caches may be half-written.
                let mut session = poisoned.into_inner();
                session.forget();
                self.0.clear_poison();
                session
            }
        };
        body(&mut session)
    }

    /// Runs `change` on the scene.
    pub(crate) fn edit<E: std::fmt::Display>(
        &self,
        change: impl FnOnce(&mut rototoon::scene::Scene) -> Result<(), E>,
    ) -> Result<(), Failure> {
        self.with(|session| change(session.scene_mut()).map_err(Failure::error))
    }
}

/// Creates a session from the JSON text of a document. A relative footage pattern is relative to `folder`. Pictures are
/// read when they are needed.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rototoon_session_new(
    document: *const u8,
    document_length: usize,
    folder: *const u8,
    folder_length: usize,
    session: *mut *mut RototoonSession,
    error: *mut *mut RototoonText,
) -> RototoonStatus {
    // SAFETY: the crate's contract.
    unsafe {
        entry(error, || {
            clear(session, null_mut(), "session")?;
            let document = text(document, document_length, "document")?;
            let folder = text(folder, folder_length, "folder")?;
            let value = RototoonSession::new(Session::new(document, Path::new(folder))?);
            give(session, value);
            Ok(())
        })
    }
}

/// Creates a session from a project file. A relative footage pattern is relative to the file's folder.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rototoon_session_open(
    path: *const u8,
    path_length: usize,
    session: *mut *mut RototoonSession,
    error: *mut *mut RototoonText,
) -> RototoonStatus {
    // SAFETY: the crate's contract.
    unsafe {
        entry(error, || {
            clear(session, null_mut(), "session")?;
            let path = text(path, path_length, "path")?;
            let value = RototoonSession::new(Session::open(Path::new(path))?);
            give(session, value);
            Ok(())
        })
    }
}

/// Frees a session. Null is allowed. No call may be running on it.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rototoon_session_free(session: *mut RototoonSession) {
    // SAFETY: the crate's contract.
    unsafe { free(session) }
}

/// Returns the document as JSON, with its results.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rototoon_session_document(
    session: *const RototoonSession,
    document: *mut *mut RototoonText,
    error: *mut *mut RototoonText,
) -> RototoonStatus {
    // SAFETY: the crate's contract.
    unsafe {
        entry(error, || {
            clear(document, null_mut(), "document")?;
            let session = handle(session, "session")?;
            let value = session.with(|session| Ok(RototoonText::new(session.document())))?;
            give(document, value);
            Ok(())
        })
    }
}

/// Replaces the document, given as JSON. The session keeps solved spans, so tracking solves only spans that differ. It
/// keeps its pictures if the footage is the same.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rototoon_session_set_document(
    session: *const RototoonSession,
    document: *const u8,
    document_length: usize,
    error: *mut *mut RototoonText,
) -> RototoonStatus {
    // SAFETY: the crate's contract.
    unsafe {
        entry(error, || {
            let session = handle(session, "session")?;
            let document = text(document, document_length, "document")?;
            session.with(|session| session.set_document(document))
        })
    }
}

/// Writes the document to a file, completely or not at all. If the file is not in the session's folder, a relative
/// footage pattern is rewritten so that it names the same files.
///
/// What another program wrote to the file after this session opened or saved it is not written over: the document goes into a new file beside it, and the
/// call fails with the names of both. A file that this session neither opened nor saved is replaced.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rototoon_session_save(
    session: *const RototoonSession,
    path: *const u8,
    path_length: usize,
    error: *mut *mut RototoonText,
) -> RototoonStatus {
    // SAFETY: the crate's contract.
    unsafe {
        entry(error, || {
            let session = handle(session, "session")?;
            let path = text(path, path_length, "path")?;
            session.with(|session| session.save(Path::new(path)))
        })
    }
}

/// Replaces the footage. `footage` is JSON with the fields of the document's `footage`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rototoon_session_set_footage(
    session: *const RototoonSession,
    footage: *const u8,
    footage_length: usize,
    error: *mut *mut RototoonText,
) -> RototoonStatus {
    // SAFETY: the crate's contract.
    unsafe {
        entry(error, || {
            let session = handle(session, "session")?;
            let footage = text(footage, footage_length, "footage")?;
            session.with(|session| session.set_footage(footage))
        })
    }
}

/// Returns the names of the parts as a JSON list, in the document's order.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rototoon_session_parts(
    session: *const RototoonSession,
    names: *mut *mut RototoonText,
    error: *mut *mut RototoonText,
) -> RototoonStatus {
    // SAFETY: the crate's contract.
    unsafe {
        entry(error, || {
            clear(names, null_mut(), "names")?;
            let session = handle(session, "session")?;
            let value = session.with(|session| Ok(RototoonText::new(session.part_names())))?;
            give(names, value);
            Ok(())
        })
    }
}
