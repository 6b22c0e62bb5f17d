//! Templates for render farms. Each calls the command line program alone: once for a number of shots, and in the end once
//! for the page.
//!
//! [`words`] describes these two calls. The templates differ only in how an engine writes a place in a list of shots.
//!
//! | engine | template |
//! | --- | --- |
//! | OpenJD (AWS Deadline Cloud and others) | [`openjd`]: a job template of a manifest |
//! | Flamenco | [`flamenco`]: a job type, which a manager installs once |
//! | OpenCue | [`opencue`]: a script that sends a manifest |

pub mod flamenco;
pub mod opencue;
pub mod openjd;

/// What a call of the program works on. Each text may be a place that the engine fills.
#[derive(Clone, Copy, Debug)]
pub struct Places<'a> {
    /// The manifest.
    pub manifest: &'a str,
    /// The folder of the results.
    pub output: &'a str,
}

/// What a call for shots says of a shot that failed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum OnFailure {
    /// Its status is 0. A shot that fails would commonly fail again, and the page then shows all that was done.
    GoOn,
    /// Its status is 1, so that the engine tries the chunk again, and makes no page before all is done.
    Fail,
}

/// How a call tells an engine how far it is: in the engine's own lines where it knows some, else in lines for its log.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Tells {
    /// `openjd_progress: 42.0` on standard output, which the engine shows as the progress of the task.
    Openjd,
    /// Lines on standard error.
    Lines,
}

/// The words of the call for some shots (`--shots A-B`), or for the page if `shots` is `None`, which takes a moment and tells nothing.
///
/// The call for the page has the status of the whole batch.
pub fn words(places: Places, shots: Option<&str>, failure: OnFailure, tells: Tells) -> Vec<String> {
    let mut words: Vec<&str> = vec!["batch", places.manifest, "-o", places.output];
    match shots {
        Some(shots) => {
            let fine = if failure == OnFailure::GoOn { "all" } else { "keys" };
            let way = if tells == Tells::Openjd { "openjd" } else { "lines" };
            words.extend(["--shots", shots, "--fine", fine, "--progress", way]);
        }
        None => words.extend(["--summary", "--fine", "keys"]),
    }
    words.into_iter().map(str::to_owned).collect()
}
