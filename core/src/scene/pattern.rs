//! File names with a place for the frame number, as artists' tools write them: `frame_%03d.png`.

use super::FrameNumber;

/// A path with one `%d` or `%0Nd`, where the frame's number stands.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Pattern {
    before: String,
    digits: usize,
    after: String,
}

/// Why a text is no [`Pattern`].
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("found {pattern:?} with {places} places for the frame number, expected one %d or %0Nd such as %04d")]
pub struct PatternError {
    /// The text.
    pub pattern: String,
    /// Number of `%d` and `%0Nd` in it.
    pub places: usize,
}

impl Pattern {
    /// Reads a pattern.
    pub fn parse(text: &str) -> Result<Self, PatternError> {
        let places: Vec<_> =
            text.match_indices('%').filter_map(|(at, _)| place(&text[at..]).map(|p| (at, p))).collect();
        match places[..] {
            [(at, (length, digits))] => {
                Ok(Self { before: text[..at].to_owned(), digits, after: text[at + length..].to_owned() })
            }
            _ => Err(PatternError { pattern: text.to_owned(), places: places.len() }),
        }
    }

    /// The path of a frame: its number with leading zeros to the pattern's width, a minus sign included.
    pub fn path(&self, frame: FrameNumber) -> String {
        format!("{}{frame:0width$}{}", self.before, self.after, width = self.digits)
    }
}

/// Length and width of the `%d` or `%0Nd` at the start of a text.
fn place(text: &str) -> Option<(usize, usize)> {
    const WIDEST: usize = 20;
    let rest = text.strip_prefix('%')?;
    let digits = rest.find(|c: char| !c.is_ascii_digit())?;
    if !rest[digits..].starts_with('d') {
        return None;
    }
    let width = match &rest[..digits] {
        "" => 0,
        width => width.strip_prefix('0')?.parse().ok().filter(|width| *width <= WIDEST)?,
    };
    Some((digits + 2, width))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_number_takes_the_place_and_the_width() {
        let path = |pattern: &str, frame| Pattern::parse(pattern).unwrap().path(frame);
        assert_eq!(path("a/b_%03d.png", 7), "a/b_007.png");
        assert_eq!(path("%d", 1234), "1234");
        assert_eq!(path("x%04d", -5), "x-005");
        assert_eq!(path("100%_%02d.png", 123), "100%_123.png");
    }

    #[test]
    fn a_pattern_has_exactly_one_place() {
        for (text, places) in
            [("a.png", 0), ("%d_%02d.png", 2), ("%s", 0), ("%5d", 0), ("%", 0), ("", 0), ("%099999999d", 0)]
        {
            assert_eq!(Pattern::parse(text).unwrap_err().places, places, "{text}");
        }
    }
}
