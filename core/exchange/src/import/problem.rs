//! What is wrong with a file of shapes, and where.

use roxmltree::{Document, Node, ParsingOptions};
use std::fmt;

/// Where something stands in a text file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Place {
    /// Line, from 1.
    pub line: u32,
    /// Column, from 1.
    pub column: u32,
}

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "line {}, column {}", self.line, self.column)
    }
}

/// Why shapes could not be read.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum ImportError {
    /// The file is no XML.
    #[error("it is no XML: {0}")]
    Syntax(String),
    /// An element is not as it must be.
    #[error("{place}: <{element}>: {message}")]
    Element {
        /// Where it begins.
        place: Place,
        /// Its name.
        element: String,
        /// What was found and what was expected.
        message: String,
    },
    /// There is nothing to import.
    #[error("found no shape, expected {0}")]
    Nothing(&'static str),
}

impl ImportError {
    /// An error at an element.
    pub(super) fn at(node: Node, message: impl Into<String>) -> Self {
        let element = node.tag_name().name().to_owned();
        Self::Element { place: place(node), element, message: message.into() }
    }
}

/// Where an element begins.
pub(super) fn place(node: Node) -> Place {
    let position = node.document().text_pos_at(node.range().start);
    Place { line: position.row, column: position.col }
}

/// The document of a text. Declarations of a document type, as drawing programs write them, are allowed.
pub(super) fn parsed(text: &str) -> Result<Document<'_>, ImportError> {
    let options = ParsingOptions { allow_dtd: true, ..ParsingOptions::default() };
    Document::parse_with_options(text, options).map_err(|error| ImportError::Syntax(error.to_string()))
}

/// An attribute's number.
pub(super) fn number(node: Node, name: &str) -> Result<Option<f64>, ImportError> {
    let Some(text) = node.attribute(name) else { return Ok(None) };
    match text.trim().parse::<f64>() {
        Ok(value) if value.is_finite() => Ok(Some(value)),
        _ => Err(ImportError::at(node, format!("{name}: found {text:?}, expected a number"))),
    }
}
