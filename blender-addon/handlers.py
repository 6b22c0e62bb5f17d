"""Handlers for opening, saving and changing files: they close sessions, keep footage paths right, mark the generated drawings of older files,
notice new contours, and start live tracking."""

from __future__ import annotations

import os

import bpy
from bpy.app.handlers import persistent

from .blender import footage, guard, movie
from .capture import arrivals, live, sessions, stand
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


@persistent
def _saving(path: str = "", *_args) -> None:
    """Makes footage paths relative to the new place of the file, as Blender does with its own paths."""
    if path and bpy.context.preferences.filepaths.use_relative_paths:
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
    """Makes a path that was relative to the file `old` relative to the file `new`; absolute if that is not saved yet."""
    value = getattr(ob.rototoon, name)
    if not value or (value.startswith("//") and not old):
        return
    absolute = os.path.normpath(os.path.join(os.path.dirname(old), value[2:])) if value[:2] == "//" else value
    based = footage.relative(absolute, new)
    if based != value:
        setattr(ob.rototoon, name, based)


@persistent
def _imported(context, *_args) -> None:
    """Makes footage paths of appended objects relative to this file: Blender knows only its own paths."""
    for item in context.import_items:
        ob, library = item.id, item.source_library
        if isinstance(ob, bpy.types.Object) and library is not None and not guard.refusal(ob, guard.SETTINGS):
            for name in _FIELDS:
                _move(ob, name, bpy.path.abspath(library.filepath), bpy.data.filepath)


@persistent
def _list_clips(*_args) -> None:
    clip_browser.refresh_for(bpy.context.object)


_HOOKS = (
    ("load_pre", live.closing),
    ("load_pre", arrivals.reset),
    ("load_post", stand.clear),
    ("load_post", _loaded),
    ("load_post", live.opened),
    ("load_post", _list_clips),
    ("depsgraph_update_post", arrivals.changed),
    ("depsgraph_update_post", live.changed),
    ("undo_pre", live.undoing),
    ("redo_pre", live.undoing),
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


def unregister() -> None:
    """Removes the handlers, and closes the sessions."""
    for name, hook in _HOOKS:
        hooks = getattr(bpy.app.handlers, name)
        if hook in hooks:
            hooks.remove(hook)
    live.reset()
    arrivals.reset()
    stand.clear()
    sessions.clear()
