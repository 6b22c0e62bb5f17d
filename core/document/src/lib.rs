//! The project document: footage, parts, the artist's keys and corrections, and what was found.
//!
//! This crate reads, checks and writes Rototoon's own files: documents, files of curves, and the clip library. The stages
//! compute the results. `rototoon-exchange` handles the files of other programs.
//!
//! - [`schema`]: names, order and limits of the fields
//! - [`problem`]: what is wrong with a document, and where
//! - `shape`: reading JSON that may hold anything
//! - [`library`]: a folder of skeleton clips with an index
//! - [`load`], [`save`]: documents from and to files
//! - `direction`: keys that were drawn in the other direction; `unknown`: fields with almost the name of a known one
//! - [`validate`]: what a document must hold beyond being well-formed
//! - [`conform`]: a document moved to new footage
//! - [`drawings`]: drawings on key frames, pairs, pegs and in-betweens
//! - [`traced`]: strokes that tracing found on every frame
//! - [`fills`]: clicks of a painter, and the painted regions of every frame
//! - [`recolours`]: colours of paint that become others from a drawing on
//! - [`seen`]: which pictures results were made of
//! - `reshaped`: which keys reshaping made
//! - [`limbs`]: limbs on contours, swapped sides, which part is in front
//! - [`skeleton`]: which body the limbs or clips are of
//! - [`curves`]: files of curves to fit
//! - [`clips`], `plain_clips`: files of skeleton clips, and the quick way to read and write them
//! - [`output`]: files that appear whole or not at all
//! - [`path`]: paths as documents hold them
//! - [`unfinished`]: temporary files, and their removal when the process ends early
//!
//! Fields that this version does not know are kept where they stood. A document of a newer major version is refused.
//!
//! # Example
//!
//! A document that cannot be used is refused with all of its problems. What other tools noted in a document survives.
//!
//! ```
//! use rototoon_document::{Document, LoadError};
//!
//! let footage = r#""footage": {"pattern": "%04d.png", "first": 1, "last": 9, "fps": 24, "width": 640, "height": 360}"#;
//! let part = r#"{"name": "arm", "keys": {"1": [[10, 10], [40, 20]], "99": [[10, 10]]}}"#;
//! let error = Document::parse(&format!(r#"{{"rototoon": 1, {footage}, "parts": [{part}]}}"#), "shot.json").unwrap_err();
//! let LoadError::Invalid { problems, .. } = &error else { panic!("{error}") };
//! assert_eq!(problems.error_count(), 2, "a frame outside the footage, and a key with another number of points");
//! assert!(problems.errors().all(|problem| problem.place.starts_with(r#"parts[0] "arm".keys."99""#)), "{problems}");
//!
//! let text = format!(r#"{{"rototoon": 1, {footage}, "note": "retake", "parts": []}}"#);
//! let document = Document::parse(&text, "shot.json")?;
//! let folder = tempfile::tempdir()?;
//! let path = folder.path().join("shot.json");
//! document.save(&path)?;
//! assert_eq!(Document::load(&path)?, document);
//! assert!(std::fs::read_to_string(&path)?.contains(r#""note": "retake""#));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

#![forbid(unsafe_code)]

pub mod clips;
pub mod conform;
pub mod curves;
mod direction;
mod doubled;
pub mod drawings;
mod fields;
pub mod fills;
pub mod inputs;
mod kept;
pub mod library;
pub mod limbs;
mod line;
pub mod load;
mod looks;
pub mod output;
pub mod path;
pub mod place;
mod plain_clips;
pub mod problem;
pub mod recolours;
mod reshaped;
mod rights;
pub mod save;
pub mod schema;
pub mod seen;
mod shape;
pub mod skeleton;
pub mod traced;
pub mod unfinished;
mod unknown;
pub mod validate;

pub use fields::{FieldError, described};
pub use inputs::{Inputs, OverwritesInput, is_same_file};
pub use load::LoadError;
pub use output::{WriteError, write_unflushed, write_whole, write_whole_unless};
pub use problem::{Problem, Problems, Severity};
pub use save::SaveError;

use rototoon_base::scene::Scene;

/// A project document: the scene, and the fields that this version does not know.
#[derive(Clone, Debug, PartialEq)]
pub struct Document {
    /// Footage and parts.
    pub scene: Scene,
    layout: schema::Layout,
}

impl Document {
    /// A new document of a scene.
    pub fn new(scene: Scene) -> Self {
        Self { scene, layout: schema::Layout::default() }
    }

    /// Everything that is wrong with the scene as it is now.
    pub fn problems(&self) -> Problems {
        validate::problems(&self.scene)
    }
}
