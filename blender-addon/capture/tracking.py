"""One run of tracking: it reads an object, tracks in a thread, and writes the result into strokes.

The button Track and live tracking both use it. Nothing in the file changes before `finish`.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from ..blender import grease_pencil as gp
from ..blender import preferences
from ..blender.errors import Problem
from ..common import jobs
from . import document, ends, identity, sessions, writing

OUTWARD = "rototoon"
"""The method that tracks a part with one key outward from that key."""


@dataclass
class Run:
    """A running track. It has no references to Blender's data, so it survives undo and deleted objects."""

    uid: int
    """The object's `session_uid`."""
    inputs: dict[str, Any]
    """The document that it tracks."""
    preset: str
    """The method in the panel at the beginning."""
    entry: sessions.Entry
    worker: jobs.Worker


def can_track(reading: document.Reading, preset: str) -> bool:
    """Whether any part has enough keys: two, or one if the method tracks outward from a single key."""
    least = 1 if preset == OUTWARD else 2
    return any(len(part.keys) >= least for part in reading.found.parts)


def begin(ob, reading: document.Reading, preset: str) -> Run:
    """Makes a run. The caller starts its worker."""
    entry = sessions.get(ob, reading.document, reading.folder)
    entry.inputs = None
    threads = preferences.threads()
    worker = jobs.Worker(lambda progress: entry.session.track(preset, progress, threads=threads))
    return Run(ob.session_uid, reading.document, ob.rototoon.preset, entry, worker)


def finish(ob, run: Run) -> int | None:
    """Writes the result of a run. Returns the number of strokes.

    If the object's document has changed since the run began, it writes nothing and returns `None`.
    """
    reading = document.read(ob)
    if reading.document != run.inputs:
        return None
    identity.write(ob, reading.found, reading.decisions)
    strokes = write_tracks(ob, reading, run.entry.session)
    note_ends(ob, reading, run.worker.result.ends)
    run.entry.inputs, run.entry.preset = reading.document, run.preset
    ob.data.update_tag()
    return strokes


def write_tracks(ob, reading: document.Reading, session) -> int:
    """Writes a session's tracks into the object's contour layers. Returns the number of strokes."""
    offset = ob.rototoon.frame_offset
    tracks = {}
    for part in reading.found.parts:
        if not part.keys:
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
        layer = gp.find_layer(ob, name)
        written += writing.write(layer, block, list(gp.drawings(layer)))
    return written


def note_ends(ob, reading: document.Reading, found) -> None:
    """Stores the ends of tracks with the parts, for the panel."""
    numbers = {part.name: part.number for part in reading.found.parts}
    by_number: dict[int, list[tuple[int, str]]] = {}
    for end in found:
        by_number.setdefault(numbers[end.part], []).append((end.frame, end.reason))
    for item in ob.rototoon.parts:
        ends.put(item, by_number.get(item.number, []))


def wanted_keys(summary) -> str:
    """A message about parts that were lost; empty if there are none."""
    lost = sorted({end.part for end in summary.ends if end.reason == ends.LOST})
    if not lost:
        return ""
    return f"{len(lost)} parts need a key" if len(lost) > 1 else f'"{lost[0]}" needs a key'


def nothing_to_track() -> Problem:
    """The error for an object that `can_track` refuses."""
    return Problem("Nothing to track: go to another frame, press New Key Here and fit the contours there")
