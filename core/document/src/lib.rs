//! The project document: footage, parts, the artist's keys and corrections, and what was found.
//!
//! - [`schema`]: names, order and limits of the fields
//! - [`problem`]: what is wrong with a document, and where
//! - [`shape`]: reading JSON that may hold anything
//! - [`library`]: a folder of skeleton clips with an index
//! - [`load`], [`save`]: documents from and to files
//! - [`validate`]: what a document must hold beyond being well-formed
//! - [`drawings`]: drawings on key frames, pairs, pegs and in-betweens
//! - [`limbs`]: limbs on contours, swapped sides, which part is in front
//! - [`curves`]: files of curves to fit
//! - [`clips`], `plain_clips`: files of skeleton clips, and the quick way to read and write them
//! - [`output`]: files that appear whole or not at all
//!
//! Fields that this version does not know are kept where they stood. A document of a newer major version is refused.

#![forbid(unsafe_code)]

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
