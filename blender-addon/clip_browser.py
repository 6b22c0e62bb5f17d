"""The list of a library's clips in the window: what it shows, which one is chosen.

A folder is no part of a Blender file, so the list is kept with the window, not with the file, and undo leaves it alone. It is read
when a library is chosen or added to, when a file is opened, and by Refresh.
"""

from __future__ import annotations

import bpy

from . import clip_library
from .errors import Problem
from .native.errors import RototoonError

_shelf: clip_library.Shelf | None = None


def _offered_characters(_self, _context, text: str) -> list[str]:
    return offered(characters(), text)


def _offered_motions(_self, _context, text: str) -> list[str]:
    return offered(motions(), text)


def _in_view_changed(_self, _context) -> None:
    redraw()


class RototoonClip(bpy.types.PropertyGroup):
    """A row of the list; `name` is what it is found by."""

    character: bpy.props.StringProperty(name="Character", description="Who moves")
    motion: bpy.props.StringProperty(name="Motion", description="What is done")
    frames: bpy.props.IntProperty(name="Frames", description="Number of postures")
    trouble: bpy.props.StringProperty(name="Trouble", description="Why the file cannot be used")


class RototoonBrowser(bpy.types.PropertyGroup):
    """The list."""

    folder: bpy.props.StringProperty(description="The library that is listed")
    clips: bpy.props.CollectionProperty(type=RototoonClip)
    active: bpy.props.IntProperty(name="Chosen Clip", default=0)
    character: bpy.props.StringProperty(
        name="Character",
        description="Show clips of characters whose name holds this",
        search=_offered_characters,
        search_options={"SUGGESTION"},
        options={"TEXTEDIT_UPDATE"},
    )
    motion: bpy.props.StringProperty(
        name="Motion",
        description="Show clips of motions whose name holds this",
        search=_offered_motions,
        search_options={"SUGGESTION"},
        options={"TEXTEDIT_UPDATE"},
    )
    in_view: bpy.props.BoolProperty(
        name="Show Beside Drawing",
        description="Let the chosen clip play beside the drawing, in the 3D view, with the scene's frames",
        default=False,
        update=_in_view_changed,
    )


def browser() -> RototoonBrowser:
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
    redraw()
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


def redraw() -> None:
    """Has 3D views and their sidebars drawn again."""
    for window in bpy.context.window_manager.windows:
        for area in window.screen.areas:
            if area.type == "VIEW_3D":
                for region in area.regions:
                    region.tag_redraw()


CLASSES = (RototoonClip, RototoonBrowser)


def attach() -> None:
    """Gives the window manager its list; after registering the classes."""
    bpy.types.WindowManager.rototoon_clips = bpy.props.PointerProperty(type=RototoonBrowser)


def detach() -> None:
    """Takes it away again."""
    global _shelf
    _shelf = None
    del bpy.types.WindowManager.rototoon_clips
