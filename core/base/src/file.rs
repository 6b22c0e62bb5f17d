//! Reads a file of a user within limits: a regular file of bounded length.
//!
//! A pipe would wait for a writer for ever, and a device such as `/dev/zero` has no end. Both are errors at once.

mod encoding;

use encoding::foreign_encoding;
use std::fs::File;
use std::io::{self, Read, Seek, SeekFrom};
use std::path::Path;

/// Greatest length in bytes of a file that is read into memory at once.
pub const LONGEST: u64 = 1 << 30;

/// Checks that a path leads to a regular file, and returns its length in bytes.
///
/// # Errors
///
/// The error of the system, or that it is a folder, a pipe or a device.
pub fn length(path: &Path) -> io::Result<u64> {
    let data = std::fs::metadata(path)?;
    if data.is_file() {
        return Ok(data.len());
    }
    let found = if data.is_dir() { "a folder" } else { "a pipe or a device" };
    Err(io::Error::other(format!("it is {found}, expected a file")))
}

/// The bytes of a file.
///
/// # Errors
///
/// As for [`length`]; a file longer than [`LONGEST`].
pub fn bytes(path: &Path) -> io::Result<Vec<u8>> {
    let long = length(path)?;
    if long > LONGEST {
        return Err(io::Error::other(format!("found a file of {long} bytes, expected at most {LONGEST}")));
    }
    let mut bytes = Vec::new();
    bytes.try_reserve_exact(long as usize).map_err(io::Error::other)?;
    // The file may grow while it is read.
    File::open(path)?.take(LONGEST).read_to_end(&mut bytes)?;
    Ok(bytes)
}

/// The text of a file in UTF-8.
///
/// # Errors
///
/// As for [`bytes`], and for [`utf8`].
pub fn text(path: &Path) -> io::Result<String> {
    utf8(bytes(path)?)
}

/// The text in the bytes of a file.
///
/// # Errors
///
/// Another encoding than UTF-8 is named if the text begins as such a one; else a byte that is not UTF-8 by its index.
pub fn utf8(bytes: Vec<u8>) -> io::Result<String> {
    let wrong = |message: String| io::Error::new(io::ErrorKind::InvalidData, message);
    let named = |bytes: &[u8]| {
        let encoding = foreign_encoding(bytes)?;
        Some(wrong(format!("found a text in {encoding}, expected UTF-8: save it as UTF-8")))
    };
    match String::from_utf8(bytes) {
        // UTF-16 without any letter beyond ASCII is UTF-8 too, with a zero beside each letter.
        Ok(text) if text.contains('\0') => named(text.as_bytes()).map_or(Ok(text), Err),
        Ok(text) => Ok(text),
        Err(error) => {
            let at = error.utf8_error().valid_up_to();
            Err(named(error.as_bytes()).unwrap_or_else(|| wrong(format!("byte {at} is not UTF-8 text"))))
        }
    }
}

/// Whether the error of a lock says that the disk knows no locks: some disks of the network, one whose lock service does not run,
/// and some file systems of users. Rust names only a part of what systems say then.
pub fn knows_no_locks(error: &io::Error) -> bool {
    #[cfg(unix)]
    let named = {
        use rustix::io::Errno;
        let known = [Errno::NOLCK, Errno::OPNOTSUPP, Errno::NOSYS, Errno::INVAL];
        error.raw_os_error().is_some_and(|raw| known.contains(&Errno::from_raw_os_error(raw)))
    };
    #[cfg(not(unix))]
    let named = false;
    named || error.kind() == io::ErrorKind::Unsupported
}

/// A reader that repeats a call which a signal interrupted.
///
/// On a slow or remote disk a signal may end a call before it has read anything. The standard library's functions for a
/// whole file repeat such a call. Decoders that read step by step do not all do so.
#[derive(Debug)]
pub struct Repeating<R>(pub R);

impl<R: Read> Read for Repeating<R> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        loop {
            match self.0.read(buffer) {
                Err(error) if error.kind() == io::ErrorKind::Interrupted => {}
                other => return other,
            }
        }
    }
}

impl<R: Seek> Seek for Repeating<R> {
    fn seek(&mut self, to: SeekFrom) -> io::Result<u64> {
        self.0.seek(to)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn interrupted_calls_are_repeated() {
        struct Interrupted(u8);
        impl Read for Interrupted {
            fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
                self.0 += 1;
                if self.0 < 3 {
                    return Err(io::ErrorKind::Interrupted.into());
                }
                buffer[0] = 7;
                Ok(1)
            }
        }
        let mut buffer = [0; 4];
        assert_eq!(Repeating(Interrupted(0)).read(&mut buffer).unwrap(), 1);
        assert_eq!(buffer[0], 7);
    }

    #[test]
    fn files_are_read_and_other_things_refused() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.json");
        assert_eq!(text(&path).unwrap_err().kind(), io::ErrorKind::NotFound);
        std::fs::write(&path, "ä\n").unwrap();
        assert_eq!(text(&path).unwrap(), "ä\n");
        std::fs::write(&path, b"ab\xFFc").unwrap();
        assert_eq!(text(&path).unwrap_err().to_string(), "byte 2 is not UTF-8 text");
        for utf16 in [&b"\xFF\xFE{\0"[..], b"{\0}\0", b"\0{\0\xE4"] {
            std::fs::write(&path, utf16).unwrap();
            let said = text(&path).unwrap_err().to_string();
            assert_eq!(said, "found a text in UTF-16, expected UTF-8: save it as UTF-8");
        }
        assert_eq!(bytes(folder.path()).unwrap_err().to_string(), "it is a folder, expected a file");
    }

    #[cfg(unix)]
    #[test]
    fn disks_without_locks_are_told_from_other_failures() {
        use rustix::io::Errno;
        let of = |errno: Errno| io::Error::from_raw_os_error(errno.raw_os_error());
        assert!([Errno::NOLCK, Errno::OPNOTSUPP, Errno::INVAL, Errno::NOSYS].map(of).iter().all(knows_no_locks));
        assert!(knows_no_locks(&io::ErrorKind::Unsupported.into()));
        assert!(![Errno::IO, Errno::ACCESS, Errno::INTR].map(of).iter().any(knows_no_locks));
    }

    #[cfg(unix)]
    #[test]
    fn pipes_devices_and_endless_files_are_refused() {
        let folder = tempfile::tempdir().unwrap();
        let pipe = folder.path().join("pipe");
        assert!(std::process::Command::new("mkfifo").arg(&pipe).status().unwrap().success());
        for path in [&pipe, Path::new("/dev/zero")] {
            assert_eq!(text(path).unwrap_err().to_string(), "it is a pipe or a device, expected a file");
        }
        // A file with a hole takes no space on the disk.
        let long = folder.path().join("long");
        std::fs::File::create(&long).unwrap().set_len(LONGEST + 1).unwrap();
        assert_eq!(
            text(&long).unwrap_err().to_string(),
            "found a file of 1073741825 bytes, expected at most 1073741824"
        );
    }
}
