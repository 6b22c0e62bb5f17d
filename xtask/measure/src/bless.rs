//! `bless`: accepts the golden pictures and the generated pages that the tests last wrote.

use anyhow::{Context, Result};
use rototoon_tests::golden;
use xtask_shell::shell::{root, target};

/// Copies each picture of `target/golden` that differs from its golden picture to `tests/golden`, and each page to the
/// documentation.
pub fn bless() -> Result<()> {
    let drawn = target().join("golden");
    let entries = std::fs::read_dir(&drawn).context("nothing to accept: run the tests first")?;
    let mut names: Vec<_> = entries.map(|entry| Ok(entry?.file_name())).collect::<Result<_>>()?;
    names.sort();
    for name in names {
        let text = name.to_string_lossy();
        let folder = match text.rsplit_once('.') {
            Some((_, "png")) => golden::FOLDER,
            Some((_, "md")) => golden::PAGES,
            _ => continue,
        };
        let kept = root().join(folder);
        std::fs::create_dir_all(&kept)?;
        let (from, to) = (drawn.join(&name), kept.join(&name));
        let bytes = std::fs::read(&from).with_context(|| format!("cannot read {from:?}"))?;
        if std::fs::read(&to).is_ok_and(|have| have == bytes) {
            continue;
        }
        std::fs::write(&to, bytes).with_context(|| format!("cannot write {to:?}"))?;
        println!("accepted {text}");
    }
    Ok(())
}
