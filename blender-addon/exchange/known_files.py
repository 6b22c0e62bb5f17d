"""Files that an object was read from or written to: what another program wrote there meanwhile is not written over.

The object keeps a mark of what each of its files held, in the Blender file too: a colleague may change a document while the Blender file is closed.
The look and the writing are the core's (`rototoon.documents`); the command line and Python sessions use the same.

Undo takes an object's marks back, and what this Blender wrote stays on the disk. So this Blender also remembers its own writes: they are nobody else's.

Limits: files are known by their paths, so a document on a drive that has another name on another machine is replaced there without a look, as any file that
the user chose. Linked objects keep no marks.
"""

from __future__ import annotations

import json
import os
from typing import Any

from rototoon import LibraryError, documents

from ..blender import guard
from ..common import kept
from . import files

_own: dict[str, set[str]] = {}
"""By file the marks of what this Blender wrote."""


def mark(path: str) -> str:
    """The mark of what a file holds now; empty if there is none, or no library to ask. To be called before the file is read."""
    try:
        return documents.mark(path)
    except LibraryError:
        return ""


def note(ob, path: str, held: str) -> None:
    """Keeps with an object what a file holds from which it was read, or to which it was written."""
    if held and not guard.refusal(ob, guard.SETTINGS):
        ob.rototoon.known_files = json.dumps(kept.fields(ob.rototoon.known_files) | {_real(path): held})


def is_known(ob, path: str) -> bool:
    """Whether the object was read from a file, or written to it."""
    return _real(path) in kept.fields(ob.rototoon.known_files)


def save(ob, path: str, document: dict[str, Any]) -> None:
    """Writes a document of an object. If another program wrote the file after the object was read from it or written to it, the file stays as it is,
    and an error names the new file beside it that has the document."""
    file, content = _real(path), files.text(os.path.dirname(os.path.abspath(path)), document)
    known = kept.fields(ob.rototoon.known_files).get(file, "")
    if not isinstance(known, str):
        known = ""
    try:
        held = documents.mark(path) if known else ""
        written = documents.replace(path, content, held if held in _own.get(file, ()) else known)
    except LibraryError:
        if known:
            raise
        files.put(path, content)
        return
    _own.setdefault(file, set()).add(written)
    note(ob, path, written)


def _real(path: str) -> str:
    return os.path.normcase(os.path.realpath(path))
