"""The extension's settings in Blender's preferences."""

from __future__ import annotations

import bpy

from ..blender.preferences import EXTENSION
from . import keymap


class RototoonPreferences(bpy.types.AddonPreferences):
    """Settings for all files."""

    bl_idname = EXTENSION

    threads: bpy.props.IntProperty(
        name="Threads", description="Number of threads for tracking and snapping. 0 is one per core", min=0, max=256, default=0
    )
    cache_folder: bpy.props.StringProperty(
        name="Cache Folder",
        description="Folder for the frames of movies. If empty, the extension's folder",
        subtype="DIR_PATH",
        default="",
    )
    cache_limit: bpy.props.IntProperty(
        name="Cache Limit",
        description="Size in megabytes. Above it, the least recently used movies are removed from the cache. Those used within a day stay",
        min=10,
        soft_max=1_000_000,
        default=4096,
    )
    clips_folder: bpy.props.StringProperty(
        name="Clip Library",
        description="Folder of the library of skeleton clips, for objects without a library of their own",
        subtype="DIR_PATH",
        default="",
    )

    help_address: bpy.props.StringProperty(
        name="Help Address",
        description="Web address of the documentation for the help buttons. If empty, the pages that come with the extension",
        default="",
    )

    def draw(self, context) -> None:
        """Called by Blender."""
        self.layout.label(text="Press N in the 3D view and choose the tab Rototoon. Open Sample there shows how it works", icon="INFO")
        column = self.layout.column()
        column.use_property_split = True
        column.prop(self, "threads")
        column.prop(self, "cache_folder")
        column.prop(self, "cache_limit")
        column.prop(self, "clips_folder")
        column.prop(self, "help_address")
        self.layout.label(text="Keys in the 3D View")
        keymap.draw(self.layout.column(), context)


CLASSES = (RototoonPreferences,)
