//! Runs long work on the requested number of threads, tells its progress ([`tell`](crate::tell)), and cancels it where the program is asked to end ([`stop`]).

use crate::failure::Failure;
use crate::stop::{self, Counted};
use crate::tell::{Teller, Way};
use clap::ArgMatches;
use rototoon::scene::{Cancelled, Progress};
use std::path::Path;
use std::sync::{Mutex, PoisonError};

/// Long work as it tells its progress.
struct Watched {
    teller: Teller,
    /// The last step that was reported.
    doing: Mutex<String>,
}

impl Progress for Watched {
    fn report(&self, step: &str, done: f64) -> Result<(), Cancelled> {
        if stop::signal().is_some() {
            return Err(Cancelled);
        }
        step.clone_into(&mut self.doing.lock().unwrap_or_else(PoisonError::into_inner));
        stop::at(step, done);
        self.teller.report(step, done);
        Ok(())
    }

    fn written(&self, files: usize, of: usize) {
        stop::done(files, of, Counted::Frames);
    }
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
    let name = from.display().to_string();
    stop::begin(name.clone());
    let watched = Watched { teller: Teller::new(Way::of(given, true), name), doing: Mutex::default() };
    let result = pool.install(|| work(&watched));
    match &result {
        Ok(_) => {
            stop::worked();
            watched.teller.end(&watched.doing.lock().unwrap_or_else(PoisonError::into_inner));
        }
        Err(_) => watched.teller.fail(),
    }
    result
}
