//! What a batch and the program that takes its steps say to each other.
//!
//! One program takes all steps of a shot, so that each frame is decoded once. The batch writes the words of a subcommand to
//! its standard input, a JSON list in each line. The program's standard error has errors, warnings and notes. Between them it says
//! how far the step is, as a share of 1 and in words. Its last line for each step is the answer; after it the program says nothing until the next request:
//!
//! ```text
//! at: 0.4213 Reading frames
//! step: 2 status=0 peak_bytes=123456789 kept_bytes=62208000 processor_ms=5100
//! ```

/// What an answer begins with.
const BEGIN: &str = "step: ";
/// What a line begins with that says how far a step is.
const AT: &str = "at: ";

/// The end of a step, as its program tells it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Answer {
    /// Number of the step; the program's first one is 1.
    pub step: usize,
    /// The exit status of the subcommand.
    pub status: u8,
    /// The most memory that the program held during the step, in bytes; 0 where the system does not say it.
    pub peak_bytes: u64,
    /// Bytes of decoded frames that it keeps for later steps.
    pub kept_bytes: u64,
    /// Milliseconds of processors that the step took; 0 where the system does not say it.
    pub processor_ms: u64,
}

impl Answer {
    /// The line, without its end.
    pub fn line(&self) -> String {
        let Self { step, status, peak_bytes, kept_bytes, processor_ms } = self;
        let memory = format!("peak_bytes={peak_bytes} kept_bytes={kept_bytes}");
        format!("{BEGIN}{step} status={status} {memory} processor_ms={processor_ms}")
    }

    /// Reads a line; `None` if it is no answer.
    pub fn read(line: &str) -> Option<Self> {
        let mut words = line.strip_prefix(BEGIN)?.split(' ');
        let step = words.next()?.parse().ok()?;
        let mut number = |name: &str| words.next()?.strip_prefix(name)?.strip_prefix('=')?.parse::<u64>().ok();
        let status = u8::try_from(number("status")?).ok()?;
        let (peak_bytes, kept_bytes) = (number("peak_bytes")?, number("kept_bytes")?);
        Some(Self { step, status, peak_bytes, kept_bytes, processor_ms: number("processor_ms")? })
    }
}

/// The line that says how far a step is, without its end. The share is rounded down: 1 is the end alone.
pub fn at(share: f64, doing: &str) -> String {
    format!("{AT}{:.4} {doing}", (share * 1e4).floor() / 1e4)
}

/// How far a step is, and what it does; `None` if the line does not say it.
pub fn read_at(line: &str) -> Option<(f64, &str)> {
    let (share, doing) = line.strip_prefix(AT)?.split_once(' ')?;
    Some((share.parse().ok().filter(|share| (0.0..=1.0).contains(share))?, doing))
}

/// The line that asks for a subcommand, with its end.
pub fn request(words: &[String]) -> String {
    serde_json::json!(words).to_string() + "\n"
}

/// The words of a line that asks for a subcommand; `None` if it does not.
pub fn words(line: &str) -> Option<Vec<String>> {
    serde_json::from_str(line).ok()
}

/// Milliseconds of processors that this process has taken; 0 where the system does not say it.
pub fn processor_ms() -> u64 {
    #[cfg(unix)]
    {
        use rustix::time::{ClockId, clock_gettime};
        let time = clock_gettime(ClockId::ProcessCPUTime);
        u64::try_from(time.tv_sec * 1000 + time.tv_nsec / 1_000_000).unwrap_or(0)
    }
    #[cfg(not(unix))]
    0
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_said_is_understood() {
        let answer = Answer { step: 3, status: 2, peak_bytes: 1 << 40, kept_bytes: 7, processor_ms: 9 };
        assert_eq!(Answer::read(&answer.line()), Some(answer));
        for wrong in
            ["", "note: step: 3", "step: 3 status=300 peak_bytes=1 kept_bytes=1 processor_ms=1", "step: 3 status=0"]
        {
            assert_eq!(Answer::read(wrong), None, "{wrong}");
        }
        assert_eq!(read_at(&at(0.42131, "Reading frames")), Some((0.4213, "Reading frames")));
        assert_eq!([at(0.99999, "a"), at(1.0, "a")], ["at: 0.9999 a", "at: 1.0000 a"]);
        for wrong in ["", "note: at: 0.5 a", "at: 1.5 a", "at: NaN a", "at: 0.5"] {
            assert_eq!(read_at(wrong), None, "{wrong}");
        }
        let list = ["track", "a \"b\"\n.json"].map(str::to_owned);
        let line = request(&list);
        assert_eq!(line.matches('\n').count(), 1);
        assert_eq!(words(&line).unwrap(), list);
        assert_eq!(words("track a.json"), None);
    }
}
