"""Match Contours: finds the parts of new strokes."""

import bpy

from ...common.operators import Guarded, OnContours
from .. import document, identity


class ROTOTOON_OT_match_contours(Guarded, OnContours, bpy.types.Operator):
    bl_idname = "rototoon.match_contours"
    bl_label = "Match Contours"
    bl_description = (
        "Find the part of each new stroke. Order, direction, starting point and number of points may differ. "
        "Strokes without a match become new parts. Track does this too"
    )
    bl_options = {"REGISTER", "UNDO"}

    def run(self, context) -> str:
        ob = context.object
        reading = document.read(ob)
        identity.write(ob, reading.found, reading.decisions)
        ob.data.update_tag()
        return f"{reading.decisions.matched} strokes matched, {len(reading.decisions.created)} new parts"


CLASSES = (ROTOTOON_OT_match_contours,)
