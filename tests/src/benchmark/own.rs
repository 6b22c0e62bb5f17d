//! Sets of our own for whoever has no others with truth: all of them are drawn by this package.
//!
//! - `limbs`: a crowd of limbs that swing there and back and cross, keyed on the first, the middle and the last frame
//!   ([`crate::puppet`])
//! - `sample`: the sample cartoon with the keys that an artist would set ([`crate::sample`])
//! - `far_keys`: the same with every part keyed on three frames only: between them limbs swing there and back unseen

use crate::puppet::Puppet;
use crate::sample;
use anyhow::Result;
use std::path::{Path, PathBuf};

/// Nine limbs at the sample cartoon's size.
const LIMBS: Puppet = Puppet { width: 960, height: 540, frames: 29, step: 14, parts: 9, points: 12 };

/// Writes the sets into folders of their names in `folder`; their names and folders.
pub fn write(folder: &Path) -> Result<Vec<(String, PathBuf)>> {
    let of = |name: &str| (name.to_owned(), folder.join(name));
    let sets = vec![of("limbs"), of("sample"), of("far_keys")];
    LIMBS.write(&sets[0].1)?;
    sample::write(&sets[1].1)?;
    sample::write_keyed(&sets[2].1, sample::far_key_frames)?;
    Ok(sets)
}
