"""Strokes as light curves: quadratic B-splines with few guiding points, in the place of many points.

Blender draws such a curve as a NURBS of order 3. It is fitted in the plane of the drawing; what points have beside
their place in it (the distance from it, radius, opacity, colour, attributes of the artist's own) is blended along the
curve by the same weights as the guiding points, so Blender's blend of it runs as it did along the stroke. Numbers that
cannot be blended are taken from the nearest point.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..blender import camera as cameras
from ..blender import strokes as st
from ..blender.errors import Problem
from ..rototoon import Strokes, fit_strokes

_BLENDED = {"FLOAT", "FLOAT_VECTOR", "FLOAT2", "FLOAT_COLOR", "BYTE_COLOR"}
ORDER = 3
MOST_STEPS, FEWEST_STEPS = 64, 12
SMOOTH = 0.1
"""Share of the tolerance by which Blender's polyline may be off the curve that it draws."""


@dataclass
class Fitted:
    """A drawing with light strokes."""

    content: st.Content
    fitted: int
    """Strokes that became curves."""
    skipped: int
    """Strokes that were wanted and cannot be fitted: curves already, or with points that are no places."""
    before: int
    after: int
    """Points of the strokes that became curves."""


def fit(content: st.Content, wanted: np.ndarray, scale: float, tolerance: float) -> Fitted | None:
    """Fits the strokes `wanted` (mask) within `tolerance` pixels, `scale` of them a unit; `None` where none changes."""
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
        raise Problem("The tolerance is too small for coordinates as large as these")
    found = fit_strokes(Strokes(offsets, flat, closed), tolerance, carried, carried.shape[1])
    counts = np.diff(np.asarray(found.offsets))
    # A stroke that needs as many guides as it has points is as light as it gets; so is a closed curve of two.
    lighter = (counts < content.sizes[chosen]) & ((closed == 0) | (counts >= ORDER))
    if not lighter.any():
        return None
    guides = _Guides(found, counts, lighter, carried.shape[1], offsets)
    result = _assembled(content, chosen[lighter], guides, old, layout, scale, tolerance)
    taken = chosen[lighter]
    return Fitted(result, len(taken), skipped, int(content.sizes[taken].sum()), int(counts[lighter].sum()))


class _Guides:
    """The guides of the strokes that become lighter, as arrays."""

    def __init__(self, found, counts, lighter, channels, offsets):
        rows = st.ranges(np.asarray(found.offsets)[:-1][lighter], counts[lighter])
        self.counts = counts[lighter]
        self.points = np.asarray(found.points).reshape(-1, 2)[rows]
        self.values = np.asarray(found.values).reshape(-1, channels)[rows]
        self.nearest = np.asarray(found.nearest)[rows]
        self.source = np.repeat(np.flatnonzero(lighter), self.counts)
        self.given = offsets


def _flattened(content: st.Content, old: np.ndarray, scale: float):
    """Pixels (N, 2) in the drawing's plane, all that is blended as columns, and where each attribute's columns are."""
    points = content.point["position"][old].astype(np.float64)
    origin, normal = cameras.plane_of(points, np.array([0.0, 1.0, 0.0]))
    aside = np.eye(3)[np.abs(normal).argmin()]
    across = np.cross(normal, aside)
    across /= np.linalg.norm(across)
    axes = np.stack([across, np.cross(normal, across), normal])
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
    """The content with the guides of the strokes `taken` in the place of their points."""
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
    """Blended values, none beyond those that its stroke had."""
    each = given.reshape(len(given), -1)
    low = np.minimum.reduceat(each, guides.given[:-1])[guides.source]
    high = np.maximum.reduceat(each, guides.given[:-1])[guides.source]
    return np.clip(values, low, high)


def _make_curves(result: st.Content, taken, guides: _Guides, tolerance: float) -> None:
    """Says that the strokes `taken` are quadratic B-splines; those of one or two points stay what they are."""
    curved = guides.counts >= ORDER
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
    """Steps a piece with which the polyline that Blender draws is within a share of the tolerance of the curve."""
    # Half the second difference of neighbouring guides at most; at clamped ends a piece bends up to twice as much.
    bend = np.zeros(len(guides.points))
    bend[1:-1] = np.linalg.norm(guides.points[2:] - 2 * guides.points[1:-1] + guides.points[:-2], axis=1)
    ends = np.concatenate([[0], np.cumsum(guides.counts)])
    bend[ends[1:-1]] = bend[ends[1:-1] - 1] = 0.0
    most = np.maximum.reduceat(bend, ends[:-1])
    steps = np.ceil(np.sqrt(most / (4 * SMOOTH * tolerance)))
    return np.clip(steps, FEWEST_STEPS, MOST_STEPS).astype(np.int32)
