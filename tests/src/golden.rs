//! Golden pictures: pictures that somebody has looked at and accepted.
//!
//! [`compare`] writes the present picture to `target/golden/<name>.png` and compares it with `tests/golden/<name>.png`. Look
//! at the new pictures first; `cargo xtask bless` then accepts them.

use anyhow::{Context, Result, bail, ensure};
use std::path::{Path, PathBuf};
use tiny_skia::Pixmap;

/// The folder of the accepted pictures, below the workspace's folder.
pub const FOLDER: &str = "tests/golden";
/// Where the generated pages of the documentation are, below the workspace's folder.
pub const PAGES: &str = "docs/src/generated";
/// A channel may differ by so much of 255: mathematical functions of two systems may differ in their last bit.
const STEP: u8 = 2;
/// Allowed share of pixels that differ by more than [`STEP`].
const SHARE: f64 = 1e-4;

/// Fails if `picture` differs from the accepted picture `name`, or if there is none.
pub fn compare(name: &str, picture: &Pixmap) -> Result<()> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).parent().context("the tests are in the workspace")?;
    compare_in(&root.join(FOLDER), &current_folder(root), name, picture)
}

/// Fails where `text` is not the page `name` of the documentation. Writes it to `target/golden/<name>.md` for
/// `cargo xtask bless`.
pub fn compare_page(name: &str, text: &str) -> Result<()> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).parent().context("the tests lie in the workspace")?;
    let file = format!("{name}.md");
    let (kept, drawn) = (root.join(PAGES).join(&file), current_folder(root).join(&file));
    std::fs::create_dir_all(drawn.parent().context("a file lies in a folder")?)?;
    std::fs::write(&drawn, text).with_context(|| format!("cannot write {drawn:?}"))?;
    let current = std::fs::read_to_string(&kept).is_ok_and(|page| page == text);
    ensure!(current, "{kept:?} is stale: look at {drawn:?}; `cargo xtask bless` accepts it");
    Ok(())
}

fn current_folder(root: &Path) -> PathBuf {
    let target = std::env::var_os("CARGO_TARGET_DIR").map_or_else(|| root.join("target"), |folder| root.join(folder));
    target.join("golden")
}

fn compare_in(kept: &Path, drawn: &Path, name: &str, picture: &Pixmap) -> Result<()> {
    let file = format!("{name}.png");
    let (kept, drawn) = (kept.join(&file), drawn.join(&file));
    std::fs::create_dir_all(drawn.parent().context("a file is in a folder")?)?;
    std::fs::write(&drawn, picture.encode_png()?).with_context(|| format!("cannot write {drawn:?}"))?;
    let advice = format!("look at {drawn:?}; `cargo xtask bless` accepts it");
    let Ok(bytes) = std::fs::read(&kept) else { bail!("{kept:?} does not exist: {advice}") };
    let golden = Pixmap::decode_png(&bytes).with_context(|| format!("cannot read {kept:?}"))?;
    let size = |p: &Pixmap| (p.width(), p.height());
    ensure!(
        size(&golden) == size(picture),
        "{name}: found {:?}, expected {:?}: {advice}",
        size(picture),
        size(&golden)
    );
    let differing = golden.pixels().iter().zip(picture.pixels()).filter(|(a, b)| differ(**a, **b)).count();
    let allowed = (SHARE * golden.pixels().len() as f64) as usize;
    ensure!(differing <= allowed, "{name}: {differing} pixels differ, expected at most {allowed}: {advice}");
    Ok(())
}

fn differ(a: tiny_skia::PremultipliedColorU8, b: tiny_skia::PremultipliedColorU8) -> bool {
    let channels = |c: tiny_skia::PremultipliedColorU8| [c.red(), c.green(), c.blue(), c.alpha()];
    channels(a).into_iter().zip(channels(b)).any(|(a, b)| a.abs_diff(b) > STEP)
}

#[cfg(test)]
mod tests {
    use super::*;
    use tiny_skia::Color;

    #[test]
    fn equal_pictures_pass_and_others_fail() {
        let folder = tempfile::tempdir().unwrap();
        let (kept, drawn) = (folder.path().join("kept"), folder.path().join("drawn"));
        let mut picture = Pixmap::new(20, 10).unwrap();
        picture.fill(Color::from_rgba8(10, 200, 30, 255));
        let missing = compare_in(&kept, &drawn, "patch", &picture).unwrap_err().to_string();
        assert!(missing.contains("bless"), "{missing}");
        std::fs::create_dir_all(&kept).unwrap();
        std::fs::copy(drawn.join("patch.png"), kept.join("patch.png")).unwrap();
        compare_in(&kept, &drawn, "patch", &picture).unwrap();
        picture.data_mut()[4] = 60;
        let changed = compare_in(&kept, &drawn, "patch", &picture).unwrap_err().to_string();
        assert!(changed.contains("1 pixels differ"), "{changed}");
        let other = Pixmap::new(10, 20).unwrap();
        assert!(compare_in(&kept, &drawn, "patch", &other).is_err());
    }

    #[test]
    fn every_golden_picture_has_a_test() {
        let tests = Path::new(env!("CARGO_MANIFEST_DIR"));
        let mut sources = String::new();
        for folder in ["src", "src/sample", "tests"] {
            for entry in std::fs::read_dir(tests.join(folder)).into_iter().flatten().flatten() {
                if entry.path().extension().is_some_and(|e| e == "rs") {
                    sources += &std::fs::read_to_string(entry.path()).unwrap();
                }
            }
        }
        for entry in std::fs::read_dir(tests.join("golden")).into_iter().flatten().flatten() {
            let name = entry.path().file_stem().unwrap().to_string_lossy().into_owned();
            assert!(sources.contains(&format!("\"{name}\"")), "no test draws {name}.png: remove it");
        }
    }
}
