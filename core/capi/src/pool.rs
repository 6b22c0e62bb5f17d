//! The threads that do the work.
//!
//! Work with a given number of threads gets a pool for that call. Other work runs on one pool that the process keeps.
//! This is not rayon's global pool, because of fork: a forked child has the memory of the global pool and none of its
//! threads, so work there waits for ever. Python's `multiprocessing` forks by default on Linux up to 3.13. The pool
//! here knows the process that made it. In any other process each call makes a pool of its own, which takes about a
//! tenth of a millisecond.

use crate::status::Failure;
use rayon::{ThreadPool, ThreadPoolBuilder};
use std::process;
use std::sync::OnceLock;

/// Most threads. More are a mistake of the caller, and each one costs a stack.
const MAX_THREADS: usize = 1024;

/// The pool of the process that first needed one, and the id of that process.
static KEPT: OnceLock<(u32, ThreadPool)> = OnceLock::new();

/// A pool for work.
pub enum Pool {
    /// The pool that this process keeps.
    Kept(&'static ThreadPool),
    /// A pool for one call.
    Own(ThreadPool),
}

impl Pool {
    /// A pool of `threads` threads, 0 for one per core.
    ///
    /// # Errors
    ///
    /// More than 1024 threads, or the system starts no more threads.
    pub fn of(threads: usize) -> Result<Self, Failure> {
        match threads {
            0 => Self::kept(),
            1..=MAX_THREADS => new(threads).map(Self::Own),
            _ => Err(Failure::Error(format!("threads: found {threads}, expected at most {MAX_THREADS}"))),
        }
    }

    fn kept() -> Result<Self, Failure> {
        if KEPT.get().is_none() {
            // The pool is made before the cell is entered. A fork while another thread is in the cell would leave it
            // locked in the child; so that thread is there only for an instant. If two threads come here at once, the
            // pool of the second one goes again.
            let _ = KEPT.set((process::id(), new(0)?));
        }
        match KEPT.get() {
            Some((owner, pool)) if *owner == process::id() => Ok(Self::Kept(pool)),
            _ => new(0).map(Self::Own),
        }
    }

    /// Runs `work` on the pool. All parallel work inside it uses the pool's threads.
    pub fn install<T: Send>(&self, work: impl FnOnce() -> T + Send) -> T {
        match self {
            Self::Kept(pool) => pool.install(work),
            Self::Own(pool) => pool.install(work),
        }
    }
}

/// Runs `work` on a pool with one thread per core.
///
/// # Errors
///
/// The error of the work, or the system starts no more threads.
pub fn install<T: Send>(work: impl FnOnce() -> Result<T, Failure> + Send) -> Result<T, Failure> {
    Pool::of(0)?.install(work)
}

fn new(threads: usize) -> Result<ThreadPool, Failure> {
    ThreadPoolBuilder::new().num_threads(threads).build().map_err(Failure::error)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn work_runs_on_the_pool_that_the_process_keeps() {
        let names = || {
            let pool = Pool::of(0).unwrap();
            assert!(matches!(pool, Pool::Kept(_)));
            pool.install(|| rayon::current_thread_index().is_some())
        };
        assert!(names() && names());
        assert_eq!(Pool::of(3).unwrap().install(rayon::current_num_threads), 3);
    }

    #[test]
    fn unreasonable_thread_counts_are_refused() {
        let found = Pool::of(MAX_THREADS + 1).err();
        assert_eq!(found, Some(Failure::Error("threads: found 1025, expected at most 1024".into())));
    }
}
