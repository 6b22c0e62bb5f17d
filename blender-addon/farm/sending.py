"""The contours and the paint of objects as shots of a batch."""

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
from . import painting


def shots_of(objects: Iterable[bpy.types.Object], path: str) -> tuple[list[dict[str, Any]], list[str]]:
    """Shots of all objects that can be tracked or painted, and why others were left out. `path` is the Blender file; empty if it was never
    saved. Changes nothing.

    A shot is plain data, so that it can come from another process: `object`, `blend`, `preset` and `document`, and `paint`, the options of the
    step `fill`, where there is paint.
    """
    shots, left = [], []
    for ob in sorted(objects, key=lambda ob: ob.name):
        if not gp.is_drawing(ob) or not ob.rototoon.pattern:
            continue
        found, problems = _contents(ob)
        left += [f'"{ob.name}": {problem}' for problem in problems]
        if found:
            shots.append({"object": ob.name, "blend": path, "preset": ob.rototoon.preset, **found})
    return shots, left


def _contents(ob) -> tuple[dict[str, Any], list[str]]:
    """What a shot has of an object, and why something was left out. Without contours, paint alone is sent."""
    found, problems = {}, []
    try:
        found["document"] = _document(ob)
    except (Problem, RototoonError) as problem:
        problems.append(str(problem))
    try:
        paint = painting.sent(ob)
        if paint is None:
            return found, problems
        _need_picture(paint[0])
    except (Problem, RototoonError) as problem:
        return found, [*problems, f"its paint: {problem}"]
    if "document" not in found and not _has_contours(ob):
        problems = []
    found.setdefault("document", paint[0])["fills"] = paint[0]["fills"]
    return found | {"paint": paint[1]}, problems


def _has_contours(ob) -> bool:
    return any(gp.has_strokes(layer) for layer in gp.layers(ob, ob.rototoon.contours_layer))


def _document(ob: bpy.types.Object) -> dict[str, Any]:
    # Linked objects can be read too. Their results cannot be taken in, but mattes are of use.
    why = OnContours.lacking(ob, guard.NOTHING)
    if why:
        raise Problem(why)
    reading = document.read(ob)
    if not tracking.can_track(reading, ob.rototoon.preset):
        raise tracking.nothing_to_track()
    _need_picture(reading.document)
    return reading.document


def _need_picture(document: dict[str, Any]) -> None:
    shot = document["footage"]
    first = footage.picture(shot["pattern"], shot["first"])
    if not os.path.isfile(first):
        raise Problem(f"No picture {first}")
