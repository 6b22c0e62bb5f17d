"""Handlers for opening, saving and changing files: they close sessions, keep footage paths right, mark the generated drawings of older files,
notice new contours, and start live tracking."""

from __future__ import annotations

import os

import bpy
from bpy.app.handlers import persistent

from .blender import footage, guard, memo, movie
from .blender.errors import Problem
from .capture import arrivals, live, part_names, sessions, stand
from .capture.operators.footage_base import used_folders
from .lines import older_files
from .style import clip_browser

_FIELDS = ("pattern", "movie")


@persistent
def _loaded(*_args) -> None:
    sessions.clear()
    movie.mark_used(used_folders())
    for ob in bpy.data.objects:
        older_files.mark(ob)
    _remember_parts()


def _remember_parts() -> None:
    for ob in bpy.data.objects:
        if not guard.refusal(ob, guard.SETTINGS):
            part_names.remember(ob)


@persistent
def _saving(path: str = "", *_args) -> None:
    """Makes footage paths relative to the new place of the file, as Blender does with its own paths. Movies of a file that is saved are in use."""
    movie.mark_used(used_folders())
    if path:
        _rebase(bpy.data.filepath, path)


@persistent
def _saved(path: str = "", *_args) -> None:
    """Sets footage paths back after a copy was saved, or nothing at all: the open file is still the old one, or has no place yet."""
    open_file = bpy.data.filepath
    if path and not (open_file and os.path.abspath(path) == os.path.abspath(open_file)):
        _rebase(path, open_file)


def _rebase(old: str, new: str) -> None:
    for ob in bpy.data.objects:
        if guard.refusal(ob, guard.SETTINGS):
            continue
        for name in _FIELDS:
            _move(ob, name, old, new)


def _move(ob: bpy.types.Object, name: str, old: str, new: str) -> None:
    """Makes a path that was relative to the file `old` relative to the file `new`; absolute if that is not saved yet.

    A path that is not relative becomes so only where Blender's preferences want relative paths.
    """
    value = getattr(ob.rototoon, name)
    if not value or not (old if value.startswith("//") else footage.wants_relative()):
        return
    absolute = os.path.normpath(os.path.join(os.path.dirname(old), value[2:])) if value[:2] == "//" else value
    based = footage.relative(absolute, new)
    if based != value:
        setattr(ob.rototoon, name, based)


@persistent
def _imported(context, *_args) -> None:
    """Makes footage paths of appended and pasted objects relative to this file: Blender knows only its own paths."""
    for item in context.import_items:
        ob, library = item.id, item.source_library
        if isinstance(ob, bpy.types.Object) and library is not None and not guard.refusal(ob, guard.SETTINGS):
            part_names.remember(ob)
            for name in _FIELDS:
                _settle(ob, name, bpy.path.abspath(library.filepath))


def _settle(ob: bpy.types.Object, name: str, library: str) -> None:
    """Makes a path of an object from the file `library` relative to this file.

    What is pasted comes from a file in the folder of the clipboard, and its paths are relative to the file where it was copied, which nobody
    tells. Of the places where the footage may be, the first counts that has it: beside the library, where the pictures are that the
    object is drawn on, since Blender keeps their paths right, and beside this file.
    """
    value = getattr(ob.rototoon, name)
    if not value.startswith("//"):
        _move(ob, name, library, bpy.data.filepath)
        return
    beside = [os.path.normpath(os.path.join(os.path.dirname(file), value[2:])) for file in (library, bpy.data.filepath) if file]
    places = [beside[0], *_of_shown_pictures(ob, os.path.basename(value)), *beside[1:]]
    found = next((place for place in places if _is_there(ob, name, place)), places[0])
    setattr(ob.rototoon, name, footage.relative(found, bpy.data.filepath))


def _of_shown_pictures(ob: bpy.types.Object, pattern: str) -> list[str]:
    """Where footage of a name is, by the pictures of that name in the background of the object's camera and on its reference image."""
    camera, empty = ob.rototoon.camera, ob.rototoon.reference
    images = [entry.image for entry in camera.data.background_images] if camera is not None else []
    images += [empty.data] if empty is not None else []
    paths = [os.path.normpath(bpy.path.abspath(image.filepath, library=image.library)) for image in images if isinstance(image, bpy.types.Image)]
    return [os.path.join(os.path.dirname(path), pattern) for path in paths if _is_of(pattern, os.path.basename(path))]


def _is_of(pattern: str, picture: str) -> bool:
    number = footage.number_of(picture)
    try:
        return number is not None and footage.picture(pattern, number) == picture
    except Problem:
        return False


def _is_there(ob: bpy.types.Object, name: str, path: str) -> bool:
    try:
        return os.path.isfile(footage.picture(path, ob.rototoon.first) if name == "pattern" else path)
    except Problem:
        return False


@persistent
def _list_clips(*_args) -> None:
    clip_browser.refresh_for(bpy.context.object)


_HOOKS = (
    ("load_pre", live.closing),
    ("load_pre", arrivals.reset),
    ("load_post", memo.clear),
    ("load_post", stand.clear),
    ("load_post", _loaded),
    ("load_post", live.opened),
    ("load_post", _list_clips),
    ("depsgraph_update_post", memo.changed),
    ("depsgraph_update_post", arrivals.changed),
    ("depsgraph_update_post", live.changed),
    ("undo_pre", live.undoing),
    ("redo_pre", live.undoing),
    ("undo_post", memo.clear),
    ("redo_post", memo.clear),
    ("undo_post", stand.clear),
    ("redo_post", stand.clear),
    ("undo_post", arrivals.undone),
    ("redo_post", arrivals.undone),
    ("undo_post", live.undone),
    ("redo_post", live.undone),
    ("blend_import_post", _imported),
    ("save_pre", _saving),
    ("save_post", _saved),
    ("save_post_fail", _saved),
)


def register() -> None:
    """Adds the handlers."""
    for name, hook in _HOOKS:
        getattr(bpy.app.handlers, name).append(hook)
    # An update of the extension finds a file that an older version has opened. What is open can be read only after the registration.
    bpy.app.timers.register(_remember_parts, first_interval=0.01)


def unregister() -> None:
    """Removes the handlers, and closes the sessions."""
    for name, hook in _HOOKS:
        hooks = getattr(bpy.app.handlers, name)
        if hook in hooks:
            hooks.remove(hook)
    if bpy.app.timers.is_registered(_remember_parts):
        bpy.app.timers.unregister(_remember_parts)
    live.reset()
    arrivals.reset()
    stand.clear()
    sessions.clear()
