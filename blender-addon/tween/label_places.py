"""Places for numbers beside lines on the screen. No number covers another, and numbers cover as little of the lines as
possible."""

from __future__ import annotations

import numpy as np

SHARES = (0.5, 0.35, 0.65, 0.2, 0.8, 0.05, 0.95)
"""Places along a line where its number may be, the best first."""
GAPS = (5.0, 24.0, 44.0)
"""Pixels between a line and its number: beside the line, or farther away with a stem between them."""
_FURTHER = 3
"""A number covers up to this number of cells of lines before it moves farther away."""
_CELL = 4
"""Side of a cell in pixels. Covered lines are counted in cells."""
_MOST_POINTS = 100_000


def anchors(lines: list[np.ndarray]) -> np.ndarray:
    """For each line (N, 3) and each share of its points the points before, at and after it: (lines, shares, 3, 3)."""
    found = np.full((len(lines), len(SHARES), 3, 3), np.nan)
    for line, row in zip(lines, found):
        if len(line):
            at = np.round(np.array(SHARES) * (len(line) - 1)).astype(int)
            row[:] = line[np.clip(at[:, None] + [-1, 0, 1], 0, len(line) - 1)]
    return found


def drawn(lines: list[np.ndarray]) -> np.ndarray:
    """Dense points (N, 3) along all lines, for `Covered`."""
    if not lines:
        return np.zeros((0, 3))
    points = np.vstack(lines)
    starts = np.cumsum([0] + [len(line) for line in lines])
    if len(points) > _MOST_POINTS:
        return points[:: -(-len(points) // _MOST_POINTS)]
    steps = max(1, min(8, _MOST_POINTS // max(len(points), 1)))
    within = np.ones(len(points), bool)
    within[starts[1:] - 1] = False
    first = np.flatnonzero(within)
    shares = (np.arange(steps) / steps)[:, None, None]
    between = points[first] + shares * (points[np.minimum(first + 1, len(points) - 1)] - points[first])
    return np.vstack([between.reshape(-1, 3), points[starts[1:] - 1]])


class Covered:
    """Counts the cells with lines that a box covers."""

    def __init__(self, points: np.ndarray, size: tuple[float, float]):
        """`points` (N, 2) are points along the lines in pixels."""
        self._shape = np.array([int(side) // _CELL + 1 for side in size])
        cells = np.floor(points[((points >= 0) & (points < size)).all(1)] / _CELL).astype(int)
        grid = np.zeros(self._shape, np.int32)
        grid[cells[:, 0], cells[:, 1]] = 1
        self._sums = np.pad(grid.cumsum(0).cumsum(1), ((1, 0), (1, 0)))

    def __call__(self, middles: np.ndarray, extents: np.ndarray) -> np.ndarray:
        """The counts of boxes around `middles` (..., 2). `extents` are half their width and height."""
        low = np.clip(np.floor((middles - extents) / _CELL).astype(int), 0, self._shape)
        high = np.clip(np.floor((middles + extents) / _CELL).astype(int) + 1, 0, self._shape)
        sums = self._sums
        (x0, y0), (x1, y1) = np.moveaxis(low, -1, 0), np.moveaxis(high, -1, 0)
        return sums[x1, y1] - sums[x0, y1] - sums[x1, y0] + sums[x0, y0]


def arrange(around: np.ndarray, extents: np.ndarray, covered: Covered, size: tuple, scale: float) -> list[tuple | None]:
    """For each line the middle of its number and the point of the line to which it belongs, in pixels; `None` if no place is free.

    `around` (lines, shares, 3, 2) is `anchors` on the screen. `extents` (lines, 2) are half the width and height of each number.
    `size` is the size of the region. Earlier lines choose first.
    """
    middles, on_line = _candidates(around, extents, scale)
    costs = covered(middles, extents[:, None]) + _FURTHER * np.repeat(range(len(GAPS)), len(SHARES) * 2)
    inside = ((middles >= extents[:, None]) & (middles <= np.array(size) - extents[:, None])).all(-1)
    taken = np.empty((len(around), 4))
    count, found = 0, []
    for middle, line, extent, cost, within in zip(middles, on_line, extents, costs, inside):
        apart = np.abs(middle[:, None] - taken[None, :count, :2]) >= extent + taken[None, :count, 2:] + 1
        free = np.flatnonzero(within & apart.any(-1).all(-1))
        if not len(free):
            found.append(None)
            continue
        best = free[np.argmin(cost[free])]
        taken[count] = *middle[best], *extent
        count += 1
        found.append((tuple(middle[best]), tuple(line[best])))
    return found


def _candidates(around: np.ndarray, extents: np.ndarray, scale: float) -> tuple[np.ndarray, np.ndarray]:
    """For each line the possible middles of its number, the best first, and their points on the line, both (lines, places, 2)."""
    along = around[:, :, 2] - around[:, :, 0]
    length = np.linalg.norm(along, axis=-1, keepdims=True)
    across = np.where(length > 1e-6, along[..., ::-1] * [-1, 1] / np.maximum(length, 1e-6), [0.0, 1.0])
    # (lines, gaps, shares, sides, 2)
    sides = np.stack([across, -across], axis=2)[:, None]
    off = (np.abs(sides) * extents[:, None, None, None]).sum(-1, keepdims=True)
    gaps = np.array(GAPS)[None, :, None, None, None] * scale
    shape = np.broadcast_shapes(sides.shape, gaps.shape)
    on_line = np.broadcast_to(around[:, None, :, None, 1], shape)
    middles = on_line + sides * (off + gaps)
    return middles.reshape(len(around), -1, 2), on_line.reshape(len(around), -1, 2)
