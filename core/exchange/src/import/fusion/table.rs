//! The tables of a Fusion file.
//!
//! A file of Fusion is Lua, but what it saves is data: numbers, texts, truths, and tables, before which the name of a kind may
//! stand (`Input { … }`, `ordered() { … }`). This module reads these and nothing else. Nothing is run.

use super::super::ImportError;
use super::super::limits::{DEEPEST, MOST_NODES};
use super::super::nuke::{place, wrong};

/// A value with the place where it begins.
#[derive(Clone, Debug, PartialEq)]
pub struct Value<'a> {
    /// Byte at which it begins.
    pub start: usize,
    /// What it is.
    pub kind: Kind<'a>,
}

/// What a value is.
#[derive(Clone, Debug, PartialEq)]
pub enum Kind<'a> {
    /// A number.
    Number(f64),
    /// A text between quotation marks as it stands in the file, or a word.
    Text(&'a str),
    /// `true` or `false`.
    Truth(bool),
    /// A table, with the word before it.
    Table(&'a str, Vec<(Name<'a>, Value<'a>)>),
}

/// The name of a value in its table.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Name<'a> {
    /// `word = …` or `["word"] = …`
    Word(&'a str),
    /// `[number] = …`
    Number(f64),
    /// None.
    None,
}

impl<'a> Value<'a> {
    /// The values of a table; none for others.
    pub fn fields(&self) -> &[(Name<'a>, Self)] {
        match &self.kind {
            Kind::Table(_, fields) => fields,
            _ => &[],
        }
    }

    /// The word before a table; empty for others.
    pub fn word(&self) -> &'a str {
        match self.kind {
            Kind::Table(word, _) => word,
            _ => "",
        }
    }

    /// The value of this name in a table.
    pub fn get(&self, name: &str) -> Option<&Self> {
        self.fields().iter().find(|(own, _)| *own == Name::Word(name)).map(|(_, value)| value)
    }

    /// The values without a name.
    pub fn listed(&self) -> impl Iterator<Item = &Self> + '_ {
        self.fields().iter().filter(|(name, _)| *name == Name::None).map(|(_, value)| value)
    }

    /// The number; `None` for others.
    pub fn number(&self) -> Option<f64> {
        match self.kind {
            Kind::Number(number) => Some(number),
            _ => None,
        }
    }

    /// The text; `None` for others.
    pub fn text(&self) -> Option<&'a str> {
        match self.kind {
            Kind::Text(text) => Some(text),
            _ => None,
        }
    }

    /// Whether it is `true`.
    pub fn is_true(&self) -> bool {
        self.kind == Kind::Truth(true)
    }
}

/// Reads the value that a file is. A word and `=` before it, as in `return` or `Composition`, count to it.
pub fn value(text: &str) -> Result<Value<'_>, ImportError> {
    // A mark of its encoding may stand before the text.
    let at = if text.starts_with('\u{feff}') { '\u{feff}'.len_utf8() } else { 0 };
    let mut reader = Reader { text, at, count: 0 };
    let value = reader.value(0)?;
    reader.skip();
    match reader.peek() {
        None => Ok(value),
        Some(_) => Err(reader.wrong(reader.at, "found more text after the table, expected its end")),
    }
}

struct Reader<'a> {
    text: &'a str,
    at: usize,
    count: u32,
}

impl<'a> Reader<'a> {
    fn wrong(&self, at: usize, message: impl Into<String>) -> ImportError {
        wrong(self.text, at, "table", message)
    }

    fn peek(&self) -> Option<u8> {
        self.text.as_bytes().get(self.at).copied()
    }

    /// Goes past blanks and comments.
    fn skip(&mut self) {
        while let Some(byte) = self.peek() {
            if byte.is_ascii_whitespace() {
                self.at += 1;
            } else if self.text[self.at..].starts_with("--") {
                let end = match self.opens_long(self.at + 2) {
                    Some([begin, level]) => self.end_of_long(begin, level).map(|end| end + level + 2),
                    None => self.text[self.at..].find('\n').map(|end| self.at + end),
                };
                self.at = end.unwrap_or(self.text.len());
            } else {
                return;
            }
        }
    }

    /// Where a text in long brackets, `[[…]]` or `[=[…]=]`, has its first letter if one begins at a byte, and the number of its signs.
    fn opens_long(&self, start: usize) -> Option<[usize; 2]> {
        let inner = self.text.get(start..)?.strip_prefix('[')?;
        let level = inner.bytes().take_while(|byte| *byte == b'=').count();
        inner[level..].starts_with('[').then_some([start + level + 2, level])
    }

    /// The byte after the last letter of such a text.
    fn end_of_long(&self, begin: usize, level: usize) -> Option<usize> {
        Some(begin + self.text[begin..].find(&format!("]{}]", "=".repeat(level)))?)
    }

    fn long(&mut self) -> Result<&'a str, ImportError> {
        let start = self.at;
        let found =
            self.opens_long(start).and_then(|[begin, level]| Some([begin, self.end_of_long(begin, level)?, level]));
        let Some([begin, end, level]) = found else {
            return Err(self.wrong(start, "found a text without its end, expected closing brackets"));
        };
        self.at = end + level + 2;
        Ok(&self.text[begin..end])
    }

    /// Goes past a sign if it is next.
    fn takes(&mut self, sign: u8) -> bool {
        self.skip();
        let is = self.peek() == Some(sign);
        self.at += usize::from(is);
        is
    }

    fn value(&mut self, depth: usize) -> Result<Value<'a>, ImportError> {
        self.skip();
        let start = self.at;
        self.count += 1;
        if self.count > MOST_NODES {
            return Err(ImportError::Large(MOST_NODES));
        }
        let kind = match self.peek() {
            Some(b'{') => self.table("", depth)?,
            Some(quote @ (b'"' | b'\'')) => Kind::Text(self.quoted(quote)?),
            Some(b'[') if self.opens_long(start).is_some() => Kind::Text(self.long()?),
            Some(byte) if byte.is_ascii_digit() || matches!(byte, b'-' | b'+' | b'.') => self.numeric()?,
            Some(byte) if byte.is_ascii_alphabetic() || byte == b'_' => match self.identifier() {
                "true" => Kind::Truth(true),
                "false" => Kind::Truth(false),
                word => self.called(word, depth)?,
            },
            found => {
                let found = found.map_or_else(|| "the end".to_owned(), |_| format!("{:?}", self.next_char()));
                return Err(self.wrong(start, format!("found {found}, expected a number, a text or a table")));
            }
        };
        Ok(Value { start, kind })
    }

    fn next_char(&self) -> char {
        self.text[self.at..].chars().next().unwrap_or_default()
    }

    /// What follows a word: a table, or nothing.
    fn called(&mut self, word: &'a str, depth: usize) -> Result<Kind<'a>, ImportError> {
        self.skip();
        if self.peek() == Some(b'(') {
            self.at += 1;
            if !self.takes(b')') {
                return Err(self.wrong(self.at, format!("found a call of {word:?}, expected data only")));
            }
            self.skip();
        }
        match self.peek() {
            Some(b'{') => self.table(word, depth),
            _ => Ok(Kind::Text(word)),
        }
    }

    fn identifier(&mut self) -> &'a str {
        let rest = &self.text[self.at..];
        let end = rest.find(|c: char| !c.is_ascii_alphanumeric() && c != '_' && c != '.').unwrap_or(rest.len());
        self.at += end;
        &rest[..end]
    }

    fn number(&mut self) -> Result<f64, ImportError> {
        let start = self.at;
        match self.numeric()? {
            Kind::Number(number) => Ok(number),
            _ => Err(self.wrong(start, format!("found {:.40?}, expected a number", &self.text[start..self.at]))),
        }
    }

    /// A number. One that is not finite, such as `-1.#IND`, is a text: it may be of an input that nobody reads.
    fn numeric(&mut self) -> Result<Kind<'a>, ImportError> {
        let (start, rest) = (self.at, &self.text[self.at..]);
        let is_part = |c: char| c.is_ascii_alphanumeric() || matches!(c, '.' | '-' | '+' | '#');
        let end = rest.find(|c: char| !is_part(c)).unwrap_or(rest.len());
        let word = &rest[..end];
        self.at += end;
        let (sign, plain) = word.strip_prefix('-').map_or((1.0, word), |plain| (-1.0, plain));
        let digits = plain.strip_prefix("0x").or_else(|| plain.strip_prefix("0X"));
        if let Some(number) = digits.and_then(|digits| u64::from_str_radix(digits, 16).ok()) {
            return Ok(Kind::Number(sign * number as f64));
        }
        match word.parse::<f64>() {
            Ok(number) if number.is_finite() => Ok(Kind::Number(number)),
            Ok(number) if number.is_nan() => Ok(Kind::Text(word)),
            _ if plain.contains(".#") => Ok(Kind::Text(word)),
            _ => Err(self.wrong(start, format!("found {word:.40?}, expected a number"))),
        }
    }

    fn quoted(&mut self, quote: u8) -> Result<&'a str, ImportError> {
        let (start, bytes) = (self.at, self.text.as_bytes());
        let mut end = start + 1;
        while end < bytes.len() && bytes[end] != quote {
            end += if bytes[end] == b'\\' { 2 } else { 1 };
        }
        if end >= bytes.len() {
            return Err(self.wrong(start, "found a text without its end, expected a quotation mark"));
        }
        self.at = end + 1;
        Ok(&self.text[start + 1..end])
    }

    fn table(&mut self, word: &'a str, depth: usize) -> Result<Kind<'a>, ImportError> {
        let start = self.at;
        if depth >= DEEPEST {
            return Err(
                self.wrong(start, format!("found tables nested deeper than {DEEPEST}, expected at most so many"))
            );
        }
        self.at += 1;
        let mut fields = Vec::new();
        while !self.takes(b'}') {
            let name = self.name()?;
            fields.push((name, self.value(depth + 1)?));
            if !(self.takes(b',') || self.takes(b';')) && self.peek() != Some(b'}') {
                let place = place(self.text, start);
                return Err(
                    self.wrong(self.at, format!("found no comma or brace, expected the end of the table of {place}"))
                );
            }
        }
        Ok(Kind::Table(word, fields))
    }

    /// The name before a value, with its `=`.
    fn name(&mut self) -> Result<Name<'a>, ImportError> {
        self.skip();
        let start = self.at;
        if self.opens_long(start).is_some() {
            return Ok(Name::None);
        }
        if self.takes(b'[') {
            self.skip();
            let name = match self.peek() {
                Some(quote @ (b'"' | b'\'')) => Name::Word(self.quoted(quote)?),
                _ => Name::Number(self.number()?),
            };
            return match self.takes(b']') && self.takes(b'=') {
                true => Ok(name),
                false => Err(self.wrong(start, "found a bracket without its end, expected a name like [1] =")),
            };
        }
        if self.peek().is_some_and(|byte| byte.is_ascii_alphabetic() || byte == b'_') {
            let word = self.identifier();
            if self.takes(b'=') {
                return Ok(Name::Word(word));
            }
            self.at = start;
        }
        Ok(Name::None)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tables_have_words_names_and_values() {
        let text = "-- saved\n{ Tools = ordered() { a = Mask { [0] = { -1.5e-1, Flags = { Linear = true, }, }; [\"b.c\"] = \"x \\\" y\", FuID { 'Fast' } } }, }";
        let found = value(text).unwrap();
        let mask = found.get("Tools").and_then(|tools| tools.get("a")).unwrap();
        assert_eq!((found.get("Tools").unwrap().word(), mask.word()), ("ordered", "Mask"));
        let (name, key) = &mask.fields()[0];
        assert_eq!((*name, key.listed().next().unwrap().number()), (Name::Number(0.0), Some(-0.15)));
        assert!(key.get("Flags").unwrap().get("Linear").unwrap().is_true());
        assert_eq!(mask.get("b.c").unwrap().text(), Some("x \\\" y"));
        let listed = mask.listed().next().unwrap();
        assert_eq!((listed.word(), listed.listed().next().unwrap().text()), ("FuID", Some("Fast")));
        let marked = value("\u{feff}{ a = 1 }").unwrap();
        assert_eq!(marked.get("a").and_then(Value::number), Some(1.0), "a mark of the encoding before it");
    }

    #[test]
    fn what_is_no_data_is_refused_with_its_place() {
        for (text, message) in [
            ("", "line 1, column 1: <table>: found the end"),
            (
                "{ a = os.execute(\"x\") }",
                "line 1, column 18: <table>: found a call of \"os.execute\", expected data only",
            ),
            ("{\n a = 1 b = 2 }", "line 2, column 8: <table>: found no comma or brace"),
            ("{ a = \"x", "found a text without its end"),
            ("{ a = 1-2 }", "found \"1-2\", expected a number"),
            ("{ [1 = 2 }", "found a bracket without its end"),
            ("{ } x", "found more text after the table"),
            ("{ a = ä }", "found 'ä', expected a number"),
        ] {
            let error = value(text).unwrap_err().to_string();
            assert!(error.contains(message), "{text}: {error}");
        }
        let deep = "{".repeat(1_000_000);
        assert!(value(&deep).unwrap_err().to_string().contains("nested deeper than 256"));
    }

    #[test]
    fn long_texts_comments_and_other_numbers_are_read() {
        let text = "{ --[[ a { comment\n\" ]] a = [[ x } \" ]], --[==[ ]] ]==] b = { [=[ ]] ]=], 7 }, c = -0x1F, d = -1.#IND, [2] = 3 -- }\n }";
        let found = value(text).unwrap();
        assert_eq!(found.get("a").and_then(Value::text), Some(" x } \" "));
        let listed: Vec<_> = found.get("b").unwrap().listed().map(|value| (value.text(), value.number())).collect();
        assert_eq!(listed, [(Some(" ]] "), None), (None, Some(7.0))]);
        assert_eq!(found.get("c").and_then(Value::number), Some(-31.0));
        let odd = found.get("d").unwrap();
        assert_eq!((odd.text(), odd.number()), (Some("-1.#IND"), None));
        assert_eq!(found.fields().last().unwrap().0, Name::Number(2.0));
        for wrong in ["{ a = [[ x }", "{ a = 0xZ }", "{ [1.#IND] = 2 }", "{ --[[ a = 1 }"] {
            assert!(value(wrong).is_err(), "{wrong}");
        }
    }
}
