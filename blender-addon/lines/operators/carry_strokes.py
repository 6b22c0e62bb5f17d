"""Carry Strokes: the artist's strokes on the other frames."""

import bpy

from ...blender import grease_pencil as gp
from ...blender import guard
from ...blender.errors import Problem
from .. import drawings as dr
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
        ob, active = context.object, self.layers == "ACTIVE"
        wanted = _layers(ob, active)
        guard.need_some(wanted)
        self.warn(guard.left_out(wanted))
        names = [layer.name for layer in guard.open_layers(wanted)]
        home = gp.active_layer(ob)
        home = home.name if home is not None and home.name in names else names[-1]
        traced = ob.rototoon.lines_layer in names
        return self.start(context, names, ob.rototoon.lines_layer if traced else home, self.new_lines or traced)


def _layers(ob, active: bool) -> list:
    """The layers whose strokes are carried, closed ones too."""
    wanted = dr.layers(ob, active)
    if not wanted:
        what = "The active layer has contours, snapped lines or paint: make" if active else "There are no drawings to carry: draw on"
        raise Problem(f"{what} another layer active" if active else f"{what} a layer of your own")
    return wanted


CLASSES = (ROTOTOON_OT_carry_strokes,)
