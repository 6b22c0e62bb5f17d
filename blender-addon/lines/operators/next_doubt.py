"""Next Doubtful Stroke: goes from one stroke that may be wrong to the next."""

import bpy

from ...blender import guard, selection
from ...common.operators import Guarded, OnDrawing
from .. import doubts
from .match_lines import nothing_traced


class ROTOTOON_OT_next_doubt(Guarded, OnDrawing, bpy.types.Operator):
    bl_idname = "rototoon.next_doubt"
    bl_label = "Next Doubtful Stroke"
    bl_description = (
        "Go to the next frame on which a traced stroke may be another stroke, and select the stroke for Edit Mode. After the last one "
        "comes the first"
    )
    bl_options = {"REGISTER", "UNDO"}
    changes = guard.SETTINGS

    layer: bpy.props.StringProperty(name="Layer", description="Layer of a certain stroke. If empty, the next stroke", default="")
    number: bpy.props.IntProperty(
        name="Stroke", description="Number of a certain stroke. The first frame on which it is in doubt is shown", default=0, min=0
    )

    @classmethod
    def lacking(cls, ob, changes: str) -> str:
        """As `OnDrawing.lacking`."""
        why = super().lacking(ob, changes)
        return why or nothing_traced(ob)

    def run(self, context) -> str:
        ob, scene = context.object, context.scene
        found = doubts.places(ob)
        if self.layer:
            found = [place for place in found if (place.layer, place.number) == (self.layer, self.number)]
        settings = ob.rototoon
        # The stroke that was shown last counts only as long as its frame is shown.
        last = (settings.doubt_layer, settings.doubt_number) if settings.doubt_frame == scene.frame_current else ("", 0)
        place = (found or [None])[0] if self.layer else doubts.after(found, scene.frame_current, *last)
        if place is None:
            return "No stroke is in doubt"
        scene.frame_set(place.frame)
        settings.doubt_frame, settings.doubt_layer, settings.doubt_number = place.frame, place.layer, place.number
        selection.select_stroke(ob, place.layer, place.frame, place.index)
        others = len({(each.layer, each.number) for each in found}) - 1
        more = f". {others} more in doubt" if others else ""
        if place.off:
            return f"Stroke {place.number} lies on no line of the picture on frame {place.frame}: draw it again there, and press Trace Drawing; if it is right, press Accept Stroke{more}"
        verdict = "is probably another stroke" if place.lost else "may be another stroke"
        return f"Stroke {place.number} {verdict} on frame {place.frame}: mend it with Match Lines, or redraw it and press Carry Strokes; if it is right, press Accept Stroke{more}"


CLASSES = (ROTOTOON_OT_next_doubt,)
