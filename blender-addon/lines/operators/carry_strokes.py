"""Carry Strokes: the artist's strokes on the other frames."""

import bpy

from .. import choosing
from .tracing_base import Tracing


class ROTOTOON_OT_carry_strokes(Tracing, bpy.types.Operator):
    bl_idname = "rototoon.carry_strokes"
    bl_label = "Carry Strokes"
    bl_description = (
        "Carry the strokes that you drew on one or several frames to the other frames, along the lines of the footage. Your drawings "
        "stay as they are. Layers, materials, radius and opacity are those of your strokes"
    )
    bl_options = {"REGISTER", "UNDO"}

    layers: bpy.props.EnumProperty(
        name="Layers",
        description="Whose strokes are carried",
        items=(
            ("ACTIVE", "Active", "The active layer"),
            ("ALL", "All", "All layers that are neither locked nor hidden, but for those with contours, snapped lines and paint"),
        ),
    )
    new_lines: bpy.props.BoolProperty(
        name="New Lines",
        description="Lines of the footage that no stroke explains become new strokes, on the active layer. "
        "On the layer of Trace Drawing they always do",
        default=False,
    )

    def begin(self, context):
        chosen = choosing.to_carry(context.object, self.layers == "ACTIVE", self.new_lines)
        self.warn(chosen.left)
        return self.start(context, chosen)


CLASSES = (ROTOTOON_OT_carry_strokes,)
