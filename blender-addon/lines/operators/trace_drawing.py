"""Trace Drawing: the lines of the footage as strokes."""

import bpy

from .. import choosing
from .tracing_base import Tracing


class ROTOTOON_OT_trace_drawing(Tracing, bpy.types.Operator):
    bl_idname = "rototoon.trace_drawing"
    bl_label = "Trace Drawing"
    bl_description = (
        "Turn the lines of the footage into strokes, the same strokes on every frame, on a layer of their own. Radius and material "
        "follow the ink. Drawings of yours on that layer stay as they are, and their strokes are followed"
    )
    bl_options = {"REGISTER", "UNDO"}

    def begin(self, context):
        return self.start(context, choosing.to_trace(context.object))


CLASSES = (ROTOTOON_OT_trace_drawing,)
