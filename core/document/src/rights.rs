//! Who may write a file that is about to be replaced, and whose it is afterwards.
//!
//! A file is replaced by renaming another one, for which the system asks only who may write into the folder. So it is asked here whether this user
//! may write the file itself: in a folder that is shared, the files of others stay theirs.

use std::fs::{File, Metadata, OpenOptions};
use std::io;
use std::path::Path;

/// Fails where this user may not write a file that is there. Nothing of it is changed.
pub(crate) fn check(path: &Path, data: &Metadata) -> io::Result<()> {
    let denied = |message: &str| Err(io::Error::new(io::ErrorKind::PermissionDenied, message));
    // To the administrator the system would say yes.
    if data.permissions().readonly() {
        return denied("the file is read-only");
    }
    match OpenOptions::new().write(true).open(path) {
        Err(error) if error.kind() == io::ErrorKind::PermissionDenied => denied(
            "the file is read-only for this user; write to another file, or ask its owner for the right to write it",
        ),
        // On Windows another program may hold it for a moment. Renaming tells of that.
        _ => Ok(()),
    }
}

/// Gives a new file the owner, the group and the mode of the one that it replaces, as far as this user may.
pub(crate) fn keep(file: &File, data: &Metadata) -> io::Result<()> {
    #[cfg(unix)]
    {
        use std::os::unix::fs::{MetadataExt, fchown};
        // Only the administrator may give a file away. Others may give it to a group of theirs.
        if fchown(file, Some(data.uid()), Some(data.gid())).is_err() {
            let _ = fchown(file, None, Some(data.gid()));
        }
    }
    file.set_permissions(data.permissions())
}

#[cfg(all(test, unix))]
mod tests {
    use crate::output::{check_writable, write_whole};
    use std::fs::{self, OpenOptions, Permissions};
    use std::os::unix::fs::{MetadataExt, PermissionsExt, chown};

    #[test]
    fn a_file_that_this_user_may_not_write_stays() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.json");
        write_whole(&path, b"one").unwrap();
        // Others may write it, so it is not read-only; its owner may not.
        fs::set_permissions(&path, Permissions::from_mode(0o466)).unwrap();
        if OpenOptions::new().write(true).open(&path).is_ok() {
            return; // the administrator may
        }
        let refused = check_writable(&path).unwrap_err().to_string();
        assert!(refused.contains("the file is read-only for this user"), "{refused}");
        assert_eq!(write_whole(&path, b"two").unwrap_err().to_string(), refused);
        assert_eq!(fs::read(&path).unwrap(), b"one");
    }

    #[test]
    fn a_file_that_the_administrator_replaces_stays_its_owners() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.json");
        write_whole(&path, b"one").unwrap();
        if chown(&path, Some(4321), Some(8765)).is_err() {
            return; // an ordinary user may not give files away
        }
        fs::set_permissions(&path, Permissions::from_mode(0o640)).unwrap();
        write_whole(&path, b"two").unwrap();
        let data = fs::metadata(&path).unwrap();
        assert_eq!((data.uid(), data.gid(), data.mode() & 0o777), (4321, 8765, 0o640));
        assert_eq!(fs::read(&path).unwrap(), b"two");
    }
}
