"""Track: follows contours from key to key."""

import bpy

from ...blender.errors import Problem
from ...common.operators import Long, OnContours
from .. import document, properties, tracking


class ROTOTOON_OT_track(Long, OnContours, bpy.types.Operator):
    bl_idname = "rototoon.track"
    bl_label = "Track"
    bl_description = (
        "Follow the contours from key to key, and from a single key as far as they can be trusted. Points and parts that you "
        "moved on generated frames stay where you put them. Only what you changed since the last time is tracked again"
    )
    bl_options = {"REGISTER", "UNDO"}

    method: bpy.props.EnumProperty(
        name="Method",
        description="Method of tracking",
        items=(("SETTINGS", "As in the Panel", "The method chosen in the panel"), *properties.PRESETS),
    )

    def begin(self, context):
        self._ob = context.object
        reading = document.read(self._ob)
        preset = self._ob.rototoon.preset if self.method == "SETTINGS" else self.method
        if not tracking.can_track(reading, preset):
            raise tracking.nothing_to_track()
        self._tracking = tracking.begin(self._ob, reading, preset)
        return self._tracking.worker

    def finish(self, context, work) -> str:
        strokes = tracking.finish(self._ob, self._tracking)
        if strokes is None:
            raise Problem("The contours changed while they were tracked, so the result was dropped: press Track again")
        summary = work.result
        wanted = tracking.wanted_keys(summary)
        return f"{strokes} contours: {summary.solved} spans tracked, {summary.reused} kept{wanted and '; ' + wanted}"


CLASSES = (ROTOTOON_OT_track,)
