"""The fields `fills` and `filled` of a document: the layer with paint, and back.

A document counts regions from 0, a layer from 1. The artist's shapes are clicks, and regions, too.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterator
from typing import Any

import numpy as np
from rototoon import RototoonError, Session
from rototoon.fills import Click, Recolour

from ..blender import colours, fill_materials, holds
from ..blender import grease_pencil as gp
from ..blender.errors import Problem
from ..common import polygons
from ..lines import doubts
from ..lines import plan as lines_plan
from ..paint import clicks as paint_clicks
from ..paint import filling, given, painted, recolours, sheets
from ..paint import palette as palettes
from ..paint import plan as pl


def read(project: dict[str, Any]) -> tuple[dict[int, list[Click]], dict[int, list[painted.Region]]]:
    """The clicks and the regions of a document by picture number. Raises a `Problem` that names the field that is wrong."""
    if not (project.get("fills") or project.get("filled")):
        return {}, {}
    try:
        # The pictures are not read, and only these fields are looked at.
        own = {name: project[name] for name in ("rototoon", "footage", "palette", "fills", "filled") if name in project}
        with Session.from_document({**own, "parts": []}, ".") as session:
            fills, filled = session.fills(), session.filled()
    except RototoonError as error:
        raise Problem(str(error)) from error
    found: dict[int, list[Click]] = {}
    for click in fills:
        found.setdefault(click.frame, []).append(click)
    return found, {frame: filling.regions_on(filled, frame) for frame in filled.frames.tolist()}


def need_open(ob, project: dict[str, Any]) -> None:
    """Raises a `Problem` if the document has paint and the layer for it may not be written."""
    if any(read(project)):
        given.need_open(ob)


def draw(ob, project: dict[str, Any]) -> int:
    """Draws the paint of a document. Generated drawings of the layer are replaced, the artist's stay. Returns the number of frames."""
    fills, regions = read(project)
    palettes.take(ob, project.get("palette", {}))
    changing = recolours_of(project)
    if changing:
        recolours.take(ob, changing)
    if not fills and not regions:
        return 0
    offset = ob.rototoon.frame_offset
    moved = {frame + offset: own for frame, own in fills.items()}, {frame + offset: own for frame, own in regions.items()}
    return given.draw(ob, *moved)


def of(ob) -> tuple[list[dict[str, Any]], list[dict[str, Any]]]:
    """The clicks and the regions of the object's layer with paint, in the form of a document."""
    name, offset = ob.rototoon.fills_layer, ob.rototoon.frame_offset
    drawn = sheets.read(ob, name)
    mapper = pl.mapper_of(ob, name, drawn, drawn)
    used = max((int(sheet.content.strokes(gp.TRACK).max(initial=0)) for sheet in drawn.values()), default=0)
    shown: dict[int, list[dict[str, Any]]] = {}
    fills, fresh = [], itertools.count(used + 1)
    for frame, sheet in sorted(drawn.items()):
        mapping = mapper.at(0, frame)
        asked = paint_clicks.of(ob, sheet, mapping, ob.rototoon.height)
        if asked:
            fills.append({"frame": frame - offset, "regions": paint_clicks.asked(asked)})
        regions = _regions(ob, sheet, mapping, fresh)
        if regions or not len(sheet.own):
            shown[frame] = regions
    low, high = lines_plan.film(ob)
    for frame in holds.read(ob.data, name) - drawn.keys():
        before = max((each for each in drawn if each < frame), default=None)
        if low <= frame <= high and before in shown:
            shown[frame] = shown[before]
    return fills, [{"frame": frame - offset, "regions": regions} for frame, regions in sorted(shown.items())]


def recolours_of(project: dict[str, Any]) -> list[Recolour]:
    """The colours of a document that become others. Raises a `Problem` that names the field that is wrong."""
    if not project.get("recolours"):
        return []
    try:
        own = {name: project[name] for name in ("rototoon", "footage", "palette", "fills", "recolours") if name in project}
        with Session.from_document({**own, "parts": []}, ".") as session:
            return session.recolours()
    except RototoonError as error:
        raise Problem(str(error)) from error


def palette(ob, fills: list[dict[str, Any]], filled: list[dict[str, Any]]) -> dict[str, list[float]]:
    """The look of each named colour: of the palette that the object came with, of clicks and of regions."""
    return palettes.fields(ob) | {each["name"]: each["colour"] for own in [*filled, *fills] for each in own["regions"] if "name" in each}


def _regions(ob, sheet: sheets.Sheet, mapping, fresh: Iterator[int]) -> list[dict[str, Any]]:
    """The shapes of a drawing. One without a number gets a fresh one. Of several with one number the largest counts."""
    content = sheet.content
    numbers = content.strokes(gp.TRACK)
    seen = colours.of_strokes(ob, content, colours.palette(ob)).clip(0, 1).round(6)
    sure = np.where(sheet.made, doubts.of_strokes(content.point.get(gp.CONFIDENCE), content.starts), 1.0).round(3)
    found: dict[int, tuple[float, dict[str, Any]]] = {}
    bare, names = fill_materials.are_bare(ob, content), fill_materials.names_of_strokes(ob, content)
    for shape in sheets.shapes_of(ob, content, mapping, np.flatnonzero(~bare).tolist()):
        first = shape.strokes[0]
        number, (outline, *others) = int(numbers[first]) or next(fresh), sheets.loops_of(shape)
        size = abs(polygons.area(outline))
        if number in found and found[number][0] >= size:
            continue
        region: dict[str, Any] = {"outline": outline.round(4).tolist()}
        holes = [hole.round(4).tolist() for hole in others if polygons.inside([outline], hole.mean(0, keepdims=True))[0]]
        if holes:
            region["holes"] = holes
        found.pop(number, None)
        if names[first] is not None:
            region["name"] = names[first]
        region |= {"colour": seen[first].tolist(), "track": number - 1, "confidence": float(sure[first])}
        found[number] = size, region
    return [region for _, region in found.values()]
