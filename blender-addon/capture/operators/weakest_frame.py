"""Go to Weakest Frame: where the next key helps most."""

import bpy

from ...blender import grease_pencil as gp
from ...blender import guard
from ...common.operators import Guarded
from .. import contours
from ..doubt import weakest
from ..polls import OnTracked


class ROTOTOON_OT_weakest_frame(Guarded, OnTracked, bpy.types.Operator):
    bl_idname = "rototoon.weakest_frame"
    bl_label = "Go to Weakest Frame"
    bl_description = "Go to the frame where your next key helps most: tracking is least sure around it, or a part was lost there"
    bl_options = {"REGISTER", "UNDO"}
    changes = guard.NOTHING

    def run(self, context) -> str:
        frame, doubt = weakest(context.object, contours.read(context.object, (gp.CONFIDENCE,)))
        context.scene.frame_set(frame)
        return f"Frame {frame} is the least certain one ({doubt:.0%} doubt): look for contours that are off"


CLASSES = (ROTOTOON_OT_weakest_frame,)
