"""Match Contours: finds the parts of new strokes."""

import bpy

from ...blender import guard
from ...common.operators import Guarded, OnContours
from ...common.wording import counted
from .. import document, identity, tracking


class ROTOTOON_OT_match_contours(Guarded, OnContours, bpy.types.Operator):
    bl_idname = "rototoon.match_contours"
    bl_label = "Match Contours"
    bl_description = (
        "Find the part of each new stroke. Order, direction, starting point and number of points may differ. "
        "Strokes without a match become new parts. Track does this too. On hidden layers too, "
        "not on locked ones"
    )
    bl_options = {"REGISTER", "UNDO"}

    def run(self, context) -> str:
        ob = context.object
        layers = tracking.contour_layers(ob)
        guard.need_some(layers, hidden=True)
        reading = document.read(ob)
        identity.write(ob, reading.found, reading.decisions)
        dropped = identity.drop_empty(ob, reading.found)
        ob.data.update_tag()
        decisions = reading.decisions
        for doubt in decisions.doubts:
            self.warn(doubt)
        self.warn(guard.left_out(layers, hidden=True))
        counts = (f"{counted(decisions.matched, 'stroke')} matched", counted(len(decisions.created), "new part"))
        named = zip(counts, identity.named(decisions), strict=True)
        return "; ".join(f"{count}: {names}" if names else count for count, names in named) + dropped


CLASSES = (ROTOTOON_OT_match_contours,)
