//! Ctrl-C and the signals that end a program in order.
//!
//! Unix sends SIGINT for Ctrl-C, SIGTERM to end a program, and SIGHUP when its terminal goes. `nohup` starts a program with SIGHUP ignored, so that
//! a night's work outlives the terminal. A handler would undo that. So SIGHUP is caught only where it was not ignored at the start. Linux tells
//! it in `/proc/self/status`. Elsewhere it is always caught: there `nohup` needs the shell's `disown` or a terminal multiplexer.
//!
//! SIGXFSZ, which comes where a file gets too large for a limit of the user (`ulimit -f`), is caught and does nothing: writing then fails in order.
//!
//! A program that was stopped ends by the signal that stopped it: after everything is tidied up, the signal gets its default action back and is raised again ([`end`]). A shell then
//! gives 130 for SIGINT, 143 for SIGTERM and 129 for SIGHUP, and a farm that looks closer sees a signal and not a failure. So a rule such as "try again what was stopped, look at what failed" needs
//! no reading of logs. An exit with status 143 would look the same in a shell, but not to what starts programs: a loop in a shell goes on after a command that exits with 130 and stops after one that SIGINT
//! ended, and systemd counts an end by SIGTERM as clean and status 143 as a failure. Process 1 of a container is an exception: the system lets no default action end it, so it
//! exits with the number.
//!
//! A SIGINT that was ignored at the start is caught. Shells ignore it for commands in the background, so that the Ctrl-C of another command does
//! not end them; but it is sent to them by name only to stop them.

#[cfg(unix)]
use std::sync::Arc;

/// What is added to a signal's number in an exit status.
pub const STOPPED: u8 = 128;
/// The number of the signal of Ctrl-C.
#[cfg(not(unix))]
const INTERRUPT: i32 = 2;

/// Calls `interrupt` with the signal on a thread of its own for each signal.
#[cfg(unix)]
pub fn catch(interrupt: impl Fn(i32) + Send + 'static) -> std::io::Result<()> {
    use signal_hook::consts::{SIGHUP, SIGINT, SIGTERM, SIGXFSZ};
    // The file would be larger than the user's limit: with a handler the write fails, and its error names the file.
    signal_hook::flag::register(SIGXFSZ, Arc::default())?;
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let mut caught = vec![SIGINT, SIGTERM];
    if !is_ignored(SIGHUP, &status) {
        caught.push(SIGHUP);
    }
    let mut signals = signal_hook::iterator::Signals::new(caught)?;
    std::thread::Builder::new().name("signals".to_owned()).spawn(move || signals.forever().for_each(&interrupt))?;
    Ok(())
}

/// Calls `interrupt` on a thread of its own for Ctrl-C, and where the console is closed.
#[cfg(not(unix))]
pub fn catch(interrupt: impl Fn(i32) + Send + 'static) -> Result<(), ctrlc::Error> {
    ctrlc::set_handler(move || interrupt(INTERRUPT))
}

/// The exit status that a shell gives of a program that a signal ended.
pub fn status(signal: i32) -> u8 {
    STOPPED.saturating_add(u8::try_from(signal).unwrap_or(0))
}

/// The name of a signal, such as `SIGTERM`.
#[cfg(unix)]
pub fn name(signal: i32) -> &'static str {
    signal_hook::low_level::signal_name(signal).unwrap_or("a signal")
}

/// The name of a signal. Only Ctrl-C comes here, and the closing of the console in its place.
#[cfg(not(unix))]
pub fn name(_signal: i32) -> &'static str {
    "Ctrl-C"
}

/// Ends the program by a signal that stopped it.
pub fn end(signal: i32) -> ! {
    // The first process of a container would not be ended by it.
    #[cfg(unix)]
    if std::process::id() != 1 {
        let _ = signal_hook::low_level::emulate_default_handler(signal);
    }
    std::process::exit(i32::from(status(signal)))
}

/// Whether a signal is ignored, by the status that Linux gives of a process: a mask in hexadecimal digits, whose lowest bit is signal 1.
#[cfg(unix)]
fn is_ignored(signal: i32, status: &str) -> bool {
    let mask = status.lines().find_map(|line| line.strip_prefix("SigIgn:"));
    let mask = mask.and_then(|digits| u64::from_str_radix(digits.trim(), 16).ok());
    mask.is_some_and(|mask| mask >> (signal - 1) & 1 == 1)
}

#[cfg(all(test, unix))]
mod tests {
    use super::*;

    #[test]
    fn signals_have_names_and_statuses() {
        let said = |signal| (name(signal), status(signal));
        assert_eq!([1, 2, 15].map(said), [("SIGHUP", 129), ("SIGINT", 130), ("SIGTERM", 143)]);
    }

    #[test]
    fn an_ignored_signal_is_known_by_its_bit() {
        let status = "Name:\trototoon\nSigBlk:\t0000000000000000\nSigIgn:\t0000000000001004\n";
        assert!(is_ignored(3, status) && is_ignored(13, status));
        assert!(!is_ignored(1, status) && !is_ignored(2, status) && !is_ignored(1, ""));
        assert!(is_ignored(1, "SigIgn:\t0000000000000001"));
    }
}
