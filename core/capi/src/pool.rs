//! The threads that do the work.
//!
//! Work with a given number of threads gets a pool for that call. Other work runs on one pool that the process keeps.
//! This is not rayon's global pool, because of fork: a forked child has the memory of the global pool and none of its
//! threads, so work there waits for ever. Python's `multiprocessing` forks by default on Linux up to 3.13. The pool
//! here knows the process that made it. In any other process each call makes a pool of its own, which takes about a
//! tenth of a millisecond.
//!
//! The threads end with [`release`], which the caller needs before it lets the library go: a thread whose code was taken
//! out of memory would crash at its next step. rayon ends the threads of a pool some time after the pool is dropped. So
//! the threads are started here, and the end of a pool waits for each of them.

use crate::status::Failure;
use rayon::{ThreadPool, ThreadPoolBuilder};
use std::process;
use std::sync::{Arc, Mutex, PoisonError, TryLockError};
use std::thread::JoinHandle;

/// Most threads. More are a mistake of the caller, and each one costs a stack.
const MAX_THREADS: usize = 1024;

/// The pool that a process keeps. It is locked only for an instant.
static KEPT: Mutex<Option<Kept>> = Mutex::new(None);

struct Kept {
    /// The id of the process that made the pool.
    owner: u32,
    pool: Arc<Threads>,
}

/// A pool that waits for the ends of its threads when it is dropped.
pub struct Threads {
    /// `None` only while it is dropped.
    pool: Option<ThreadPool>,
    handles: Vec<JoinHandle<()>>,
}

/// A pool for work.
pub enum Pool {
    /// The pool that this process keeps.
    Kept(Arc<Threads>),
    /// A pool for one call.
    Own(Threads),
}

/// As many threads as can be of use. Many more than there are cores only wait for each other, for minutes. No result depends on their number.
fn useful() -> usize {
    /// Threads for each core: some wait for the disk.
    const EACH: usize = 4;
    EACH * std::thread::available_parallelism().map_or(1, usize::from)
}

impl Pool {
    /// A pool of `threads` threads, 0 for one per core. There are at most four for each core.
    ///
    /// # Errors
    ///
    /// More than 1024 threads, or the system starts no more threads.
    pub fn of(threads: usize) -> Result<Self, Failure> {
        match threads {
            0 => Self::kept(),
            1..=MAX_THREADS => Threads::new(threads.min(useful())).map(Self::Own),
            _ => Err(Failure::Error(format!("threads: found {threads}, expected at most {MAX_THREADS}"))),
        }
    }

    fn kept() -> Result<Self, Failure> {
        if let Some(pool) = known()? {
            return Ok(pool);
        }
        // The pool is made while nothing is locked. A fork while another thread holds the lock leaves it locked in the
        // child; so that thread holds it only for an instant. If two threads come here at once, the pool of the second
        // one goes again.
        let made = Kept { owner: process::id(), pool: Arc::new(Threads::new(0)?) };
        let mut kept = KEPT.lock().unwrap_or_else(PoisonError::into_inner);
        Ok(Self::Kept(kept.get_or_insert(made).pool.clone()))
    }

    /// Runs `work` on the pool. All parallel work inside it uses the pool's threads.
    pub fn install<T: Send>(&self, work: impl FnOnce() -> T + Send) -> T {
        match self {
            Self::Kept(pool) => pool.install(work),
            Self::Own(pool) => pool.install(work),
        }
    }
}

impl Threads {
    /// Starts `threads` threads, 0 for one per core.
    fn new(threads: usize) -> Result<Self, Failure> {
        let mut handles = Vec::new();
        let builder = ThreadPoolBuilder::new().num_threads(threads).spawn_handler(|thread| {
            handles.push(std::thread::Builder::new().spawn(|| thread.run())?);
            Ok(())
        });
        let pool = builder.build().map_err(Failure::error)?;
        Ok(Self { pool: Some(pool), handles })
    }

    fn install<T: Send>(&self, work: impl FnOnce() -> T + Send) -> T {
        match &self.pool {
            Some(pool) => pool.install(work),
            None => work(),
        }
    }
}

impl Drop for Threads {
    fn drop(&mut self) {
        // This tells the threads to end.
        self.pool = None;
        for handle in self.handles.drain(..) {
            // A thread that panicked has ended too.
            let _ = handle.join();
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

/// The kept pool, or one for a single call where the kept one cannot be used; `None` where there is none yet.
fn known() -> Result<Option<Pool>, Failure> {
    let kept = match KEPT.try_lock() {
        Ok(kept) => kept,
        Err(TryLockError::Poisoned(error)) => error.into_inner(),
        // Another thread has it for an instant, or, in a forked child, for ever.
        Err(TryLockError::WouldBlock) => return Threads::new(0).map(|pool| Some(Pool::Own(pool))),
    };
    match &*kept {
        Some(kept) if kept.owner == process::id() => Ok(Some(Pool::Kept(kept.pool.clone()))),
        Some(_) => Threads::new(0).map(|pool| Some(Pool::Own(pool))),
        None => Ok(None),
    }
}

/// Ends the threads of the kept pool and waits for their ends. Later work makes a new pool.
///
/// # Errors
///
/// [`Failure::Busy`] while work runs on the pool.
pub fn release() -> Result<(), Failure> {
    let mut kept = KEPT.lock().unwrap_or_else(PoisonError::into_inner);
    let Some(Kept { owner, pool }) = kept.take() else { return Ok(()) };
    if owner != process::id() {
        // A forked child has the memory of the pool and none of its threads: nobody can be waited for.
        std::mem::forget(pool);
        return Ok(());
    }
    match Arc::try_unwrap(pool) {
        Ok(pool) => drop(pool),
        Err(pool) => {
            *kept = Some(Kept { owner, pool });
            return Err(Failure::Busy);
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn work_runs_on_the_pool_that_the_process_keeps() {
        let names = || {
            let pool = Pool::of(0).unwrap();
            pool.install(|| rayon::current_thread_index().is_some())
        };
        assert!(names() && names());
        assert_eq!(Pool::of(3).unwrap().install(rayon::current_num_threads), 3);
    }

    #[test]
    fn a_pool_in_use_is_not_released() {
        // Other tests use the kept pool too, so only what holds beside them is asserted.
        let pool = Pool::of(0).unwrap();
        if matches!(pool, Pool::Kept(_)) {
            assert_eq!(release(), Err(Failure::Busy));
        }
        assert_eq!(pool.install(|| 7), 7);
        drop(pool);
        let _ = release();
        assert_eq!(install(|| Ok(8)), Ok(8));
    }

    #[test]
    fn unreasonable_thread_counts_are_refused() {
        let found = Pool::of(MAX_THREADS + 1).err();
        assert_eq!(found, Some(Failure::Error("threads: found 1025, expected at most 1024".into())));
    }
}
