"""Match Strokes: shows which strokes are pairs, and lets the artist change it."""

import bpy

from ...blender import guard
from ...blender import strokes as st
from ...blender.errors import Problem
from .. import pairing, pairs
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

    earlier: bpy.props.IntProperty(
        name="Earlier",
        description="Number (rototoon_track) of a stroke on the earlier key, for scripts; -1 if the later stroke has no counterpart; 0 for none",
        default=0,
        min=-1,
    )
    later: bpy.props.IntProperty(
        name="Later",
        description="Number of its counterpart on the later key, for scripts; -1 if the earlier stroke has no counterpart",
        default=0,
        min=-1,
    )

    def make_pairing(self, context) -> pairing.Pairing:
        ob = context.object
        self.warn(guard.left_out(st.drawn_layers(ob, self.layers == "ACTIVE")))
        layers = st.editable_layers(ob, self.layers == "ACTIVE")
        found = pairing.Pairing(ob, layers, context.scene.frame_current)
        if not len(found):
            raise Problem("There are no two keys around this frame: go between two keys that have strokes")
        if self.earlier or self.later:
            self._decide(found)
        return found

    def _decide(self, found: pairing.Pairing) -> None:
        """Takes the pair of a script."""
        for name, number, other in (("earlier", self.earlier, self.later), ("later", self.later, self.earlier)):
            if not number:
                raise Problem(f"{name}: found 0, expected the number of a stroke on the {name} key, or -1 for no counterpart of stroke {other}")
        if self.earlier == self.later == pairs.NONE:
            raise Problem("earlier and later: found -1 for both, expected the number of a stroke for one of them")
        if not found.decide(self.earlier, self.later):
            said = [f"{number} on the {name} key" for name, number in (("earlier", self.earlier), ("later", self.later)) if number != pairs.NONE]
            raise Problem(
                f"{found.keys()}: no layer has the stroke {' and the stroke '.join(said)}. Strokes get their numbers, the attribute rototoon_track, by Match "
                "Strokes without a pair"
            )


CLASSES = (ROTOTOON_OT_match_strokes,)
