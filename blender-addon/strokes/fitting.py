"""Fit Strokes: replaces strokes by quadratic B-splines with few guiding points.

Blender draws such a curve as a NURBS of order 3. The curve is fitted in the plane of the drawing. Other values of the points
(distance from the plane, radius, opacity, colour, the artist's attributes) are fitted with the same weights as the guiding points,
so Blender blends them along the curve as they ran along the stroke. Values that cannot be blended come from the nearest point.

A uniform spline has a corner where a guiding point is doubled, and each side between two corners takes two pieces. Where nothing
but such sides is left, the stroke stays a polyline with one point at each corner: the same picture, and simpler to edit.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from rototoon import Strokes, fit_strokes

from ..blender import drawn_plane
from ..blender import strokes as st
from ..blender.errors import Problem

_BLENDED = {"FLOAT", "FLOAT_VECTOR", "FLOAT2", "FLOAT_COLOR", "BYTE_COLOR"}
ORDER = 3
MOST_STEPS, FEWEST_STEPS = 64, 12
SMOOTH = 0.1
"""Blender draws a curve as a polyline. This share of the tolerance is the allowed distance between the two."""
SAME = 1e-3
"""Values of a doubled guiding point are the same if they differ by less than this share of the stroke's largest one."""


@dataclass
class Fitted:
    """A drawing with fitted strokes."""

    content: st.Content
    fitted: int
    """Number of strokes that became lighter: curves, or polylines with a point at each corner."""
    skipped: int
    """Number of chosen strokes that cannot be fitted: they are curves already, or have points that are not finite."""
    before: int
    after: int
    """Numbers of points of these strokes, before and after."""


def fit(content: st.Content, wanted: np.ndarray, scale: float, tolerance: float) -> Fitted | None:
    """Fits the strokes of the mask `wanted` within `tolerance` pixels, at `scale` pixels per unit. `None` if no stroke
    changes."""
    poly = (content.types == st.POLY) & content.finite()
    chosen = np.flatnonzero(wanted & poly & (content.sizes > 2))
    skipped = int((wanted & ~poly).sum())
    if not len(chosen):
        return None
    starts = content.starts
    old = st.ranges(starts[chosen], content.sizes[chosen])
    flat, carried, layout = _flattened(content, old, scale)
    offsets = np.concatenate([[0], np.cumsum(content.sizes[chosen])]).astype(np.int32)
    closed = content.strokes("cyclic")[chosen].astype(np.uint8)
    if flat.size and np.abs(flat).max() > 1e9:
        raise Problem("The tolerance is too small for coordinates of this size")
    found = fit_strokes(Strokes(offsets, flat, closed), tolerance, carried, carried.shape[1])
    counts = np.diff(np.asarray(found.offsets))
    # A stroke is kept if it needs as many guiding points as it has points, or if it would become a closed curve of two.
    lighter = (counts < content.sizes[chosen]) & ((closed == 0) | (counts >= ORDER))
    if not lighter.any():
        return None
    guides = _Guides(found, counts, lighter, carried.shape[1], offsets)
    guides.straighten(closed[lighter] != 0, SMOOTH * tolerance)
    result = _assembled(content, chosen[lighter], guides, old, layout, scale, tolerance)
    taken = chosen[lighter]
    return Fitted(result, len(taken), skipped, int(content.sizes[taken].sum()), int(guides.counts.sum()))


class _Guides:
    """The guiding points of the strokes that become lighter, as arrays."""

    def __init__(self, found, counts, lighter, channels, offsets):
        rows = st.ranges(np.asarray(found.offsets)[:-1][lighter], counts[lighter])
        self.counts = counts[lighter]
        self.points = np.asarray(found.points).reshape(-1, 2)[rows]
        self.values = np.asarray(found.values).reshape(-1, channels)[rows]
        self.nearest = np.asarray(found.nearest)[rows]
        self.source = np.repeat(np.flatnonzero(lighter), self.counts)
        self.given = offsets
        self.straight = np.zeros(len(self.counts), bool)
        """Strokes whose points are the corners of a polyline."""

    def straighten(self, closed: np.ndarray, beside: float) -> None:
        """Leaves one point at each corner of the strokes that are straight between their corners.

        `beside` is by how many pixels the distances of a doubled point from the drawing's plane may differ.
        """
        kept = np.ones(len(self.points), bool)
        ends = np.concatenate([[0], np.cumsum(self.counts)])
        for stroke, (first, last) in enumerate(zip(ends[:-1], ends[1:])):
            points, values = self.points[first:last], self.values[first:last]
            limits = SAME * np.abs(values).max(0)
            limits[0] = beside
            pairs = _doubled(points, values, closed[stroke], limits)
            if pairs is not None:
                here, there = pairs
                values[here] = (values[here] + values[there]) / 2
                kept[first + there] = False
                self.straight[stroke] = True
        self.counts = np.add.reduceat(kept.astype(int), ends[:-1])
        self.points, self.values, self.nearest, self.source = (
            rows[kept] for rows in (self.points, self.values, self.nearest, self.source)
        )


def _doubled(points: np.ndarray, values: np.ndarray, closed: bool, limits: np.ndarray):
    """The first and the second points of all corners, if a curve has nothing but corners (and its ends). Otherwise `None`.

    Values that differ at a corner bend along the sides, and a polyline has only straight ones.
    """
    count = len(points)
    if count % 2 or count < (6 if closed else 4):
        return None
    for begin in (0, 1) if closed else (1,):
        here = np.arange(begin, count if closed else count - 1, 2)
        there = (here + 1) % count
        same = (np.abs(values[here] - values[there]) <= limits).all()
        if same and (points[here] == points[there]).all():
            return here, there
    return None


def _flattened(content: st.Content, old: np.ndarray, scale: float):
    """Pixels (N, 2) in the drawing's plane, the values to blend as columns, and the columns of each attribute."""
    points = content.point["position"][old].astype(np.float64)
    origin, axes = points.mean(0), drawn_plane.axes(drawn_plane.normal([points]))
    local = (points - origin) @ axes.T * scale
    layout, columns, at = {}, [local[:, 2:]], 1
    for name, values in content.point.items():
        if name == "position" or content.kinds[name] not in _BLENDED:
            continue
        each = np.nan_to_num(values[old].astype(np.float64).reshape(len(old), -1), posinf=0.0, neginf=0.0)
        layout[name] = slice(at, at + each.shape[1])
        at += each.shape[1]
        columns.append(each)
    layout["position"] = (origin, axes)
    return np.ascontiguousarray(local[:, :2]), np.concatenate(columns, 1), layout


def _assembled(content, taken, guides: _Guides, old, layout, scale, tolerance) -> st.Content:
    """The content, where the strokes `taken` have their guiding points instead of their points."""
    sizes = content.sizes.copy()
    sizes[taken] = guides.counts
    result = st.Content(sizes, content.types.copy(), kinds=dict(content.kinds))
    starts, now = content.starts, result.starts
    rows = st.ranges(now[taken], guides.counts)
    kept = np.setdiff1d(np.arange(len(sizes)), taken)
    there, here = st.ranges(starts[kept], sizes[kept]), st.ranges(now[kept], sizes[kept])
    origin, axes = layout["position"]
    places = np.concatenate([guides.points, guides.values[:, :1]], 1) / scale @ axes + origin
    for name, values in content.point.items():
        fresh = np.empty((int(now[-1]), *values.shape[1:]), values.dtype)
        fresh[here] = values[there]
        if name == "position":
            fresh[rows] = places
        elif name in layout:
            fresh[rows] = _within(values[old], guides, guides.values[:, layout[name]]).reshape(-1, *values.shape[1:])
        else:
            fresh[rows] = values[old][guides.nearest]
        result.point[name] = fresh
    result.curve = dict(content.curve)
    _make_curves(result, taken, guides, tolerance)
    return result


def _within(given: np.ndarray, guides: _Guides, values: np.ndarray) -> np.ndarray:
    """Blended values, limited to the range of the stroke's values."""
    each = given.reshape(len(given), -1)
    low = np.minimum.reduceat(each, guides.given[:-1])[guides.source]
    high = np.maximum.reduceat(each, guides.given[:-1])[guides.source]
    return np.clip(values, low, high)


def _make_curves(result: st.Content, taken, guides: _Guides, tolerance: float) -> None:
    """Makes the strokes `taken` quadratic B-splines. Straight ones, and those with one or two points, stay polylines."""
    curved = (guides.counts >= ORDER) & ~guides.straight
    which = taken[curved]
    result.types[which] = st.NURBS
    order, knots = result.strokes("nurbs_order").copy(), result.strokes("knots_mode").copy()
    steps = result.strokes("resolution").copy()
    order[which] = ORDER
    knots[which] = np.where(result.strokes("cyclic")[which], 0, st.ENDPOINT)
    steps[which] = _steps(guides, tolerance)[curved]
    for name, values in (("nurbs_order", order), ("knots_mode", knots), ("resolution", steps)):
        result.set_strokes(name, values)


def _steps(guides: _Guides, tolerance: float) -> np.ndarray:
    """Number of steps per piece, so that Blender's polyline is within `SMOOTH` of the tolerance."""
    # A piece bends by at most half the second difference of its guiding points; at clamped ends by up to twice that.
    bend = np.zeros(len(guides.points))
    bend[1:-1] = np.linalg.norm(guides.points[2:] - 2 * guides.points[1:-1] + guides.points[:-2], axis=1)
    ends = np.concatenate([[0], np.cumsum(guides.counts)])
    bend[ends[1:-1]] = bend[ends[1:-1] - 1] = 0.0
    most = np.maximum.reduceat(bend, ends[:-1])
    steps = np.ceil(np.sqrt(most / (4 * SMOOTH * tolerance)))
    return np.clip(steps, FEWEST_STEPS, MOST_STEPS).astype(np.int32)
