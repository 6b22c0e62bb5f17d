"""Define Limbs: makes limbs from lines across contours."""

import functools

import bpy
from rototoon import RototoonError
from rototoon.style import KEY_POINTS

from ...blender import grease_pencil as gp
from ...blender import guard
from ...capture import document, identity
from ...common.operators import Guarded, OnContours
from ...common.wording import counted
from .. import bodies, limbs


@functools.cache
def _items(points: tuple[str, ...]) -> list[tuple[str, str, str]]:
    """Items of a menu. Blender needs the same texts as long as it shows them."""
    return [(point, bodies.label(point), f"The line marks the {point}") for point in points]


def _points(_self, context) -> list[tuple[str, str, str]]:
    ob = context.object if context is not None else None
    try:
        return _items(bodies.of(ob).points if gp.is_drawing(ob) else KEY_POINTS)
    except RototoonError:
        return _items(KEY_POINTS)


class ROTOTOON_OT_define_limbs(Guarded, OnContours, bpy.types.Operator):
    bl_idname = "rototoon.define_limbs"
    bl_label = "Define Limbs"
    bl_description = (
        f'Choose the key point that the selected line on the layer "{limbs.LAYER}" marks, or the last line that you drew. It is '
        "a short line across the limb, from one side to the other. Neighbouring key points make limbs, which move with the contours"
    )
    bl_options = {"REGISTER", "UNDO"}

    point: bpy.props.EnumProperty(name="Key Point", description="The key point that the line marks", items=_points)

    def run(self, context) -> str:
        ob = context.object
        guard.need_open([gp.find_layer(ob, limbs.LAYER)])
        limbs.name_lines(ob, context.scene.frame_current, self.point)
        # New strokes get their parts here, since limbs refer to parts by name.
        reading = document.read(ob)
        identity.write(ob, reading.found, reading.decisions)
        lines = limbs.count_lines(ob)
        if lines < 2:
            return f"{self.point}: draw the line of the next key point"
        made = limbs.define(ob, document.read(ob, results=True))
        return f"{counted(lines, 'key point')}, {counted(len(made), 'limb')}"


CLASSES = (ROTOTOON_OT_define_limbs,)
