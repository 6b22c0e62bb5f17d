"""Strokes of a drawing without a session: matched, fitted, and cut where others hide them."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from .native import handles
from .native.arrays import as_json, buffer
from .native.errors import RototoonError


@dataclass(frozen=True)
class Strokes:
    """Strokes of a drawing as flat buffers, such as NumPy arrays: stroke `i` has the points `offsets[i]` to
    `offsets[i + 1]`."""

    offsets: Any
    """int32, one more than there are strokes."""
    points: Any
    """float64 (N, 2), pixels."""
    closed: Any
    """uint8 or bool, one a stroke: whether the end joins the start."""


@dataclass(frozen=True)
class Guides:
    """Fitted strokes: quadratic B-splines by their guiding points."""

    offsets: memoryview
    """int32: stroke `i` has the guides `offsets[i]` to `offsets[i + 1]`."""
    points: memoryview
    """float64 (G, 2), pixels; those of corners twice."""
    values: memoryview
    """float64 (G, channels): what the points carried."""
    nearest: memoryview
    """int32 (G,): the given point that is nearest along the stroke."""
    errors: memoryview
    """float64, one a stroke: the largest distance in pixels."""


@dataclass(frozen=True)
class Pieces:
    """Seen and hidden parts of strokes, in the order of the strokes and along each."""

    strokes: memoryview
    """int32 (P,): the stroke of each part."""
    hidden: memoryview
    """int32 (P,): not 0 where it is hidden."""
    intervals: memoryview
    """float64 (P, 2): from which parameter of the stroke to which; over the seam of a closed one beyond its end."""
    offsets: memoryview
    """int32 (P + 1): part `i` has the points `offsets[i]` to `offsets[i + 1]`, none where it is a whole stroke."""
    indices: memoryview
    """int32 (M, 3): the given points of which each point is the sum."""
    weights: memoryview
    """float64 (M, 3): their weights."""


def match_contours(request: Mapping[str, Any]) -> Any:
    """Finds which drawn contour is which known one, whatever their order, direction, start and number of points.

    The request is ``{"references": [contour, ...], "drawn": [contour, ...]}``, each contour being
    ``{"closed": bool, "points": [[x, y], ...]}``. The answer is ``{"matches": [{"reference": index, "drawn": index,
    "points": [[x, y], ...], "cost": number}, ...]}``, rising by reference: `points` are the reference's control points
    on the drawn line; the cost is 0 for equal contours. What has no counterpart is left out. Contours may have a
    ``"color": [r, g, b]``, sRGB from 0 to 1, which is compared where both have one.
    """
    return json.loads(handles.take(handles.Text, "rototoon_match_contours", *as_json(request)))


def fit_strokes(strokes: Strokes, tolerance: float, values: Any = None, channels: int = 0) -> Guides:
    """Fits quadratic B-splines with few guiding points; no point is farther than `tolerance` pixels from its curve.

    `values` (float64, N × `channels`) are numbers that the points carry and the guides carry on. A stroke with a point
    that is no place is an error that names it; a stroke without points gives no guides.
    """
    given = stroke_buffers(strokes)
    carried, numbers = buffer([] if values is None else values, "d")
    expected = channels * (len(given[2]) // 2)
    if channels < 0 or numbers != expected:
        raise RototoonError(f"values: {numbers} numbers, expected {expected}, {channels} a point")
    arguments = (*given, carried, channels, float(tolerance))
    sizes = (given[1], channels)
    return Guides(*handles.take(handles.GuideArrays, "rototoon_fit_strokes", *arguments, sizes=sizes))


def hidden_lines(
    strokes: Strokes, forms: Any, depths: Any, fills: Any, *, border: float = 0.01, sliver: float = 0.1
) -> Pieces:
    """Cuts strokes where filled strokes in front hide them.

    `forms` (uint8) says what the points of each stroke mean: 0 a polyline, 1 guiding points of a uniform quadratic
    B-spline, 2 a chain of quadratic Bézier curves. `depths` (int32, two a stroke) are layer and stroke, larger is nearer,
    equal ones do not hide each other. `fills` (int32) is 0 where a stroke is not filled; strokes of a layer with the same
    number fill one shape. What is nearer to an outline than `border` pixels lies on it; parts shorter than `sliver` pixels
    take after their surroundings. Parts of polylines are polylines, all others are of form 2; all are open.
    """
    given = stroke_buffers(strokes)
    count = given[1]
    placing = []
    for name, values, kind, length in (
        ("forms", forms, "B", count),
        ("depths", depths, "i", 2 * count),
        ("fills", fills, "i", count),
    ):
        pointer, found = buffer(values, kind)
        if found != length:
            raise RototoonError(f"{name}: {found} values, expected {length}")
        placing.append(pointer)
    arguments = (*given, *placing, float(border), float(sliver))
    return Pieces(*handles.take(handles.PieceArrays, "rototoon_hidden_lines", *arguments))


def stroke_buffers(strokes: Strokes) -> tuple[Any, int, Any, Any]:
    """Pointers to the arrays of strokes, and their number, as the library takes them; checked against each other."""
    offsets, count = buffer(strokes.offsets, "i")
    points, numbers = buffer(strokes.points, "d")
    closed, flags = buffer(strokes.closed, "B")
    if count < 1 or flags != count - 1:
        raise RototoonError(f"closed: {flags} values, expected {max(count - 1, 0)}, one less than offsets")
    if numbers != 2 * max(offsets[count - 1], 0):
        raise RototoonError(f"points: {numbers} numbers, expected x and y of {offsets[count - 1]} points")
    return offsets, count - 1, points, closed
