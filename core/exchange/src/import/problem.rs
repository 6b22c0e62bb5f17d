//! Errors of a file of shapes, with their places.

use super::limits;
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
    /// The file is too large.
    #[error("found more than {0} elements and texts, expected fewer")]
    Large(u32),
    /// The shapes have too many points on all frames on which they are shown.
    #[error(
        "found more than {0} points of shapes on all frames on which they are shown, expected fewer: import fewer shapes, or into a document of fewer frames"
    )]
    Shown(usize),
    /// All keys of the file lie beyond the footage. The error is that of its first shape.
    #[error("{0}")]
    Beyond(Box<Self>),
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

/// Why there is no shape.
pub(super) enum Fault {
    /// The shape is left out; the reason follows "the shape … is left out: ".
    Omitted(String),
    /// The file is wrong.
    Wrong(ImportError),
}

impl From<ImportError> for Fault {
    fn from(error: ImportError) -> Self {
        Self::Wrong(error)
    }
}

/// The place where an element begins.
pub(super) fn place(node: Node) -> Place {
    let position = node.document().text_pos_at(node.range().start);
    Place { line: position.row, column: position.col }
}

/// Elements that are left out, with the reasons.
#[derive(Clone, Debug, Default)]
pub(super) struct LeftOut(Vec<(usize, String)>);

impl LeftOut {
    pub(super) fn push(&mut self, node: Node, reason: String) {
        self.push_at(node.range().start, reason);
    }

    /// Adds what begins at a byte of the text.
    pub(super) fn push_at(&mut self, start: usize, reason: String) {
        self.0.push((start, reason));
    }

    /// A line for each element, with its place in the text. All places are found in one pass over the text, since a
    /// file may have any number of such elements.
    pub(super) fn lines(mut self, text: &str) -> Vec<String> {
        self.0.sort_by_key(|(start, _)| *start);
        let (mut at, mut place) = (0, Place { line: 1, column: 1 });
        let line = |(start, reason): (usize, String)| {
            for c in text[at..start].chars() {
                let ends = c == '\n';
                place.line += u32::from(ends);
                place.column = if ends { 1 } else { place.column + 1 };
            }
            at = start;
            format!("{place}: {reason}")
        };
        self.0.into_iter().map(line).collect()
    }
}

/// Parses a text, and requires that it keeps the [`limits`]. Document type declarations are allowed,
/// since drawing programs write them. The parser itself refuses entities that grow without end.
pub(super) fn parsed(text: &str) -> Result<Document<'_>, ImportError> {
    let options = ParsingOptions { allow_dtd: true, nodes_limit: limits::MOST_NODES, ..ParsingOptions::default() };
    let document = Document::parse_with_options(text, options).map_err(|error| match error {
        roxmltree::Error::NodesLimitReached => ImportError::Large(limits::MOST_NODES),
        other => ImportError::Syntax(other.to_string()),
    })?;
    limits::shallow(&document)?;
    Ok(document)
}

/// An attribute as a message quotes it.
pub(super) fn quoted(text: Option<&str>) -> String {
    match text.map(|text| (text, text.char_indices().nth(QUOTED))) {
        None => "nothing".into(),
        Some((text, Some((end, _)))) => format!("{:?}", format!("{}…", &text[..end])),
        Some((text, None)) => format!("{text:?}"),
    }
}

/// Texts as a message lists them.
pub(super) fn listed(texts: &[String]) -> String {
    let first: Vec<String> = texts.iter().take(LISTED).map(|text| quoted(Some(text))).collect();
    let more = texts.len().saturating_sub(LISTED);
    first.join(", ") + &if more > 0 { format!(" and {more} more") } else { String::new() }
}

/// Greatest number of texts of a list.
const LISTED: usize = 5;
/// Greatest number of characters of a quotation.
const QUOTED: usize = 40;

/// The number in an attribute; `None` if the attribute is missing.
pub(super) fn number(node: Node, name: &str) -> Result<Option<f64>, ImportError> {
    let Some(text) = node.attribute(name) else { return Ok(None) };
    match text.trim().parse::<f64>() {
        Ok(value) if value.is_finite() => Ok(Some(value)),
        _ => Err(ImportError::at(node, format!("{name}: found {}, expected a number", quoted(Some(text))))),
    }
}
