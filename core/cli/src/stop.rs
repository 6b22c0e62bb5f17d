//! Ends the program in order when it is asked to, and says of what work and how far it was.
//!
//! Ctrl-C cancels the work in an orderly way, so that no file is half-written. Where a step takes longer than [`grace`] to
//! notice, the process ends without it. Files are still complete or absent, because each is renamed when it is complete,
//! and temporary files are removed. A second Ctrl-C ends the process at once. SIGTERM and SIGHUP do the same as Ctrl-C ([`signals`]).
//! Commands without long work are ended in the same way.
//!
//! In all of these cases one line says what was stopped, and the program ends by the signal itself. So what was stopped never looks like what failed. Work
//! that came to its end all the same, because the signal came late, ends with its own status: 0, or that of what it found or what failed.
//! A program that takes steps for a batch says nothing between two of them: its answer was its last word.

use crate::failure::{Failure, line};
use crate::{signals, tell};
use rototoon::project::unfinished;
use std::sync::atomic::{AtomicBool, AtomicI32, Ordering};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::Duration;

/// The signal that asked the program to end; 0 if none did.
static SIGNAL: AtomicI32 = AtomicI32::new(0);
/// Whether no work is under way, so that nothing is to be said of it.
static RESTS: AtomicBool = AtomicBool::new(false);
/// Whether it was said what was stopped.
static SAID: AtomicBool = AtomicBool::new(false);
/// The work that runs.
static WORK: Mutex<Work> = Mutex::new(Work { name: String::new(), at: None, done: None });

/// What is counted of work whose parts stay when it is stopped.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Counted {
    /// Pictures, each a file.
    Frames,
    /// Shots of a batch.
    Shots,
}

/// Work, and how far it is.
#[derive(Debug)]
struct Work {
    /// The document; empty where it is not known.
    name: String,
    /// The share that is done, and what is done now.
    at: Option<(f64, String)>,
    /// How many parts are done, of how many.
    done: Option<(usize, usize, Counted)>,
}

impl Work {
    /// The line for a signal of this name.
    fn stopped_by(&self, signal: &str) -> String {
        let name = if self.name.is_empty() { String::new() } else { format!("{}: ", self.name) };
        let how_far = match (self.done, &self.at) {
            (Some((done, of, Counted::Shots)), _) => format!(" after {done} of {of} shots; start it again to go on"),
            (Some((0, of, Counted::Frames)), _) => format!(" after 0 of {of} frames; nothing was written"),
            (Some((done, of, Counted::Frames)), _) => format!(" after {done} of {of} frames, which are whole"),
            (None, Some((share, doing))) => {
                format!(" at {:.0} % ({doing}); nothing was written", (100.0 * share).floor())
            }
            (None, None) => String::new(),
        };
        format!("{name}cancelled by {signal}{how_far}")
    }
}

fn work() -> MutexGuard<'static, Work> {
    WORK.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Work on a document begins.
pub fn begin(name: String) {
    *work() = Work { name, at: None, done: None };
    RESTS.store(false, Ordering::Relaxed);
}

/// No work is under way until some begins: a signal ends the program without a word.
pub fn rest() {
    RESTS.store(true, Ordering::Relaxed);
}

/// A share of the work is done.
pub fn at(doing: &str, share: f64) {
    let mut work = work();
    match &mut work.at {
        Some((before, text)) => {
            *before = share;
            doing.clone_into(text);
        }
        none => *none = Some((share, doing.to_owned())),
    }
}

/// So many parts are done, of so many. The number never falls.
pub fn done(count: usize, of: usize, counted: Counted) {
    let mut work = work();
    let before = work.done.map_or(0, |(before, ..)| before);
    work.done = Some((count.max(before), of, counted));
}

/// The work came to its end. Its result may be written from now on.
pub fn worked() {
    let mut work = work();
    (work.at, work.done) = (None, None);
}

/// The signal that asked the program to end.
pub fn signal() -> Option<i32> {
    Some(SIGNAL.load(Ordering::Relaxed)).filter(|signal| *signal != 0)
}

/// Lets Ctrl-C, SIGTERM and SIGHUP end the program in order.
pub fn catch_signals() -> Result<(), Failure> {
    let interrupt = |signal| {
        if SIGNAL.swap(signal, Ordering::Relaxed) != 0 {
            say(signal);
            end(signal);
        }
        std::thread::spawn(move || {
            std::thread::sleep(grace());
            say(signal);
            end(signal);
        });
    };
    signals::catch(interrupt).map_err(|error| Failure::Other(format!("cannot catch Ctrl-C: {error}")))
}

/// Time that the work has to end after Ctrl-C. A program that takes steps for a batch has less, so that the batch sees its end within its own time.
fn grace() -> Duration {
    Duration::from_millis(if tell::is_for_batch() { 1000 } else { 1500 })
}

/// Says once what was stopped, if work is under way.
pub fn say(signal: i32) {
    if !RESTS.load(Ordering::Relaxed) && !SAID.swap(true, Ordering::Relaxed) {
        line("error", &work().stopped_by(signals::name(signal)));
    }
}

/// Ends the process by a signal. Where work goes on until then, its temporary files are removed here.
pub fn end(signal: i32) -> ! {
    unfinished::remove_all();
    signals::end(signal)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_was_stopped_is_named_with_how_far_it_was() {
        let at = |share: f64, doing: &str| Some((share, doing.to_owned()));
        for (name, at, done, expected) in [
            ("", None, None, "cancelled by SIGTERM"),
            ("a.json", None, None, "a.json: cancelled by SIGTERM"),
            (
                "a.json",
                at(0.649, "Tracking"),
                None,
                "a.json: cancelled by SIGTERM at 64 % (Tracking); nothing was written",
            ),
            (
                "a.json",
                at(0.5, "Rendering"),
                Some((12, 24, Counted::Frames)),
                "a.json: cancelled by SIGTERM after 12 of 24 frames, which are whole",
            ),
            (
                "a.json",
                at(0.0, "Rendering"),
                Some((0, 24, Counted::Frames)),
                "a.json: cancelled by SIGTERM after 0 of 24 frames; nothing was written",
            ),
            (
                "m.json",
                None,
                Some((3, 20, Counted::Shots)),
                "m.json: cancelled by SIGTERM after 3 of 20 shots; start it again to go on",
            ),
        ] {
            assert_eq!(Work { name: name.to_owned(), at, done }.stopped_by("SIGTERM"), expected);
        }
    }
}
