//! Tests of the command line. They are one program, because a program of its own for each file would cost more to link than to run.

mod batch;
mod batch_faults;
#[cfg(unix)]
mod budgets;
mod cached;
mod cartoon;
mod command_line;
mod conform;
mod documented;
mod drawn;
mod exchange;
mod fill;
mod fit;
mod inputs;
mod plates;
mod progress;
mod season;
mod seen;
#[cfg(unix)]
mod stops;
mod style;
mod style_corrections;
mod style_guesses;
mod style_reshape;
mod trace;
mod tween;
#[cfg(windows)]
mod windows;
#[cfg(unix)]
mod writing;
