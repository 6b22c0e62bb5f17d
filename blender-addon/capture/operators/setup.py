"""Set Up: footage, a camera or reference image that shows it, and an object to draw on."""

import os

import bpy

from ...blender import stage
from ...common.operators import InObjectMode
from .. import properties
from .footage_base import FootageOperator, described
from .footage_from_file import FilePicker


class ROTOTOON_OT_setup(FilePicker, FootageOperator, InObjectMode, bpy.types.Operator):
    bl_idname = "rototoon.setup"
    bl_label = "Set Up"
    bl_description = "Choose footage. You get a camera or reference image that shows it, and an object to draw on"
    bl_options = {"REGISTER", "UNDO"}

    plane: bpy.props.EnumProperty(name="Show In", description="What shows the footage", items=properties.PLANES)
    match_scene: bpy.props.BoolProperty(
        name="Match Scene", description="Give the scene the footage's size and frames", default=True
    )

    def apply(self, context, shot):
        shot = self.timed(context, shot)
        stage.build(context, shot, self.plane, _name(shot), self.match_scene)
        return described(shot)

    def draw(self, context):
        super().draw(context)
        self.layout.prop(self, "plane")
        self.layout.prop(self, "match_scene")


def _name(shot: stage.Shot) -> str:
    """The name of the movie, or of the sequence without its number."""
    stem = os.path.splitext(os.path.basename(shot.movie or shot.pattern))[0]
    return stem.split("%")[0].rstrip("_-. ") or os.path.basename(os.path.dirname(shot.pattern)) or "Contours"


CLASSES = (ROTOTOON_OT_setup,)
