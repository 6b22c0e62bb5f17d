//! The benchmark's own sets, which this package draws. They are used if no other sets with truth are given.
//!
//! - `limbs`: a crowd of limbs that swing out and back and cross, keyed on the first, the middle and the last frame
//!   ([`crate::puppet`])
//! - `sample`: the sample cartoon with the keys that an artist would set ([`crate::sample`])
//! - `far_keys`: the same cartoon with every part keyed on three frames only, so that limbs swing out and back between keys

use crate::puppet::Puppet;
use crate::sample;
use anyhow::Result;
use std::path::{Path, PathBuf};

/// Nine limbs at the sample cartoon's size.
const LIMBS: Puppet = Puppet { width: 960, height: 540, frames: 29, step: 14, parts: 9, points: 12 };

/// Writes each set into a folder of its name in `folder`. Returns the names and folders.
pub fn write(folder: &Path) -> Result<Vec<(String, PathBuf)>> {
    let of = |name: &str| (name.to_owned(), folder.join(name));
    let sets = vec![of("limbs"), of("sample"), of("far_keys")];
    LIMBS.write(&sets[0].1)?;
    sample::write(&sets[1].1)?;
    sample::write_keyed(&sets[2].1, sample::far_key_frames)?;
    Ok(sets)
}
