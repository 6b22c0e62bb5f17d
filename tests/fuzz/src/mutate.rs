//! Changes of inputs, and the loop that needs no nightly compiler.
//!
//! It sees nothing of the code that it runs, so it finds less than libFuzzer. It runs everywhere.

use crate::seeds;
use crate::targets::Target;
use std::fs;
use std::io;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

/// The longest input in bytes.
pub const MOST_BYTES: usize = 4096;
/// An execution that takes longer is a finding.
pub const MOST_TIME: Duration = Duration::from_secs(10);

/// Random numbers (xorshift), the same for the same start.
#[derive(Clone, Debug)]
pub struct Random(u64);

impl Random {
    /// A sequence of its own for each number.
    pub fn new(number: u64) -> Self {
        Self(number.wrapping_mul(0x9E37_79B9_7F4A_7C15) | 1)
    }

    /// A number below `end`, which is not 0.
    pub fn below(&mut self, end: usize) -> usize {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 >> 16) as usize % end
    }
}

/// A change of an input: one to four flips, cuts, insertions, copies and splices with `other`.
pub fn changed(input: &[u8], other: &[u8], random: &mut Random) -> Vec<u8> {
    let mut bytes = input.to_vec();
    for _ in 0..1 + random.below(4) {
        change(&mut bytes, other, random);
    }
    bytes.truncate(MOST_BYTES);
    bytes
}

fn change(bytes: &mut Vec<u8>, other: &[u8], random: &mut Random) {
    let at = random.below(bytes.len() + 1);
    let length = 1 + random.below(16);
    match random.below(9) {
        0 if at < bytes.len() => bytes[at] ^= 1 << random.below(8),
        1 if at < bytes.len() => bytes[at] = random.below(256) as u8,
        2 => drop(bytes.drain(at..bytes.len().min(at + length))),
        3 => bytes.truncate(at),
        4 => {
            let piece: Vec<u8> = (0..length).map(|_| random.below(256) as u8).collect();
            bytes.splice(at..at, piece);
        }
        5 if !bytes.is_empty() => {
            let from = random.below(bytes.len());
            let piece = bytes[from..bytes.len().min(from + length)].to_vec();
            bytes.splice(at..at, piece);
        }
        6 if !other.is_empty() => {
            let from = random.below(other.len());
            bytes.truncate(at);
            bytes.extend(&other[from..]);
        }
        // The decoders make an odd number of it.
        7 | 8 if at + 2 <= bytes.len() => bytes[at..at + 2].copy_from_slice(&[128 + random.below(128) as u8, 0xFF]),
        _ => bytes.push(random.below(256) as u8),
    }
}

/// What a loop did.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Ran {
    /// Number of executions.
    pub executions: u64,
    /// The file with the input of the finding.
    pub finding: Option<PathBuf>,
}

/// Runs a target on changed seeds until the time is over or there is a finding. Each input is in a file in `folder` while
/// it runs, so it is there even if the process dies.
///
/// # Errors
///
/// A file that cannot be read or written.
pub fn run(target: Target, time: Duration, folder: &Path, start: u64) -> io::Result<Ran> {
    let known = seeds::seeds(target.name)?;
    let mut random = Random::new(start);
    fs::create_dir_all(folder)?;
    let present = folder.join(format!("present-{start}"));
    let begun = Instant::now();
    let mut ran = Ran::default();
    while begun.elapsed() < time {
        let pick = |random: &mut Random| known.get(random.below(known.len().max(1))).map_or(&[][..], Vec::as_slice);
        let (one, other) = (pick(&mut random), pick(&mut random));
        let input = if random.below(3) == 0 { noise(&mut random) } else { changed(one, other, &mut random) };
        fs::write(&present, &input)?;
        let (at, fine) = (Instant::now(), holds(target, &input));
        ran.executions += 1;
        if !fine || at.elapsed() > MOST_TIME {
            let finding = folder.join(format!("finding-{start}-{}", ran.executions));
            fs::rename(&present, &finding)?;
            ran.finding = Some(finding);
            return Ok(ran);
        }
    }
    fs::remove_file(&present)?;
    Ok(ran)
}

/// Whether a target takes an input without a panic.
pub fn holds(target: Target, input: &[u8]) -> bool {
    catch_unwind(AssertUnwindSafe(|| (target.run)(input))).is_ok()
}

/// Any bytes, now and then with many of those that the decoders make odd numbers of.
fn noise(random: &mut Random) -> Vec<u8> {
    let (length, odd) = (random.below(1024), random.below(3) == 0);
    let byte = |random: &mut Random| if odd && random.below(4) == 0 { 0xFF } else { random.below(256) as u8 };
    (0..length).map(|_| byte(random)).collect()
}
