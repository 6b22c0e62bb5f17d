//! Free room on the disk, asked before much is written: a compiler and a package installer that run out of it fail with
//! messages that seldom say so.

use anyhow::{Result, bail};
use std::path::Path;
use xtask_shell::shell::{capture, command, target};

/// What a run in a fresh clone writes: builds, and one Python environment for each Blender.
const FRESH: u64 = 7_000_000_000;
/// What a run writes when all that is built already.
const AGAIN: u64 = 500_000_000;

/// Refuses a run that would fill the disk. Where the room cannot be found out, it is taken for enough.
pub fn need_room() -> Result<()> {
    // One of the last things that a run makes. The folder debug is there from the start: this program lies in it.
    let built = target().join("Rototoon.ofx.bundle").is_dir();
    enough(room(&target()), if built { AGAIN } else { FRESH })
}

fn enough(found: Option<u64>, needed: u64) -> Result<()> {
    let gigabytes = |bytes: u64| bytes as f64 / 1e9;
    if let Some(free) = found.filter(|&free| free < needed) {
        bail!(
            "the disk has {:.1} GB left for the folder target, and the checks need {:.1} GB: free some, or set \
             CARGO_TARGET_DIR to a folder on another disk",
            gigabytes(free),
            gigabytes(needed)
        );
    }
    Ok(())
}

/// Free bytes on the disk of a folder, or of the nearest folder above that exists.
fn room(folder: &Path) -> Option<u64> {
    let there = folder.ancestors().find(|folder| folder.is_dir())?;
    free_in(&capture(command("df").arg("-Pk").arg(there)).ok()?)
}

/// Reads the answer of `df -Pk` (POSIX): a heading, then device, size, used, free, each in blocks of 1024 bytes.
fn free_in(answer: &str) -> Option<u64> {
    let row = answer.lines().nth(1)?;
    // The name of a device may have spaces, so the columns are counted from the share in percent.
    let words: Vec<&str> = row.split_whitespace().collect();
    let share = words.iter().rposition(|word| word.ends_with('%'))?;
    words.get(share.checked_sub(1)?)?.parse::<u64>().ok().map(|blocks| 1024 * blocks)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_answer_of_df_is_read() {
        let heading = "Filesystem 1024-blocks Used Available Capacity Mounted on\n";
        assert_eq!(free_in(&format!("{heading}/dev/sda1 100 60 40 60% /")), Some(40 * 1024));
        assert_eq!(free_in(&format!("{heading}//nas/my films 100 60 7 93% /mnt/my films")), Some(7 * 1024));
        assert_eq!(free_in(heading), None);
        assert_eq!(free_in("df: no such file"), None);
    }

    #[test]
    fn too_little_room_is_said_with_both_figures() {
        assert!(enough(None, FRESH).is_ok() && enough(Some(FRESH), FRESH).is_ok());
        let said = enough(Some(3_400_000_000), FRESH).unwrap_err().to_string();
        assert!(said.contains("has 3.4 GB") && said.contains("need 7.0 GB"), "{said}");
    }
}
