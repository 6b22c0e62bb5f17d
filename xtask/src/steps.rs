//! Runs steps in parallel, each in a process of its own, and prints a summary of all of them.
//!
//! A compiler leaves processors idle at the end of its work, and so do downloads and Blender. So steps that do not depend on
//! each other run in parallel. Cargo locks the folder that it builds in, so only one step at a time builds in it. The output
//! of a step is printed when the step has ended.

use anyhow::{Context, Result, bail};
use std::fs::{self, File};
use std::path::{Path, PathBuf};
use std::sync::mpsc;
use std::time::Instant;
use xtask_shell::shell::{command, target};

/// The work of a step. `Ok(Some(reason))` means that it cannot be run here.
pub type Body = Box<dyn Fn() -> Result<Option<String>>>;

/// A step.
pub struct Step {
    /// Its name, for the command line and messages.
    pub name: String,
    /// Steps that must have passed before it.
    needs: Vec<String>,
    /// Steps that must have ended before it, with any outcome.
    after: Vec<String>,
    /// Whether it builds in Cargo's target folder for development.
    builds: bool,
    body: Body,
}

/// The outcome of a step.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Outcome {
    /// It passed.
    Passed,
    /// It failed with this error.
    Failed(String),
    /// It could not be run here, for this reason.
    NotRun(String),
}

impl Step {
    /// A step that depends on no other.
    pub fn new(name: &str, body: impl Fn() -> Result<Option<String>> + 'static) -> Self {
        Self { name: name.to_owned(), needs: Vec::new(), after: Vec::new(), builds: false, body: Box::new(body) }
    }

    /// Makes the step need that another one has passed.
    pub fn needs(mut self, name: &str) -> Self {
        self.needs.push(name.to_owned());
        self
    }

    /// Makes the step start after another one has ended.
    pub fn after(mut self, name: &str) -> Self {
        self.after.push(name.to_owned());
        self
    }

    /// Declares that the step builds in Cargo's target folder for development.
    pub fn builds(mut self) -> Self {
        self.builds = true;
        self
    }

    /// Runs the step in this process and writes its outcome to a file, which [`in_own_process`] reads. It is an error if the
    /// step fails.
    pub fn run_here(&self) -> Result<()> {
        let ended = (self.body)();
        let told = match &ended {
            Ok(None) => "passed\n".to_owned(),
            Ok(Some(reason)) => format!("not run\n{reason}"),
            Err(error) => format!("failed\n{error:#}"),
        };
        if let Ok(Some(reason)) = &ended {
            println!("this step cannot be run here: {reason}");
        }
        let file = file(&self.name, "outcome")?;
        fs::write(&file, told).with_context(|| format!("cannot write {file:?}"))?;
        ended.map(|_| ())
    }
}

/// The file with the log or the outcome of a step.
fn file(step: &str, kind: &str) -> Result<PathBuf> {
    let folder = target().join("test");
    fs::create_dir_all(&folder).with_context(|| format!("cannot make {folder:?}"))?;
    Ok(folder.join(format!("{}.{kind}", step.replace(' ', "-"))))
}

/// Runs a step as `xtask test --step NAME`, with `more` arguments, and prints its output when it has ended.
///
/// `program` is this program, found before the first step: a step that compiles the workspace links it anew, and the system
/// then no longer knows the running program by its path.
pub fn in_own_process(program: &Path, step: &str, more: &[&str]) -> Outcome {
    child(program, step, more).unwrap_or_else(|error| {
        eprintln!("{error:#}");
        Outcome::Failed(format!("{error:#}"))
    })
}

fn child(program: &Path, step: &str, more: &[&str]) -> Result<Outcome> {
    let (log, outcome) = (file(step, "log")?, file(step, "outcome")?);
    let _ = fs::remove_file(&outcome);
    let output = File::create(&log).with_context(|| format!("cannot write {log:?}"))?;
    let status = command(program)
        .args(["test", "--step", step])
        .args(more)
        .stdin(std::process::Stdio::null())
        .stdout(output.try_clone().with_context(|| format!("cannot write {log:?}"))?)
        .stderr(output)
        .status()
        .with_context(|| format!("cannot start the step {step}"))?;
    let printed = fs::read(&log).with_context(|| format!("cannot read {log:?}"))?;
    println!("\n=== {step}\n{}", String::from_utf8_lossy(&printed).trim_end());
    let Ok(told) = fs::read_to_string(&outcome) else {
        bail!("the step {step} ended with {status} and wrote no outcome")
    };
    let (word, reason) = told.split_once('\n').unwrap_or((&told, ""));
    Ok(match word {
        "passed" => Outcome::Passed,
        "not run" => Outcome::NotRun(reason.to_owned()),
        _ => Outcome::Failed(reason.to_owned()),
    })
}

/// Name, outcome and seconds of each step, in the order of the steps.
pub struct Report(Vec<(String, Outcome, f64)>);

/// Runs all steps with `run`, at most `at_once` at the same time. Of the steps that may start, the first one starts first.
pub fn run_all(steps: &[Step], at_once: usize, run: &(dyn Fn(&str) -> Outcome + Sync)) -> Report {
    let mut ended: Vec<Option<(Outcome, f64)>> = steps.iter().map(|_| None).collect();
    let mut running: Vec<usize> = Vec::new();
    let (sender, receiver) = mpsc::channel();
    std::thread::scope(|scope| {
        loop {
            while let Some(next) = (0..steps.len()).find(|&i| {
                let busy = steps[i].builds && running.iter().any(|&r| steps[r].builds);
                ended[i].is_none() && !running.contains(&i) && !busy && ready(steps, &ended, i)
            }) {
                if let Some(reason) = missing(steps, &ended, next) {
                    ended[next] = Some((Outcome::NotRun(reason), 0.0));
                    continue;
                }
                if running.len() == at_once {
                    break;
                }
                running.push(next);
                let (sender, name) = (sender.clone(), steps[next].name.clone());
                scope.spawn(move || {
                    let start = Instant::now();
                    let outcome = run(&name);
                    let _ = sender.send((next, outcome, start.elapsed().as_secs_f64()));
                });
            }
            if running.is_empty() {
                break;
            }
            let (step, outcome, seconds) = receiver.recv().expect("a running step sends its outcome");
            running.retain(|&r| r != step);
            ended[step] = Some((outcome, seconds));
        }
    });
    let never = || (Outcome::Failed("it waits for a step that does not exist".into()), 0.0);
    let all = steps.iter().zip(ended).map(|(step, ended)| (step.name.clone(), ended.unwrap_or_else(never)));
    Report(all.map(|(name, (outcome, seconds))| (name, outcome, seconds)).collect())
}

/// Whether all steps that a step waits for have ended.
fn ready(steps: &[Step], ended: &[Option<(Outcome, f64)>], step: usize) -> bool {
    let has_ended = |name: &String| steps.iter().zip(ended).any(|(other, end)| other.name == *name && end.is_some());
    steps[step].needs.iter().chain(&steps[step].after).all(has_ended)
}

/// A message if a step that this step needs has not passed.
fn missing(steps: &[Step], ended: &[Option<(Outcome, f64)>], step: usize) -> Option<String> {
    let passed = |name: &String| {
        let mut ends = steps.iter().zip(ended).filter(|(other, _)| other.name == *name);
        ends.any(|(_, end)| matches!(end, Some((Outcome::Passed, _))))
    };
    let lacking = steps[step].needs.iter().find(|name| !passed(name))?;
    Some(format!("it needs the step {lacking}, which did not pass"))
}

impl Report {
    /// Prints the summary. It is an error if a step failed, but not if a step could not be run.
    pub fn finish(&self) -> Result<()> {
        println!("\n=== Summary");
        for (name, outcome, seconds) in &self.0 {
            let (word, reason) = match outcome {
                Outcome::Passed => ("passed", String::new()),
                Outcome::Failed(reason) => ("FAILED", format!(": {}", reason.lines().next().unwrap_or_default())),
                Outcome::NotRun(reason) => ("NOT RUN", format!(": {reason}")),
            };
            println!("{word:<8} {name} ({seconds:.0} s){reason}");
        }
        let count = |f: fn(&Outcome) -> bool| self.0.iter().filter(|(_, outcome, _)| f(outcome)).count();
        let not_run = count(|o| matches!(o, Outcome::NotRun(_)));
        if not_run > 0 {
            println!("{not_run} of {} steps could not be run here", self.0.len());
        }
        let failed = count(|o| matches!(o, Outcome::Failed(_)));
        if failed > 0 {
            bail!("{failed} of {} steps failed", self.0.len());
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::Mutex;
    use std::time::Duration;

    fn step(name: &str) -> Step {
        Step::new(name, || Ok(None))
    }

    #[test]
    fn a_failed_step_fails_the_run_and_the_others_go_on() {
        let outcome = |name: &str| match name {
            "b" => Outcome::Failed("broken".into()),
            "c" => Outcome::NotRun("no such machine".into()),
            _ => Outcome::Passed,
        };
        let report = run_all(&[step("a"), step("b"), step("c"), step("d")], 2, &outcome);
        assert_eq!(report.finish().unwrap_err().to_string(), "1 of 4 steps failed");
        assert_eq!(report.0[3].1, Outcome::Passed);
    }

    #[test]
    fn steps_that_could_not_be_run_are_no_failures() {
        run_all(&[step("a")], 2, &|_| Outcome::NotRun("no such machine".into())).finish().unwrap();
    }

    #[test]
    fn a_step_waits_for_the_steps_it_needs_and_is_not_run_if_they_fail() {
        let steps = [
            step("late").needs("first"),
            step("last").after("broken"),
            step("first"),
            step("broken"),
            step("hopeless").needs("broken"),
        ];
        let order = Mutex::new(Vec::new());
        let report = run_all(&steps, 2, &|name| {
            order.lock().unwrap().push(name.to_owned());
            if name == "broken" { Outcome::Failed("broken".into()) } else { Outcome::Passed }
        });
        let order = order.into_inner().unwrap();
        let place = |name: &str| order.iter().position(|other| other == name);
        assert!(place("late") > place("first") && place("last") > place("broken"), "{order:?}");
        assert_eq!(place("hopeless"), None);
        let reason = "it needs the step broken, which did not pass".to_owned();
        assert_eq!(report.0[4].1, Outcome::NotRun(reason));
    }

    #[test]
    fn at_most_three_steps_run_at_once_and_only_one_that_builds() {
        let steps: Vec<Step> = (0..8).map(|i| step(&i.to_string())).collect();
        let steps: Vec<Step> = steps.into_iter().enumerate().map(|(i, s)| if i < 4 { s.builds() } else { s }).collect();
        let running = Mutex::new(Vec::<usize>::new());
        let report = run_all(&steps, 3, &|name| {
            let step: usize = name.parse().unwrap();
            let mut now = running.lock().unwrap();
            now.push(step);
            assert!(now.len() <= 3 && now.iter().filter(|i| **i < 4).count() <= 1, "{now:?}");
            drop(now);
            std::thread::sleep(Duration::from_millis(2));
            running.lock().unwrap().retain(|&i| i != step);
            Outcome::Passed
        });
        report.finish().unwrap();
    }

    #[test]
    fn a_step_that_waits_for_a_missing_step_fails() {
        let report = run_all(&[step("a").after("nothing")], 2, &|_| Outcome::Passed);
        assert!(report.finish().is_err());
    }
}
