"""What holds for all files: threads, and the cache of movie frames."""

from __future__ import annotations

import bpy

from ..blender.preferences import EXTENSION


class RototoonPreferences(bpy.types.AddonPreferences):
    """Settings of the extension."""

    bl_idname = EXTENSION

    threads: bpy.props.IntProperty(
        name="Threads", description="Threads that track and snap; 0 takes one for each core", min=0, max=256, default=0
    )
    cache_folder: bpy.props.StringProperty(
        name="Cache Folder",
        description="Where the frames of movies are kept; empty takes the extension's own folder",
        subtype="DIR_PATH",
        default="",
    )
    cache_limit: bpy.props.IntProperty(
        name="Cache Limit",
        description="Size in megabytes above which the movies used longest ago are removed from the cache",
        min=10,
        soft_max=1_000_000,
        default=4096,
    )
    clips_folder: bpy.props.StringProperty(
        name="Clip Library",
        description="Folder of the library of skeleton clips where an object names none",
        subtype="DIR_PATH",
        default="",
    )

    def draw(self, _context) -> None:
        """Called by Blender."""
        column = self.layout.column()
        column.use_property_split = True
        column.prop(self, "threads")
        column.prop(self, "cache_folder")
        column.prop(self, "cache_limit")
        column.prop(self, "clips_folder")


CLASSES = (RototoonPreferences,)
