//! Runs long work and calls the progress callback on the caller's own thread.
//!
//! The core reports progress from any of its threads. The foreign callback must not be called from there: hosts allow
//! their API on one thread only, and every worker would wait for the interpreter lock. So the work runs on a thread of
//! its own and writes its reports to a `Board`. The calling thread reads the board at a steady pace and calls back.
//! It calls back even if nothing has changed, so that a host can notice a key press or a signal during a long step.

use crate::pool::Pool;
use crate::status::Failure;
use rototoon::scene::{Cancelled, Progress, Silent};
use std::sync::{Condvar, Mutex, PoisonError};
use std::time::Duration;

/// The progress callback. It gets the finished share (0 to 1) and the name of the step, and returns whether to go on.
pub type GoOn<'a> = Option<&'a mut dyn FnMut(f64, &str) -> bool>;

/// Time between two calls of the callback. It feels immediate and costs next to nothing.
const PACE: Duration = Duration::from_millis(50);

/// The latest report of the work, and whether the caller has cancelled it.
#[derive(Default)]
struct Board {
    done: f64,
    step: String,
    cancelled: bool,
    finished: bool,
}

#[derive(Default)]
struct Shared {
    board: Mutex<Board>,
    finished: Condvar,
}

impl Shared {
    fn board(&self) -> std::sync::MutexGuard<'_, Board> {
        self.board.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Progress for Shared {
    fn report(&self, step: &str, done: f64) -> Result<(), Cancelled> {
        let mut board = self.board();
        if done >= board.done {
            board.done = done.min(1.0);
            step.clone_into(&mut board.step);
        }
        if board.cancelled { Err(Cancelled) } else { Ok(()) }
    }
}

/// Marks the work as finished when dropped, even after a panic.
struct Finish<'a>(&'a Shared);

impl Drop for Finish<'_> {
    fn drop(&mut self) {
        self.0.board().finished = true;
        self.0.finished.notify_all();
    }
}

/// Runs `work` on `threads` threads (0 for one per core).
///
/// `go_on(done, step)` is called on this thread: once before the work begins, and once after it has succeeded. Once it
/// has returned false, the result of the work is dropped and the call fails with [`Failure::Cancelled`].
pub fn run<T: Send>(
    threads: usize,
    go_on: GoOn<'_>,
    work: impl FnOnce(&dyn Progress) -> Result<T, Failure> + Send,
) -> Result<T, Failure> {
    let pool = Pool::of(threads)?;
    let in_pool = |progress: &dyn Progress| pool.install(|| work(progress));
    let Some(go_on) = go_on else { return in_pool(&Silent) };
    if !go_on(0.0, "starting") {
        return Err(Failure::Cancelled);
    }
    let shared = Shared::default();
    // The step that the callback gets until the work makes its first report.
    "starting".clone_into(&mut shared.board().step);
    let result = std::thread::scope(|scope| {
        let worker = scope.spawn(|| {
            let _finish = Finish(&shared);
            in_pool(&shared)
        });
        watch(&shared, go_on);
        worker.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic))
    });
    if shared.board().cancelled {
        return Err(Failure::Cancelled);
    }
    let result = result?;
    if go_on(1.0, "done") { Ok(result) } else { Err(Failure::Cancelled) }
}

/// Calls back at a steady pace until the work has ended.
fn watch(shared: &Shared, go_on: &mut dyn FnMut(f64, &str) -> bool) {
    loop {
        let waiting = shared.finished.wait_timeout_while(shared.board(), PACE, |board| !board.finished);
        let (board, _) = waiting.unwrap_or_else(PoisonError::into_inner);
        if board.finished {
            return;
        }
        let (done, step, cancelled) = (board.done, board.step.clone(), board.cancelled);
        drop(board);
        if !cancelled && !go_on(done, &step) {
            shared.board().cancelled = true;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::atomic::{AtomicBool, Ordering};

    #[test]
    fn callback_runs_on_the_calling_thread_with_rising_shares() {
        let caller = std::thread::current().id();
        let mut seen = Vec::new();
        let mut go_on = |done: f64, _: &str| {
            assert_eq!(std::thread::current().id(), caller);
            seen.push(done);
            true
        };
        let answer = run(2, Some(&mut go_on), |progress| {
            assert_ne!(std::thread::current().id(), caller);
            progress.report("late", 0.7)?;
            progress.report("early", 0.3)?;
            std::thread::sleep(3 * PACE);
            Ok(42)
        });
        assert_eq!(answer, Ok(42));
        assert!(seen.is_sorted(), "{seen:?}");
        assert_eq!((seen.first(), seen.last()), (Some(&0.0), Some(&1.0)));
        assert!(seen.contains(&0.7), "{seen:?}");
    }

    #[test]
    fn work_cancelled_at_the_start_never_begins() {
        let begun = AtomicBool::new(false);
        let answer = run(0, Some(&mut |_, _| false), |_| {
            begun.store(true, Ordering::Relaxed);
            Ok(())
        });
        assert_eq!(answer, Err(Failure::Cancelled));
        assert!(!begun.into_inner());
    }

    #[test]
    fn cancelled_work_is_stopped_and_its_result_dropped() {
        let answer = run(0, Some(&mut |done, _| done < 0.5), |progress| {
            while progress.report("working", 0.5).is_ok() {
                std::thread::sleep(PACE / 10);
            }
            Ok(())
        });
        assert_eq!(answer, Err(Failure::Cancelled));
        assert_eq!(run(0, Some(&mut |done, _| done < 1.0), |_| Ok(())), Err(Failure::Cancelled));
    }

    #[test]
    fn panics_of_the_work_reach_the_caller() {
        let caught = std::panic::catch_unwind(|| {
            run(0, Some(&mut |_, _| true), |_| -> Result<(), Failure> { panic!("broken") })
        });
        assert_eq!(caught.unwrap_err().downcast_ref::<&str>(), Some(&"broken"));
    }
}
