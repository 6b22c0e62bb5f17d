"""The field `traced` of a document: traced strokes as a layer of lines, and back.

A document counts strokes from 0, a layer from 1. Widths in pixels are radii in the layer's units.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from ..blender import colours, guard, placement, stroke_lines
from ..blender import grease_pencil as gp
from ..blender import strokes as st
from ..lines import doubts, tracing
from ..lines import drawings as dr
from .fields import wrong

Drawing = dict[int, list[tracing.Placed]]


def checked(project: dict[str, Any]) -> Drawing:
    """The traced strokes of a document by picture number. Raises a `Problem` that names the field that is wrong."""
    drawings = project.get("traced", [])
    if not isinstance(drawings, list):
        raise wrong("traced", drawings, "a list of drawings")
    found: Drawing = {}
    for k, drawing in enumerate(drawings):
        place = f"traced[{k}]"
        frame = drawing.get("frame") if isinstance(drawing, dict) else None
        if not isinstance(frame, int) or not isinstance(drawing.get("strokes"), list):
            raise wrong(place, drawing, "a drawing: an object with frame and a list of strokes")
        strokes = [_stroke(f"{place}.strokes[{i}]", each) for i, each in enumerate(drawing["strokes"])]
        if len({stroke.number for stroke in strokes}) < len(strokes):
            raise wrong(f"{place}.strokes", sorted(stroke.number - 1 for stroke in strokes), "each track once on a frame")
        found[frame] = strokes
    return found


def _stroke(place: str, stroke: Any) -> tracing.Placed:
    if not isinstance(stroke, dict):
        raise wrong(place, stroke, "a stroke: an object with track and points")
    if not isinstance(stroke.get("track"), int) or stroke["track"] < 0:
        raise wrong(f"{place}.track", stroke.get("track"), "a number from 0")
    points = _numbers(f"{place}.points", stroke.get("points"))
    if points.ndim != 2 or points.shape[1:] != (2,) or not len(points):
        raise wrong(f"{place}.points", stroke.get("points"), "a list of points [x, y]")
    widths = np.full(len(points), np.nan)
    if stroke.get("widths"):
        widths = _numbers(f"{place}.widths", stroke["widths"])
        if widths.shape != (len(points),):
            raise wrong(f"{place}.widths", stroke["widths"], f"one number for each of the {len(points)} points")
    colour = _numbers(f"{place}.colour", stroke.get("colour") or [0.0] * 3)
    if colour.shape != (3,):
        raise wrong(f"{place}.colour", stroke["colour"], "three numbers")
    sure = stroke.get("confidence", 1.0)
    if isinstance(sure, bool) or not isinstance(sure, (int, float)) or not 0 <= sure <= 1:
        raise wrong(f"{place}.confidence", sure, "a number from 0 to 1")
    closed, fill = bool(stroke.get("closed")), stroke.get("fill", False)
    if not isinstance(fill, bool) or fill and not closed:
        raise wrong(f"{place}.fill", fill, "true or false, and true only for a closed stroke")
    return tracing.Placed(stroke["track"] + 1, points, closed, widths, colour, float(sure), fill)


def _numbers(place: str, values: Any) -> np.ndarray:
    try:
        array = np.asarray(values, np.float64)
    except (TypeError, ValueError):
        array = np.array(np.nan)
    if not np.isfinite(array).all():
        raise wrong(place, values, "finite numbers")
    return array


def need_open(ob, project: dict[str, Any]) -> None:
    """Raises a `Problem` if the document has traced strokes and the layer for them may not be written."""
    if checked(project):
        guard.need_open([gp.find_layer(ob, ob.rototoon.lines_layer)])


def draw(ob, project: dict[str, Any]) -> int:
    """Draws the traced strokes of a document. Traced drawings of the layer are replaced, the artist's stay. Returns the number of
    different strokes."""
    found = checked(project)
    if not found:
        return 0
    offset = ob.rototoon.frame_offset
    return len(tracing.draw(ob, ob.rototoon.lines_layer, {frame + offset: each for frame, each in found.items()}).numbers)


def of(ob) -> list[dict[str, Any]]:
    """The strokes of the object's layer of lines in the form of a document; those without a number are left out."""
    name, offset = ob.rototoon.lines_layer, ob.rototoon.frame_offset
    if gp.find_layer(ob, name) is None:
        return []
    (layer,) = dr.read(ob, [name], None)
    contents = layer.keys | layer.made
    mapper, palette = placement.Mapper(ob, contents, {}, [name]), colours.palette(ob)
    return [
        {"frame": frame - offset, "strokes": _written(ob, contents[frame], mapper.at(0, frame), palette, frame in layer.made)}
        for frame in sorted(contents)
    ]


def _written(ob, content, mapping, palette, traced: bool) -> list[dict[str, Any]]:
    seen, tracks, closed = colours.of_strokes(ob, content, palette), content.strokes(gp.TRACK), content.strokes("cyclic")
    radii, fills = content.point.get("radius"), st.solid(ob, content)
    # What the artist drew is beyond doubt.
    sure = doubts.of_strokes(content.point.get(gp.CONFIDENCE) if traced else None, content.starts).round(3)
    found, taken = [], {0}
    for i, line in enumerate(stroke_lines.lines(content)):
        line = line[:-1] if closed[i] and len(line) > 2 and np.array_equal(line[0], line[-1]) else line
        if int(tracks[i]) in taken or not len(line) or not np.isfinite(line).all():
            continue
        taken.add(int(tracks[i]))
        points = mapping.to_pixels(line)
        stroke = {"track": int(tracks[i]) - 1, "points": points.round(4).tolist(), "closed": bool(closed[i])}
        own = None if radii is None else radii[content.starts[i] : content.starts[i + 1]]
        if fills[i]:
            stroke["fill"] = True
        elif own is not None and len(own) == len(line):
            # The length of a pixel in the layer's units, at each point.
            pixel = np.linalg.norm(mapping.to_layer(points + (1.0, 0.0)) - mapping.to_layer(points), axis=1)
            stroke["widths"] = (2 * own / np.maximum(pixel, 1e-12)).round(4).tolist()
        stroke["colour"] = seen[i].clip(0, 1).round(4).tolist()
        if sure[i] < 1:
            stroke["confidence"] = float(sure[i])
        found.append(stroke)
    return found
