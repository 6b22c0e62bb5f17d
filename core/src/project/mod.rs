//! The project document: footage, parts, the artist's keys and corrections, and the results.
//!
//! - [`schema`]: names, order and limits of the fields
//! - [`problem`]: problems of a document, with their places
//! - [`shape`]: a reader for JSON of any content
//! - [`library`]: a folder of skeleton clips with an index
//! - [`load`], [`save`]: reading and writing of documents
//! - [`validate`]: conditions for a document beyond its syntax
//! - [`drawings`]: drawings on key frames, pairs, pegs and in-betweens
//! - [`limbs`]: limbs on contours, swapped sides, order in depth
//! - [`curves`]: files of curves to fit
//! - [`clips`], `plain_clips`: files of skeleton clips, and the fast way to read and write them
//! - [`output`]: files that are written completely or not at all
//!
//! Fields that this version does not know keep their values and places. A document of a newer major version is
//! rejected.

pub mod clips;
pub mod curves;
pub mod drawings;
mod fields;
pub mod library;
pub mod limbs;
pub mod load;
pub mod output;
mod plain_clips;
pub mod problem;
pub mod save;
pub mod schema;
mod shape;
pub mod validate;

pub use fields::FieldError;
pub use load::LoadError;
pub use output::{WriteError, write_whole};
pub use problem::{Problem, Problems, Severity};
pub use save::SaveError;

use crate::scene::Scene;

/// A project document: the scene, and the fields that this version does not know.
#[derive(Clone, Debug, PartialEq)]
pub struct Document {
    /// Footage and parts.
    pub scene: Scene,
    layout: schema::Layout,
}

impl Document {
    /// A new document with a scene.
    pub fn new(scene: Scene) -> Self {
        Self { scene, layout: schema::Layout::default() }
    }

    /// All problems of the present scene.
    pub fn problems(&self) -> Problems {
        validate::problems(&self.scene)
    }
}
