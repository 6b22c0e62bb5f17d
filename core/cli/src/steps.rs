//! `rototoon steps`: takes the steps of a shot for `rototoon batch`, which starts it. Frames are decoded once for all of
//! them. It is not for people: `rototoon_batch::answer` says what it reads and prints.

use crate::failure::{Failure, WRONG_USE, line};
use crate::{arguments, stop, tell, usage};
use clap::{Arg, ArgMatches, Command, value_parser};
use rototoon::pictures::store;
use rototoon::scene::Cancelled;
use rototoon_batch::answer::{Answer, processor_ms, words};
use std::io::{BufRead, Write, stderr, stdin};

/// The subcommand.
pub fn command() -> Command {
    Command::new("steps").about("Takes the steps of a batch from standard input").hide(true).arg(
        Arg::new("keep")
            .long("keep")
            .value_name("BYTES")
            .help("Greatest number of bytes of decoded frames that are kept")
            .default_value("0")
            .value_parser(value_parser!(u64)),
    )
}

/// Runs the subcommand, until standard input ends.
pub fn run(given: &ArgMatches) -> Result<(), Failure> {
    tell::to_batch();
    store::keep(given.get_one::<u64>("keep").copied().unwrap_or(0));
    for (index, text) in stdin().lock().lines().enumerate() {
        let text = text.map_err(|error| Failure::Other(format!("standard input: {error}")))?;
        usage::forget_peak();
        let before = processor_ms();
        let status = match words(&text) {
            Some(words) => step(&words),
            None => refused(&format!("standard input: found {text:?}, expected a list of words")),
        };
        let answer = Answer {
            step: index + 1,
            status,
            peak_bytes: usage::peak(),
            kept_bytes: store::kept_bytes(),
            processor_ms: processor_ms().saturating_sub(before),
        };
        // The answer is the last word of the step.
        stop::rest();
        // At once, so that nothing comes between.
        let _ = stderr().write_all((answer.line() + "\n").as_bytes());
        if stop::signal().is_some() {
            return Err(Cancelled.into());
        }
    }
    Ok(())
}

fn step(words: &[String]) -> u8 {
    let program = std::iter::once("rototoon").chain(words.iter().map(String::as_str));
    match crate::program().try_get_matches_from(program) {
        Ok(matches) => crate::execute(&matches).status(),
        Err(error) => refused(&arguments::in_one_line(&error)),
    }
}

fn refused(why: &str) -> u8 {
    line("error", why);
    WRONG_USE
}
