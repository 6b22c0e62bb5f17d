"""Track: follows contours from key to key."""

import bpy

from ...blender import guard
from ...blender.errors import Problem
from ...common import jobs
from ...common.operators import Long, OnContours
from .. import contours, document, exchanged, identity, properties, set_back, stand, tracking, unseen


class ROTOTOON_OT_track(Long, OnContours, bpy.types.Operator):
    bl_idname = "rototoon.track"
    bl_label = "Track"
    bl_description = (
        "Follow the contours from key to key, and from a single key as far as they can be trusted. Points and parts that you "
        "moved on generated frames stay where you put them. Only what you changed since the last time is tracked again. Hidden "
        "layers are tracked too, locked ones are not changed"
    )
    bl_options = {"REGISTER", "UNDO"}

    method: bpy.props.EnumProperty(
        name="Method",
        description="Method of tracking",
        items=(("SETTINGS", "As in the Panel", "The method chosen in the panel"), *properties.PRESETS),
    )

    def begin(self, context):
        self._ob = context.object
        if not stand.read(self._ob).loose:
            return self._begin_to_track()
        found = contours.read(self._ob)
        # Matching new contours takes long, so a thread asks first. When the contours are read again, the answers are known.
        mapper, number = document.mapper_of(self._ob, found), self._ob.rototoon.next_number
        return jobs.Chain(jobs.Worker(lambda progress: _match(progress, found, mapper, number)), self._begin_to_track)

    def _begin_to_track(self):
        reading = document.read(self._ob)
        preset = self._ob.rototoon.preset if self.method == "SETTINGS" else self.method
        if not tracking.can_track(reading, preset):
            raise tracking.nothing_to_track()
        self._tracking = tracking.begin(self._ob, reading, preset)
        return self._tracking.worker

    def finish(self, _context, _work):
        looks = set_back.changed(self._ob)
        strokes = yield from tracking.finishing(self._ob, self._tracking, drop_empty=True)
        if strokes is None:
            raise Problem("The contours changed while they were tracked, so the result was dropped: press Track again")
        reset = set_back.note(self._ob, looks)
        for doubt in [reset, *self._tracking.doubts]:
            self.warn(doubt)
        for text in [tracking.where_to_look(self._ob, self._tracking), *exchanged.told(self._ob), *unseen.told(self._ob)]:
            self.warn(text)
        self.warn(guard.left_out(tracking.contour_layers(self._ob), hidden=True))
        told = tracking.told(self._tracking, strokes, bool(reset)) + self._tracking.taken + self._tracking.dropped
        return told + tracking.of_moved_lines(self._tracking) + tracking.goes_on(self._ob, self._tracking)


def _match(progress, found: contours.Contours, mapper, number: int) -> None:
    progress(0.0, "finding the parts of new contours")
    identity.decide(found, mapper, number)


CLASSES = (ROTOTOON_OT_track,)
