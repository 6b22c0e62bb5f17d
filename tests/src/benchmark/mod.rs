//! The benchmark of tracking: measures every preset on project documents with truth.
//!
//! - [`run`]: tracks one set with one preset, lets the simulated artist correct it, and measures times
//! - [`table`]: the results as Markdown and JSON
//! - [`errors`]: a plot of errors over frames
//! - [`overlay`]: a contact sheet of tracked and true contours
//! - [`evidence`]: tables from which the model of confidence is fitted
//! - [`own`]: sets that this package draws
//! - [`pins`]: times after a pin
//! - [`growth`]: time and memory by frames, parts, points and pixels
//!
//! A **set** is a folder with `project.json` (key frames only) and `truth.json` ([`crate::truth`]). The command
//! (`cargo xtask bench-tracking`) runs each set and preset in an optimised process of its own, so that all start with cold
//! caches and peak memory is measured separately.

pub mod errors;
pub mod evidence;
pub mod growth;
pub mod overlay;
pub mod own;
pub mod pins;
pub mod run;
pub mod table;

use anyhow::Result;
use rototoon::project::write_whole;
use rototoon::track::{Mechanism, Preset};
use run::Outcome;
use std::path::Path;
use table::Failure;

/// The ids of the mechanisms of the default preset. Each can be left out.
pub fn mechanisms() -> Vec<&'static str> {
    Mechanism::ALL.iter().map(|(_, id)| *id).collect()
}

/// The ids of all presets.
pub fn presets() -> Vec<&'static str> {
    Preset::ALL.iter().map(|(_, id)| *id).collect()
}

/// Writes the results of some runs into `folder`: `table.md`, `table.json`, and for each set `SET.errors.svg` and `.png`.
/// Each file is written completely or not at all.
pub fn write_files(folder: &Path, outcomes: &[Outcome], failures: &[Failure]) -> Result<()> {
    write_whole(&folder.join("table.md"), table::markdown(outcomes, failures).as_bytes())?;
    write_whole(&folder.join("table.json"), &serde_json::to_vec_pretty(&table::json(outcomes, failures))?)?;
    for set in table::in_order(outcomes.iter().map(|outcome| outcome.set.as_str())) {
        let own: Vec<&Outcome> = outcomes.iter().filter(|outcome| outcome.set == set).collect();
        let Some(chart) = errors::chart(set, &own) else { continue };
        let drawing = chart.draw();
        write_whole(&folder.join(format!("{set}.errors.svg")), drawing.svg().as_bytes())?;
        write_whole(&folder.join(format!("{set}.errors.png")), &drawing.png()?)?;
    }
    Ok(())
}
