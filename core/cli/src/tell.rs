//! How the progress of long work is told: as a bar, as lines of a log, as JSON, in the words of a farm's engine, or not at all.
//!
//! | `--progress` | what is told, and where |
//! | --- | --- |
//! | `auto` | a bar, if standard error is a terminal; else nothing |
//! | `lines` | `progress: shot.json: 42 %, 12 s, Reading frames` on standard error |
//! | `json` | an object in each line on standard error |
//! | `openjd` | `openjd_progress: 42.0` and `openjd_status: …` on standard output, where Open Job Description has them |
//! | `none` | nothing |
//!
//! Work reports hundreds of steps a second. A log wants few lines, and wants to show that the work goes on. So a line is told at the begin and at the end; between them only where enough
//! time has passed since the line before, and either the share has grown by enough or much time has passed ([`Pace`]). Nothing is told by a timer: a line always says that the work itself moved, so
//! a log that stands still means that the step does not move. A batch also says nothing while it waits for another worker or for memory, reads footage to compare it, or draws the
//! contact sheet of a shot.
//!
//! A program that takes steps for a batch tells the batch in lines of their own ([`rototoon_batch::answer`]), whatever its way.

use crate::failure::line;
use clap::builder::{PossibleValue, PossibleValuesParser};
use clap::{Arg, ArgMatches};
use indicatif::{ProgressBar, ProgressStyle};
use rototoon_batch::answer;
use serde_json::json;
use std::io::{IsTerminal, Write, stderr, stdout};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, PoisonError};
use std::time::Instant;

/// Number of steps of the bar.
const STEPS: u64 = 1000;

/// Whether this program takes steps for a batch.
static FOR_BATCH: AtomicBool = AtomicBool::new(false);

/// Lets progress go to the batch that this program takes steps for.
pub fn to_batch() {
    FOR_BATCH.store(true, Ordering::Relaxed);
}

/// Whether this program takes steps for a batch.
pub fn is_for_batch() -> bool {
    FOR_BATCH.load(Ordering::Relaxed)
}

/// How progress is told.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Way {
    /// A bar on a terminal.
    Bar,
    /// Lines for a log.
    Lines,
    /// A JSON object in each line.
    Json,
    /// The lines of Open Job Description.
    Openjd,
    /// The lines for a batch.
    Batch,
    /// Nothing.
    Nothing,
}

impl Way {
    /// The way that was asked for. `has_bar` says whether the command shows a bar on a terminal.
    pub fn of(given: &ArgMatches, has_bar: bool) -> Self {
        if is_for_batch() {
            return Self::Batch;
        }
        match given.get_one::<String>("progress").map(String::as_str) {
            Some("lines") => Self::Lines,
            Some("json") => Self::Json,
            Some("openjd") => Self::Openjd,
            Some("none") => Self::Nothing,
            _ if has_bar && stderr().is_terminal() => Self::Bar,
            _ => Self::Nothing,
        }
    }

    fn pace(self) -> Pace {
        match self {
            // A person reads them.
            Self::Lines => Pace { least: 1.0, grown: 0.05, most: 30.0 },
            _ => Pace { least: 0.2, grown: 0.01, most: 5.0 },
        }
    }
}

/// `--progress`.
pub fn option() -> Arg {
    let ways = PossibleValuesParser::new([
        PossibleValue::new("auto").help("A bar, if standard error is a terminal"),
        PossibleValue::new("lines").help("Lines on standard error, for a log"),
        PossibleValue::new("json").help("A JSON object in each line on standard error, for programs"),
        PossibleValue::new("openjd").help("The lines of Open Job Description on standard output, for render farms"),
        PossibleValue::new("none").help("Nothing"),
    ]);
    Arg::new("progress")
        .long("progress")
        .help("How the command says how far it is")
        .default_value("auto")
        .value_parser(ways)
}

/// When a line was told, in seconds, and with which share.
type Told = (f64, f64);

/// When a line is due.
#[derive(Clone, Copy, Debug)]
struct Pace {
    /// Least time between two lines, in seconds.
    least: f64,
    /// Growth of the share that is worth a line.
    grown: f64,
    /// Time after which any report is worth a line, in seconds.
    most: f64,
}

impl Pace {
    /// What is told of this share after the line before; `None` where no line is due. The share that is told never falls, although work in several parts may report less.
    fn next(self, before: Option<Told>, (seconds, share): Told, is_last: bool) -> Option<Told> {
        let Some((then, told)) = before else { return Some((seconds, share)) };
        let passed = seconds - then;
        let is_due = passed >= self.least && (share - told >= self.grown || passed >= self.most);
        (is_due || is_last).then_some((seconds, share.max(told)))
    }
}

/// Tells the progress of the work on a document.
pub struct Teller {
    way: Way,
    name: String,
    start: Instant,
    bar: ProgressBar,
    /// The last line.
    last: Mutex<Option<Told>>,
}

impl Teller {
    /// Begins to tell of the work on a document of this name.
    pub fn new(way: Way, name: String) -> Self {
        let bar = if way == Way::Bar { ProgressBar::new(STEPS) } else { ProgressBar::hidden() };
        if let Ok(style) = ProgressStyle::with_template("{msg:20} [{bar:40}] {percent:>3} % {eta}") {
            bar.set_style(style.progress_chars("=> "));
        }
        Self { way, name: one_line(&name), start: Instant::now(), bar, last: Mutex::default() }
    }

    /// `share` of the work is done, and `doing` is the present step.
    pub fn report(&self, doing: &str, share: f64) {
        let share = share.clamp(0.0, 1.0);
        match self.way {
            Way::Nothing => {}
            Way::Bar => {
                let position = (share * STEPS as f64) as u64;
                if position >= self.bar.position() {
                    self.bar.set_message(doing.to_owned());
                    self.bar.set_position(position);
                }
            }
            _ => self.line(doing, share, false),
        }
    }

    /// The work came to its end. A bar goes, and lines get the last one.
    pub fn end(&self, doing: &str) {
        match self.way {
            Way::Nothing => {}
            Way::Bar => self.bar.finish_and_clear(),
            _ => self.line(doing, 1.0, true),
        }
    }

    /// The work failed. A bar goes.
    pub fn fail(&self) {
        self.bar.finish_and_clear();
    }

    fn line(&self, doing: &str, share: f64, is_last: bool) {
        // Locked while it is written, so that lines are in their order.
        let mut last = self.last.lock().unwrap_or_else(PoisonError::into_inner);
        let seconds = self.start.elapsed().as_secs_f64();
        if let Some(told) = self.way.pace().next(*last, (seconds, share), is_last) {
            *last = Some(told);
            self.write(&one_line(doing), told);
        }
    }

    /// Writes a line. A closed output is ignored.
    fn write(&self, doing: &str, (seconds, share): Told) {
        // Rounded down: 100 % is the end alone.
        let (name, percent) = (&self.name, (1000.0 * share).floor() / 10.0);
        match self.way {
            Way::Lines => line("progress", &in_a_log(name, percent, seconds, doing)),
            Way::Json => {
                let seconds = (1000.0 * seconds).round() / 1000.0;
                let told = json!({"event": "progress", "document": name, "step": doing, "percent": percent, "seconds": seconds});
                let _ = stderr().write_all(format!("{told}\n").as_bytes());
            }
            Way::Openjd => {
                let text = format!("openjd_progress: {percent:.1}\nopenjd_status: {name}: {doing}\n");
                let _ = stdout().write_all(text.as_bytes()).and_then(|()| stdout().flush());
            }
            Way::Batch => drop(stderr().write_all((answer::at(share, doing) + "\n").as_bytes())),
            Way::Bar | Way::Nothing => {}
        }
    }
}

/// A line of a log.
fn in_a_log(name: &str, percent: f64, seconds: f64, doing: &str) -> String {
    format!("{name}: {:.0} %, {}, {doing}", percent.floor(), spoken(seconds))
}

/// Seconds as a person says them: `12 s`, `3 min 5 s`, `2 h 7 min`.
fn spoken(seconds: f64) -> String {
    let whole = seconds as u64;
    match (whole / 3600, whole / 60 % 60, whole % 60) {
        (0, 0, s) => format!("{s} s"),
        (0, min, s) => format!("{min} min {s} s"),
        (h, min, _) => format!("{h} h {min} min"),
    }
}

/// A text without ends of lines and other signs that a terminal or an engine obeys.
fn one_line(text: &str) -> String {
    text.chars().map(|sign| if sign.is_control() { ' ' } else { sign }).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_is_due_where_the_work_has_moved_and_now_and_then() {
        let pace = Way::Lines.pace();
        assert_eq!(pace.next(None, (0.0, 0.0), false), Some((0.0, 0.0)), "the first one");
        let before = Some((10.0, 0.2));
        for (now, share) in [
            ((10.5, 0.9), None),
            ((11.0, 0.24), None),
            ((11.0, 0.26), Some(0.26)),
            ((39.0, 0.21), None),
            ((40.0, 0.2), Some(0.2)),
            ((40.0, 0.1), Some(0.2)),
        ] {
            assert_eq!(pace.next(before, now, false), share.map(|share| (now.0, share)), "{now:?}");
        }
        assert_eq!(pace.next(before, (10.1, 1.0), true), Some((10.1, 1.0)), "the last one");
    }

    #[test]
    fn a_long_work_has_few_lines() {
        // Thirteen minutes with ten reports a second, as a farm's log gets them.
        let (pace, mut last, mut told) = (Way::Lines.pace(), None, 0);
        for k in 0..=7800 {
            let now = (f64::from(k) / 10.0, f64::from(k) / 7800.0);
            if let Some(now) = pace.next(last, now, false) {
                (last, told) = (Some(now), told + 1);
            }
        }
        assert!((20..=30).contains(&told), "{told}");
    }

    #[test]
    fn all_is_told_at_the_end_alone() {
        for (percent, text) in [(99.9, "a: 99 %, 7 s, b"), (100.0, "a: 100 %, 7 s, b")] {
            assert_eq!(in_a_log("a", percent, 7.0, "b"), text);
        }
    }

    #[test]
    fn times_are_spoken() {
        for (seconds, text) in [(0.9, "0 s"), (59.9, "59 s"), (185.0, "3 min 5 s"), (7620.0, "2 h 7 min")] {
            assert_eq!(spoken(seconds), text);
        }
        assert_eq!(one_line("a\nopenjd_fail: b"), "a openjd_fail: b");
    }
}
