"""Track as a function: the same run as the operator's, with its result as data."""

from __future__ import annotations

from dataclasses import dataclass

import bpy
from rototoon.types import Progress

from ..blender import guard
from ..blender.errors import Problem
from ..capture import document, exchanged, properties, tracking, unseen
from ..capture import ends as track_ends
from ..common import jobs
from ..common.operators import OnContours
from .reading import End
from .refusing import need, told


@dataclass(frozen=True)
class Tracked:
    """Result of `track`."""

    contours: int
    """Number of generated contours in the file."""
    solved: int
    """Number of spans that were tracked."""
    kept: int
    """Number of spans whose result is from an earlier run, since nothing that affects it had changed."""
    ends: tuple[End, ...]
    """Ends of parts with a single key."""
    warnings: tuple[str, ...]
    """What the operator would report as a warning: parts that need a key or are most likely off, strokes that could be something else,
    corrections that are gone, layers that were left out."""

    @property
    def lost(self) -> dict[str, list[int]]:
        """By part the frames on which it was lost, and needs a key."""
        found: dict[str, list[int]] = {}
        for end in self.ends:
            if end.reason == track_ends.LOST:
                found.setdefault(end.part, []).append(end.frame)
        return found


@told
def track(ob: bpy.types.Object, method: str = "", progress: Progress | None = None) -> Tracked:
    """Tracks an object's contours from key to key, and writes them.

    `method` is a method of the operator, such as ``zhou2011``; by default that of the panel. `progress(fraction, step)` is called on
    this thread; it returns ``False`` to cancel, which raises `RuntimeError` and changes nothing.
    """
    need(ob, OnContours)
    known = [name for name, *_ in properties.PRESETS]
    if method and method not in known:
        raise Problem(f"No method {method!r}: expected one of {', '.join(known)}")
    jobs.clear_the_way()
    reading = document.read(ob)
    preset = method or ob.rototoon.preset
    if not tracking.can_track(reading, preset):
        raise tracking.nothing_to_track()
    run = tracking.begin(ob, reading, preset)
    run.worker.run_here(progress)
    strokes = tracking.finish(ob, run)
    if strokes is None:
        raise Problem("The contours changed while they were tracked, so the result was dropped: track again")
    summary, offset = run.worker.result, ob.rototoon.frame_offset
    ends = tuple(End(end.part, end.frame + offset, end.reason) for end in summary.ends)
    left = guard.left_out(tracking.contour_layers(ob), hidden=True)
    said = (*run.doubts, tracking.where_to_look(ob, run), *exchanged.told(ob), *unseen.told(ob), left)
    warnings = tuple(text for text in said if text)
    return Tracked(strokes, summary.solved, summary.reused, ends, warnings)
