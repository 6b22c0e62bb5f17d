"""Outlines with holes as one closed line, and places well inside of shapes.

A hole is joined to the outline by a seam: a line that is walked there and back. So a region with holes is one stroke in every version of
Blender, and an artist chooses or recolours it with one click.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ..common import polygons

SCANS = 24
"""Number of lines across and down a shape on which places inside of it are looked for."""


def joined(outline: np.ndarray, holes: Sequence[np.ndarray]) -> np.ndarray:
    """An outline (N, 2) and its holes as one closed line. The next hole is always the nearest, by a seam that crosses nothing."""
    line = np.asarray(outline, np.float64)
    left = [_Hole(np.asarray(hole, np.float64), line) for hole in holes if len(hole) > 2]
    while left:
        edges = polygons.edges(line, *(hole.points for hole in left))
        hole = left.pop(int(np.argmin([hole.away.min() for hole in left])))
        j = hole.seam(edges)
        i = int(np.flatnonzero((line == hole.to[j]).all(1))[0])
        points = np.roll(hole.points, -j, axis=0)
        line = np.concatenate([line[: i + 1], points, points[:1], line[i:]])
        for other in left:
            other.meet(points)
    return line


class _Hole:
    """A hole that is not joined yet, and for each of its points the nearest point of the line."""

    def __init__(self, points: np.ndarray, line: np.ndarray):
        self.points, self.low, self.high = points, points.min(0), points.max(0)
        self.away, self.to = np.full(len(points), np.inf), np.zeros((len(points), 2))
        self.meet(line)

    def meet(self, line: np.ndarray) -> None:
        """Takes points of the line into account."""
        apart = np.maximum(np.maximum(self.low - line.max(0), line.min(0) - self.high), 0.0)
        if (apart**2).sum() >= self.away.max() ** 2:
            return
        step = max(PAIRS // len(line), 1)
        for start in range(0, len(self.points), step):
            span = slice(start, start + step)
            found = ((self.points[span, None] - line) ** 2).sum(2)
            which = found.argmin(1)
            away = np.sqrt(found.min(1))
            nearer = away < self.away[span]
            self.away[span][nearer] = away[nearer]
            self.to[span][nearer] = line[which[nearer]]

    def seam(self, edges) -> int:
        """The point from which the shortest seam goes that crosses no edge. Outlines that touch may have none: then the shortest."""
        order = np.argsort(self.away, kind="stable")
        fine = (j for j in order[:TRIED] if not _crosses(self.to[j], self.points[j], *edges))
        return int(next(fine, order[0]))


PAIRS = 1 << 20
"""Pairs of points that are compared together, so that the arrays stay small."""
TRIED = 60
"""Most seams that are tried for a hole."""


def _crosses(a: np.ndarray, b: np.ndarray, p: np.ndarray, q: np.ndarray) -> bool:
    """Whether the line from `a` to `b` crosses one of the edges from `p` to `q` at an inner point of both."""
    own = _side(a, b, p) * _side(a, b, q)
    other = _side(p, q, a) * _side(p, q, b)
    return bool(((own < 0) & (other < 0)).any())


def _side(a: np.ndarray, b: np.ndarray, p: np.ndarray) -> np.ndarray:
    d, e = b - a, p - a
    return np.sign(d[..., 0] * e[..., 1] - d[..., 1] * e[..., 0])


def parted(line: np.ndarray) -> list[np.ndarray]:
    """The loops of a line that `joined` made, as lists of indices: the outline first, then its holes."""
    keys = [point.tobytes() for point in np.ascontiguousarray(line)]
    found, stack = [], [list(range(len(line)))]
    while stack:
        loop = stack.pop()
        seam = _seam([keys[k] for k in loop])
        if seam is None:
            found.append(loop)
            continue
        a, b = seam
        inner = loop[a + 1 : b]
        outer = loop[: a + 1] + loop[b + 2 :]
        stack += [inner, outer]
    areas = [abs(polygons.area(line[loop][:, :2])) for loop in found]
    return [np.array(found[k], int) for k in np.argsort(areas, kind="stable")[::-1]]


def _seam(keys: list[bytes]) -> tuple[int, int] | None:
    """The first edge that is walked back later: the index of its start, and that of its start on the way back."""
    edges: dict[tuple[bytes, bytes], int] = {}
    for k, edge in enumerate(zip(keys, keys[1:])):
        back = edges.get(edge[::-1])
        if back is not None and k > back + 1:
            return back, k
        edges.setdefault(edge, k)
    return None


def clearance(loops: Sequence[np.ndarray], places: np.ndarray) -> np.ndarray:
    """The distance of places from the lines of a shape."""
    p, q = polygons.edges(*loops)
    way = q - p
    size = np.maximum((way**2).sum(1), 1e-12)
    found = np.empty(len(places))
    for start in range(0, len(places), polygons.CHUNK):
        off = places[start : start + polygons.CHUNK, None] - p
        along = ((off * way).sum(2) / size).clip(0, 1)[..., None]
        found[start : start + polygons.CHUNK] = np.sqrt(((off - along * way) ** 2).sum(2).min(1))
    return found


def middles(loops: Sequence[np.ndarray]) -> np.ndarray:
    """Places inside of a shape (N, 2): the middles of the stretches in which lines across and down the shape lie inside of it."""
    found = [_across(loops), _across([loop[:, ::-1] for loop in loops])[:, ::-1]]
    return np.concatenate(found)


def _across(loops: Sequence[np.ndarray]) -> np.ndarray:
    p, q = polygons.edges(*loops)
    low, high = p[:, 1].min(), p[:, 1].max()
    found = []
    for y in low + (high - low) * (np.arange(SCANS) + 0.5) / SCANS:
        over = (p[:, 1] > y) != (q[:, 1] > y)
        a, b = p[over], q[over]
        xs = np.sort(a[:, 0] + (y - a[:, 1]) / (b[:, 1] - a[:, 1]) * (b[:, 0] - a[:, 0]))
        pairs = xs[: len(xs) // 2 * 2].reshape(-1, 2)
        found += [(x, y) for x in pairs.mean(1)]
    return np.array(found, np.float64).reshape(-1, 2)
