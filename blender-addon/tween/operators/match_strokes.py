"""Match Strokes: shows which strokes are pairs, and lets the artist change it."""

import bpy

from ...blender import guard
from ...blender import strokes as st
from ...blender.errors import Problem
from .. import pairing
from .pairs_base import Pairing
from .tweening_base import LAYERS


class ROTOTOON_OT_match_strokes(Pairing, bpy.types.Operator):
    bl_idname = "rototoon.match_strokes"
    bl_label = "Match Strokes"
    bl_description = (
        "Find and show the pairs of strokes on the two keys around the current frame. Click two strokes to pair them, "
        "Alt-click one to free it. Your decisions are kept with the strokes, and In-between uses them"
    )
    # Without REGISTER: repeating the operator with other settings would undo the artist's decisions.
    bl_options = {"UNDO"}

    layers: bpy.props.EnumProperty(
        name="Layers",
        description="On which layers",
        items=LAYERS,
        default="ALL",
    )

    def make_pairing(self, context) -> pairing.Pairing:
        ob = context.object
        self.warn(guard.left_out(st.drawn_layers(ob, self.layers == "ACTIVE")))
        layers = st.editable_layers(ob, self.layers == "ACTIVE")
        found = pairing.Pairing(ob, layers, context.scene.frame_current)
        if not len(found):
            raise Problem("There are no two keys around this frame: go between two keys that have strokes")
        return found


CLASSES = (ROTOTOON_OT_match_strokes,)
