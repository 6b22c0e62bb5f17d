//! The data of an instance: its document, which is read once, and the messages that the user has seen.

use super::edit::Editor;
use super::state::State;
use super::track::Film;
use super::{shared, stored};
use crate::ofx::{Effect, Failure, Parameters};
use rototoon::project::Document;
use std::collections::BTreeSet;
use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::SystemTime;

/// The name of the stored document in messages.
pub const ORIGIN: &str = "the composition's document";
/// Most different messages until the user changes something.
const MOST_NOTES: usize = 20;

/// A stored state: its text, and what it says or why it could not be read.
type ReadState = (String, Result<Arc<State>, String>);

/// The data that an instance keeps between actions.
#[derive(Debug, Default)]
pub struct Instance {
    read: Mutex<Option<Read>>,
    told: Mutex<BTreeSet<String>>,
    state: Mutex<Option<ReadState>>,
    editor: Mutex<Editor>,
    film: Mutex<Option<Arc<Film>>>,
    following: AtomicBool,
    menu: Mutex<Vec<String>>,
}

/// A document, or why it could not be read.
#[derive(Clone, Debug)]
struct Read {
    origin: Origin,
    result: Result<Arc<Document>, String>,
}

/// The origin of a document. Equal origins give equal documents.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub enum Origin {
    /// The text stored in the composition.
    Text(String),
    /// A file with its modification time and size.
    File(String, Option<(SystemTime, u64)>),
}

impl Instance {
    /// The document stored in the composition, or else the project's file. `None` if there is neither.
    pub fn document(&self, parameters: &Parameters) -> Result<Option<Arc<Document>>, Failure> {
        let text = parameters.text(c"document")?;
        let origin = if text.trim().is_empty() {
            let path = parameters.text(c"project")?;
            if path.trim().is_empty() {
                return Ok(None);
            }
            let stamp = std::fs::metadata(&path).and_then(|data| Ok((data.modified()?, data.len()))).ok();
            Origin::File(path, stamp)
        } else {
            Origin::Text(text)
        };
        let mut read = lock(&self.read);
        if read.as_ref().is_none_or(|read| read.origin != origin) {
            let result = shared::document(&origin, || match &origin {
                Origin::Text(text) => stored::decode(text)
                    .map_err(|error| format!("{ORIGIN}: {error}"))
                    .and_then(|json| Document::parse(&json, ORIGIN).map_err(|error| error.to_string())),
                Origin::File(path, _) => Document::load(Path::new(path)).map_err(|error| error.to_string()),
            });
            *read = Some(Read { origin, result });
        }
        match read.as_ref().map(|read| read.result.clone()) {
            Some(Ok(document)) => Ok(Some(document)),
            Some(Err(error)) => Err(Failure::Told(error)),
            None => Ok(None),
        }
    }

    /// The document stored in the composition; `None` if there is none.
    pub fn document_of_text(&self, parameters: &Parameters) -> Result<Option<Arc<Document>>, Failure> {
        if parameters.text(c"document")?.trim().is_empty() { Ok(None) } else { self.document(parameters) }
    }

    /// Drops the document, which can be read again, and the frames.
    pub fn forget(&self) {
        self.keep_film(None);
        *lock(&self.read) = None;
    }

    /// Shows the user a message about the picture, once until the user changes something.
    pub fn note(&self, effect: &Effect, text: &str, error: bool) {
        let new = {
            let mut told = lock(&self.told);
            told.len() < MOST_NOTES && told.insert(text.to_owned())
        };
        if new {
            effect.note(text, error);
        }
    }

    /// The settings of the parts, and what their tracks were made from.
    pub fn state(&self, parameters: &Parameters) -> Result<Arc<State>, Failure> {
        let text = parameters.text(c"state")?;
        let mut read = lock(&self.state);
        let known = read.take().filter(|(known, _)| *known == text);
        let (_, state) = read.insert(known.unwrap_or_else(|| {
            let state = State::parse(&text).map(Arc::new);
            (text, state)
        }));
        state.clone().map_err(Failure::Told)
    }

    /// The selection and the pen's unfinished work.
    pub fn editor(&self) -> MutexGuard<'_, Editor> {
        lock(&self.editor)
    }

    /// The frames that the last Track has left in memory.
    pub fn film(&self) -> Option<Arc<Film>> {
        lock(&self.film).clone()
    }

    /// Keeps frames in memory, or drops them.
    pub fn keep_film(&self, film: Option<Arc<Film>>) {
        *lock(&self.film) = film;
    }

    /// Begins to follow an edit. `None` if an edit is being followed.
    pub fn begin_following(&self) -> Option<Following<'_>> {
        (!self.following.swap(true, Ordering::AcqRel)).then_some(Following(&self.following))
    }

    /// Whether an edit is being followed. A host may send events of the pen while it shows the progress.
    pub fn is_following(&self) -> bool {
        self.following.load(Ordering::Acquire)
    }

    /// Notes the names in the menu of the parts. Returns whether they are others than before.
    pub fn replace_menu(&self, names: &[&str]) -> bool {
        let mut menu = lock(&self.menu);
        let same = menu[..] == *names;
        if !same {
            *menu = names.iter().map(|name| (*name).to_owned()).collect();
        }
        !same
    }

    /// A name in the menu of the parts.
    pub fn menu(&self, index: usize) -> Option<String> {
        lock(&self.menu).get(index).cloned()
    }

    /// Removes the messages, because the user has changed something and they may no longer be true.
    pub fn changed(&self, effect: &Effect) {
        let told = std::mem::take(&mut *lock(&self.told));
        if !told.is_empty() {
            effect.clear_note();
        }
    }
}

/// An edit is being followed until this is dropped.
pub struct Following<'a>(&'a AtomicBool);

impl Drop for Following<'_> {
    fn drop(&mut self) {
        self.0.store(false, Ordering::Release);
    }
}

fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}
