"""Strokes of a drawing without a session: matching contours, fitting curves, cutting hidden lines."""

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
    """Strokes of a drawing as flat buffers such as NumPy arrays. Stroke `i` has the points `offsets[i]` to `offsets[i + 1]`."""

    offsets: Any
    """int32, one more than the number of strokes."""
    points: Any
    """float64 (N, 2), pixels."""
    closed: Any
    """uint8 or bool, one per stroke: whether its end joins its start."""


@dataclass(frozen=True)
class Guides:
    """Fitted strokes: the guiding points of quadratic B-splines."""

    offsets: memoryview
    """int32: stroke `i` has the guiding points `offsets[i]` to `offsets[i + 1]`."""
    points: memoryview
    """float64 (G, 2), pixels. The guiding point of a corner comes twice."""
    values: memoryview
    """float64 (G, channels): the values of the given points, carried over."""
    nearest: memoryview
    """int32 (G,): the nearest given point along the stroke."""
    errors: memoryview
    """float64, one per stroke: the largest distance of a point from the curve, in pixels."""


@dataclass(frozen=True)
class Pieces:
    """Visible and hidden parts of strokes, in the order of the strokes and along each stroke."""

    strokes: memoryview
    """int32 (P,): the stroke of each part."""
    hidden: memoryview
    """int32 (P,): not 0 if the part is hidden."""
    intervals: memoryview
    """float64 (P, 2): parameters of the stroke at the part's start and end. A part over the seam of a closed stroke ends beyond the
    stroke's last parameter."""
    offsets: memoryview
    """int32 (P + 1): part `i` has the points `offsets[i]` to `offsets[i + 1]`. It has none if it is the complete stroke."""
    indices: memoryview
    """int32 (M, 3): each point is a weighted sum of these given points."""
    weights: memoryview
    """float64 (M, 3): the weights of the sum."""


def match_contours(request: Mapping[str, Any]) -> Any:
    """Matches drawn contours to known ones. Order, direction, start and number of points may differ.

    The request is ``{"references": [contour, ...], "drawn": [contour, ...]}``. A contour is ``{"closed": bool, "points":
    [[x, y], ...]}``. It may have a ``"color": [r, g, b]``, sRGB from 0 to 1; colours are compared where both contours have one. It may have
    ``"labels": [text, ...]``, such as its layer and its material: labels at the same place that differ make a match less likely. Where nothing
    else decides, the order of the contours does.

    The answer is ``{"matches": [{"reference": index, "drawn": index, "points": [[x, y], ...], "cost": number}, ...]}``, sorted
    by reference. `points` are the reference's control points on the drawn line. The cost of equal contours is 0. Contours
    without a counterpart are left out.
    """
    return json.loads(handles.take(handles.Text, "rototoon_match_contours", *as_json(request)))


def fit_strokes(strokes: Strokes, tolerance: float, values: Any = None, channels: int = 0) -> Guides:
    """Fits quadratic B-splines with few guiding points. No point is farther than `tolerance` pixels from its curve.
    Where points are rounded to pixels and the tolerance is below a pixel, it is meant for the line before rounding: points are
    then within the tolerance plus half a pixel, at most one pixel.

    `values` (float64, N × `channels`) are numbers of the given points; the guiding points get blended ones. A point that is
    not finite is an error that names its stroke. A stroke without points gives no guiding points.
    """
    given = stroke_buffers(strokes)
    carried, numbers = buffer([] if values is None else values, "d")
    expected = channels * (len(given[2]) // 2)
    if channels < 0 or numbers != expected:
        raise RototoonError(f"values: {numbers} numbers, expected {expected}, {channels} per point")
    arguments = (*given, carried, channels, float(tolerance))
    sizes = (given[1], channels)
    return Guides(*handles.take(handles.GuideArrays, "rototoon_fit_strokes", *arguments, sizes=sizes))


def hidden_lines(
    strokes: Strokes, forms: Any, depths: Any, fills: Any, *, border: float = 0.01, sliver: float = 0.1
) -> Pieces:
    """Cuts strokes where filled strokes in front hide them.

    `forms` (uint8) says what the points of each stroke are: 0 a polyline, 1 guiding points of a uniform quadratic B-spline, 2 a
    chain of quadratic Bézier curves. `depths` (int32, two per stroke) are the depth of the layer and of the stroke. Larger is
    nearer; strokes of equal depth do not hide each other. `fills` (int32) is 0 for a stroke without a fill; strokes of a layer
    with the same number fill one shape together.

    A point that is nearer to an outline than `border` pixels counts as on the outline. Parts shorter than `sliver` pixels
    become visible or hidden as their neighbours are. Parts of polylines are polylines, all others have form 2. All are open.
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
    """Pointers to the arrays of strokes, and the number of strokes, as the library takes them. Checks that the arrays fit."""
    offsets, count = buffer(strokes.offsets, "i")
    points, numbers = buffer(strokes.points, "d")
    closed, flags = buffer(strokes.closed, "B")
    if count < 1 or flags != count - 1:
        raise RototoonError(f"closed: {flags} values, expected {max(count - 1, 0)}, one less than offsets")
    if numbers != 2 * max(offsets[count - 1], 0):
        raise RototoonError(f"points: {numbers} numbers, expected x and y of {offsets[count - 1]} points")
    return offsets, count - 1, points, closed
