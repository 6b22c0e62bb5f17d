//! Work on the host's threads.
//!
//! The next free thread takes the next job. If the host has no threads, or lends none, the calling thread does all jobs.

use super::effect::Effect;
use openfx::sys::image_effect_v1::multi_thread::OfxMultiThreadSuiteV1;
use std::ffi::{c_uint, c_void};
use std::panic::{AssertUnwindSafe, catch_unwind, resume_unwind};
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Mutex, PoisonError};

struct Work<'a> {
    next: AtomicUsize,
    count: usize,
    job: &'a (dyn Fn(usize) + Sync),
    panic: Mutex<Option<Box<dyn std::any::Any + Send>>>,
}

impl Work<'_> {
    fn go(&self) {
        loop {
            let index = self.next.fetch_add(1, Ordering::Relaxed);
            if index >= self.count {
                return;
            }
            (self.job)(index);
        }
    }
}

/// Calls `job` with every number below `count`.
pub fn each(effect: &Effect, count: usize, job: &(dyn Fn(usize) + Sync)) {
    let work = Work { next: AtomicUsize::new(0), count, job, panic: Mutex::new(None) };
    if let Some(suite) = effect.suites.threads {
        let threads = threads(suite).min(count);
        if threads > 1
            && let Some(function) = suite.multiThread
        {
            let argument: *const Work = &work;
            // SAFETY: the function returns after all threads have ended. The work outlives it, and threads may share it.
            let _ = unsafe { function(Some(run), threads as c_uint, argument.cast_mut().cast()) };
        }
    }
    let panic = work.panic.lock().unwrap_or_else(PoisonError::into_inner).take();
    if let Some(panic) = panic {
        resume_unwind(panic);
    }
    // Jobs that no thread has taken.
    work.go();
}

/// The number of threads that the host lends.
pub fn count(effect: &Effect) -> usize {
    effect.suites.threads.map_or(1, threads)
}

fn threads(suite: &OfxMultiThreadSuiteV1) -> usize {
    // SAFETY: the function has no arguments. OpenFX allows no threads within threads.
    if suite.multiThreadIsSpawnedThread.is_some_and(|function| unsafe { function() } != 0) {
        return 1;
    }
    let mut count: c_uint = 1;
    // SAFETY: the pointer is to a local number.
    let status = suite.multiThreadNumCPUs.map(|function| unsafe { function(&mut count) });
    if status == Some(0) { count as usize } else { 1 }
}

/// The entry point of each thread.
unsafe extern "C" fn run(_index: c_uint, _count: c_uint, argument: *mut c_void) {
    // SAFETY: the argument is the work of `each`, which outlives the call.
    let work = unsafe { &*argument.cast_const().cast::<Work>() };
    if let Err(panic) = catch_unwind(AssertUnwindSafe(|| work.go())) {
        *work.panic.lock().unwrap_or_else(PoisonError::into_inner) = Some(panic);
    }
}
