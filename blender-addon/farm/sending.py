"""The contours, the lines and the paint of objects as shots of a batch."""

from __future__ import annotations

import os
from collections.abc import Iterable
from typing import Any

import bpy
from rototoon import RototoonError

from ..blender import footage, guard, preferences
from ..blender import grease_pencil as gp
from ..blender.errors import Problem
from ..capture import document, tracking
from ..common.operators import OnContours
from . import painting, tracing


def shots_of(objects: Iterable[bpy.types.Object], path: str, lines: tracing.Wanted) -> tuple[list[dict[str, Any]], list[str]]:
    """Shots of all objects that can be tracked, traced or painted, and why others were left out. `path` is the Blender file; empty if it was
    never saved. Changes nothing.

    A shot is plain data, so that it can come from another process: `object`, `blend`, `preset` and `document`; `parts`, their numbers by name, where
    there are contours; `trace` and `lines` as in `tracing.sent` where there are lines; `paint`, the options of the step `fill`, where there is paint. An object has further shots where its
    lines need them.
    """
    shots, left = [], []
    for ob in sorted(objects, key=lambda ob: ob.name):
        if not gp.is_drawing(ob) or not ob.rototoon.pattern:
            continue
        contents, problems = _contents(ob, lines)
        left += [f'"{ob.name}": {problem}' for problem in problems]
        shots += [{"object": ob.name, "blend": path, "preset": ob.rototoon.preset, **content} for content in contents]
    return shots, left


def _contents(ob, lines: tracing.Wanted) -> tuple[list[dict[str, Any]], list[str]]:
    """What the shots of an object have, and why something was left out. An object without contours has lines and paint alone."""
    found: list[dict[str, Any]] = []
    why, problems = "", []
    try:
        found.append({"document": _document(ob), "parts": {part.name: part.number for part in ob.rototoon.parts}})
    except (Problem, RototoonError) as problem:
        why = str(problem)
    traced, problem = _lines(ob, lines)
    problems += [f"its lines: {problem}"] if problem else []
    if traced:
        found[:1] = [_joined(found, traced[0], "drawings")]
        found += traced[1:]
    paint, problem = _paint(ob)
    problems += [f"its paint: {problem}"] if problem else []
    if paint:
        found[:1] = [_joined(found, paint, "fills", "recolours")]
    if why and (not found or _has_contours(ob)):
        problems.insert(0, why)
    return found, problems


def _joined(found: list[dict[str, Any]], more: dict[str, Any], *fields: str) -> dict[str, Any]:
    """The first shot with the content `more` and these fields of its document."""
    if not found:
        return more
    document = found[0]["document"] | {name: more["document"][name] for name in fields if name in more["document"]}
    return found[0] | more | {"document": document}


def _lines(ob, wanted: tracing.Wanted) -> tuple[list[dict[str, Any]], str]:
    """What is sent of an object's lines, and what was left out."""
    try:
        shots, left = tracing.sent(ob, wanted)
        for shot in shots:
            _need_picture(shot["document"])
    except (Problem, RototoonError) as problem:
        return [], str(problem)
    return shots, left


def _paint(ob) -> tuple[dict[str, Any], str]:
    """What is sent of an object's paint, and why nothing can be."""
    try:
        paint = painting.sent(ob)
        if paint is None:
            return {}, ""
        _need_picture(paint[0])
    except (Problem, RototoonError) as problem:
        return {}, str(problem)
    return {"document": paint[0], "paint": paint[1]}, ""


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


def of_movies(shots: Iterable[dict[str, Any]]) -> list[str]:
    """The objects whose pictures are in this machine's cache of movies."""
    try:
        cache = os.path.normcase(os.path.realpath(preferences.cache_path()))
    except Problem:
        return []  # no cache, so no pictures in it
    patterns = {shot["object"]: shot["document"]["footage"]["pattern"] for shot in shots}
    folders = {name: os.path.normcase(os.path.realpath(os.path.dirname(pattern))) for name, pattern in patterns.items()}
    return [name for name, folder in folders.items() if os.path.dirname(folder) == cache]


def _need_picture(document: dict[str, Any]) -> None:
    shot = document["footage"]
    first = footage.picture(shot["pattern"], shot["first"])
    if not os.path.isfile(first):
        raise Problem(f"No picture {first}")
