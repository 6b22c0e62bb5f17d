"""Go to Parts That May Have Changed Places."""

import bpy

from ...blender import guard
from ...common.operators import Guarded
from .. import exchanged
from ..polls import OnTracked


class ROTOTOON_OT_exchanged_parts(Guarded, OnTracked, bpy.types.Operator):
    bl_idname = "rototoon.exchanged_parts"
    bl_label = "Go to Exchanged Parts"
    bl_description = "Go to the first frame on which two parts that look alike may have changed places. A key or a pin there says which is which"
    bl_options = {"REGISTER", "UNDO"}
    changes = guard.NOTHING

    pair: bpy.props.IntProperty(name="Pair", description="Which pair of parts, in the order of the panel Track", default=0, min=0)

    @classmethod
    def lacking(cls, ob, changes: str) -> str:
        """As `OnDrawing.lacking`."""
        return super().lacking(ob, changes) or ("" if exchanged.of(ob) else "Track found no parts that may have changed places")

    def run(self, context) -> str:
        pairs = exchanged.of(context.object)
        pair = pairs[min(self.pair, len(pairs) - 1)]
        context.scene.frame_set(pair.frames[0])
        return f"Frame {pair.frames[0]}: {pair}"


CLASSES = (ROTOTOON_OT_exchanged_parts,)
