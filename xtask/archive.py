"""Packs a folder or a file into a zip. The same content gives the same bytes: names are sorted, and all entries have one date.

    python archive.py FOLDER ZIP DATE

DATE is in seconds since 1970. Programs stay executable.
"""

import os
import stat
import sys
import time
import zipfile
from pathlib import Path


def main(source: Path, target: Path, date: int) -> None:
    """Packs `source` under its own name."""
    files = sorted(path for path in source.rglob("*") if path.is_file()) if source.is_dir() else [source]
    with zipfile.ZipFile(target, "w", zipfile.ZIP_DEFLATED, compresslevel=9) as out:
        for path in files:
            name = path.relative_to(source.parent).as_posix()
            entry = zipfile.ZipInfo(name, time.gmtime(date)[:6])
            entry.create_system = 3  # Unix: only then the mode is read
            entry.external_attr = (stat.S_IFREG | (0o755 if os.access(path, os.X_OK) else 0o644)) << 16
            entry.compress_type = zipfile.ZIP_DEFLATED
            out.writestr(entry, path.read_bytes(), compresslevel=9)


if __name__ == "__main__":
    main(Path(sys.argv[1]), Path(sys.argv[2]), int(sys.argv[3]))
