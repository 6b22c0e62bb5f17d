//! Documents that instances share.
//!
//! Hosts clone instances for renders, previews and copies of a node. All of them have the same document, which is parsed
//! once. A document is kept as long as an instance uses it.

use super::instance::Origin;
use rototoon::pipeline::Cels;
use rototoon::project::Document;
use std::collections::HashMap;
use std::collections::hash_map::DefaultHasher;
use std::hash::{Hash, Hasher};
use std::ops::Deref;
use std::sync::{Arc, Mutex, OnceLock, PoisonError, Weak};

/// A document, and what is painted and drawn in it, which is read when it is first shown.
#[derive(Debug)]
pub struct Loaded {
    document: Document,
    regions: OnceLock<Result<Cels, String>>,
    strokes: OnceLock<Result<Cels, String>>,
}

impl Loaded {
    /// A document of which nothing is shown yet.
    pub fn new(document: Document) -> Self {
        Self { document, regions: OnceLock::new(), strokes: OnceLock::new() }
    }

    /// The painted regions of all frames. The error is a message for the user.
    pub fn regions(&self) -> Result<&Cels, &String> {
        self.regions.get_or_init(|| Cels::regions(&self.document).map_err(|error| error.to_string())).as_ref()
    }

    /// The strokes of all frames. The error is a message for the user.
    pub fn strokes(&self) -> Result<&Cels, &String> {
        self.strokes.get_or_init(|| Cels::strokes(&self.document).map_err(|error| error.to_string())).as_ref()
    }
}

impl Deref for Loaded {
    type Target = Document;

    fn deref(&self) -> &Document {
        &self.document
    }
}

/// Documents by the sum of their origin.
type Known = HashMap<u64, (Origin, Weak<Loaded>)>;

static KNOWN: Mutex<Option<Known>> = Mutex::new(None);

/// The document of an origin, which `read` reads unless an instance has it already.
pub fn document(origin: &Origin, read: impl FnOnce() -> Result<Document, String>) -> Result<Arc<Loaded>, String> {
    let mut hasher = DefaultHasher::new();
    origin.hash(&mut hasher);
    let sum = hasher.finish();
    let known = || KNOWN.lock().unwrap_or_else(PoisonError::into_inner);
    let found = known().as_ref().and_then(|known| known.get(&sum)).and_then(|(own, document)| {
        // Two origins may have one sum.
        if own == origin { document.upgrade() } else { None }
    });
    if let Some(found) = found {
        return Ok(found);
    }
    // The lock is open while the document is read, so that other instances need not wait.
    let document = Arc::new(Loaded::new(read()?));
    let mut known = known();
    let known = known.get_or_insert_default();
    known.retain(|_, (_, document)| document.strong_count() > 0);
    known.insert(sum, (origin.clone(), Arc::downgrade(&document)));
    Ok(document)
}

#[cfg(test)]
mod tests {
    use super::*;
    use rototoon::scene::{Footage, Scene};

    #[test]
    fn a_document_in_use_is_read_once() {
        let footage =
            Footage { pattern: "%d.png".into(), first: 0, last: 1, fps: 24.0, width: 4, height: 4, held: false };
        let read = || Ok(Document::new(Scene { footage: footage.clone(), parts: Vec::new() }));
        let origin = Origin::Text("a document that only this test has".into());
        let first = document(&origin, read).unwrap();
        let second = document(&origin, || Err("read again".into())).unwrap();
        assert!(Arc::ptr_eq(&first, &second));
        drop((first, second));
        assert_eq!(document(&origin, || Err("read again".into())).unwrap_err(), "read again");
    }
}
