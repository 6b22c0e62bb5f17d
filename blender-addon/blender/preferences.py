"""The extension's settings, and the folders that they name."""

from __future__ import annotations

import os

import bpy

EXTENSION = __package__.rpartition(".")[0]
"""Name of the extension's package, by which Blender knows its settings."""


def preferences() -> bpy.types.AddonPreferences:
    """The extension's settings."""
    return bpy.context.preferences.addons[EXTENSION].preferences


def threads() -> int:
    """Threads to use; 0 for one a core."""
    return preferences().threads


def cache_folder() -> str:
    """The cache's folder, made if need be."""
    chosen = preferences().cache_folder
    if not chosen:
        return bpy.utils.extension_path_user(EXTENSION, path="movies", create=True)
    folder = bpy.path.abspath(chosen)
    os.makedirs(folder, exist_ok=True)
    return folder
