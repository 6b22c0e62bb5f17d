"""Contours from keys to every frame."""

import bpy
import numpy as np

from .. import document, identity, jobs, preferences, properties, sessions, writing
from .. import grease_pencil as gp
from ..errors import Problem
from .base import Long, contours_poll


class ROTOTOON_OT_track(Long, bpy.types.Operator):
    bl_idname = "rototoon.track"
    bl_label = "Track"
    bl_description = (
        "Follow the contours from key to key. Points and parts that you moved on generated frames are kept; "
        "only what you touched since the last time is tracked again"
    )
    bl_options = {"REGISTER", "UNDO"}

    method: bpy.props.EnumProperty(
        name="Method",
        description="How contours are followed",
        items=(("SETTINGS", "As in the Panel", "The method chosen in the panel"), *properties.PRESETS),
    )

    @classmethod
    def poll(cls, context):
        return contours_poll(cls, context)

    def begin(self, context):
        self._ob = context.object
        self._reading = document.read(self._ob)
        if not any(len(part.keys) > 1 for part in self._reading.found.parts):
            raise Problem("Nothing to track: go to another frame, press New Key Here and fit the contours there")
        preset = self._ob.rototoon.preset if self.method == "SETTINGS" else self.method
        entry = sessions.get(self._ob, self._reading.document, self._reading.folder)
        entry.inputs = None
        threads = preferences.threads()
        self._session = entry
        return jobs.Worker(lambda progress: entry.session.track(preset, progress, threads=threads))

    def finish(self, context, work) -> str:
        reading = document.read(self._ob)
        if reading.document != self._reading.document:
            raise Problem("The contours changed while they were tracked, so the result was dropped: press Track again")
        identity.write(self._ob, reading.found, reading.decisions)
        strokes = write_tracks(self._ob, reading, self._session.session)
        self._session.inputs = reading.document
        self._ob.data.update_tag()
        summary = work.result
        return f"{strokes} contours: {summary.solved} spans tracked, {summary.reused} kept"


def write_tracks(ob, reading: document.Reading, session) -> int:
    """Writes what a session tracked into the object's contour layers; returns the number of strokes."""
    offset = ob.rototoon.frame_offset
    tracks = {}
    for part in reading.found.parts:
        if len(part.keys) < 2:
            continue
        track = session.tracks(part.name)
        frames = np.asarray(track.frames)
        if len(frames):
            confidence = np.asarray(session.confidence(part.name))
            tracks[part.number] = writing.Track(frames + offset, np.asarray(track.points), confidence)
    blocks = [
        writing.lay_out(index, reading.found.parts, tracks, reading.found, reading.mapper, reading.corrections)
        for index in range(len(reading.found.layer_names))
    ]
    written = 0
    for name, block in zip(reading.found.layer_names, blocks, strict=True):
        layer = ob.data.layers[name]
        written += writing.write(layer, block, list(gp.drawings(layer)))
    return written


CLASSES = (ROTOTOON_OT_track,)
