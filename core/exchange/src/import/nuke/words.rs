//! Splits a Nuke script into words and lists.
//!
//! A script is lines of Tcl. What matters here are its lists: words in braces, with lists in them. A word in quotation marks
//! may contain blanks.

use super::super::limits::{DEEPEST, MOST_NODES};
use super::super::{ImportError, Place};

/// A word or a list of a script, with the place where it begins.
#[derive(Clone, Debug, PartialEq)]
pub struct Item<'a> {
    /// Byte at which it begins.
    pub start: usize,
    /// What it is.
    pub kind: Kind<'a>,
}

/// What an item is.
#[derive(Clone, Debug, PartialEq)]
pub enum Kind<'a> {
    /// A word without its quotation marks.
    Word(&'a str),
    /// The items in braces.
    List(Vec<Item<'a>>),
}

impl<'a> Item<'a> {
    /// The word; `None` for a list.
    pub fn word(&self) -> Option<&'a str> {
        match self.kind {
            Kind::Word(word) => Some(word),
            Kind::List(_) => None,
        }
    }

    /// The items of a list; none for a word.
    pub fn items(&self) -> &[Self] {
        match &self.kind {
            Kind::Word(_) => &[],
            Kind::List(items) => items,
        }
    }

    /// The first word of a list, which names it.
    pub fn name(&self) -> Option<&'a str> {
        self.items().first().and_then(Self::word)
    }
}

/// The place of a byte in a text.
pub fn place(text: &str, start: usize) -> Place {
    let before = &text[..start.min(text.len())];
    let line = before.bytes().filter(|byte| *byte == b'\n').count() as u32 + 1;
    let column = before.rsplit('\n').next().map_or(0, |last| last.chars().count()) as u32 + 1;
    Place { line, column }
}

/// An error at a byte of a text.
pub fn wrong(text: &str, start: usize, element: &str, message: impl Into<String>) -> ImportError {
    ImportError::Element { place: place(text, start), element: element.to_owned(), message: message.into() }
}

/// The items of a script.
pub fn items(text: &str) -> Result<Vec<Item<'_>>, ImportError> {
    let bytes = text.as_bytes();
    // The open lists with their starts; the script itself is the first.
    let mut open: Vec<(usize, Vec<Item>)> = vec![(0, Vec::new())];
    let (mut at, mut count) = (0, 0u32);
    while at < bytes.len() {
        let start = at;
        let item = match bytes[at] {
            byte if byte.is_ascii_whitespace() || byte == b';' => {
                at += 1;
                continue;
            }
            b'{' => {
                if open.len() > DEEPEST {
                    let message = format!("found lists nested {} deep, expected at most {DEEPEST}", open.len());
                    return Err(wrong(text, start, "list", message));
                }
                open.push((start, Vec::new()));
                at += 1;
                continue;
            }
            b'}' => {
                let Some((from, list)) = open.pop().filter(|_| !open.is_empty()) else {
                    return Err(wrong(text, start, "list", "found a closing brace without an opening one"));
                };
                at += 1;
                Item { start: from, kind: Kind::List(list) }
            }
            _ => {
                let (word, end) = word(text, start)?;
                at = end;
                Item { start, kind: Kind::Word(word) }
            }
        };
        if let Some((_, list)) = open.last_mut() {
            list.push(item);
        }
        count += 1;
        if count > MOST_NODES {
            return Err(ImportError::Large(MOST_NODES));
        }
    }
    match open.pop() {
        Some((_, items)) if open.is_empty() => Ok(items),
        Some((start, _)) => Err(wrong(text, start, "list", "found no closing brace")),
        None => Ok(Vec::new()),
    }
}

/// The word that begins at a byte, without its quotation marks, and the byte after it.
fn word(text: &str, start: usize) -> Result<(&str, usize), ImportError> {
    if let Some(quoted) = text[start..].strip_prefix('"') {
        let length = quoted.find('"').ok_or_else(|| wrong(text, start, "word", "found no closing quotation mark"))?;
        return Ok((&quoted[..length], start + 1 + length + 1));
    }
    let ends = |byte: &u8| byte.is_ascii_whitespace() || b"{}\"".contains(byte);
    let length = text.as_bytes()[start..].iter().position(ends).unwrap_or(text.len() - start);
    Ok((&text[start..start + length], start + length))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_and_lists() {
        let found = items("Roto {\n inputs 0\n name \"a b\" {x {y}}}").unwrap();
        assert_eq!(found[0].word(), Some("Roto"));
        let list = found[1].items();
        assert_eq!((list[3].word(), list[4].name()), (Some("a b"), Some("x")));
        assert_eq!(list[4].items()[1].name(), Some("y"));
        for (text, place, message) in [
            ("a }", "line 1, column 3", "without an opening"),
            ("a\n {b", "line 2, column 2", "no closing brace"),
            ("\"a", "line 1, column 1", "no closing quotation mark"),
        ] {
            let error = items(text).unwrap_err().to_string();
            assert!(error.contains(place) && error.contains(message), "{error}");
        }
        let deep = "{".repeat(1000);
        assert!(items(&deep).unwrap_err().to_string().contains("nested"));
    }
}
