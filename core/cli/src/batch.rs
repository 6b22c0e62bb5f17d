//! `rototoon batch`: works through many shots.

use crate::failure::{Failure, line};
use crate::stop::{self, Counted};
use crate::tell::{self, Teller, Way};
use crate::{arguments, export, render};
use clap::builder::PossibleValuesParser;
use clap::{Arg, ArgAction, ArgMatches, Command, value_parser};
use rototoon::memory::Bytes;
use rototoon::project::Inputs;
use rototoon::scene::{Cancelled, FrameNumber};
use rototoon_batch::budget::Budget;
use rototoon_batch::manifest::{Manifest, Shot};
use rototoon_batch::names::{PAGE, REPORT, SUMMARY};
use rototoon_batch::page;
use rototoon_batch::report;
use rototoon_batch::run::{self, BatchError, Options};
use rototoon_batch::summary::{Outcome, Summary};
use std::ops::RangeInclusive;
use std::path::{Path, PathBuf};

/// Bytes of a gigabyte.
const GB: f64 = 1e9;
/// Most shots that a message names. A season has hundreds.
const MOST_NAMED: usize = 20;

/// The subcommand.
pub fn command() -> Command {
    Command::new("batch")
        .about("Works through many shots: tracks, snaps, renders and exports them, and lists the keys that would help most")
        .arg(
            Arg::new("manifest")
                .value_name("MANIFEST")
                .help("The file that names shots and steps")
                .required(true)
                .value_parser(value_parser!(PathBuf)),
        )
        .arg(arguments::output("DIR", "The folder of the results; each shot gets a folder in it"))
        .args(of_machine())
        .arg(tell::option())
        .args(of_shots())
        .arg(
            Arg::new("report")
                .long("report")
                .value_name("FILE")
                .help("The report, a JSON object in each line [default: report.jsonl in DIR]")
                .value_parser(value_parser!(PathBuf)),
        )
        .arg(
            Arg::new("summary")
                .long("summary")
                .help("Runs no shot, and writes summary.json and index.html of what was done")
                .action(ArgAction::SetTrue),
        )
        .arg(
            Arg::new("fine")
                .long("fine")
                .value_name("WHAT")
                .help("Ends with status 0 also where shots want keys (keys), or also where shots fail (all)")
                .default_value("none")
                .value_parser(PossibleValuesParser::new(["none", "keys", "all"])),
        )
}

/// What the machine gives.
fn of_machine() -> [Arg; 3] {
    [
        number("jobs", "N", "Shots at a time; 0 for one per core").default_value("0"),
        number("threads", "N", "Threads of each shot; 0 to share the cores among the shots").default_value("0"),
        Arg::new("memory")
            .long("memory")
            .value_name("GB")
            .help("Memory of all shots together in gigabytes [default: four fifths of what is free]")
            .value_parser(gigabytes),
    ]
}

/// Which shots are worked on.
fn of_shots() -> [Arg; 2] {
    [
        Arg::new("shots")
            .long("shots")
            .value_name("A-B")
            .help("Only the shots at these places of the manifest; the first is 1")
            .conflicts_with("shot")
            .value_parser(render::range),
        Arg::new("shot")
            .long("shot")
            .value_name("NAME")
            .help("Only the shot of this name; may be given several times")
            .action(ArgAction::Append),
    ]
}

fn number(id: &'static str, name: &'static str, help: &'static str) -> Arg {
    Arg::new(id).long(id).value_name(name).help(help).value_parser(value_parser!(u16).range(0..=1024))
}

fn gigabytes(text: &str) -> Result<u64, String> {
    match text.parse::<f64>() {
        Ok(value) if value > 0.0 && value < 1e6 => Ok((value * GB) as u64),
        _ => Err("expected a positive number".into()),
    }
}

/// Runs the subcommand.
pub fn run(given: &ArgMatches) -> Result<(), Failure> {
    let (path, folder) = (arguments::path(given, "manifest"), arguments::path(given, "output"));
    let manifest = load(path)?;
    let chosen = chosen(given, &manifest)?;
    let whole = chosen.len() == manifest.shots.len();
    let fine = arguments::choice(given, "fine");
    if given.get_flag("summary") {
        return status(&write_summary(&Summary::read(&manifest, folder), folder)?, fine);
    }
    let outcomes = work(given, &manifest, chosen, (path, folder))?;
    if whole {
        write_summary(&Summary::read(&manifest, folder).after(&outcomes), folder)?;
    }
    status(&outcomes, fine)
}

/// Reads a manifest, and checks the steps by the rules of their subcommands.
pub fn load(path: &Path) -> Result<Manifest, Failure> {
    Manifest::load(path, &check_words).map_err(|error| Failure::Use(error.to_string()))
}

/// The files that a manifest names.
pub fn named(path: &Path, manifest: &Manifest) -> Inputs {
    let files = manifest.shots.iter().flat_map(|shot| std::iter::once(&shot.project).chain(&shot.blend));
    files.fold(Inputs::default().file(path), |inputs, file| inputs.file(file))
}

/// Where the report goes: to a report that is there, or where nothing is and nothing will be.
fn report_path(given: &ArgMatches, manifest: &Manifest, (path, folder): (&Path, &Path)) -> Result<PathBuf, Failure> {
    let report = given.get_one::<PathBuf>("report").cloned().unwrap_or_else(|| folder.join(REPORT));
    named(path, manifest).check(&report)?;
    let mut taken = [PAGE, SUMMARY].into_iter().chain(manifest.shots.iter().map(|shot| shot.name.as_str()));
    if taken.any(|name| report == folder.join(name)) {
        let found = report.display();
        return Err(Failure::Use(format!(
            "--report: found {found}, expected another name: this one belongs to the batch"
        )));
    }
    // This keeps frames safe too.
    report::check(&report).map_err(|error| Failure::Use(error.to_string()))?;
    Ok(report)
}

/// Shots at a time, the threads of each, and the memory of all together.
fn of_given(given: &ArgMatches, shots: usize) -> (usize, usize, Budget) {
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    let asked = |id: &str| given.get_one::<u16>(id).map_or(0, |number| usize::from(*number));
    let jobs = if asked("jobs") == 0 { cores } else { asked("jobs") }.min(shots).max(1);
    let threads = if asked("threads") == 0 { (cores / jobs).max(1) } else { asked("threads") };
    let memory = given.get_one::<u64>("memory").map_or_else(Budget::of_machine, |bytes| Budget::new(*bytes));
    (jobs, threads, memory)
}

fn work(
    given: &ArgMatches,
    manifest: &Manifest,
    shots: Vec<usize>,
    (path, folder): (&Path, &Path),
) -> Result<Vec<Outcome>, Failure> {
    let report = report_path(given, manifest, (path, folder))?;
    let (jobs, threads, memory) = of_given(given, shots.len());
    let all = shots.len();
    let shots_word = if all == 1 { "shot" } else { "shots" };
    line("note", &format!("{all} {shots_word}, at most {jobs} at a time, within {} of memory", Bytes(memory.bytes())));
    let program =
        std::env::current_exe().map_err(|error| Failure::Other(format!("cannot find this program: {error}")))?;
    let name = path.display().to_string();
    stop::begin(name.clone());
    stop::done(0, all, Counted::Shots);
    let teller = Teller::new(Way::of(given, false), name);
    let options = Options {
        folder: folder.to_owned(),
        shots,
        jobs,
        threads,
        memory,
        program,
        report,
        stop: &|| stop::signal().is_some(),
        waits: &|shot| line("note", &format!("{}: waiting for another worker that has it", shot.name)),
        told: &|shot, outcome, ended| {
            stop::done(ended, all, Counted::Shots);
            tell(shot, outcome, ended, all);
        },
        at: &|share, doing| teller.report(doing, share),
    };
    let outcomes = run::run(manifest, &options).map_err(|error| match error {
        BatchError::Write(error) => Failure::Write(error),
        BatchError::Stopped => Cancelled.into(),
    })?;
    stop::worked();
    teller.end(&format!("{all} {shots_word}"));
    Ok(outcomes)
}

/// The places of the shots to work on.
fn chosen(given: &ArgMatches, manifest: &Manifest) -> Result<Vec<usize>, Failure> {
    let (all, from) = (manifest.shots.len(), arguments::path(given, "manifest").display());
    if let Some(range) = given.get_one::<RangeInclusive<FrameNumber>>("shots") {
        let place = |number: FrameNumber| usize::try_from(number).ok().filter(|place| (1..=all).contains(place));
        let (Some(first), Some(last)) = (place(*range.start()), place(*range.end())) else {
            let (first, last) = (range.start(), range.end());
            return Err(Failure::Use(format!(
                "{from}: --shots: found {first}-{last}, expected places from 1 to {all}"
            )));
        };
        return Ok((first - 1..last).collect());
    }
    let Some(names) = given.get_many::<String>("shot") else { return Ok((0..all).collect()) };
    let at = |name: &String| {
        let found = manifest.shots.iter().position(|shot| shot.name == *name);
        found.ok_or_else(|| {
            let mut known: Vec<_> =
                manifest.shots.iter().take(MOST_NAMED).map(|shot| format!("{:?}", shot.name)).collect();
            if all > MOST_NAMED {
                known.push(format!("… ({all} shots)"));
            }
            Failure::Use(format!("{from}: --shot: found {name:?}, expected one of {}", known.join(", ")))
        })
    };
    let mut places = names.map(at).collect::<Result<Vec<_>, _>>()?;
    // In the order of the manifest, each once.
    places.sort_unstable();
    places.dedup();
    Ok(places)
}

/// Checks the words of a step by the subcommand's own rules.
fn check_words(words: &[String]) -> Result<(), String> {
    let commands = super::subcommands();
    let known = commands.iter().find(|(command, _)| words.first().is_some_and(|word| command.get_name() == word));
    let Some((command, _)) = known else { return Err(format!("found no subcommand {:?}", words.first())) };
    let given = command.clone().try_get_matches_from(words).map_err(|error| arguments::in_one_line(&error))?;
    match command.get_name() {
        "render" => render::check(&given),
        "export" => export::check(&given),
        _ => Ok(()),
    }
}

fn tell(shot: &Shot, outcome: &Outcome, ended: usize, all: usize) {
    let (name, of) = (&shot.name, format!("{ended} of {all}"));
    match outcome {
        Outcome::Good => line("note", &format!("{of}: {name}: good")),
        Outcome::WantsKeys => line("note", &format!("{of}: {name}: wants keys")),
        Outcome::NotRun => line("note", &format!("{of}: {name}: not run")),
        Outcome::Failed(reason) => line("error", &format!("{of}: {name}: {reason}")),
    }
}

/// Writes summary and page. Returns how each shot came out.
fn write_summary(summary: &Summary, folder: &Path) -> Result<Vec<Outcome>, Failure> {
    summary.write(folder)?;
    page::write(summary, folder)?;
    let of = |id: &str| summary.count(id);
    let counts = format!(
        "{} good, {} {} keys, {} failed, {} not run",
        of("good"),
        of("wants_keys"),
        if of("wants_keys") == 1 { "wants" } else { "want" },
        of("failed"),
        of("not_run")
    );
    line("note", &format!("{counts}: see {}", folder.join(PAGE).display()));
    Ok(summary.entries.iter().map(|entry| entry.outcome.clone()).collect())
}

fn status(outcomes: &[Outcome], fine: &str) -> Result<(), Failure> {
    let failed = outcomes.iter().any(|outcome| matches!(outcome, Outcome::Failed(_) | Outcome::NotRun));
    match fine {
        "all" => Ok(()),
        _ if failed => Err(Failure::Reported),
        "keys" => Ok(()),
        _ if outcomes.contains(&Outcome::WantsKeys) => Err(Failure::WantsKeys),
        _ => Ok(()),
    }
}
