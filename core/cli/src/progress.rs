//! Runs long work on the requested number of threads. If standard error is a terminal, it shows a progress bar.
//!
//! Ctrl-C cancels the work in an orderly way, so that no file is half-written. Where a step takes longer than [`GRACE`] to
//! notice, the process ends without it. Files are still complete or absent, because each is renamed when it is complete,
//! and temporary files are removed. A second Ctrl-C ends the process at once. SIGTERM and SIGHUP do the same as Ctrl-C ([`crate::signals`]).
//! Commands without long work are ended in the same way.

use crate::failure::{Failure, line};
use crate::signals;
use indicatif::{ProgressBar, ProgressStyle};
use rototoon::project::unfinished;
use rototoon::scene::{Cancelled, Progress};
use std::io::IsTerminal;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

/// Number of steps of the bar.
const STEPS: u64 = 1000;
/// The exit status that shells report for a process ended by Ctrl-C.
const INTERRUPTED: i32 = 130;

/// Time that the work has to end after Ctrl-C.
const GRACE: Duration = Duration::from_millis(1500);

static STOP: AtomicBool = AtomicBool::new(false);

struct Bar(ProgressBar);

impl Progress for Bar {
    fn report(&self, step: &str, done: f64) -> Result<(), Cancelled> {
        if STOP.load(Ordering::Relaxed) {
            return Err(Cancelled);
        }
        let position = (done.clamp(0.0, 1.0) * STEPS as f64) as u64;
        if !self.0.is_hidden() && position >= self.0.position() {
            self.0.set_message(step.to_owned());
            self.0.set_position(position);
        }
        Ok(())
    }
}

/// Whether the program was asked to end.
pub fn stopped() -> bool {
    STOP.load(Ordering::Relaxed)
}

/// Lets Ctrl-C, SIGTERM and SIGHUP end the program in order.
pub fn catch_signals() -> Result<(), Failure> {
    let interrupt = || {
        if STOP.swap(true, Ordering::Relaxed) {
            end();
        }
        std::thread::spawn(|| {
            std::thread::sleep(GRACE);
            line("error", &Cancelled.to_string());
            end();
        });
    };
    signals::catch(interrupt).map_err(|error| Failure::Other(format!("cannot catch Ctrl-C: {error}")))
}

/// Ends the process. The work goes on until then, so its temporary files are removed here.
fn end() -> ! {
    unfinished::remove_all();
    std::process::exit(INTERRUPTED)
}

/// Runs `work` on `threads` threads; 0 for one per core.
pub fn run<T: Send>(
    threads: usize,
    work: impl FnOnce(&dyn Progress) -> Result<T, Failure> + Send,
) -> Result<T, Failure> {
    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(threads)
        .build()
        .map_err(|error| Failure::Other(format!("cannot start {threads} threads: {error}")))?;
    let bar = if std::io::stderr().is_terminal() { ProgressBar::new(STEPS) } else { ProgressBar::hidden() };
    if let Ok(style) = ProgressStyle::with_template("{msg:20} [{bar:40}] {percent:>3} % {eta}") {
        bar.set_style(style.progress_chars("=> "));
    }
    let bar = Bar(bar);
    let result = pool.install(|| work(&bar));
    bar.0.finish_and_clear();
    result
}
