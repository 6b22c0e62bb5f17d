"""The list of a library's clips in the window, and the chosen clip.

A folder is not part of a Blender file. So the window manager keeps the list, not the file, and undo does not affect it. The list is
read when a library is chosen, when a clip is added, when a file is opened, and by Refresh.
"""

from __future__ import annotations

import bpy
from rototoon import RototoonError

from ..blender import windows
from ..blender.errors import Problem
from . import clip_library

_shelf: clip_library.Shelf | None = None


def browser() -> bpy.types.PropertyGroup:
    """The window manager's list."""
    return bpy.context.window_manager.rototoon_clips


def shelf() -> clip_library.Shelf | None:
    """The listed library; `None` if there is none."""
    return _shelf if _shelf is not None and browser().folder == _shelf.folder else None


def refresh(folder: str) -> clip_library.Shelf:
    """Reads a library and lists it. The chosen clip stays chosen."""
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
    """Lists an object's library. If it cannot be read, lists nothing and reports no error."""
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
    """Forgets the library, without a change of the window's list."""
    global _shelf
    _shelf = None


def is_listed(ob) -> bool:
    """Whether the listed library is that of an object."""
    try:
        folder = clip_library.folder_of(ob)
        return shelf() is not None and shelf().folder == folder
    except Problem:
        return True


def chosen() -> clip_library.Row | None:
    """The chosen clip; `None` if it cannot be used."""
    listed, found = browser(), shelf()
    if found is None or not 0 <= listed.active < len(found.rows):
        return None
    row = found.rows[listed.active]
    return None if row.trouble else row


def fits(item, character: str, motion: str) -> bool:
    """Whether a row passes the list's filter."""
    return character.lower() in item.character.lower() and motion.lower() in item.motion.lower()


def characters(motion: str = "", human: bool = False) -> list[str]:
    """Characters of the listed library; with `human` humans only."""
    found = shelf()
    return found.characters(motion, human) if found is not None else []


def motions(character: str = "", human: bool = False) -> list[str]:
    """Motions of the listed library; with `human` those of humans only."""
    found = shelf()
    return found.motions(character, human) if found is not None else []


def offered(names: list[str], text: str) -> list[str]:
    """The names that contain the typed text."""
    return [name for name in names if text.lower() in name.lower()]
