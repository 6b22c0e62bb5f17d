//! Runs long work on the requested number of threads, tells its progress ([`tell`](crate::tell)), and cancels it where the program is asked to end ([`stop`]).

use crate::failure::Failure;
use crate::stop::{self, Counted};
use crate::tell::{Teller, Way};
use clap::ArgMatches;
use rototoon::scene::{Cancelled, Progress};
use std::path::Path;
use std::sync::{Mutex, PoisonError};

/// A part of work that consists of several. Each part reports its own shares from 0 to 1.
pub struct Part<'a> {
    whole: &'a dyn Progress,
    /// The share of the whole that is done before.
    before: f64,
    /// The part's share of the whole.
    share: f64,
}

impl<'a> Part<'a> {
    /// The first half of the work; all of it where no second one follows.
    pub fn first(whole: &'a dyn Progress, is_half: bool) -> Self {
        Self { whole, before: 0.0, share: if is_half { 0.5 } else { 1.0 } }
    }

    /// The second half of the work.
    pub fn second(whole: &'a dyn Progress) -> Self {
        Self { whole, before: 0.5, share: 0.5 }
    }
}

impl Progress for Part<'_> {
    fn report(&self, step: &str, done: f64) -> Result<(), Cancelled> {
        self.whole.report(step, self.before + self.share * done)
    }

    fn written(&self, files: usize, of: usize) {
        self.whole.written(files, of);
    }
}

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

#[cfg(test)]
mod tests {
    use super::*;

    /// Notes the shares.
    #[derive(Default)]
    struct Noted(Mutex<Vec<f64>>);

    impl Progress for Noted {
        fn report(&self, _step: &str, done: f64) -> Result<(), Cancelled> {
            self.0.lock().unwrap().push(done);
            Ok(())
        }
    }

    #[test]
    fn halves_make_a_whole() {
        let (noted, alone) = (Noted::default(), Noted::default());
        for share in [0.0, 0.5, 1.0] {
            Part::first(&noted, true).report("a", share).unwrap();
            Part::first(&alone, false).report("a", share).unwrap();
        }
        for share in [0.0, 0.5, 1.0] {
            Part::second(&noted).report("b", share).unwrap();
        }
        assert_eq!(*noted.0.lock().unwrap(), [0.0, 0.25, 0.5, 0.5, 0.75, 1.0]);
        assert_eq!(*alone.0.lock().unwrap(), [0.0, 0.5, 1.0]);
    }
}
