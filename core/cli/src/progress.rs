//! Runs long work on the requested number of threads, tells its progress ([`crate::tell`]), and ends it when the program is asked to.
//!
//! Ctrl-C cancels the work in an orderly way, so that no file is half-written. Where a step takes longer than [`GRACE`] to
//! notice, the process ends without it. Files are still complete or absent, because each is renamed when it is complete,
//! and temporary files are removed. A second Ctrl-C ends the process at once. SIGTERM and SIGHUP do the same as Ctrl-C ([`crate::signals`]).
//! Commands without long work are ended in the same way.

use crate::failure::{Failure, line};
use crate::signals;
use crate::tell::{Teller, Way};
use clap::ArgMatches;
use rototoon::project::unfinished;
use rototoon::scene::{Cancelled, Progress};
use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, PoisonError};
use std::time::Duration;

/// The exit status that shells report for a process ended by Ctrl-C.
const INTERRUPTED: i32 = 130;

/// Time that the work has to end after Ctrl-C.
const GRACE: Duration = Duration::from_millis(1500);

static STOP: AtomicBool = AtomicBool::new(false);

/// Long work as it tells its progress.
struct Watched {
    teller: Teller,
    /// The last step that was reported.
    doing: Mutex<String>,
}

impl Progress for Watched {
    fn report(&self, step: &str, done: f64) -> Result<(), Cancelled> {
        if STOP.load(Ordering::Relaxed) {
            return Err(Cancelled);
        }
        step.clone_into(&mut self.doing.lock().unwrap_or_else(PoisonError::into_inner));
        self.teller.report(step, done);
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

/// The number of threads given; 0 for one per core.
fn threads(given: &ArgMatches) -> usize {
    given.get_one::<i64>("threads").and_then(|n| usize::try_from(*n).ok()).unwrap_or(0)
}

/// Runs `work` on the file `from`, on the number of threads and with the way to tell progress that were given.
pub fn run<T: Send>(
    given: &ArgMatches,
    from: &Path,
    work: impl FnOnce(&dyn Progress) -> Result<T, Failure> + Send,
) -> Result<T, Failure> {
    let threads = threads(given);
    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(threads)
        .build()
        .map_err(|error| Failure::Other(format!("cannot start {threads} threads: {error}")))?;
    let teller = Teller::new(Way::of(given, true), from.display().to_string());
    let watched = Watched { teller, doing: Mutex::default() };
    let result = pool.install(|| work(&watched));
    match &result {
        Ok(_) => watched.teller.end(&watched.doing.lock().unwrap_or_else(PoisonError::into_inner)),
        Err(_) => watched.teller.fail(),
    }
    result
}
