//! Splits a Nuke script into words and lists.
//!
//! A script is lines of Tcl. What matters here are its lists: words in braces, with lists in them. A word in quotation marks
//! may contain blanks. As in Tcl, a quotation begins only where a word does, a backslash makes the next character a plain one, and a line
//! that begins with `#` is a comment. Labels and Python of a script are full of such marks.

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
            b'#' if open.len() == 1 && begins_line(&bytes[..at]) => {
                at += bytes[at..].iter().position(|byte| *byte == b'\n').unwrap_or(bytes.len() - at);
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
                let (word, end) = word(text, start, open.len() > 1)?;
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

/// Whether only blanks stand before a byte on its line.
fn begins_line(before: &[u8]) -> bool {
    before.iter().rev().find(|byte| !matches!(byte, b' ' | b'\t')).is_none_or(|byte| b"\n\r".contains(byte))
}

/// The word that begins at a byte, without its quotation marks, and the byte after it. A quotation mark that nothing closes is a letter within
/// braces, where Tcl reads plain text.
fn word(text: &str, start: usize, within_braces: bool) -> Result<(&str, usize), ImportError> {
    let bytes = text.as_bytes();
    if bytes[start] == b'"' {
        let end = unescaped(bytes, start + 1, |byte| byte == b'"');
        if end < bytes.len() {
            return Ok((&text[start + 1..end], end + 1));
        }
        if !within_braces {
            return Err(wrong(text, start, "word", "found no closing quotation mark without a backslash before it"));
        }
    }
    let end = unescaped(bytes, start, |byte| byte.is_ascii_whitespace() || b"{}".contains(&byte));
    Ok((&text[start..end], end))
}

/// The first byte from `at` on that is asked for and has no backslash before it; the end if there is none.
fn unescaped(bytes: &[u8], mut at: usize, is_asked: impl Fn(u8) -> bool) -> usize {
    while at < bytes.len() && !is_asked(bytes[at]) {
        at += if bytes[at] == b'\\' { 2 } else { 1 };
    }
    at.min(bytes.len())
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
            ("a \"b\\\"", "line 1, column 3", "without a backslash before it"),
        ] {
            let error = items(text).unwrap_err().to_string();
            assert!(error.contains(place) && error.contains(message), "{error}");
        }
        let deep = "{".repeat(1000);
        assert!(items(&deep).unwrap_err().to_string().contains("nested"));
    }

    #[test]
    fn marks_in_texts_are_letters() {
        let words = |text| {
            let mut found = Vec::new();
            fn walk<'a>(items: &[Item<'a>], found: &mut Vec<&'a str>) {
                for item in items {
                    found.extend(item.word());
                    walk(item.items(), found);
                }
            }
            walk(&items(text).unwrap(), &mut found);
            found
        };
        assert_eq!(words(r#"label "5\" board" name a"#), ["label", r#"5\" board"#, "name", "a"]);
        assert_eq!(words(r#"knob "d = \{\"a\": \}" b"#), ["knob", r#"d = \{\"a\": \}"#, "b"]);
        assert_eq!(words(r#"label \{hello b\ c \" d"#), ["label", r"\{hello", r"b\ c", r#"\""#, "d"]);
        assert_eq!(words(r#"label {5" board} b"#), ["label", r#"5""#, "board", "b"]);
        assert_eq!(words("{ \"a} b"), ["\"a", "b"]);
        assert_eq!(words("a\n # it's {5\" \nb # {c}"), ["a", "b", "#", "c"]);
        assert_eq!(words("#! /usr/Nuke\na"), ["a"]);
        assert_eq!(words("größe\\"), ["größe\\"]);
    }
}
