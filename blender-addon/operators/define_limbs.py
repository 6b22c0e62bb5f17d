"""Limbs of a character from lines across its contours."""

import bpy

from .. import document, identity, limbs
from ..style import KEY_POINTS
from .base import Guarded, contours_poll

POINTS = tuple(
    (name, name.replace("_", " ").title().replace("L ", "Left ").replace("R ", "Right "), f"The line tells the {name}")
    for name in KEY_POINTS
)


class ROTOTOON_OT_define_limbs(Guarded, bpy.types.Operator):
    bl_idname = "rototoon.define_limbs"
    bl_label = "Define Limbs"
    bl_description = (
        f'Say which key point the selected line on the layer "{limbs.LAYER}" tells (else the last one drawn): a short line across '
        "the limb, from one side of it to the other. Neighbouring key points make limbs, and go with the contours"
    )
    bl_options = {"REGISTER", "UNDO"}

    point: bpy.props.EnumProperty(name="Key Point", description="What the line tells", items=POINTS)

    @classmethod
    def poll(cls, context):
        return contours_poll(cls, context)

    def run(self, context) -> str:
        ob = context.object
        limbs.name_lines(ob, context.scene.frame_current, self.point)
        # Strokes get their parts here if they have none yet: limbs are bound to parts by name.
        reading = document.read(ob)
        identity.write(ob, reading.found, reading.decisions)
        lines = limbs.count_lines(ob)
        if lines < 2:
            return f"{self.point}: draw the line of the next key point"
        made = limbs.define(ob, document.read(ob, results=True))
        return f"{lines} key points, {len(made)} limbs"


CLASSES = (ROTOTOON_OT_define_limbs,)
