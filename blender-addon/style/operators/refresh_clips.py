"""Refresh Clips: reads the library again."""

import bpy

from ...common.operators import Guarded
from ...common.wording import counted
from .. import clip_browser, clip_library
from ..clip_properties import shared


class ROTOTOON_OT_refresh_clips(Guarded, bpy.types.Operator):
    bl_idname = "rototoon.refresh_clips"
    bl_label = "Refresh Clips"
    bl_description = "Read the library's folder again"
    bl_options = {"INTERNAL"}

    folder: shared("folder")

    def run(self, context) -> str:
        found = clip_browser.refresh(clip_library.folder_of(context.object, self.folder))
        damaged = sum(bool(row.trouble) for row in found.rows)
        said = counted(len(found.rows) - damaged, "clip") + (f", {damaged} cannot be used" if damaged else "")
        return said + "".join(f"; {trouble}" for trouble in found.troubles)


CLASSES = (ROTOTOON_OT_refresh_clips,)
