"""Strokes that bound a part, as one closed contour. Plain NumPy, pixels.

The strokes are put in the order and direction in which the gaps between their ends are smallest (all orders are tried for a few
strokes; with more, each next stroke is the nearest one). Where a stroke runs on beyond the next one, as lines do at a junction, both
are cut where they cross. Then the contour is thinned to control points.
"""

from __future__ import annotations

from itertools import permutations

import numpy as np

from .drawings import shares

ALL_ORDERS = 6
"""Most strokes of which all orders are tried."""
END = 0.45
"""Share of a stroke at each of its ends in which it may be cut."""


def joined(strokes: list[tuple[np.ndarray, bool]]) -> tuple[np.ndarray, float]:
    """The contour (N, 2) around a part, without a repeated first point, and its largest gap between two strokes.

    `strokes` are points and whether the stroke is closed. A closed stroke is a contour by itself: of several, the longest counts.
    """
    closed = [points for points, is_closed in strokes if is_closed]
    if closed:
        return _plain(max(closed, key=_length)), 0.0
    lines = _ordered([np.asarray(points, np.float64) for points, _ in strokes])
    gaps = [float(np.linalg.norm(a[-1] - b[0])) for a, b in zip(lines, lines[1:] + lines[:1])]
    count = len(lines)
    for k in range(count) if count > 1 else ():
        after = (k + 1) % count
        lines[k], lines[after], cut = _cut(lines[k], lines[after])
        gaps[k] = 0.0 if cut else gaps[k]
    return _plain(np.concatenate(lines)), max(gaps)


def _length(points: np.ndarray) -> float:
    return float(np.linalg.norm(np.diff(points, axis=0), axis=1).sum())


def _ordered(lines: list[np.ndarray]) -> list[np.ndarray]:
    """The lines in the order and direction of the contour."""
    if len(lines) == 1:
        return lines
    ends = np.array([[line[0], line[-1]] for line in lines])
    if len(lines) > ALL_ORDERS:
        return _nearest_next(lines, ends)
    best, found = np.inf, lines
    for order in permutations(range(1, len(lines))):
        for bits in range(2 ** (len(lines) - 1)):
            way = [(0, False)] + [(i, bool(bits >> k & 1)) for k, i in enumerate(order)]
            cost = sum(np.linalg.norm(ends[a, int(not u)] - ends[b, int(v)]) for (a, u), (b, v) in zip(way, way[1:] + way[:1]))
            if cost < best - 1e-9:
                best, found = cost, [lines[i][::-1] if turned else lines[i] for i, turned in way]
    return found


def _nearest_next(lines: list[np.ndarray], ends: np.ndarray) -> list[np.ndarray]:
    left, found = set(range(1, len(lines))), [lines[0]]
    while left:
        here = found[-1][-1]
        away, i, side = min((float(np.linalg.norm(ends[i, side] - here)), i, side) for i in left for side in (0, 1))
        left.discard(i)
        found.append(lines[i][::-1] if side else lines[i])
    return found


def _cut(a: np.ndarray, b: np.ndarray) -> tuple[np.ndarray, np.ndarray, bool]:
    """Two successive lines, cut where the end of `a` crosses the beginning of `b`, and whether they cross."""
    first = max(int(np.searchsorted(shares(a), 1 - END)) - 1, 0)
    last = min(int(np.searchsorted(shares(b), END)) + 1, len(b) - 1)
    best = None
    for j in range(last):
        p, v = b[j], b[j + 1] - b[j]
        starts, ways = a[first:-1], np.diff(a[first:], axis=0)
        cross = ways[:, 0] * v[1] - ways[:, 1] * v[0]
        safe = np.where(np.abs(cross) > 1e-12, cross, np.inf)
        off = p - starts
        s = (off[:, 0] * v[1] - off[:, 1] * v[0]) / safe
        t = (off[:, 0] * ways[:, 1] - off[:, 1] * ways[:, 0]) / safe
        for i in np.flatnonzero((np.abs(cross) > 1e-12) & (s >= 0) & (s <= 1) & (t >= 0) & (t <= 1)):
            # The outermost crossing keeps most of both lines.
            kept = first + i + s[i] - (j + t[i])
            if best is None or kept > best[0]:
                best = kept, first + int(i), j, starts[i] + s[i] * ways[i]
    if best is None:
        return a, b, False
    _, i, j, place = best
    return np.vstack([a[: i + 1], place]), np.vstack([place, b[j + 1 :]]), True


def _plain(points: np.ndarray) -> np.ndarray:
    """Without repeated points."""
    points = np.asarray(points, np.float64)
    apart = np.linalg.norm(points - np.roll(points, 1, 0), axis=1) > 1e-6
    return points[apart] if apart.any() else points[:1]


def thinned(points: np.ndarray, tolerance: float, spacing: float) -> np.ndarray:
    """Control points of a closed contour: it stays within `tolerance` of the given points, and neighbours are at most `spacing` apart
    along it (Douglas & Peucker 1973, from two outer points)."""
    count = len(points)
    if count < 4:
        return points
    # An outermost point is a good one to begin at.
    points = np.roll(points, -int(np.argmax(np.linalg.norm(points - points.mean(0), axis=1))), axis=0)
    other = int(np.argmax(np.linalg.norm(points - points[0], axis=1)))
    ring = np.vstack([points, points[:1]])
    kept = np.zeros(count + 1, bool)
    kept[[0, other, count]] = True
    stack = [(0, other), (other, count)]
    along = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(ring, axis=0), axis=1))])
    while stack:
        a, b = stack.pop()
        if b - a < 2:
            continue
        inner = ring[a + 1 : b]
        way = ring[b] - ring[a]
        share = ((inner - ring[a]) @ way / max(way @ way, 1e-12)).clip(0, 1)
        away = np.linalg.norm(inner - ring[a] - share[:, None] * way, axis=1)
        worst = int(np.argmax(away)) + a + 1
        if away.max() <= tolerance:
            if along[b] - along[a] <= spacing:
                continue
            worst = int(np.clip(np.searchsorted(along, (along[a] + along[b]) / 2), a + 1, b - 1))
        kept[worst] = True
        stack += [(a, worst), (worst, b)]
    return ring[:-1][kept[:-1]]
