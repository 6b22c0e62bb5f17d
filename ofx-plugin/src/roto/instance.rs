//! The data of an instance: its document, which is read once, and the messages that the user has seen.

use super::edit::Editor;
use super::film::Film;
use super::job::Tracked;
use super::shared::{self, Loaded};
use super::stale::Stale;
use super::state::{FileMark, State};
use super::stored;
use crate::ofx::{Effect, Failure, Parameters};
use rototoon::pipeline::unchanged::Mark;
use rototoon::project::Document;
use rototoon::scene::Part;
use std::path::Path;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::SystemTime;

/// The name of the stored document in messages.
pub const ORIGIN: &str = "the composition's document";
/// What a button says that needs shapes where there are none.
pub const NO_SHAPES: &str = "found no shapes: draw some, or load a project first";
/// Most different messages until the user changes something.
const MOST_NOTES: usize = 20;

/// A message about the picture.
#[derive(Clone, Debug, PartialEq, Eq)]
struct Note {
    text: String,
    error: bool,
}

/// A stored state: its text, and what it says or why it could not be read.
type ReadState = (Arc<str>, Result<Arc<State>, String>);

/// The data that an instance keeps between actions.
#[derive(Debug, Default)]
pub struct Instance {
    read: Mutex<Option<Read>>,
    told: Mutex<Vec<Note>>,
    state: Mutex<Option<ReadState>>,
    editor: Mutex<Editor>,
    film: Mutex<Option<Arc<Film>>>,
    drops: AtomicU64,
    stale: Mutex<Stale>,
    tracking: AtomicBool,
    menu: Mutex<Vec<String>>,
}

/// A document, or why it could not be read.
#[derive(Clone, Debug)]
struct Read {
    origin: Origin,
    /// What the file held.
    mark: Option<Mark>,
    result: Result<Arc<Loaded>, String>,
}

/// The origin of a document. Equal origins give equal documents.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub enum Origin {
    /// The text stored in the composition.
    Text(Arc<str>),
    /// A file with its modification time and size.
    File(String, Option<(SystemTime, u64)>),
}

impl Instance {
    /// The document stored in the composition, or else the project's file. `None` if there is neither.
    pub fn document(&self, parameters: &Parameters) -> Result<Option<Arc<Loaded>>, Failure> {
        let known = lock(&self.read).clone();
        if let Some(Read { origin: Origin::Text(text), result, .. }) = known
            && parameters.is_text(c"document", &text)?
        {
            return result.map(Some).map_err(Failure::Told);
        }
        let text = parameters.text(c"document")?;
        let origin = if text.trim().is_empty() {
            let path = parameters.text(c"project")?;
            if path.trim().is_empty() {
                return Ok(None);
            }
            let stamp = std::fs::metadata(&path).and_then(|data| Ok((data.modified()?, data.len()))).ok();
            Origin::File(path, stamp)
        } else {
            Origin::Text(text.into())
        };
        let mut read = lock(&self.read);
        if read.as_ref().is_none_or(|read| read.origin != origin) {
            // The mark comes first: what is written in between counts as a change.
            let mark = match &origin {
                Origin::Text(_) => None,
                Origin::File(path, _) => Mark::of(Path::new(path)),
            };
            let result = shared::document(&origin, || match &origin {
                Origin::Text(text) => stored::decode(text)
                    .map_err(|error| format!("{ORIGIN}: {error}"))
                    .and_then(|json| Document::parse(&json, ORIGIN).map_err(|error| error.to_string())),
                Origin::File(path, _) => Document::load(Path::new(path)).map_err(|error| error.to_string()),
            });
            *read = Some(Read { origin, mark, result });
        }
        match read.as_ref().map(|read| read.result.clone()) {
            Some(Ok(document)) => Ok(Some(document)),
            Some(Err(error)) => Err(Failure::Told(error)),
            None => Ok(None),
        }
    }

    /// The document stored in the composition; `None` if there is none.
    pub fn document_of_text(&self, parameters: &Parameters) -> Result<Option<Arc<Loaded>>, Failure> {
        if parameters.is_blank(c"document")? { Ok(None) } else { self.document(parameters) }
    }

    /// The project's file as it was read, where the composition has no document of its own.
    pub fn shown_file(&self, parameters: &Parameters) -> Result<Option<FileMark>, Failure> {
        let project = parameters.text(c"project")?;
        Ok(match lock(&self.read).as_ref() {
            Some(Read { origin: Origin::File(path, _), mark: Some(mark), result: Ok(_) }) if *path == project => {
                Some(FileMark { path: project, mark: mark.to_string() })
            }
            _ => None,
        })
    }

    /// Drops the document, which can be read again, and the frames.
    pub fn forget(&self) {
        self.drop_frames();
        *lock(&self.read) = None;
    }

    /// Shows the user a message about the picture, beside those that stand already, until the user changes something.
    pub fn note(&self, effect: &Effect, text: &str, error: bool) {
        let mut told = {
            let mut told = lock(&self.told);
            if told.len() >= MOST_NOTES || told.iter().any(|note| note.text == text) {
                return;
            }
            told.push(Note { text: text.to_owned(), error });
            told.clone()
        };
        // A host may draw while it shows a message, so the lock is open. What was noted meanwhile is shown by whoever comes last.
        loop {
            let first = told.iter().filter(|note| note.error);
            let all: Vec<&str> = first.chain(told.iter().filter(|note| !note.error)).map(|note| &*note.text).collect();
            effect.note(&all.join("; "), text, told.iter().any(|note| note.error));
            let now = lock(&self.told).clone();
            if now.len() <= told.len() {
                break;
            }
            told = now;
        }
    }

    /// The settings of the parts, and what their tracks were made from.
    pub fn state(&self, parameters: &Parameters) -> Result<Arc<State>, Failure> {
        let known = lock(&self.state).clone();
        if let Some((text, state)) = known
            && parameters.is_text(c"state", &text)?
        {
            return state.map_err(Failure::Told);
        }
        let text = parameters.text(c"state")?;
        let state = State::parse(&text).map(Arc::new);
        *lock(&self.state) = Some((text.into(), state.clone()));
        state.map_err(Failure::Told)
    }

    /// The selection and the pen's unfinished work.
    pub fn editor(&self) -> MutexGuard<'_, Editor> {
        lock(&self.editor)
    }

    /// The frames that the last Track has left in memory.
    pub fn film(&self) -> Option<Arc<Film>> {
        lock(&self.film).clone()
    }

    /// Drops the frames in memory. Returns the number of times that this was done.
    pub fn drop_frames(&self) -> u64 {
        *lock(&self.film) = None;
        self.drops.fetch_add(1, Ordering::AcqRel) + 1
    }

    /// Keeps frames in memory, unless frames were dropped since that many times: then they may be old already.
    pub fn keep_frames(&self, film: Film, drops: u64) {
        if self.drops.load(Ordering::Acquire) == drops {
            *lock(&self.film) = Some(Arc::new(film));
        }
    }

    /// Drops a film whose source has changed, unless it was dropped before, and notes that the tracks of these parts are old.
    /// Returns whether it was dropped now.
    pub fn drop_film(&self, film: &Arc<Film>, parts: &[Part]) -> bool {
        let mut kept = lock(&self.film);
        let ours = kept.as_ref().is_some_and(|kept| Arc::ptr_eq(kept, film));
        if ours {
            *kept = None;
            lock(&self.stale).add(parts);
        }
        ours
    }

    /// The tracks that were made from a source that has changed since.
    pub fn stale(&self) -> Stale {
        lock(&self.stale).clone()
    }

    /// Notes that what was tracked is made from the source as it is now. `before` are the parts as they were. Other tracks
    /// of a part may still be made from what the source was.
    pub fn replace_stale(&self, before: &[Part], tracked: &Tracked) {
        let mut stale = lock(&self.stale);
        for &index in &tracked.parts {
            let part = &tracked.document.scene.parts[index];
            let is_whole = part.tracks.keys().all(|frame| tracked.has(&[*frame; 2]));
            if !is_whole && stale.has(&before[index]) {
                stale.add([part]);
            } else {
                stale.remove([part]);
            }
        }
    }

    /// Begins to track, or to follow an edit. `None` if the tracker is at work already.
    pub fn begin_tracking(&self) -> Option<Busy<'_>> {
        (!self.tracking.swap(true, Ordering::AcqRel)).then_some(Busy(&self.tracking))
    }

    /// Whether the tracker is at work. A host may send events while it shows the progress.
    pub fn is_tracking(&self) -> bool {
        self.tracking.load(Ordering::Acquire)
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

/// The tracker is at work until this is dropped.
pub struct Busy<'a>(&'a AtomicBool);

impl Drop for Busy<'_> {
    fn drop(&mut self) {
        self.0.store(false, Ordering::Release);
    }
}

fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}
