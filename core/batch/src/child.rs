//! Starts the program that takes the steps of a shot, and asks it for one step after the other.
//!
//! [`answer`](crate::answer) says how the two speak. A program that the system ends, for want of memory or for another
//! reason, ends the shot and nothing else.

use crate::answer::{Answer, read_at, request};
use crate::peak;
use std::fs::File;
use std::io::{self, Read, Write};
use std::path::Path;
use std::process::{Child, ChildStdin, Command, ExitStatus, Stdio};
use std::sync::mpsc::{Receiver, RecvTimeoutError, channel};
use std::thread::sleep;
use std::time::{Duration, Instant};

/// Time between two looks at whether the batch was asked to end.
const PAUSE: Duration = Duration::from_millis(5);
/// Time that the program has to end after it was asked to.
const GRACE: Duration = Duration::from_secs(3);
/// Time between two looks at the program's memory.
const LOOK: Duration = Duration::from_millis(100);
/// Number of bytes that are read at a time.
const BLOCK: usize = 4096;
/// Number of bytes at the end of what was said among which an answer is looked for: those of a block, and the begin of an answer before it.
const LAST: usize = BLOCK + 1024;
/// Greatest number of bytes of messages that are kept.
const MOST_MESSAGES: usize = 64 << 10;

/// SIGHUP, SIGINT and SIGTERM, which ask a program to end.
const INTERRUPTS: [i32; 3] = [1, 2, 15];

/// How a step ended.
#[derive(Clone, Debug, PartialEq)]
pub struct Ended {
    /// Its exit status; `None` if the system ended the program.
    pub status: Option<i32>,
    /// How the system describes the end.
    pub description: String,
    /// The lines that it printed.
    pub messages: Vec<String>,
    /// Seconds that it ran.
    pub seconds: f64,
    /// The most memory that it held, as it said or was seen; 0 where neither was.
    pub peak_bytes: u64,
    /// Bytes of decoded frames that are kept for later steps.
    pub kept_bytes: u64,
    /// Seconds of processors that it took; 0 where it did not say it.
    pub processor_seconds: f64,
    /// Whether `stop` ended it.
    pub stopped: bool,
    /// Whether somebody else asked it to end, by a signal such as that of Ctrl-C.
    pub interrupted: bool,
}

/// A program that takes steps. It ends when this is dropped.
#[derive(Debug)]
pub struct Program {
    child: Child,
    requests: Option<ChildStdin>,
    output: Receiver<Vec<u8>>,
    steps: usize,
}

/// What a program said and did while it had a step.
struct Heard {
    said: Vec<u8>,
    end: End,
    /// Whether it was asked to end.
    asked: bool,
    /// The most memory that it was seen to hold.
    held: u64,
}

/// How a program came to the end of a step.
enum End {
    Answer(Answer),
    Gone(ExitStatus),
}

impl End {
    /// Whether one of the signals that ask a program to end was its end.
    fn is_interrupted(&self) -> bool {
        match self {
            Self::Answer(answer) => INTERRUPTS.iter().any(|signal| i32::from(answer.status) == 128 + signal),
            #[cfg(unix)]
            Self::Gone(status) => {
                std::os::unix::process::ExitStatusExt::signal(status).is_some_and(|signal| INTERRUPTS.contains(&signal))
            }
            #[cfg(not(unix))]
            Self::Gone(_) => false,
        }
    }
}

impl Program {
    /// Starts the command line program in a folder. It keeps decoded frames of at most `keep` bytes, and holds `lock` until
    /// it ends.
    ///
    /// # Errors
    ///
    /// The program cannot be started.
    pub fn start(program: &Path, folder: &Path, lock: File, keep: u64) -> io::Result<Self> {
        let mut command = Command::new(program);
        command.args(["steps", "--keep", &keep.to_string()]).current_dir(folder);
        Self::of(command, lock)
    }

    fn of(mut command: Command, lock: File) -> io::Result<Self> {
        let mut child = command.stdin(Stdio::piped()).stdout(Stdio::from(lock)).stderr(Stdio::piped()).spawn()?;
        let requests = child.stdin.take();
        let (send, output) = channel();
        if let Some(mut stream) = child.stderr.take() {
            std::thread::spawn(move || {
                let mut block = [0; BLOCK];
                while let Ok(count) = stream.read(&mut block) {
                    if count == 0 || send.send(block[..count].to_vec()).is_err() {
                        break;
                    }
                }
            });
        }
        Ok(Self { child, requests, output, steps: 0 })
    }

    /// Its number in the system.
    pub fn id(&self) -> u32 {
        self.child.id()
    }

    /// Runs a subcommand until it ends or `stop` is true. After an end by the system or by `stop` the program is gone. `at` is told how far it is, as a
    /// share of 1 and in words.
    ///
    /// # Errors
    ///
    /// The system does not say how the program ended.
    pub fn step(&mut self, words: &[String], stop: &dyn Fn() -> bool, at: &dyn Fn(f64, &str)) -> io::Result<Ended> {
        let start = Instant::now();
        self.steps += 1;
        // If the program is gone, its output has ended too.
        let _ = self.requests.as_mut().map(|pipe| pipe.write_all(request(words).as_bytes()));
        let Heard { said, end, asked, held } = self.listen(stop, at)?;
        let text = String::from_utf8_lossy(&said);
        let messages = text.lines().filter(|line| Answer::read(line).is_none()).map(str::to_owned).collect();
        let interrupted = end.is_interrupted();
        let (code, description, answer) = match end {
            End::Answer(answer) => (Some(i32::from(answer.status)), format!("exit status: {}", answer.status), answer),
            // It has not told what it held.
            End::Gone(status) => (status.code(), status.to_string(), Answer { peak_bytes: held, ..Answer::default() }),
        };
        Ok(Ended {
            status: code,
            description,
            messages,
            seconds: start.elapsed().as_secs_f64(),
            processor_seconds: answer.processor_ms as f64 / 1000.0,
            peak_bytes: answer.peak_bytes,
            kept_bytes: answer.kept_bytes,
            stopped: asked,
            interrupted: interrupted && !asked,
        })
    }

    /// Listens until the program answers or ends. If `stop` is true it is asked to end, and killed if it takes too long.
    fn listen(&mut self, stop: &dyn Fn() -> bool, at: &dyn Fn(f64, &str)) -> io::Result<Heard> {
        let (mut said, mut asked) = (Vec::new(), None::<Instant>);
        let (mut looked, mut held) = (Instant::now(), 0);
        let end = loop {
            match self.output.recv_timeout(PAUSE) {
                Ok(block) => {
                    said.extend(block);
                    take_progress(&mut said, at);
                }
                Err(RecvTimeoutError::Timeout) => {}
                Err(RecvTimeoutError::Disconnected) => break End::Gone(self.end()?),
            }
            shorten(&mut said);
            if let Some(answer) = self.answer(&said) {
                break End::Answer(answer);
            }
            if looked.elapsed() > LOOK {
                (looked, held) = (Instant::now(), peak::of(&self.child.id().to_string()).max(held));
            }
            match asked {
                None if stop() => {
                    asked = Some(Instant::now());
                    ask_to_end(&mut self.child)?;
                }
                Some(time) if time.elapsed() > GRACE => self.child.kill()?,
                _ => {}
            }
        };
        Ok(Heard { said, end, asked: asked.is_some(), held })
    }

    /// The answer to the last request, if it is among what was said last. Other threads of the program may say something right after it.
    fn answer(&self, said: &[u8]) -> Option<Answer> {
        let last = &said[said.len().saturating_sub(LAST)..];
        let whole = last.split_inclusive(|&byte| byte == b'\n').filter_map(|line| line.strip_suffix(b"\n"));
        let mut answers = whole.filter_map(|line| Answer::read(str::from_utf8(line).ok()?));
        answers.find(|answer| answer.step == self.steps)
    }

    /// Waits until the program has ended; it is killed if it takes too long.
    fn end(&mut self) -> io::Result<ExitStatus> {
        self.requests = None;
        let start = Instant::now();
        loop {
            if let Some(status) = self.child.try_wait()? {
                return Ok(status);
            }
            if start.elapsed() > GRACE {
                self.child.kill()?;
            }
            sleep(PAUSE);
        }
    }
}

impl Drop for Program {
    fn drop(&mut self) {
        let _ = self.end();
    }
}

/// Takes the lines out of what was said that say how far the step is, and tells `at` of each. The last line may not be whole yet.
fn take_progress(said: &mut Vec<u8>, at: &dyn Fn(f64, &str)) {
    let mut kept = Vec::with_capacity(said.len());
    for line in said.split_inclusive(|&byte| byte == b'\n') {
        let whole = line.strip_suffix(b"\n").and_then(|line| str::from_utf8(line).ok());
        match whole.and_then(read_at) {
            Some((share, doing)) => at(share, doing),
            None => kept.extend_from_slice(line),
        }
    }
    *said = kept;
}

/// Leaves out the middle of what is too long.
fn shorten(said: &mut Vec<u8>) {
    if said.len() > 2 * MOST_MESSAGES {
        said.drain(MOST_MESSAGES / 2..said.len() - MOST_MESSAGES / 2);
    }
}

/// Asks a program to end in order, as Ctrl-C does.
#[cfg(unix)]
fn ask_to_end(child: &mut Child) -> io::Result<()> {
    use rustix::process::{Pid, Signal, kill_process};
    // One that has ended already is as good.
    if child.try_wait()?.is_some() {
        return Ok(());
    }
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

    fn shell(text: &str) -> Program {
        let mut command = Command::new("/bin/sh");
        command.args(["-c", text]);
        Program::of(command, tempfile::tempfile().unwrap()).unwrap()
    }

    fn step(program: &mut Program) -> Ended {
        program.step(&["track".into()], &|| false, &|_, _| {}).unwrap()
    }

    #[test]
    fn one_program_takes_all_steps() {
        let mut program = shell(
            "read a; echo \"note: $a\" >&2; echo 'step: 1 status=3 peak_bytes=123 kept_bytes=5 processor_ms=40' >&2; \
             read a; echo 'step: 1 status=0 peak_bytes=0 kept_bytes=0 processor_ms=40' >&2; echo 'step: 2 status=0 peak_bytes=9 kept_bytes=6 processor_ms=40' >&2; \
             read a",
        );
        let ended = step(&mut program);
        assert_eq!((ended.status, ended.peak_bytes, ended.kept_bytes, ended.stopped), (Some(3), 123, 5, false));
        assert_eq!(
            (ended.messages, ended.description),
            (vec!["note: [\"track\"]".to_owned()], "exit status: 3".to_owned())
        );
        let ended = step(&mut program);
        assert_eq!(
            (ended.status, ended.peak_bytes, ended.processor_seconds),
            (Some(0), 9, 0.04),
            "an answer to another step is none"
        );
    }

    #[test]
    fn how_far_a_step_is_is_told_and_is_no_message() {
        let mut program = shell(
            "read a; echo 'at: 0.0000 Reading frames' >&2; echo 'note: a' >&2; printf 'at: 0.5' >&2; sleep 0.2; echo '000 Tracking' >&2; \
             echo 'at: 7 no share' >&2; echo 'step: 1 status=0 peak_bytes=0 kept_bytes=0 processor_ms=40' >&2; read a",
        );
        let told = std::sync::Mutex::new(Vec::new());
        let at = |share: f64, doing: &str| told.lock().unwrap().push((share, doing.to_owned()));
        let ended = program.step(&["track".into()], &|| false, &at).unwrap();
        assert_eq!(*told.lock().unwrap(), [(0.0, "Reading frames".to_owned()), (0.5, "Tracking".to_owned())]);
        assert_eq!((ended.status, ended.messages), (Some(0), vec!["note: a".to_owned(), "at: 7 no share".to_owned()]));
    }

    #[test]
    fn an_answer_is_heard_though_something_follows_it() {
        let mut program = shell(
            "read a; printf 'note: a\\nstep: 1 status=0 peak_bytes=0 kept_bytes=0 processor_ms=4\\nerror: b\\nno' >&2; \
             read a; echo ' end' >&2; echo 'step: 2 status=3 peak_bytes=0 kept_bytes=0 processor_ms=4' >&2; read a",
        );
        let [first, second] = [0, 1].map(|_| step(&mut program));
        assert_eq!((first.status, first.messages[0].as_str()), (Some(0), "note: a"));
        assert!(second.status == Some(3) && second.messages.last().unwrap().ends_with(" end"), "{second:?}");
    }

    #[test]
    fn a_program_that_was_ended_says_how() {
        let mut program = shell("read a; echo 'note: a' >&2; sleep 0.5; kill -9 $$");
        for messages in [1, 0] {
            let ended = step(&mut program);
            assert_eq!(ended.peak_bytes > 0, messages == 1 && cfg!(target_os = "linux"));
            assert_eq!((ended.status, ended.messages.len()), (None, messages));
            assert!(ended.description.contains('9'), "{}", ended.description);
        }
    }

    #[test]
    fn a_program_that_somebody_stopped_did_not_fail() {
        for (end, interrupted) in [
            ("echo 'step: 1 status=143 peak_bytes=0 kept_bytes=0 processor_ms=4' >&2; read a", true),
            ("kill -TERM $$", true),
            ("echo 'step: 1 status=129 peak_bytes=0 kept_bytes=0 processor_ms=4' >&2; read a", true),
            ("echo 'step: 1 status=1 peak_bytes=0 kept_bytes=0 processor_ms=4' >&2; read a", false),
            ("kill -KILL $$", false),
        ] {
            let ended = step(&mut shell(&format!("read a; {end}")));
            assert_eq!((ended.interrupted, ended.stopped), (interrupted, false), "{end}");
        }
    }

    #[test]
    fn a_stop_ends_the_program() {
        let seen = AtomicBool::new(false);
        let ended = shell("exec sleep 60").step(&[], &|| seen.swap(true, Ordering::Relaxed), &|_, _| {}).unwrap();
        assert!(ended.stopped && ended.status.is_none() && ended.seconds < 30.0);
    }

    #[test]
    fn many_messages_do_not_stop_the_program() {
        let mut program = shell(
            "read a; i=0; while [ $i -lt 20000 ]; do echo \"line $i of many lines\" >&2; i=$((i+1)); done; \
             echo 'step: 1 status=0 peak_bytes=0 kept_bytes=0 processor_ms=40' >&2; read a",
        );
        let ended = step(&mut program);
        assert_eq!(ended.status, Some(0));
        assert!(ended.messages.len() < 20000 && ended.messages[0] == "line 0 of many lines");
        assert_eq!(ended.messages.last().unwrap(), "line 19999 of many lines");
    }
}
