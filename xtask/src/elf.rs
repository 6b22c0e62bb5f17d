//! Reads from an ELF file which libraries, and which versions of glibc's symbols, a library needs.
//!
//! The section of type `SHT_GNU_verneed` of a shared library lists each library that it needs, with the symbol versions that
//! it needs of it (Linux Standard Base Core 5.0, "Symbol Version Requirements"). A record has 16 bytes and is followed by
//! its entries of 16 bytes. Names are offsets into the linked string table. Only 64-bit little-endian files are supported.

use anyhow::{Context, Result, bail, ensure};
use std::path::Path;

const VERNEED: u32 = 0x6fff_fffe;

/// The names of all symbol versions that a library needs, such as `GLIBC_2.17`.
pub fn needed_versions(file: &[u8]) -> Result<Vec<String>> {
    ensure!(file.starts_with(b"\x7fELF\x02\x01"), "not a 64-bit little-endian ELF file");
    let sections = number(file, 0x28, 8)?;
    let (size, count) = (number(file, 0x3a, 2)?, number(file, 0x3c, 2)?);
    let mut versions = Vec::new();
    for section in (0..count).map(|i| sections + i * size) {
        if number(file, section + 4, 4)? != VERNEED as usize {
            continue;
        }
        let names = sections + number(file, section + 0x28, 4)? * size;
        let strings = number(file, names + 0x18, 8)?;
        let mut record = number(file, section + 0x18, 8)?;
        for _ in 0..number(file, section + 0x2c, 4)? {
            let mut entry = record + number(file, record + 8, 4)?;
            for _ in 0..number(file, record + 2, 2)? {
                versions.push(string(file, strings + number(file, entry + 8, 4)?)?);
                entry += number(file, entry + 12, 4)?;
            }
            record += number(file, record + 12, 4)?;
        }
    }
    versions.sort();
    versions.dedup();
    Ok(versions)
}

/// The names of all libraries that a library links, such as `libc.so.6`.
pub fn needed_libraries(file: &[u8]) -> Result<Vec<String>> {
    const DYNAMIC: usize = 6;
    const NEEDED: usize = 1;
    ensure!(file.starts_with(b"\x7fELF\x02\x01"), "not a 64-bit little-endian ELF file");
    let sections = number(file, 0x28, 8)?;
    let (size, count) = (number(file, 0x3a, 2)?, number(file, 0x3c, 2)?);
    let mut names = Vec::new();
    for section in (0..count).map(|i| sections + i * size) {
        if number(file, section + 4, 4)? != DYNAMIC {
            continue;
        }
        let strings = number(file, sections + number(file, section + 0x28, 4)? * size + 0x18, 8)?;
        let (start, length) = (number(file, section + 0x18, 8)?, number(file, section + 0x20, 8)?);
        for entry in (start..start + length).step_by(16) {
            if number(file, entry, 8)? == NEEDED {
                names.push(string(file, strings + number(file, entry + 8, 8)?)?);
            }
        }
    }
    Ok(names)
}

/// Fails if a library needs a newer glibc than `most` (major and minor number).
pub fn assert_glibc(path: &Path, most: (u32, u32)) -> Result<()> {
    let file = std::fs::read(path).with_context(|| format!("cannot read {path:?}"))?;
    let versions = needed_versions(&file).with_context(|| format!("{path:?}"))?;
    for version in &versions {
        if let Some(found) = glibc(version)
            && found > most
        {
            bail!("{path:?} needs {version}, expected glibc {}.{} at most", most.0, most.1);
        }
    }
    Ok(())
}

/// `GLIBC_2.17` as (2, 17); `None` for other libraries' versions.
fn glibc(version: &str) -> Option<(u32, u32)> {
    // Relocations that are packed: no number names the glibc that reads them.
    if version == "GLIBC_ABI_DT_RELR" {
        return Some((2, 36));
    }
    let mut numbers = version.strip_prefix("GLIBC_")?.split('.').map(|n| n.parse().ok());
    Some((numbers.next()??, numbers.next().flatten().unwrap_or(0)))
}

fn number(file: &[u8], at: usize, bytes: usize) -> Result<usize> {
    let slice = file.get(at..at + bytes).context("the ELF file is cut short")?;
    Ok(slice.iter().rev().fold(0, |n, &b| n << 8 | usize::from(b)))
}

fn string(file: &[u8], at: usize) -> Result<String> {
    let rest = file.get(at..).context("the ELF file is cut short")?;
    let end = rest.iter().position(|&b| b == 0).context("a name in the ELF file is not terminated")?;
    Ok(String::from_utf8_lossy(&rest[..end]).into_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    #[cfg(target_env = "gnu")]
    fn this_program_needs_glibc() {
        let path = std::env::current_exe().unwrap();
        let versions = needed_versions(&std::fs::read(&path).unwrap()).unwrap();
        assert!(versions.iter().any(|v| glibc(v).is_some_and(|v| v >= (2, 2))), "{versions:?}");
        assert!(assert_glibc(&path, (2, 0)).unwrap_err().to_string().contains("GLIBC_2."));
        assert_glibc(&path, (99, 0)).unwrap();
        let libraries = needed_libraries(&std::fs::read(&path).unwrap()).unwrap();
        assert!(libraries.iter().any(|name| name == "libc.so.6"), "{libraries:?}");
    }

    #[test]
    fn versions_are_compared_as_numbers() {
        assert!(glibc("GLIBC_2.28") > glibc("GLIBC_2.4"));
        assert_eq!(glibc("GLIBC_2.2.5"), Some((2, 2)));
        assert_eq!(glibc("GCC_3.0"), None);
        assert_eq!(glibc("GLIBC_PRIVATE"), None);
        assert!(glibc("GLIBC_ABI_DT_RELR") > glibc("GLIBC_2.28"));
    }

    #[test]
    fn other_files_are_refused() {
        assert!(needed_versions(b"MZ").is_err() && needed_libraries(b"MZ").is_err());
        assert!(needed_versions(b"\x7fELF\x02\x01\x01").is_err());
    }
}
