"""One tracking session for each Grease Pencil object, while the file is open.

A session remembers pictures and solved spans, so the second Track is fast. Nothing is lost with a session: the file has
everything that the artist did.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

from rototoon import Session, match_contours


@dataclass
class Entry:
    """A session, and the document without results that it tracked last. It may have another document by now."""

    session: Any
    folder: str
    inputs: Mapping[str, Any] | None = None
    preset: str = ""
    """The method in the panel when `inputs` was tracked."""
    closed: tuple[str, ...] = ()
    """Names of the layers that were locked then, and got no result."""


_entries: dict[int, Entry] = {}


make: Callable[[Mapping[str, Any], str], Any] = Session.from_document
"""Makes a session from a document and its folder. Tests replace it."""
matcher: Callable[[Mapping[str, Any]], Any] = match_contours
"""Matches contours. Tests replace it."""


def get(ob, document: Mapping[str, Any], folder: str) -> Entry:
    """The object's session, with `document` as its document."""
    entry = _entries.get(ob.session_uid)
    if entry is None or entry.folder != folder:
        entry = Entry(make(document, folder), folder)
        _put(ob.session_uid, entry)
    else:
        entry.session.set_document(document)
    return entry


def known(ob) -> Entry | None:
    """The object's session, if it has one."""
    return _entries.get(ob.session_uid)


def drop(ob) -> None:
    """Forgets the object's session."""
    forget(ob.session_uid)


def forget(uid: int) -> None:
    """Forgets the session of an object that may be gone, by its `session_uid`."""
    _put(uid, None)


def clear() -> None:
    """Forgets all sessions: another file is open."""
    for uid in list(_entries):
        _put(uid, None)


def _put(uid: int, entry: Entry | None) -> None:
    old = _entries.pop(uid, None)
    if old is not None and hasattr(old.session, "close"):
        old.session.close()
    if entry is not None:
        _entries[uid] = entry
