"""Show Confidence: colours tracked points."""

import bpy

from ...blender import guard
from ...common.operators import Guarded
from ..polls import OnTracked


class ROTOTOON_OT_show_confidence(Guarded, OnTracked, bpy.types.Operator):
    bl_idname = "rototoon.show_confidence"
    bl_label = "Show Confidence"
    bl_description = "Colour the tracked points by confidence: green is high, red is low. Press again to hide the colours"
    bl_options = {"REGISTER", "UNDO"}
    changes = guard.SETTINGS

    def run(self, context) -> None:
        settings = context.object.rototoon
        settings.show_confidence = not settings.show_confidence


CLASSES = (ROTOTOON_OT_show_confidence,)
