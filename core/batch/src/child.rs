//! Starts the command line program for a step.
//!
//! The program's standard error is read while it runs. Its lines are errors, warnings and notes; with the environment
//! variable [`USAGE`] the last one tells the memory that was used.

use std::fs::File;
use std::io::{self, Read};
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::thread::{JoinHandle, sleep};
use std::time::{Duration, Instant};

/// The environment variable that makes the program print a line with its peak memory.
pub const USAGE: &str = "ROTOTOON_USAGE";
/// The line's beginning; a number of bytes follows.
pub const USAGE_LINE: &str = "usage: peak_bytes=";

/// Time between two looks at the program.
const PAUSE: Duration = Duration::from_millis(5);
/// Time that the program has to end after it was asked to.
const GRACE: Duration = Duration::from_secs(3);
/// Greatest number of bytes of messages that are kept.
const MOST_MESSAGES: usize = 64 << 10;

/// How a program ended.
#[derive(Clone, Debug, PartialEq)]
pub struct Ended {
    /// Its exit status; `None` if the system ended it.
    pub status: Option<i32>,
    /// How the system describes the end.
    pub description: String,
    /// The lines that it printed.
    pub messages: Vec<String>,
    /// Seconds that it ran.
    pub seconds: f64,
    /// The most memory that it held; 0 where it did not say it.
    pub peak_bytes: u64,
    /// Whether `stop` ended it.
    pub stopped: bool,
}

/// Runs a program with some words in a folder, until it ends or `stop` is true. It holds `lock` while it runs.
///
/// # Errors
///
/// The program cannot be started.
pub fn run(program: &Path, words: &[String], folder: &Path, lock: File, stop: &dyn Fn() -> bool) -> io::Result<Ended> {
    let start = Instant::now();
    let mut command = Command::new(program);
    command.args(words).current_dir(folder).env(USAGE, "1");
    let mut child = command.stdin(Stdio::from(lock)).stdout(Stdio::null()).stderr(Stdio::piped()).spawn()?;
    let reader = reader(&mut child);
    let mut asked: Option<Instant> = None;
    let status = loop {
        if let Some(status) = child.try_wait()? {
            break status;
        }
        match asked {
            None if stop() => {
                asked = Some(Instant::now());
                ask_to_end(&mut child)?;
            }
            Some(time) if time.elapsed() > GRACE => child.kill()?,
            _ => {}
        }
        sleep(PAUSE);
    };
    let seconds = start.elapsed().as_secs_f64();
    let text = reader.and_then(|reader| reader.join().ok()).unwrap_or_default();
    let (messages, peak_bytes) = split(&text);
    let description = status.to_string();
    Ok(Ended { status: status.code(), description, messages, seconds, peak_bytes, stopped: asked.is_some() })
}

fn reader(child: &mut Child) -> Option<JoinHandle<String>> {
    let mut stream = child.stderr.take()?;
    Some(std::thread::spawn(move || {
        let mut kept = Vec::new();
        let mut block = [0; 4096];
        // What is too long is read on, so that the program does not wait.
        while let Ok(count) = stream.read(&mut block) {
            if count == 0 {
                break;
            }
            kept.extend_from_slice(&block[..count]);
            if kept.len() > 2 * MOST_MESSAGES {
                kept.drain(MOST_MESSAGES / 2..kept.len() - MOST_MESSAGES / 2);
            }
        }
        String::from_utf8_lossy(&kept).into_owned()
    }))
}

/// The messages, and the peak memory.
fn split(text: &str) -> (Vec<String>, u64) {
    let (usage, messages): (Vec<&str>, Vec<&str>) = text.lines().partition(|line| line.starts_with(USAGE_LINE));
    let bytes = usage.last().and_then(|line| line[USAGE_LINE.len()..].trim().parse().ok());
    (messages.into_iter().map(str::to_owned).collect(), bytes.unwrap_or(0))
}

/// Asks a program to end in order, as Ctrl-C does.
#[cfg(unix)]
fn ask_to_end(child: &mut Child) -> io::Result<()> {
    use rustix::process::{Pid, Signal, kill_process};
    match i32::try_from(child.id()).ok().and_then(Pid::from_raw) {
        Some(pid) => Ok(kill_process(pid, Signal::TERM)?),
        None => child.kill(),
    }
}

/// Ends a program. Its files appear whole or not at all.
#[cfg(not(unix))]
fn ask_to_end(child: &mut Child) -> io::Result<()> {
    child.kill()
}

#[cfg(all(test, unix))]
mod tests {
    use super::*;
    use std::sync::atomic::{AtomicBool, Ordering};

    fn shell(text: &str, stop: &dyn Fn() -> bool) -> Ended {
        let lock = tempfile::tempfile().unwrap();
        run(Path::new("/bin/sh"), &["-c".into(), text.into()], Path::new("/"), lock, stop).unwrap()
    }

    #[test]
    fn messages_status_and_memory_are_read() {
        let ended =
            shell("echo 'note: a' >&2; echo 'usage: peak_bytes=123' >&2; echo 'error: b' >&2; exit 3", &|| false);
        assert_eq!((ended.status, ended.peak_bytes, ended.stopped), (Some(3), 123, false));
        assert_eq!(ended.messages, ["note: a", "error: b"]);
    }

    #[test]
    fn a_program_that_was_ended_says_how() {
        let ended = shell("kill -9 $$", &|| false);
        assert_eq!(ended.status, None);
        assert!(ended.description.contains('9'), "{}", ended.description);
    }

    #[test]
    fn a_stop_ends_the_program() {
        let seen = AtomicBool::new(false);
        let ended = shell("exec sleep 60", &|| seen.swap(true, Ordering::Relaxed));
        assert!(ended.stopped && ended.status.is_none() && ended.seconds < 30.0);
    }

    #[test]
    fn many_messages_do_not_stop_the_program() {
        let ended =
            shell("i=0; while [ $i -lt 20000 ]; do echo \"line $i of many lines\" >&2; i=$((i+1)); done", &|| false);
        assert_eq!(ended.status, Some(0));
        assert!(ended.messages.len() < 20000 && ended.messages[0] == "line 0 of many lines");
        assert_eq!(ended.messages.last().unwrap(), "line 19999 of many lines");
    }
}
