//! The benchmark of tracking: every preset over project documents with truth.
//!
//! - [`run`]: one preset on one set, tracked, corrected by the simulated artist and timed
//! - [`table`]: what came out as Markdown and JSON
//! - [`errors`]: how errors go over the frames, as a plot
//! - [`overlay`]: tracked and true contours over the footage, as a contact sheet
//! - [`own`]: sets that this package draws
//! - [`growth`]: seconds and memory by frames, parts, points and pixels
//!
//! A **set** is a folder with `project.json` (key frames only) and `truth.json` ([`crate::truth`]). The command
//! (`cargo xtask bench-tracking`) gives each set and preset an optimised process of its own, so that its peak memory is
//! the run's alone and nothing is warm that should be cold.

pub mod errors;
pub mod growth;
pub mod overlay;
pub mod own;
pub mod run;
pub mod table;

use anyhow::Result;
use rototoon::project::write_whole;
use rototoon::track::{Mechanism, Preset};
use run::Outcome;
use std::path::Path;
use table::Failure;

/// The ids of the default preset's mechanisms that can be left out.
pub fn mechanisms() -> Vec<&'static str> {
    Mechanism::ALL.iter().map(|(_, id)| *id).collect()
}

/// The ids of all presets.
pub fn presets() -> Vec<&'static str> {
    Preset::ALL.iter().map(|(_, id)| *id).collect()
}

/// Writes what is known of some runs into `folder`: `table.md`, `table.json`, and for each set `SET.errors.svg` and
/// `.png`. Each file appears whole.
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
