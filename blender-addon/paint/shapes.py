"""Outlines with holes as one closed line, and places well inside of shapes.

A hole is joined to the outline by a seam: a line that is walked there and back. So a region with holes is one stroke in every version of
Blender, and an artist chooses or recolours it with one click.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

SCANS = 24
"""Number of lines across and down a shape on which places inside of it are looked for."""


def joined(outline: np.ndarray, holes: Sequence[np.ndarray]) -> np.ndarray:
    """An outline (N, 2) and its holes as one closed line. The next hole is always the nearest, by a seam that crosses nothing."""
    line, left = np.asarray(outline, np.float64), [np.asarray(hole, np.float64) for hole in holes if len(hole) > 2]
    while left:
        seams = [_nearest(line, hole) for hole in left]
        k = int(np.argmin([seam[0] for seam in seams]))
        edges = _edges(line, *left)
        i, j = _free_seam(line, left[k], seams[k][1:], edges)
        hole = np.roll(left.pop(k), -j, axis=0)
        line = np.concatenate([line[: i + 1], hole, hole[:1], line[i:]])
    return line


def _nearest(line: np.ndarray, hole: np.ndarray) -> tuple[float, int, int]:
    away = np.linalg.norm(line[:, None] - hole[None], axis=2)
    i, j = np.unravel_index(int(away.argmin()), away.shape)
    return float(away[i, j]), int(i), int(j)


def _edges(*loops: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    return np.concatenate(loops), np.concatenate([np.roll(loop, -1, axis=0) for loop in loops])


def _free_seam(line, hole, nearest: tuple[int, int], edges) -> tuple[int, int]:
    """The shortest seam that crosses no edge. If there is none, as between outlines that touch, the nearest points make it."""
    away = np.linalg.norm(line[:, None] - hole[None], axis=2)
    for place in np.argsort(away, axis=None, kind="stable")[:TRIED]:
        i, j = np.unravel_index(int(place), away.shape)
        if not _crosses(line[i], hole[j], *edges):
            return int(i), int(j)
    return nearest


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
    areas = [abs(area(line[loop][:, :2])) for loop in found]
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


def area(loop: np.ndarray) -> float:
    """The area of a closed line (N, 2), with the sign of its direction."""
    x, y = loop[:, 0], loop[:, 1]
    return float(x @ np.roll(y, -1) - y @ np.roll(x, -1)) / 2


def inside(loops: Sequence[np.ndarray], places: np.ndarray) -> np.ndarray:
    """Which places (N, 2) are inside of a shape, which has an odd number of loops around each."""
    found = np.zeros(len(places), bool)
    if not len(loops) or not len(places):
        return found
    p, q = _edges(*loops)
    for start in range(0, len(places), CHUNK):
        x, y = places[start : start + CHUNK].T[..., None]
        over = (p[:, 1] > y) != (q[:, 1] > y)
        with np.errstate(divide="ignore", invalid="ignore"):
            at = p[:, 0] + (y - p[:, 1]) / (q[:, 1] - p[:, 1]) * (q[:, 0] - p[:, 0])
        found[start : start + CHUNK] = (over & (x < at)).sum(1) % 2 == 1
    return found


CHUNK = 256
"""Places that are looked at together, so that the arrays stay small."""


def clearance(loops: Sequence[np.ndarray], places: np.ndarray) -> np.ndarray:
    """The distance of places from the lines of a shape."""
    p, q = _edges(*loops)
    way = q - p
    size = np.maximum((way**2).sum(1), 1e-12)
    found = np.empty(len(places))
    for start in range(0, len(places), CHUNK):
        off = places[start : start + CHUNK, None] - p
        along = ((off * way).sum(2) / size).clip(0, 1)[..., None]
        found[start : start + CHUNK] = np.sqrt(((off - along * way) ** 2).sum(2).min(1))
    return found


def middles(loops: Sequence[np.ndarray]) -> np.ndarray:
    """Places inside of a shape (N, 2): the middles of the stretches in which lines across and down the shape lie inside of it."""
    found = [_across(loops), _across([loop[:, ::-1] for loop in loops])[:, ::-1]]
    return np.concatenate(found)


def _across(loops: Sequence[np.ndarray]) -> np.ndarray:
    p, q = _edges(*loops)
    low, high = p[:, 1].min(), p[:, 1].max()
    found = []
    for y in low + (high - low) * (np.arange(SCANS) + 0.5) / SCANS:
        over = (p[:, 1] > y) != (q[:, 1] > y)
        a, b = p[over], q[over]
        xs = np.sort(a[:, 0] + (y - a[:, 1]) / (b[:, 1] - a[:, 1]) * (b[:, 0] - a[:, 0]))
        pairs = xs[: len(xs) // 2 * 2].reshape(-1, 2)
        found += [(x, y) for x in pairs.mean(1)]
    return np.array(found, np.float64).reshape(-1, 2)
