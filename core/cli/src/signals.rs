//! Ctrl-C and the signals that end a program in order.
//!
//! Unix sends SIGINT for Ctrl-C, SIGTERM to end a program, and SIGHUP when its terminal goes. `nohup` starts a program with SIGHUP ignored, so that
//! a night's work outlives the terminal. A handler would undo that. So SIGHUP is caught only where it was not ignored at the start. Linux tells
//! it in `/proc/self/status`. Elsewhere it is always caught: there `nohup` needs the shell's `disown` or a terminal multiplexer.
//!
//! SIGXFSZ, which comes where a file gets too large for a limit of the user (`ulimit -f`), is caught and does nothing: writing then fails in order.
//!
//! A SIGINT that was ignored at the start is caught. Shells ignore it for commands in the background, so that the Ctrl-C of another command does
//! not end them; but it is sent to them by name only to stop them.

#[cfg(unix)]
use std::sync::Arc;

/// Calls `interrupt` on a thread of its own for each signal.
#[cfg(unix)]
pub fn catch(interrupt: impl Fn() + Send + 'static) -> std::io::Result<()> {
    use signal_hook::consts::{SIGHUP, SIGINT, SIGTERM, SIGXFSZ};
    // The file would be larger than the user's limit: with a handler the write fails, and its error names the file.
    signal_hook::flag::register(SIGXFSZ, Arc::default())?;
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let mut caught = vec![SIGINT, SIGTERM];
    if !is_ignored(SIGHUP, &status) {
        caught.push(SIGHUP);
    }
    let mut signals = signal_hook::iterator::Signals::new(caught)?;
    std::thread::Builder::new()
        .name("signals".to_owned())
        .spawn(move || signals.forever().for_each(|_| interrupt()))?;
    Ok(())
}

/// Calls `interrupt` on a thread of its own for Ctrl-C, and where the console is closed.
#[cfg(not(unix))]
pub fn catch(interrupt: impl Fn() + Send + 'static) -> Result<(), ctrlc::Error> {
    ctrlc::set_handler(interrupt)
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
    fn an_ignored_signal_is_known_by_its_bit() {
        let status = "Name:\trototoon\nSigBlk:\t0000000000000000\nSigIgn:\t0000000000001004\n";
        assert!(is_ignored(3, status) && is_ignored(13, status));
        assert!(!is_ignored(1, status) && !is_ignored(2, status) && !is_ignored(1, ""));
        assert!(is_ignored(1, "SigIgn:\t0000000000000001"));
    }
}
