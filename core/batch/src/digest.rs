//! Hashes of what a step reads: the document, the frames, the words of its command, and the version of the program.
//!
//! A step is done again only if this hash changes. Times of files play no part, since they change by copying and since
//! the clocks of a farm's machines disagree. BLAKE3 reads faster than a disk.

use crate::step::Step;
use rayon::prelude::{IntoParallelIterator, ParallelIterator};
use rototoon::file::Repeating;
use rototoon::scene::{Footage, FramePattern};
use std::fs::File;
use std::io;
use std::path::Path;

/// The hash of a file's bytes, as 64 hexadecimal digits.
///
/// # Errors
///
/// The file cannot be read, or is no regular file.
pub fn of_file(path: &Path) -> io::Result<String> {
    rototoon::file::length(path)?;
    let mut hasher = blake3::Hasher::new();
    hasher.update_reader(Repeating(File::open(path)?))?;
    Ok(hasher.finalize().to_hex().to_string())
}

/// The hash of all frames of a footage in `folder`. A frame that is missing or cannot be read has a hash too.
pub fn of_footage(footage: &Footage, folder: &Path) -> String {
    let Ok(pattern) = FramePattern::parse(&footage.pattern) else { return String::new() };
    let frames: Vec<String> = (footage.first..=footage.last)
        .into_par_iter()
        .map(|frame| of_file(&folder.join(pattern.path(frame))).unwrap_or_else(|error| error.kind().to_string()))
        .collect();
    of_texts(frames.iter().map(String::as_str))
}

/// What the steps of a shot read beside their document.
#[derive(Clone, Debug, Default)]
pub struct Frames {
    /// The hash of the frames, or of what steps need of them; empty if no step depends on them.
    pub hash: String,
    /// The pattern of the frames as a document in the folder of the results has it.
    pub pattern: String,
}

/// The hash of a step: what it reads, and how. What names the frames is another file where they are reached by another pattern.
pub fn of_step(step: &Step, document: &str, frames: &Frames) -> String {
    let hash = if step.depends_on_footage() { &frames.hash } else { "" };
    let pattern = if step.names_footage() { &frames.pattern } else { "" };
    let words = step.words("", "");
    let texts = [rototoon::VERSION, document, hash, pattern].into_iter();
    of_texts(texts.chain(words.iter().map(String::as_str)))
}

/// The hash of what a manifest asks for a shot: the words of all steps.
pub fn of_steps(steps: &[Step]) -> String {
    let each: Vec<String> = steps.iter().map(|step| of_texts(step.words("", "").iter().map(String::as_str))).collect();
    of_texts(each.iter().map(String::as_str))
}

/// The hash of texts in their order. Each has its length before it, so no two lists run together.
fn of_texts<'a>(texts: impl Iterator<Item = &'a str>) -> String {
    let mut hasher = blake3::Hasher::new();
    for text in texts {
        hasher.update(&(text.len() as u64).to_le_bytes()).update(text.as_bytes());
    }
    hasher.finalize().to_hex().to_string()
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn each_thing_that_a_step_reads_changes_its_hash() {
        let step = |value| Step::read(&value).unwrap();
        let (track, export) = (step(json!({"do": "track"})), step(json!({"do": "export", "to": "a.svg"})));
        let other = step(json!({"do": "track", "preset": "zhou2011"}));
        let frames = |hash: &str, pattern: &str| Frames { hash: hash.into(), pattern: pattern.into() };
        let all = [
            of_step(&track, "d", &frames("f", "p")),
            of_step(&track, "e", &frames("f", "p")),
            of_step(&track, "d", &frames("g", "p")),
            of_step(&track, "d", &frames("f", "q")),
            of_step(&other, "d", &frames("f", "p")),
        ];
        for (k, hash) in all.iter().enumerate() {
            assert!(all[k + 1..].iter().all(|next| next != hash));
        }
        let of = |step: &Step, hash: &str, pattern: &str| of_step(step, "d", &frames(hash, pattern));
        assert_ne!(of(&export, "f", "p"), of(&export, "g", "p"), "an export has the shape of their pixels");
        assert_ne!(of(&export, "f", "p"), of(&export, "f", "q"), "and may name them");
        let tween = step(json!({"do": "tween"}));
        assert_eq!(of(&tween, "f", "p"), of(&tween, "g", "p"), "in-betweens need no frames");
        let render = step(json!({"do": "render", "to": "a.png"}));
        assert_eq!(of(&render, "f", "p"), of(&render, "f", "q"), "a picture names none");
        assert_ne!(of_texts(["ab", "c"].into_iter()), of_texts(["a", "bc"].into_iter()));
    }

    #[test]
    fn frames_that_change_or_go_change_the_hash() {
        let folder = tempfile::tempdir().unwrap();
        let footage =
            Footage { pattern: "%d.png".into(), first: 0, last: 2, fps: 24.0, width: 4, height: 4, held: false };
        let mut seen = Vec::new();
        for (name, text) in [("0.png", "a"), ("1.png", "a"), ("1.png", "b"), ("2.png", "c"), ("3.png", "d")] {
            std::fs::write(folder.path().join(name), text).unwrap();
            seen.push(of_footage(&footage, folder.path()));
        }
        assert_eq!(seen[3], seen[4], "frame 3 is not of the footage");
        seen.pop();
        seen.dedup();
        assert_eq!(seen.len(), 4);
    }
}
