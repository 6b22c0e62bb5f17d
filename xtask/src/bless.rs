//! `bless`: accepts the pictures that the last tests drew as the new golden pictures.

use crate::shell::{root, target};
use anyhow::{Context, Result};
use rototoon_tests::golden;

/// Copies each picture of `target/golden` that differs from its golden picture to `tests/golden`.
pub fn bless() -> Result<()> {
    let (drawn, kept) = (target().join("golden"), root().join(golden::FOLDER));
    let entries = std::fs::read_dir(&drawn).context("found no pictures to accept: run the tests first")?;
    std::fs::create_dir_all(&kept)?;
    let mut names: Vec<_> = entries.map(|entry| Ok(entry?.file_name())).collect::<Result<_>>()?;
    names.retain(|name| name.to_string_lossy().ends_with(".png"));
    names.sort();
    for name in names {
        let (from, to) = (drawn.join(&name), kept.join(&name));
        let bytes = std::fs::read(&from).with_context(|| format!("cannot read {from:?}"))?;
        if std::fs::read(&to).is_ok_and(|have| have == bytes) {
            continue;
        }
        std::fs::write(&to, bytes).with_context(|| format!("cannot write {to:?}"))?;
        println!("accepted {}", name.to_string_lossy());
    }
    Ok(())
}
