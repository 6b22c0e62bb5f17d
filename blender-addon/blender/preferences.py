"""The extension's settings in Blender's preferences."""

from __future__ import annotations

import os
from types import SimpleNamespace

import bpy

from .errors import Problem

EXTENSION = __package__.rpartition(".")[0]
"""Name of the extension's package. Blender finds the settings by this name."""


def preferences() -> bpy.types.AddonPreferences | SimpleNamespace:
    """The extension's settings. Their defaults where Blender keeps none: `blender --addons` and scripts may switch an extension on without."""
    entry = bpy.context.preferences.addons.get(EXTENSION)
    found = entry.preferences if entry is not None else None
    return _defaults() if found is None else found


def _defaults() -> SimpleNamespace:
    kind = bpy.types.AddonPreferences.bl_rna_get_subclass_py("RototoonPreferences")
    return SimpleNamespace(**{name: kind.bl_rna.properties[name].default for name in kind.__annotations__})


def threads() -> int:
    """Number of threads; 0 for one per core."""
    return preferences().threads


def data_folder(name: str) -> str:
    """A folder of the extension's own data. It is made if it does not exist. Raises a `Problem` if it cannot be made."""
    folder = _data_path(name)
    try:
        os.makedirs(folder, exist_ok=True)
    except OSError as error:
        raise Problem(f"Cannot make the folder {folder} for the extension's own files: {error.strerror}") from error
    return folder


def _data_path(name: str) -> str:
    # Blender could make the folder itself, but where it cannot, it says so in the terminal and returns "", the current folder.
    return bpy.utils.extension_path_user(EXTENSION, path=name)


def cache_path() -> str:
    """The path of the cache, whether it is there or not. Raises a `Problem` if the chosen one does not say where it is."""
    chosen = preferences().cache_folder
    if not chosen:
        return _data_path("movies")
    if chosen.startswith("//") and not bpy.data.filepath:
        raise Problem(f"The Cache Folder {chosen} is relative to a file that is not saved: choose another one in the preferences")
    path = os.path.expanduser(bpy.path.abspath(chosen))
    if not os.path.isabs(path):
        raise Problem(f"Found {chosen!r} as Cache Folder, expected a whole path: choose it again in the preferences")
    return path


def cache_folder() -> str:
    """The folder of the cache. It is made if it does not exist. Raises a `Problem` if it cannot be made."""
    folder = cache_path()
    try:
        os.makedirs(folder, exist_ok=True)
    except OSError as error:
        raise Problem(f"Cannot make the Cache Folder {folder}: {error.strerror}; choose another one in the preferences") from error
    return folder
