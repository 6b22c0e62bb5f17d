"""Strokes of a document's drawings: reading and checking their fields, and writing them.

Widths in pixels are radii in the layer's units.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np

from ..blender import colours, stroke_lines
from ..blender import strokes as st
from ..lines import tracing
from .fields import wrong

KNOWN = {"track", "points", "closed", "widths", "colour", "confidence", "fill", "fill_colour", "opacity"}
"""The fields of a stroke that become strokes of Blender."""


def drawings_of(project: dict[str, Any], name: str, numbered: bool) -> Iterator[tuple[str, int, dict[str, Any], list[tracing.Placed]]]:
    """Place, picture number, fields and strokes of each drawing in a field of a document. With `numbered`, strokes have numbers. Raises a
    `Problem` that names the field that is wrong."""
    drawings = project.get(name, [])
    if not isinstance(drawings, list):
        raise wrong(name, drawings, "a list of drawings")
    before = None
    for k, drawing in enumerate(drawings):
        place = f"{name}[{k}]"
        frame = drawing.get("frame") if isinstance(drawing, dict) else None
        if type(frame) is not int or not isinstance(drawing.get("strokes"), list):
            raise wrong(place, drawing, "a drawing: an object with frame and a list of strokes")
        if before is not None and frame <= before:
            raise wrong(f"{place}.frame", frame, f"more than {before}, that of {name}[{k - 1}]")
        before = frame
        yield place, frame, drawing, [_read(f"{place}.strokes[{i}]", each, numbered) for i, each in enumerate(drawing["strokes"])]


def _read(place: str, stroke: Any, numbered: bool) -> tracing.Placed:
    if not isinstance(stroke, dict):
        raise wrong(place, stroke, "a stroke: an object with track and points" if numbered else "a stroke: an object with points")
    number = 0
    if numbered:
        if not isinstance(stroke.get("track"), int) or stroke["track"] < 0:
            raise wrong(f"{place}.track", stroke.get("track"), "a number from 0")
        number = stroke["track"] + 1
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
    closed, fill = bool(stroke.get("closed")), stroke.get("fill", False)
    if not isinstance(fill, bool) or fill and not closed:
        raise wrong(f"{place}.fill", fill, "true or false, and true only for a closed stroke")
    fill_colour = None
    if stroke.get("fill_colour") is not None:
        fill_colour = _numbers(f"{place}.fill_colour", stroke["fill_colour"])
        if fill_colour.shape != (3,) or fill:
            expected = "three numbers, and no fill: the colour of a filled shape without a line is its colour"
            raise wrong(f"{place}.fill_colour", stroke["fill_colour"], expected)
    shares = [_share(place, name, stroke.get(name, 1.0)) for name in ("confidence", "opacity")]
    return tracing.Placed(number, points, closed, widths, colour, shares[0], fill, shares[1], fill_colour=fill_colour)


def _share(place: str, name: str, value: Any) -> float:
    if isinstance(value, bool) or not isinstance(value, (int, float)) or not 0 <= value <= 1:
        raise wrong(f"{place}.{name}", value, "a number from 0 to 1")
    return float(value)


def _numbers(place: str, values: Any) -> np.ndarray:
    try:
        array = np.asarray(values, np.float64)
    except (TypeError, ValueError):
        array = np.array(np.nan)
    if not np.isfinite(array).all():
        raise wrong(place, values, "finite numbers")
    return array


def written(ob, content: st.Content, mapping, palette) -> dict[int, dict[str, Any]]:
    """The fields of a drawing's strokes by index. Strokes with a point that has no place are left out."""
    seen, closed = colours.of_strokes(ob, content, palette), content.strokes("cyclic")
    filled, inks = st.filled(ob, content) != 0, colours.of_lines(content, palette)
    # A line that Remove Hidden Lines took away leaves its fill, with a line of opacity 0: in a document this is a shape without a line.
    radii, fills = content.point.get("radius"), st.solid(ob, content) | closed & filled & st.undrawn(content)
    found = {}
    for i, line in enumerate(stroke_lines.lines(content)):
        line = line[:-1] if closed[i] and len(line) > 2 and np.array_equal(line[0], line[-1]) else line
        if not len(line) or not np.isfinite(line).all():
            continue
        points = mapping.to_pixels(line)
        stroke = found[i] = {"points": points.round(4).tolist(), "closed": bool(closed[i])}
        own = None if radii is None else radii[content.starts[i] : content.starts[i + 1]]
        if fills[i]:
            stroke["fill"] = True
        elif own is not None and len(own) == len(line):
            stroke["widths"] = (2 * own / np.maximum(mapping.radii(points, 1.0), 1e-12)).round(4).tolist()
        stroke["colour"] = (seen if fills[i] else inks)[i].clip(0, 1).round(4).tolist()
        if filled[i] and not fills[i]:
            stroke["fill_colour"] = seen[i].clip(0, 1).round(4).tolist()
    return found
