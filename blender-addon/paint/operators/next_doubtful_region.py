"""Next Doubtful Region: goes from one region whose colour is probably wrong to the next."""

import bpy

from ...blender import grease_pencil as gp
from ...blender import guard, selection
from ...common.operators import Guarded, OnDrawing
from .. import doubts


class ROTOTOON_OT_next_doubtful_region(Guarded, OnDrawing, bpy.types.Operator):
    bl_idname = "rototoon.next_doubtful_region"
    bl_label = "Next Doubtful Region"
    bl_description = (
        "Go to the next frame on which the colour of a region is probably wrong, and select the region for Edit Mode. After the last one "
        "comes the first"
    )
    bl_options = {"REGISTER", "UNDO"}
    changes = guard.SETTINGS

    @classmethod
    def lacking(cls, ob, changes: str) -> str:
        """As `OnDrawing.lacking`."""
        why = super().lacking(ob, changes)
        return why or ("" if gp.find_layer(ob, ob.rototoon.fills_layer) else "Nothing is painted yet: press Fill Drawings first")

    def run(self, context) -> str:
        ob, scene = context.object, context.scene
        settings, found = ob.rototoon, doubts.places(ob)
        number = settings.fill_doubt_number if settings.fill_doubt_frame == scene.frame_current else 0
        place = doubts.after(found, scene.frame_current, number)
        if place is None:
            return "No region is in doubt"
        scene.frame_set(place.frame)
        settings.fill_doubt_frame, settings.fill_doubt_number = place.frame, place.number
        selection.select_stroke(ob, settings.fills_layer, place.frame, place.index)
        here = sum(each.frame == place.frame for each in found)
        more = f", {here - 1} more on this frame" if here > 1 else ""
        return (
            f"The colour of region {place.number} is probably wrong on frame {place.frame}{more}: fill it with Paint Bucket, and press "
            "Fill Drawings"
        )


CLASSES = (ROTOTOON_OT_next_doubtful_region,)
