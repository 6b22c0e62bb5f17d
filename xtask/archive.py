"""Packs a folder or a file into a zip, or packs a zip again. The same content gives the same bytes: names are sorted, and all entries
have one date.

    python archive.py FOLDER ZIP DATE
    python archive.py OLD.zip ZIP DATE

DATE is in seconds since 1970. Programs stay executable. ZIP may be OLD.zip.
"""

import os
import stat
import sys
import time
import zipfile
from collections.abc import Iterator
from pathlib import Path


def of_folder(source: Path) -> Iterator[tuple[str, int, bytes]]:
    """Name, mode and content of each file, under the folder's own name."""
    for path in source.rglob("*") if source.is_dir() else [source]:
        if path.is_file():
            mode = 0o755 if os.access(path, os.X_OK) else 0o644
            yield path.relative_to(source.parent).as_posix(), mode, path.read_bytes()


def of_zip(source: Path) -> Iterator[tuple[str, int, bytes]]:
    """Name, mode and content of each file. Folders have no entries of their own."""
    with zipfile.ZipFile(source) as file:
        for entry in file.infolist():
            if not entry.is_dir():
                mode = 0o755 if entry.external_attr >> 16 & 0o100 else 0o644
                yield entry.filename, mode, file.read(entry)


def main(source: Path, target: Path, date: int) -> None:
    """Packs `source`. The zip appears whole or not at all."""
    files = sorted(of_zip(source) if zipfile.is_zipfile(source) else of_folder(source))
    unfinished = target.with_name(f"{target.name}.unfinished")
    try:
        with zipfile.ZipFile(unfinished, "w", zipfile.ZIP_DEFLATED, compresslevel=9) as out:
            for name, mode, data in files:
                entry = zipfile.ZipInfo(name, time.gmtime(date)[:6])
                entry.create_system = 3  # Unix: only then the mode is read
                entry.external_attr = (stat.S_IFREG | mode) << 16
                entry.compress_type = zipfile.ZIP_DEFLATED
                out.writestr(entry, data, compresslevel=9)
        unfinished.replace(target)
    finally:
        unfinished.unlink(missing_ok=True)


if __name__ == "__main__":
    main(Path(sys.argv[1]), Path(sys.argv[2]), int(sys.argv[3]))
