//! File names of a numbered sequence: a path with one `%d` or `%0Nd` for the frame number, as in `printf`.
//!
//! `%d` is the plain number. `%0Nd` pads it with zeros to N characters, a minus sign included; longer numbers are
//! written in full. `%%` stands for a percent sign. The number may be in the name of a file or of a folder.

use super::FrameNumber;
use std::fmt::Write;
use std::io;
use std::path::{Component, Path, PathBuf};

/// A path with a place for the frame number.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct FramePattern {
    before: String,
    /// Number of characters to fill with zeros; 0 for none.
    fill: usize,
    after: String,
}

/// Why a text is no pattern.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum PatternError {
    /// There is no place for the number.
    #[error("pattern {pattern:?} has no frame number: expected one %d or %0Nd")]
    NoNumber {
        /// The text.
        pattern: String,
    },
    /// It is the path of a movie or an animated picture.
    #[error(
        "pattern {movie:?} is a movie: expected numbered pictures. Make them with: mkdir frames; ffmpeg -i {movie:?} \
         frames/%04d.png  (the first picture has the number 1). Then the pattern is \"frames/%04d.png\""
    )]
    Movie {
        /// The path.
        movie: String,
    },
    /// There is more than one place for the number.
    #[error("pattern {pattern:?} has {found} frame numbers: expected one %d or %0Nd")]
    SeveralNumbers {
        /// The text.
        pattern: String,
        /// How many there are.
        found: usize,
    },
    /// A percent sign begins something else.
    #[error("pattern {pattern:?} has {found:?} in it: expected %d, %0Nd with N from 1 to 99, or %% for a percent sign")]
    Unknown {
        /// The text.
        pattern: String,
        /// From the percent sign on, a few characters.
        found: String,
    },
}

/// Endings of movies and animated pictures.
const MOVIES: [&str; 14] =
    ["mp4", "m4v", "mov", "avi", "mkv", "webm", "mpg", "mpeg", "wmv", "flv", "ogv", "mxf", "gif", "apng"];

/// Whether a path names a movie, by its ending.
fn is_movie(path: &str) -> bool {
    let ending = Path::new(path).extension().and_then(|ending| ending.to_str()).unwrap_or_default();
    MOVIES.iter().any(|known| ending.eq_ignore_ascii_case(known))
}

impl FramePattern {
    /// Reads a pattern.
    pub fn parse(pattern: &str) -> Result<Self, PatternError> {
        let mut texts = vec![String::new()];
        let mut fill = 0;
        let mut rest = pattern;
        while let Some(at) = rest.find('%') {
            let (text, tail) = rest.split_at(at);
            push(&mut texts, text);
            if let Some(tail) = tail.strip_prefix("%%") {
                push(&mut texts, "%");
                rest = tail;
                continue;
            }
            let Some((width, tail)) = conversion(tail) else {
                let found = tail.chars().take(4).collect();
                return Err(PatternError::Unknown { pattern: pattern.into(), found });
            };
            fill = width;
            texts.push(String::new());
            rest = tail;
        }
        push(&mut texts, rest);
        let found = texts.len() - 1;
        let mut texts = texts.into_iter();
        match (found, texts.next(), texts.next()) {
            (1, Some(before), Some(after)) => Ok(Self { before, fill, after }),
            (0, ..) if is_movie(pattern) => Err(PatternError::Movie { movie: pattern.into() }),
            (0, ..) => Err(PatternError::NoNumber { pattern: pattern.into() }),
            _ => Err(PatternError::SeveralNumbers { pattern: pattern.into(), found }),
        }
    }

    /// The path of a frame, as relative or absolute as the pattern is.
    pub fn path(&self, frame: FrameNumber) -> PathBuf {
        PathBuf::from(self.text(frame))
    }

    fn text(&self, frame: FrameNumber) -> String {
        let mut text = self.before.clone();
        // Writing to a string does not fail.
        let _ = write!(text, "{frame:0fill$}", fill = self.fill);
        text + &self.after
    }

    /// The numbers of the frames that exist, ascending. A relative pattern starts in `folder`. None where the folder
    /// that should hold them does not exist; an error where it cannot be listed.
    pub fn existing(&self, folder: &Path) -> io::Result<Vec<FrameNumber>> {
        // A frame shows which component of the path holds the number: the one that differs in another frame.
        let (one, other) = (self.path(0), self.path(1));
        let components: Vec<_> = one.components().zip(other.components()).collect();
        let Some(place) = components.iter().position(|(a, b)| a != b) else { return Ok(Vec::new()) };
        let parent: PathBuf = components[..place].iter().map(|(a, _)| a).collect();
        let beyond: PathBuf = components[place + 1..].iter().map(|(a, _)| a).collect();
        let entries = match std::fs::read_dir(folder.join(&parent)) {
            Ok(entries) => entries,
            Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(Vec::new()),
            Err(error) => return Err(error),
        };
        let mut frames = Vec::new();
        for entry in entries {
            let entry = entry?;
            let name = entry.file_name();
            let Some(frame) = name.to_str().and_then(|name| self.number_of(name, place)) else { continue };
            let there = if beyond.as_os_str().is_empty() { entry.path() } else { entry.path().join(&beyond) };
            if there.is_file() {
                frames.push(frame);
            }
        }
        frames.sort_unstable();
        frames.dedup();
        Ok(frames)
    }

    /// The frame whose path has `name` as its component number `place`.
    fn number_of(&self, name: &str, place: usize) -> Option<FrameNumber> {
        let component = |frame| match self.path(frame).components().nth(place) {
            Some(Component::Normal(text)) => text.to_str().map(String::from),
            _ => None,
        };
        let head = self.before.rsplit(std::path::is_separator).next()?;
        let tail = self.after.split(std::path::is_separator).next()?;
        let number = name.strip_prefix(head)?.strip_suffix(tail)?;
        let frame = number.parse().ok()?;
        (component(frame)? == name).then_some(frame)
    }
}

fn push(texts: &mut [String], text: &str) {
    if let Some(last) = texts.last_mut() {
        last.push_str(text);
    }
}

/// The width of `%d` or `%0Nd` at the start of the text, and what follows it.
fn conversion(text: &str) -> Option<(usize, &str)> {
    let text = text.strip_prefix('%')?;
    if let Some(rest) = text.strip_prefix('d') {
        return Some((0, rest));
    }
    let digits = text.strip_prefix('0')?;
    let (width, rest) = digits.split_once('d')?;
    let valid = (1..=2).contains(&width.len()) && width.bytes().all(|b| b.is_ascii_digit());
    let width = if valid { width.parse().ok()? } else { 0 };
    (width > 0).then_some((width, rest))
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn path(pattern: &str, frame: FrameNumber) -> String {
        FramePattern::parse(pattern).unwrap().path(frame).to_str().unwrap().to_owned()
    }

    #[test]
    fn numbers_as_printf_writes_them() {
        assert_eq!(path("a/b_%d.png", 7), "a/b_7.png");
        assert_eq!(path("a/b_%04d.png", 7), "a/b_0007.png");
        assert_eq!(path("%03d", 12345), "12345");
        assert_eq!(path("%04d", -5), "-005");
        assert_eq!(path("100%%/%d", 1), "100%/1");
        assert_eq!(path("%012d", 3), "000000000003");
    }

    #[test]
    fn what_is_no_pattern() {
        use PatternError::{NoNumber, SeveralNumbers, Unknown};
        assert!(matches!(FramePattern::parse("a.png"), Err(NoNumber { .. })));
        for movie in ["shot.MP4", "a/b.gif"] {
            let told = FramePattern::parse(movie).unwrap_err().to_string();
            assert!(told.contains("is a movie") && told.contains("ffmpeg -i"), "{told}");
        }
        assert!(matches!(FramePattern::parse(""), Err(NoNumber { .. })));
        assert!(matches!(FramePattern::parse("%%d"), Err(NoNumber { .. })));
        assert!(matches!(FramePattern::parse("%d_%02d"), Err(SeveralNumbers { found: 2, .. })));
        for text in ["%s", "a%", "%4d", "%0d", "%00d", "%0123d", "%0xd", "%-3d", "%0é"] {
            assert!(matches!(FramePattern::parse(text), Err(Unknown { .. })), "{text}");
        }
    }

    #[test]
    fn lists_what_exists() {
        let folder = tempfile::tempdir().unwrap();
        let frames = folder.path().join("frames");
        std::fs::create_dir_all(frames.join("f_0009.png")).unwrap();
        for name in ["f_0012.png", "f_0003.png", "f_10000.png", "f_-001.png", "f_3.png", "f_00005.png", "g_0004.png"] {
            std::fs::write(frames.join(name), "").unwrap();
        }
        let list = |pattern: &str| FramePattern::parse(pattern).unwrap().existing(folder.path()).unwrap();
        assert_eq!(list("frames/f_%04d.png"), [-1, 3, 12, 10000]);
        assert_eq!(list("frames/f_%d.png"), [3, 10000]);
        assert_eq!(list("nowhere/f_%d.png"), [0; 0]);
        let absolute = format!("{}/frames/g_%04d.png", folder.path().display());
        assert_eq!(list(&absolute), [4]);
    }

    #[test]
    fn the_number_may_be_a_folder() {
        let folder = tempfile::tempdir().unwrap();
        for (frame, name) in [(1, "a.png"), (2, "a.png"), (3, "b.png")] {
            let inner = folder.path().join(format!("shot_{frame:02}"));
            std::fs::create_dir(&inner).unwrap();
            std::fs::write(inner.join(name), "").unwrap();
        }
        let pattern = FramePattern::parse("shot_%02d/a.png").unwrap();
        assert_eq!(pattern.existing(folder.path()).unwrap(), [1, 2]);
    }

    proptest! {
        #[test]
        fn names_give_their_number_back(frame: FrameNumber, fill in 0usize..12) {
            let pattern = if fill == 0 { "a/f_%d.x".into() } else { format!("a/f_%0{fill}d.x") };
            let pattern = FramePattern::parse(&pattern).unwrap();
            let name = pattern.path(frame).file_name().unwrap().to_str().unwrap().to_owned();
            prop_assert_eq!(pattern.number_of(&name, 1), Some(frame));
        }

        #[test]
        fn any_text_is_read_or_refused(text in ".*") {
            let _ = FramePattern::parse(&text);
        }
    }
}
