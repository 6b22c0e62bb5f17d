"""The extension's settings in Blender's preferences."""

from __future__ import annotations

import os

import bpy

EXTENSION = __package__.rpartition(".")[0]
"""Name of the extension's package. Blender finds the settings by this name."""


def preferences() -> bpy.types.AddonPreferences:
    """The extension's settings."""
    return bpy.context.preferences.addons[EXTENSION].preferences


def threads() -> int:
    """Number of threads; 0 for one per core."""
    return preferences().threads


def data_folder(name: str) -> str:
    """A folder of the extension's own data. It is made if it does not exist."""
    return bpy.utils.extension_path_user(EXTENSION, path=name, create=True)


def cache_folder() -> str:
    """The folder of the cache. It is made if it does not exist."""
    chosen = preferences().cache_folder
    if not chosen:
        return data_folder("movies")
    folder = bpy.path.abspath(chosen)
    os.makedirs(folder, exist_ok=True)
    return folder
