"""The contours of objects as shots of a batch."""

from __future__ import annotations

import os
from collections.abc import Iterable
from typing import Any

import bpy
from rototoon import RototoonError

from ..blender import footage, guard
from ..blender import grease_pencil as gp
from ..blender.errors import Problem
from ..capture import document, tracking
from ..common.operators import OnContours


def shots_of(objects: Iterable[bpy.types.Object], path: str) -> tuple[list[dict[str, Any]], list[str]]:
    """Shots of all objects that can be tracked, and why others were left out. `path` is the Blender file; empty if it was never
    saved. Changes nothing.

    A shot is plain data, so that it can come from another process: `object`, `blend`, `preset` and `document`.
    """
    shots, left = [], []
    for ob in sorted(objects, key=lambda ob: ob.name):
        if not gp.is_drawing(ob) or not ob.rototoon.pattern:
            continue
        try:
            shots.append({"object": ob.name, "blend": path, "preset": ob.rototoon.preset, "document": _document(ob)})
        except (Problem, RototoonError) as problem:
            left.append(f'"{ob.name}": {problem}')
    return shots, left


def _document(ob: bpy.types.Object) -> dict[str, Any]:
    # Linked objects can be read too. Their results cannot be taken in, but mattes are of use.
    why = OnContours.lacking(ob, guard.NOTHING)
    if why:
        raise Problem(why)
    reading = document.read(ob)
    if not tracking.can_track(reading, ob.rototoon.preset):
        raise tracking.nothing_to_track()
    shot = reading.document["footage"]
    first = footage.picture(shot["pattern"], shot["first"])
    if not os.path.isfile(first):
        raise Problem(f"No picture {first}")
    return reading.document
