//! Many shots, unattended.
//!
//! A *manifest* names shots (project documents) and steps (subcommands of the command line). [`run`] works through them,
//! several shots at a time, within a memory budget. It starts the command line program for each shot, so a step that
//! fails, or that the system ends for want of memory, ends nothing else.
//!
//! - [`manifest`]: the manifest and everything that may be wrong with it
//! - [`names`]: names in the folder of the results
//! - [`strict`]: JSON in which no field is given twice
//! - [`step`]: the steps; each is described once, as the words of a subcommand
//! - [`digest`]: hashes of what a step reads
//! - [`record`]: what was done for a shot, so that it is not done again
//! - [`lock`]: one worker a shot
//! - [`queue`]: free shots first, locked ones later
//! - [`child`]: starts the command line program for the steps of a shot
//! - [`answer`]: what the two say to each other
//! - [`shot`]: all steps of a shot
//! - [`budget`]: how many shots fit into the memory
//! - [`peak`]: the most memory that a process has held
//! - [`findings`]: confidence, lost parts and the keys that would help most
//! - [`report`]: JSON lines while it runs
//! - [`host`]: which machine writes them, and when
//! - [`ahead`]: how far all shots together are
//! - [`summary`]: what all records together say
//! - [`page`]: the same for a person, as one HTML file
//! - [`jobs`]: templates for render farms
//!
//! # Safe to end at any moment
//!
//! A step writes to files whose names begin with `.new-`. Their hashes enter the record before they get their final
//! names. A worker that is killed therefore leaves one of three states: the step is not done; it is done but files keep
//! their first names, and the next worker renames them; it is done. A file that no worker wrote is never replaced.
//!
//! No decision depends on a clock or on the time of a file: machines of a farm disagree about both. Times are in the report alone.

#![forbid(unsafe_code)]

pub mod ahead;
pub mod answer;
pub mod budget;
pub mod child;
pub mod digest;
pub mod findings;
pub mod host;
pub mod jobs;
pub mod lock;
pub mod manifest;
pub mod names;
pub mod page;
pub mod peak;
pub mod queue;
pub mod record;
pub mod report;
pub mod run;
pub mod shot;
pub mod step;
pub mod strict;
pub mod summary;
