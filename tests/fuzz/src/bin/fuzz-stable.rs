//! `cargo xtask fuzz` starts this: writes the seeds of a target into a folder, or runs it on changed seeds.

use rototoon_fuzz::{mutate, seeds, targets};
use std::io;
use std::path::Path;
use std::process::ExitCode;
use std::time::{Duration, SystemTime, UNIX_EPOCH};

const USAGE: &str = "fuzz-stable list | seeds TARGET FOLDER | run TARGET SECONDS FOLDER | once TARGET FILE";

fn main() -> ExitCode {
    let words: Vec<String> = std::env::args().skip(1).collect();
    let words: Vec<&str> = words.iter().map(String::as_str).collect();
    match command(&words) {
        Ok(code) => code,
        Err(error) => {
            eprintln!("fuzz-stable: {error}");
            ExitCode::from(2)
        }
    }
}

fn command(words: &[&str]) -> io::Result<ExitCode> {
    let wrong = |what: String| io::Error::new(io::ErrorKind::InvalidInput, what);
    let known = |name: &str| {
        targets::find(name).ok_or_else(|| wrong(format!("found target {name:?}, expected one of the list")))
    };
    match words {
        ["list"] => targets::ALL.iter().for_each(|target| println!("{}", target.name)),
        ["seeds", name, folder] => {
            let folder = Path::new(folder);
            std::fs::create_dir_all(folder)?;
            for (k, seed) in seeds::seeds(known(name)?.name)?.iter().enumerate() {
                std::fs::write(folder.join(format!("seed-{k}")), seed)?;
            }
        }
        ["once", name, file] => (known(name)?.run)(&std::fs::read(file)?),
        ["run", name, seconds, folder] => {
            let seconds =
                seconds.parse().map_err(|_| wrong(format!("found {seconds:?}, expected a number of seconds")))?;
            // Every run goes another way; the finding's file is what makes it repeatable.
            let start = SystemTime::now().duration_since(UNIX_EPOCH).map_or(1, |time| time.as_nanos() as u64);
            let ran = mutate::run(known(name)?, Duration::from_secs(seconds), Path::new(folder), start)?;
            println!("executions {}", ran.executions);
            if let Some(finding) = ran.finding {
                println!("finding {}", finding.display());
                return Ok(ExitCode::FAILURE);
            }
        }
        _ => return Err(wrong(USAGE.into())),
    }
    Ok(ExitCode::SUCCESS)
}
