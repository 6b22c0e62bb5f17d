//! Errors of a file of shapes, with their places.

use roxmltree::{Document, Node, ParsingOptions};
use std::fmt;

/// A place in a text file.
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

/// Why shapes cannot be read.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum ImportError {
    /// The file is not XML.
    #[error("found text that is not XML, expected XML: {0}")]
    Syntax(String),
    /// An element is invalid.
    #[error("{place}: <{element}>: {message}")]
    Element {
        /// The place where the element begins.
        place: Place,
        /// Name of the element.
        element: String,
        /// The found and the expected value.
        message: String,
    },
    /// The file contains no shape.
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

/// The place where an element begins.
pub(super) fn place(node: Node) -> Place {
    let position = node.document().text_pos_at(node.range().start);
    Place { line: position.row, column: position.col }
}

/// Parses a text. Document type declarations are allowed, since drawing programs write them.
pub(super) fn parsed(text: &str) -> Result<Document<'_>, ImportError> {
    let options = ParsingOptions { allow_dtd: true, ..ParsingOptions::default() };
    Document::parse_with_options(text, options).map_err(|error| ImportError::Syntax(error.to_string()))
}

/// The number in an attribute; `None` if the attribute is missing.
pub(super) fn number(node: Node, name: &str) -> Result<Option<f64>, ImportError> {
    let Some(text) = node.attribute(name) else { return Ok(None) };
    match text.trim().parse::<f64>() {
        Ok(value) if value.is_finite() => Ok(Some(value)),
        _ => Err(ImportError::at(node, format!("{name}: found {text:?}, expected a number"))),
    }
}
