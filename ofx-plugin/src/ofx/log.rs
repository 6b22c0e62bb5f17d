//! The plugin's log: lines on standard error, for messages that the host cannot show.

use std::io::Write;

/// Writes a message to the log. A closed standard error is ignored: most hosts have no terminal.
pub(super) fn log(text: &str) {
    let _ = writeln!(std::io::stderr(), "Rototoon: {text}");
}
