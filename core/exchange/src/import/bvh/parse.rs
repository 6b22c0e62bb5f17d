//! The text of a BVH file (Biovision hierarchy).
//!
//! ```text
//! HIERARCHY
//! ROOT hips
//! {
//!   OFFSET 0 0 0
//!   CHANNELS 6 Xposition Yposition Zposition Zrotation Xrotation Yrotation
//!   JOINT chest
//!   {
//!     OFFSET 0 5 0
//!     CHANNELS 3 Zrotation Xrotation Yrotation
//!     End Site
//!     {
//!       OFFSET 0 4 0
//!     }
//!   }
//! }
//! MOTION
//! Frames: 2
//! Frame Time: 0.033333
//! 0 9 0 0 0 0 0 0 0
//! 0 9 0 90 0 0 0 0 0
//! ```
//!
//! The format has no standard; this parser accepts what programs write. Names may be any text, blanks included.
//! Keywords and channels are in upper or lower case. Channels may come in any order, and rotations about one axis may
//! come twice (proper Euler angles). Any joint may have position channels. Several roots and blank lines are allowed.
//! Each frame is one line. A missing or surplus item is an error with its line, since half a motion is useless.

use glam::DVec3;

/// A channel of a joint: the meaning of a number of a frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Channel {
    /// The position along an axis (0 x, 1 y, 2 z), in the parent's frame.
    Position(usize),
    /// The rotation about an axis, in degrees.
    Rotation(usize),
}

/// A joint, or the end of a chain.
#[derive(Clone, Debug, PartialEq)]
pub struct Node {
    /// Its name. The end of a chain has the name of its joint.
    pub name: String,
    /// Its parent node, which comes before it.
    pub parent: Option<usize>,
    /// Its position at rest, relative to the parent.
    pub offset: DVec3,
    /// Its channels in the order of the file.
    pub channels: Vec<Channel>,
    /// Whether it is the end of a chain ("End Site").
    pub end: bool,
}

/// A hierarchy of joints and its motion.
#[derive(Clone, Debug, PartialEq)]
pub struct Bvh {
    /// Joints and ends of chains, each after its parent.
    pub nodes: Vec<Node>,
    /// Seconds between two frames.
    pub frame_time: f64,
    /// The numbers of all frames in order.
    values: Vec<f64>,
    channels: usize,
}

impl Bvh {
    /// Number of frames, at least one.
    pub fn frame_count(&self) -> usize {
        self.values.len() / self.channels
    }

    /// The numbers of a frame, in the order of the nodes and their channels.
    pub fn frame(&self, frame: usize) -> &[f64] {
        &self.values[frame * self.channels..(frame + 1) * self.channels]
    }
}

/// An error in a file.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("line {line}: found {found}, expected {expected}")]
pub struct BvhError {
    /// The line, from 1.
    pub line: usize,
    /// What was found.
    pub found: String,
    /// What was expected.
    pub expected: String,
}

/// Greatest length of a quotation from the file in an error, in characters.
const SHOWN: usize = 40;

/// Parses the text of a file.
///
/// # Errors
///
/// A [`BvhError`] with the line.
pub fn parse(text: &str) -> Result<Bvh, BvhError> {
    let mut lines = Lines::new(text);
    lines.keyword("HIERARCHY", "HIERARCHY, the head of a BVH file")?;
    let nodes = hierarchy(&mut lines)?;
    let channels = nodes.iter().map(|node| node.channels.len()).sum();
    if channels == 0 {
        return Err(lines.wrong("a hierarchy without channels", "at least one joint with CHANNELS"));
    }
    let count = number_after(&mut lines, "Frames:", "Frames: and a whole number from 1", |text| {
        text.parse::<usize>().ok().filter(|count| *count > 0)
    })?;
    let frame_time = number_after(&mut lines, "Frame Time:", "Frame Time: and a positive number of seconds", seconds)?;
    let values = motion(&mut lines, count, channels)?;
    Ok(Bvh { nodes, frame_time, values, channels })
}

/// The lines of a text that are not blank.
struct Lines<'a> {
    rest: std::iter::Enumerate<std::str::Lines<'a>>,
    /// The number of the present line, from 1.
    line: usize,
    /// The rest of the present line.
    left: &'a str,
}

impl<'a> Lines<'a> {
    fn new(text: &'a str) -> Self {
        // Old programs end texts with a mark of their own.
        let text = text.trim_start_matches('\u{feff}').trim_end_matches(['\u{1a}', '\0']);
        Self { rest: text.lines().enumerate(), line: 1, left: "" }
    }

    /// The rest of the present line, or the next line that is not blank.
    fn here(&mut self) -> Option<&'a str> {
        while self.left.is_empty() {
            let (index, line) = self.rest.next()?;
            self.line = index + 1;
            self.left = line.trim();
        }
        Some(self.left)
    }

    /// Takes the rest of the line.
    fn take(&mut self) -> Option<&'a str> {
        let here = self.here()?;
        self.left = "";
        Some(here)
    }

    /// Takes a word. Blanks and braces end it, and a brace is a word of its own.
    fn word(&mut self) -> Option<&'a str> {
        let here = self.here()?;
        let end = match here.find(|c: char| c.is_whitespace() || c == '{' || c == '}') {
            Some(0) => 1,
            Some(end) => end,
            None => here.len(),
        };
        let (word, left) = here.split_at(end);
        self.left = left.trim_start();
        Some(word)
    }

    fn keyword(&mut self, word: &str, expected: &str) -> Result<(), BvhError> {
        match self.word() {
            Some(found) if found.eq_ignore_ascii_case(word) => Ok(()),
            found => Err(self.wrong_word(found, expected)),
        }
    }

    fn number(&mut self, expected: &str) -> Result<f64, BvhError> {
        let word = self.word();
        match word.and_then(|word| word.parse::<f64>().ok()).filter(|number| number.is_finite()) {
            Some(number) => Ok(number),
            None => Err(self.wrong_word(word, expected)),
        }
    }

    /// Takes a name: the text before a brace or the end of the line.
    fn name(&mut self) -> Result<String, BvhError> {
        let here = self.left;
        let (name, left) = here.split_at(here.find('{').unwrap_or(here.len()));
        self.left = left;
        match name.trim() {
            "" => Err(self.wrong("no name", "a joint's name")),
            name => Ok(name.to_owned()),
        }
    }

    fn wrong(&self, found: impl Into<String>, expected: &str) -> BvhError {
        BvhError { line: self.line, found: found.into(), expected: expected.into() }
    }

    fn wrong_word(&self, found: Option<&str>, expected: &str) -> BvhError {
        self.wrong(found.map_or_else(|| "the end of the file".into(), quoted), expected)
    }
}

fn quoted(text: &str) -> String {
    match text.char_indices().nth(SHOWN) {
        Some((end, _)) => format!("{:?}", format!("{}…", &text[..end])),
        None => format!("{text:?}"),
    }
}

/// A node whose braces are open, and which of its fields were read.
struct Open {
    node: usize,
    offset: bool,
    channels: bool,
}

/// Parses the nodes and the word MOTION after them. It does not recurse, since files may be nested to any depth.
fn hierarchy(lines: &mut Lines) -> Result<Vec<Node>, BvhError> {
    let mut nodes: Vec<Node> = Vec::new();
    let mut open: Vec<Open> = Vec::new();
    loop {
        let word = lines.word();
        let known = word.unwrap_or_default().to_ascii_uppercase();
        match (known.as_str(), open.last_mut()) {
            ("ROOT", None) | ("JOINT", Some(_)) => {
                let name = lines.name()?;
                let parent = inside(lines, &nodes, &open)?;
                open.push(begin(lines, &mut nodes, Node { parent, ..node(name, false) })?);
            }
            ("END", Some(_)) => {
                lines.keyword("SITE", "End Site")?;
                let parent = inside(lines, &nodes, &open)?;
                let name = parent.map_or_else(String::new, |parent| nodes[parent].name.clone());
                open.push(begin(lines, &mut nodes, Node { parent, ..node(name, true) })?);
            }
            ("OFFSET", Some(last)) if !last.offset => {
                last.offset = true;
                nodes[last.node].offset = offset(lines)?;
            }
            ("CHANNELS", Some(last)) if !last.channels && !nodes[last.node].end => {
                last.channels = true;
                nodes[last.node].channels = channels(lines)?;
            }
            ("}", Some(last)) if last.offset => {
                open.pop();
            }
            ("}", Some(last)) => {
                let expected = format!("OFFSET of {:?} before its end", nodes[last.node].name);
                return Err(lines.wrong_word(word, &expected));
            }
            ("MOTION", None) if !nodes.is_empty() => return Ok(nodes),
            (_, None) => return Err(lines.wrong_word(word, if nodes.is_empty() { "ROOT" } else { "MOTION" })),
            (_, Some(_)) => {
                let expected = "OFFSET or CHANNELS (once for each joint), JOINT, End Site or }";
                return Err(lines.wrong_word(word, expected));
            }
        }
    }
}

fn node(name: String, end: bool) -> Node {
    Node { name, parent: None, offset: DVec3::ZERO, channels: Vec::new(), end }
}

/// The open node; an error if it is the end of a chain.
fn inside(lines: &Lines, nodes: &[Node], open: &[Open]) -> Result<Option<usize>, BvhError> {
    let parent = open.last().map(|open| open.node);
    match parent {
        Some(parent) if nodes[parent].end => Err(lines.wrong("a joint", "} after the OFFSET of an End Site")),
        parent => Ok(parent),
    }
}

fn begin(lines: &mut Lines, nodes: &mut Vec<Node>, node: Node) -> Result<Open, BvhError> {
    lines.keyword("{", "{ after a joint's name")?;
    nodes.push(node);
    Ok(Open { node: nodes.len() - 1, offset: false, channels: false })
}

fn offset(lines: &mut Lines) -> Result<DVec3, BvhError> {
    let mut number = || lines.number("OFFSET and three numbers");
    Ok(DVec3::new(number()?, number()?, number()?))
}

fn channels(lines: &mut Lines) -> Result<Vec<Channel>, BvhError> {
    let word = lines.word();
    let count = word.and_then(|word| word.parse::<usize>().ok()).filter(|count| *count <= 6);
    let Some(count) = count else {
        return Err(lines.wrong_word(word, "CHANNELS and their number, 0 to 6"));
    };
    let mut found = Vec::with_capacity(count);
    for _ in 0..count {
        let word = lines.word();
        let channel = match word.unwrap_or_default().to_ascii_lowercase().as_str() {
            "xposition" => Channel::Position(0),
            "yposition" => Channel::Position(1),
            "zposition" => Channel::Position(2),
            "xrotation" => Channel::Rotation(0),
            "yrotation" => Channel::Rotation(1),
            "zrotation" => Channel::Rotation(2),
            _ => {
                let expected = format!("{count} channels: Xposition to Zposition, Xrotation to Zrotation");
                return Err(lines.wrong_word(word, &expected));
            }
        };
        if matches!(channel, Channel::Position(_)) && found.contains(&channel) {
            return Err(lines.wrong_word(word, "each position of a joint once"));
        }
        found.push(channel);
    }
    Ok(found)
}

/// The number on a line that begins with a keyword of one or two words, with any blanks between them.
fn number_after<T>(
    lines: &mut Lines,
    keyword: &str,
    expected: &str,
    read: impl Fn(&str) -> Option<T>,
) -> Result<T, BvhError> {
    let line = lines.take();
    let after = line.and_then(|line| line.split_once(':')).and_then(|(head, number)| {
        let same = |a: &str, b: &str| a.split_whitespace().eq(b.split_whitespace());
        same(&head.to_ascii_lowercase(), keyword.trim_end_matches(':').to_ascii_lowercase().as_str()).then_some(number)
    });
    after.and_then(|number| read(number.trim())).ok_or_else(|| lines.wrong_word(line, expected))
}

/// The time of a frame. Programs round it: 0.041667 stands for a 24th of a second, and whole frame rates are meant to be whole.
fn seconds(text: &str) -> Option<f64> {
    let time = text.parse::<f64>().ok().filter(|time| *time > 0.0 && time.is_finite() && time.recip().is_finite())?;
    let whole = time.recip().round().max(1.0).recip();
    let plain = text.bytes().all(|byte| byte.is_ascii_digit() || byte == b'.');
    let decimals = text.split_once('.').map_or(0, |(_, decimals)| decimals.len());
    let rounding = 0.5 * 0.1_f64.powi(decimals.min(99) as i32);
    // From three digits on: 0.1 is a tenth, and nobody knows what 0.03 is.
    let digits = text.trim_start_matches(['0', '.']).len();
    Some(if plain && digits >= 3 && (time - whole).abs() <= rounding * (1.0 + 1e-9) { whole } else { time })
}

fn motion(lines: &mut Lines, count: usize, channels: usize) -> Result<Vec<f64>, BvhError> {
    let mut values = Vec::new();
    for frame in 0..count {
        let Some(line) = lines.take() else {
            let found = format!("the end of the file after {frame} frames");
            return Err(lines.wrong(found, &format!("{count} frames")));
        };
        let before = values.len();
        for word in line.split_whitespace() {
            match word.parse::<f64>() {
                Ok(value) if value.is_finite() => values.push(value),
                _ => return Err(lines.wrong(quoted(word), &format!("a finite number (frame {frame})"))),
            }
        }
        let found = values.len() - before;
        if found != channels {
            let expected = format!("{channels}, one for each channel (frame {frame})");
            return Err(lines.wrong(format!("{found} numbers"), &expected));
        }
    }
    match lines.take() {
        None => Ok(values),
        Some(line) => Err(lines.wrong(quoted(line), &format!("the end of the file after {count} frames"))),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::{prop_assert, proptest};

    const SMALL: &str = "HIERARCHY\nROOT the hips\n{\n  OFFSET 0 1 -2.5e1\n  CHANNELS 4 Xposition ZROTATION yrotation zrotation\n  JOINT arm {\n    \
                         OFFSET 0 2 0\n    End Site\n    {\n      OFFSET 1 0 0\n    }\n  }\n}\nMOTION\nFrames: 2\nFrame Time: 0.25\n1 2 3 4\n5 6 7 8\n";

    fn error(from: &str, to: &str) -> String {
        assert!(SMALL.contains(from), "{from}");
        parse(&SMALL.replacen(from, to, 1)).unwrap_err().to_string()
    }

    #[test]
    fn a_small_file_is_read() {
        let bvh = parse(SMALL).unwrap();
        let names: Vec<_> = bvh.nodes.iter().map(|node| (node.name.as_str(), node.parent, node.end)).collect();
        assert_eq!(names, [("the hips", None, false), ("arm", Some(0), false), ("arm", Some(1), true)]);
        assert_eq!(bvh.nodes[0].offset, DVec3::new(0.0, 1.0, -25.0));
        let rotations = [2, 1, 2].map(Channel::Rotation);
        assert_eq!(bvh.nodes[0].channels, [&[Channel::Position(0)], rotations.as_slice()].concat());
        assert_eq!((bvh.frame_count(), bvh.frame_time, bvh.frame(1)), (2, 0.25, [5.0, 6.0, 7.0, 8.0].as_slice()));
        let odd = format!("\u{feff}\n{}", SMALL.replace('\n', "\r\n\r\n").replace("Frame Time:", "frame  time :"));
        assert_eq!(parse(&odd).unwrap(), bvh);
        let two = SMALL.replace("MOTION", "ROOT prop\n{\nOFFSET 0 0 0\n}\nMOTION");
        assert_eq!(parse(&two).unwrap().nodes[3].parent, None);
    }

    #[test]
    fn rounded_times_of_frames_mean_whole_rates() {
        let rate = |time: &str| parse(&SMALL.replace("0.25", time)).unwrap().frame_time.recip();
        for (time, expected) in [
            ("0.041667", 24.0),
            ("0.0416667", 24.0),
            (".0333333", 30.0),
            ("0.033333", 30.0),
            ("0.00833333", 120.0),
            ("0.00833", 120.0),
            ("0.0166667", 60.0),
            ("0.04", 25.0),
            ("0.0417083", 0.0417083_f64.recip()), // 23.976
            ("0.033367", 0.033367_f64.recip()),   // 29.97
            ("0.03", 0.03_f64.recip()),
            ("4.1667e-2", 4.1667e-2_f64.recip()),
            ("2", 0.5),
        ] {
            assert!((rate(time) - expected).abs() < 1e-9, "{time}: {}", rate(time));
        }
        let ended = parse(&format!("{SMALL}\u{1a}\0\0"));
        assert_eq!(ended, parse(SMALL));
    }

    #[test]
    fn what_is_wrong_is_named_with_its_line() {
        let found = |text: &str| parse(text).unwrap_err().to_string();
        assert_eq!(found(""), "line 1: found the end of the file, expected HIERARCHY, the head of a BVH file");
        assert_eq!(found("\n\n{\"a\": 1}"), "line 3: found \"{\", expected HIERARCHY, the head of a BVH file");
        assert_eq!(error("ROOT the hips", "JOINT x"), "line 2: found \"JOINT\", expected ROOT");
        assert_eq!(error("ROOT the hips", "ROOT"), "line 2: found no name, expected a joint's name");
        assert_eq!(error("-2.5e1", "nan"), "line 4: found \"nan\", expected OFFSET and three numbers");
        assert_eq!(error("-2.5e1", ""), "line 5: found \"CHANNELS\", expected OFFSET and three numbers");
        assert_eq!(
            error("CHANNELS 4", "CHANNELS 7"),
            "line 5: found \"7\", expected CHANNELS and their number, 0 to 6"
        );
        assert!(
            error("CHANNELS 4", "CHANNELS 5").starts_with("line 6: found \"JOINT\", expected 5 channels: Xposition")
        );
        assert!(
            error("CHANNELS 4", "CHANNELS 3").starts_with("line 5: found \"zrotation\", expected OFFSET or CHANNELS")
        );
        assert!(error("yrotation", "Xposition").contains("expected each position of a joint once"));
        assert!(
            error("OFFSET 1 0 0", "").starts_with("line 11: found \"}\", expected OFFSET of \"arm\" before its end")
        );
        assert!(error("OFFSET 1 0 0", "JOINT x {").contains("expected } after the OFFSET of an End Site"));
        assert_eq!(
            error("Frames: 2", "Frames: 0"),
            "line 15: found \"Frames: 0\", expected Frames: and a whole number from 1"
        );
        assert!(
            error("Frame Time: 0.25", "Frame Time: 0")
                .contains("expected Frame Time: and a positive number of seconds")
        );
        assert!(error("Frame Time: 0.25", "Frame Time: inf").contains("expected Frame Time: and a positive"));
        assert_eq!(error("5 6 7 8", "5 6 7"), "line 18: found 3 numbers, expected 4, one for each channel (frame 1)");
        assert_eq!(error("5 6 7 8", "5 6 NaN 8"), "line 18: found \"NaN\", expected a finite number (frame 1)");
        assert_eq!(error("5 6 7 8", ""), "line 18: found the end of the file after 1 frames, expected 2 frames");
        assert_eq!(error("5 6 7 8", "5 6 7 8\n9"), "line 19: found \"9\", expected the end of the file after 2 frames");
        let still = "HIERARCHY\nROOT a\n{\nOFFSET 0 0 0\n}\nMOTION\nFrames: 1\nFrame Time: 1\n";
        assert!(found(still).contains("found a hierarchy without channels"));
        assert!(error("5 6 7 8", &"y".repeat(99)).contains(&format!("{}…", "y".repeat(SHOWN))));
    }

    #[test]
    fn a_million_open_joints_are_no_danger() {
        let deep = format!("HIERARCHY\nROOT a{{OFFSET 0 0 0\n{}", "JOINT a{OFFSET 0 0 0\n".repeat(100_000));
        assert!(parse(&deep).unwrap_err().to_string().contains("found the end of the file"));
    }

    proptest! {
        #[test]
        fn files_cut_short_or_garbled_are_refused_in_order(cut in 0..SMALL.len(), at in 0..SMALL.len(), byte in 32u8..127) {
            let short = &SMALL[..cut];
            prop_assert!(parse(short).is_err() || cut >= SMALL.trim_end().len() - 1);
            let mut garbled = SMALL.as_bytes().to_vec();
            garbled[at] = byte;
            let _ = parse(&String::from_utf8_lossy(&garbled));
        }

        #[test]
        fn any_text_is_read_or_refused(text in "(HIERARCHY|ROOT|JOINT|End Site|OFFSET|CHANNELS|MOTION|Frames:|[{}\\n 0-9a-zé:.-]){0,60}") {
            let _ = parse(&text);
        }
    }
}
