"""Guess Bones: finds key points by the names of bones."""

import bpy
from rototoon.style import KEY_POINTS

from ...blender import guard
from ...common.operators import Guarded, OnArmature
from ...common.wording import counted
from .. import key_points


class ROTOTOON_OT_guess_bones(Guarded, OnArmature, bpy.types.Operator):
    bl_idname = "rototoon.guess_bones"
    bl_label = "Guess Bones"
    bl_description = "Find the bones of the key points by their names. Your choices stay"
    bl_options = {"REGISTER", "UNDO"}
    changes = guard.SETTINGS

    def run(self, context) -> str:
        found = key_points.guess(context.object)
        missing = [point for point in KEY_POINTS if point not in found]
        return counted(len(found), "key point") + (f"; choose bones for {', '.join(missing)}" if missing else "")


CLASSES = (ROTOTOON_OT_guess_bones,)
