"""Snap to Ink: lays contours along the drawn lines."""

import bpy
import numpy as np

from ...blender import guard, preferences
from ...blender.errors import Problem
from ...common import jobs
from ...common.operators import Long, OnContours
from ...common.wording import counted, joined, stayed
from .. import document, identity, sessions, snapping


class ROTOTOON_OT_snap(Long, OnContours, bpy.types.Operator):
    bl_idname = "rototoon.snap"
    bl_label = "Snap to Ink"
    bl_description = (
        "Lay the tracked contours along the drawn lines, as strokes on a layer of their own. "
        "Thickness, fill and material follow your keys. Snapped drawings that you have changed become keys and stay"
    )
    bl_options = {"REGISTER", "UNDO"}

    def begin(self, context):
        self._ob = context.object
        guard.need_apart(self._ob, [self._ob.rototoon.snapped_layer])
        self._reading = document.read(self._ob, results=True, gaps=True)
        if not any("tracks" in part for part in self._reading.document["parts"]):
            raise Problem("Nothing to snap: press Track first")
        # What the file has: the session may have other contours, as before the artist moved or deleted some, or took a Track back.
        self._session = sessions.get(self._ob, self._reading.document, self._reading.folder).session
        threads = preferences.threads()
        return jobs.Worker(lambda progress: self._session.snap(progress, threads=threads))

    def finish(self, context, work) -> str:
        guard.need_apart(self._ob, [self._ob.rototoon.snapped_layer])
        reading = document.read(self._ob, results=True, gaps=True)
        if reading.document != self._reading.document:
            raise Problem("The contours changed while they were snapped, so the result was dropped: press Snap again")
        identity.write(self._ob, reading.found, reading.decisions)
        for doubt in reading.decisions.doubts:
            self.warn(doubt)
        curves = self._curves(reading)
        edited = snapping.keep_edited(self._ob)
        strokes = snapping.write(self._ob, curves, reading.found, reading.mapper)
        hidden, left = snapping.clear_aside(self._ob)
        self.warn(left)
        self._ob.data.update_tag()
        said = f'{counted(strokes, "line")} on the layer "{self._ob.rototoon.snapped_layer}"'
        return joined(said, stayed("drawing", edited), stayed("hidden-line drawing", hidden))

    def _curves(self, reading):
        offset, curves = self._ob.rototoon.frame_offset, {}
        for part in reading.found.parts:
            for frame in sorted({*part.keys, *part.made}):
                segments = self._session.curves(part.name, frame - offset) if part.keys else []
                if segments:
                    curves[part.number, frame] = [np.asarray(path) for path in segments]
        return curves


CLASSES = (ROTOTOON_OT_snap,)
