"""Fit Strokes: replaces strokes by quadratic B-splines with few guiding points.

Blender draws such a curve as a NURBS of order 3. The curve is fitted in the plane of the drawing, that of a stroke that leaves this plane in a plane of its
own. Other values of the points
(distance from the plane, radius, opacity, colour, the artist's attributes) are fitted with the same weights as the guiding points,
so Blender blends them along the curve as they ran along the stroke. Values that cannot be blended come from the nearest point.

A uniform spline has a corner where a guiding point is doubled, and each side between two corners takes two pieces. Where nothing
but such sides is left, the stroke stays a polyline with one point at each corner: the same picture, and simpler to edit.

The distance from the plane is blended and not fitted within a tolerance. So a curve of a stroke that does not lie in a plane, such as a coil, is measured, and the
stroke stays if it is farther away than the tolerance.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from rototoon import Strokes, fit_strokes

from ..blender import drawn_plane, stroke_lines
from ..blender import strokes as st
from ..blender.errors import Problem

_BLENDED = {"FLOAT", "FLOAT_VECTOR", "FLOAT2", "FLOAT_COLOR", "BYTE_COLOR"}
ORDER = 3
MOST_STEPS, FEWEST_STEPS = 64, 12
SMOOTH = 0.1
"""Blender draws a curve as a polyline. This share of the tolerance is the allowed distance between the two, and of a stroke from its plane."""
FINE = 32
"""Number of steps per piece where a curve is measured."""
SAME = 1e-3
"""Values of a doubled guiding point are the same if they differ by less than this share of the stroke's largest one."""


@dataclass
class Fitted:
    """A drawing with fitted strokes."""

    content: st.Content
    fitted: int
    """Number of strokes that became lighter: curves, or polylines with a point at each corner."""
    skipped: int
    """Number of chosen strokes that cannot be fitted: they are curves already, have points that are not finite, or lie in no plane."""
    before: int
    after: int
    """Numbers of points of these strokes, before and after."""
    deep: int = 0
    """Number of strokes that stay because they lie in no plane, and their curve would be too far away."""


def fit(content: st.Content, wanted: np.ndarray, scale: float, tolerance: float) -> Fitted | None:
    """Fits the strokes of the mask `wanted` within `tolerance` pixels, at `scale` pixels per unit. `None` if no stroke
    could become lighter."""
    poly = (content.types == st.POLY) & content.finite()
    chosen = np.flatnonzero(wanted & poly & (content.sizes > 2))
    skipped = int((wanted & ~poly).sum())
    if not len(chosen):
        return None
    starts = content.starts
    old = st.ranges(starts[chosen], content.sizes[chosen])
    planes = _Planes(content.point["position"][old].astype(np.float64), content.sizes[chosen], SMOOTH * tolerance / scale)
    flat, carried, layout = _flattened(content, old, planes, np.repeat(np.arange(len(chosen)), content.sizes[chosen]), scale)
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

    def made(which: np.ndarray) -> tuple[st.Content, _Guides]:
        guides = _Guides(found, counts, which, carried.shape[1], offsets)
        guides.straighten(closed[which] != 0, SMOOTH * tolerance)
        return _assembled(content, chosen[which], guides, old, layout, planes, scale, tolerance), guides

    result, guides = made(lighter)
    deep = np.zeros(len(chosen), bool)
    unsure = np.flatnonzero(lighter & planes.deep)
    if len(unsure):
        deep[unsure] = _are_far(content, result, chosen[unsure], (1 + SMOOTH) * tolerance / scale)
    if deep.any():
        lighter = lighter & ~deep
        if not lighter.any():
            return Fitted(content, 0, skipped + int(deep.sum()), 0, 0, int(deep.sum()))
        result, guides = made(lighter)
    taken = chosen[lighter]
    return Fitted(result, len(taken), skipped + int(deep.sum()), int(content.sizes[taken].sum()), int(guides.counts.sum()), int(deep.sum()))


class _Planes:
    """The planes in which strokes are fitted: that of all of them, or a stroke's own."""

    def __init__(self, points: np.ndarray, sizes: np.ndarray, near: float):
        """`near` is how far points may be from a plane and still lie in it."""
        common = points.mean(0), drawn_plane.axes(drawn_plane.normal([points]))
        self.origins, self.axes = (np.tile(each, (len(sizes), *[1] * each.ndim)) for each in common)
        self.deep = np.zeros(len(sizes), bool)
        """Strokes that lie in no plane."""
        ends = np.concatenate([[0], np.cumsum(sizes)])
        away = np.maximum.reduceat(np.abs((points - common[0]) @ common[1][2]), ends[:-1])
        for i in np.flatnonzero(away > near):
            own = points[ends[i] : ends[i + 1]]
            self.origins[i], self.axes[i] = own.mean(0), drawn_plane.axes(drawn_plane.normal([own]))
            self.deep[i] = np.abs((own - self.origins[i]) @ self.axes[i][2]).max() > near

    def local(self, points: np.ndarray, stroke: np.ndarray) -> np.ndarray:
        """Points in the plane of their stroke, and their distance from it."""
        return np.einsum("nij,nj->ni", self.axes[stroke], points - self.origins[stroke])

    def back(self, local: np.ndarray, stroke: np.ndarray) -> np.ndarray:
        """The opposite."""
        return np.einsum("nij,ni->nj", self.axes[stroke], local) + self.origins[stroke]


def _are_far(content: st.Content, result: st.Content, which: np.ndarray, most: float) -> np.ndarray:
    """For each stroke of `which`: whether what it became is farther than `most` from it anywhere."""
    before = stroke_lines.lines(st.chosen(content, which))
    after = stroke_lines.lines(st.chosen(result, which), FINE)
    return np.array([max(_farthest(a, b), _farthest(b, a)) > most for a, b in zip(before, after)], bool)


def _farthest(points: np.ndarray, line: np.ndarray) -> float:
    """The greatest distance of points from a polyline."""
    a, way = line[:-1], np.diff(line, axis=0)
    size = np.maximum((way * way).sum(1), 1e-30)
    most = 0.0
    for some in np.array_split(points, len(points) // 256 + 1):
        share = np.clip(((some[:, None] - a) * way).sum(2) / size, 0, 1)
        most = max(most, float(np.linalg.norm(some[:, None] - a - share[..., None] * way, axis=2).min(1).max()))
    return most


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


def _flattened(content: st.Content, old: np.ndarray, planes: _Planes, stroke: np.ndarray, scale: float):
    """Pixels (N, 2) in the planes of the strokes, the values to blend as columns, and the columns of each attribute. `stroke` is that of each point."""
    local = planes.local(content.point["position"][old].astype(np.float64), stroke) * scale
    layout, columns, at = {}, [local[:, 2:]], 1
    for name, values in content.point.items():
        if name == "position" or content.kinds[name] not in _BLENDED:
            continue
        each = np.nan_to_num(values[old].astype(np.float64).reshape(len(old), -1), posinf=0.0, neginf=0.0)
        layout[name] = slice(at, at + each.shape[1])
        at += each.shape[1]
        columns.append(each)
    return np.ascontiguousarray(local[:, :2]), np.concatenate(columns, 1), layout


def _assembled(content, taken, guides: _Guides, old, layout, planes: _Planes, scale, tolerance) -> st.Content:
    """The content, where the strokes `taken` have their guiding points instead of their points."""
    sizes = content.sizes.copy()
    sizes[taken] = guides.counts
    result = st.Content(sizes, content.types.copy(), kinds=dict(content.kinds))
    starts, now = content.starts, result.starts
    rows = st.ranges(now[taken], guides.counts)
    kept = np.setdiff1d(np.arange(len(sizes)), taken)
    there, here = st.ranges(starts[kept], sizes[kept]), st.ranges(now[kept], sizes[kept])
    places = planes.back(np.concatenate([guides.points, guides.values[:, :1]], 1) / scale, guides.source)
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
