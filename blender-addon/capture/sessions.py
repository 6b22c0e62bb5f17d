"""One tracking session for each Grease Pencil object, kept as long as the file is open.

A session remembers pictures and solved spans, which is what makes the second Track fast. What it knows is never needed:
everything that the artist did is in the file.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any


@dataclass
class Entry:
    """A session and the document without results that it was last given."""

    session: Any
    folder: str
    inputs: Mapping[str, Any] | None = None
    preset: str = ""
    """The method that the panel showed when `inputs` was tracked."""


_entries: dict[int, Entry] = {}


def _real(document: Mapping[str, Any], folder: str) -> Any:
    from ..rototoon import Session

    return Session.from_document(document, folder)


def _real_matcher(request: Mapping[str, Any]) -> Any:
    from ..rototoon import match_contours

    return match_contours(request)


make: Callable[[Mapping[str, Any], str], Any] = _real
"""Makes a session of a document and its folder; tests put their own here."""
matcher: Callable[[Mapping[str, Any]], Any] = _real_matcher
"""Finds which contour is which; tests put their own here."""


def get(ob, document: Mapping[str, Any], folder: str) -> Entry:
    """The object's session, holding `document`."""
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
