"""The list of a library's clips in the window: what it shows, which one is chosen.

A folder is no part of a Blender file, so the list is kept with the window, not with the file, and undo leaves it alone. It is read
when a library is chosen or added to, when a file is opened, and by Refresh.
"""

from __future__ import annotations

import bpy

from ..blender import windows
from ..blender.errors import Problem
from ..rototoon import RototoonError
from . import clip_library

_shelf: clip_library.Shelf | None = None


def browser() -> bpy.types.PropertyGroup:
    """The list of this window manager."""
    return bpy.context.window_manager.rototoon_clips


def shelf() -> clip_library.Shelf | None:
    """The library that is listed."""
    return _shelf if _shelf is not None and browser().folder == _shelf.folder else None


def refresh(folder: str) -> clip_library.Shelf:
    """Reads a library and lists it; the chosen clip stays chosen."""
    global _shelf
    listed = browser()
    before = chosen()
    _shelf = clip_library.read(folder)
    listed.folder = folder
    listed.clips.clear()
    for row in _shelf.rows:
        item = listed.clips.add()
        item.name = f"{row.character} {row.motion}"
        item.character, item.motion, item.frames, item.trouble = row.character, row.motion, row.frames, row.trouble
    wanted = (before.character, before.motion) if before is not None else None
    same = (k for k, row in enumerate(_shelf.rows) if (row.character, row.motion) == wanted)
    listed.active = next(same, 0)
    windows.redraw_views()
    return _shelf


def refresh_for(ob) -> None:
    """Lists the library of an object, if it has one that can be read; used where nobody waits for an answer."""
    try:
        refresh(clip_library.folder_of(ob))
    except (Problem, RototoonError):
        forget()


def forget() -> None:
    """Lists nothing."""
    global _shelf
    _shelf = None
    listed = browser()
    listed.folder = ""
    listed.clips.clear()


def close() -> None:
    """Forgets the library, where the window's list goes too."""
    global _shelf
    _shelf = None


def is_listed(ob) -> bool:
    """Whether the list is that of an object's library."""
    try:
        folder = clip_library.folder_of(ob)
        return shelf() is not None and shelf().folder == folder
    except Problem:
        return True


def chosen() -> clip_library.Row | None:
    """The chosen clip, if it can be used."""
    listed, found = browser(), shelf()
    if found is None or not 0 <= listed.active < len(found.rows):
        return None
    row = found.rows[listed.active]
    return None if row.trouble else row


def fits(item, character: str, motion: str) -> bool:
    """Whether a row is shown while the list is filtered."""
    return character.lower() in item.character.lower() and motion.lower() in item.motion.lower()


def characters(motion: str = "") -> list[str]:
    """Characters of the listed library."""
    found = shelf()
    return found.characters(motion) if found is not None else []


def motions(character: str = "") -> list[str]:
    """Motions of the listed library."""
    found = shelf()
    return found.motions(character) if found is not None else []


def offered(names: list[str], text: str) -> list[str]:
    """The names to offer after what was typed."""
    return [name for name in names if text.lower() in name.lower()]
