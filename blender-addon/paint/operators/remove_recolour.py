"""Remove Recolour: takes a colour that becomes another one out of the list."""

import bpy

from ...blender import guard
from ...common.operators import Guarded, OnDrawing
from .. import recolours


class ROTOTOON_OT_remove_recolour(Guarded, OnDrawing, bpy.types.Operator):
    bl_idname = "rototoon.remove_recolour"
    bl_label = "Remove Recolour"
    bl_description = "The colour no longer becomes another one. Press Fill Drawings afterwards: then the regions have the old colour again"
    bl_options = {"REGISTER", "UNDO"}
    changes = guard.SETTINGS

    place: bpy.props.IntProperty(name="Place", description="The place in the list, from 0; -1 is the last one", default=-1, min=-1)

    @classmethod
    def lacking(cls, ob, changes: str) -> str:
        """As `OnDrawing.lacking`."""
        why = super().lacking(ob, changes)
        return why or ("" if len(ob.rototoon.recolours) else "No colour becomes another one: press Recolour first")

    def run(self, context) -> str:
        last = len(context.object.rototoon.recolours) - 1
        entry = recolours.remove(context.object, last if self.place < 0 else self.place)
        return f"Removed{f': {entry.said()}' if entry else ''}; press Fill Drawings to paint the old colour again"


CLASSES = (ROTOTOON_OT_remove_recolour,)
