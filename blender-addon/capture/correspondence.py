"""Places of control points on a drawn stroke.

A part of a document has the same number of control points on every key. The artist's strokes may have any number of points. So
each drawn point carries a control number. The numbers rise along the stroke, or fall if it was drawn the other way round, with
fractions between control points. Where they cross the integer `i`, control point `i` is on the drawn line. The numbers are a
point attribute: Blender moves, copies, saves and undoes them with the stroke, and blends them when points are subdivided or
dissolved. The artist's points are never changed.

Plain NumPy.
"""

from __future__ import annotations

import numpy as np


def identity(count: int) -> np.ndarray:
    """Control numbers of a stroke whose drawn points are the control points."""
    return np.arange(count, dtype=np.float32)


def is_identity(control: np.ndarray, count: int) -> bool:
    """Whether the drawn points are the control points, in order."""
    return len(control) == count and np.array_equal(control, np.arange(count))


def invert(values: np.ndarray, period: int, closed: bool) -> np.ndarray | None:
    """Fractional indices at which `values` cross 0, 1, …, `period` - 1; `None` if the values neither rise nor fall.

    Open: values run from 0 to `period` - 1 or back. Closed: values run once around modulo `period`, in either direction, and the
    indices run once around modulo `len(values)`.
    """
    values = np.asarray(values, np.float64)
    size = len(values)
    if size == 0 or period == 0 or not np.isfinite(values).all():
        return None
    if size == 1 or period == 1:
        return np.zeros(period) if size == 1 else np.full(period, float(np.argmin(np.abs(values))))
    return _invert_closed(values, period) if closed else _invert_open(values, period)


def _invert_open(values: np.ndarray, period: int) -> np.ndarray | None:
    steps = np.diff(values)
    index = np.arange(len(values), dtype=np.float64)
    if (steps >= 0).all() and values[-1] > values[0]:
        return np.interp(np.arange(period), values, index)
    if (steps <= 0).all() and values[-1] < values[0]:
        return np.interp(np.arange(period), values[::-1], index[::-1])
    return None


def _invert_closed(values: np.ndarray, period: int) -> np.ndarray | None:
    steps = np.roll(values, -1) - values
    size = len(values)
    index = np.arange(size + 1, dtype=np.float64)
    forward = np.mod(steps, period)
    if abs(forward.sum() - period) < 1e-3 * period:
        along = values[0] + np.concatenate([[0.0], np.cumsum(forward)])
        wanted = along[0] + np.mod(np.arange(period) - along[0], period)
        return np.mod(np.interp(wanted, along, index), size)
    backward = np.mod(-steps, period)
    if abs(backward.sum() - period) < 1e-3 * period:
        along = -values[0] + np.concatenate([[0.0], np.cumsum(backward)])
        wanted = along[0] + np.mod(-np.arange(period) - along[0], period)
        return np.mod(np.interp(wanted, along, index), size)
    return None


def sample(rows: np.ndarray, where: np.ndarray, closed: bool) -> np.ndarray:
    """Values of a stroke (positions, radii, colours, …) at fractional indices, interpolated linearly."""
    rows = np.asarray(rows)
    size = len(rows)
    low = np.clip(np.floor(where).astype(int), 0, size - 1)
    high = (low + 1) % size if closed else np.minimum(low + 1, size - 1)
    share = (where - low).astype(np.float64)
    if rows.ndim > 1:
        share = share[:, None]
    return rows[low] * (1 - share) + rows[high] * share


def locate(polyline: np.ndarray, points: np.ndarray, closed: bool) -> np.ndarray:
    """Fractional indices of the points on a polyline (N, 2) that are nearest to `points` (M, 2)."""
    ends = np.roll(polyline, -1, 0) if closed else polyline[1:]
    starts = polyline if closed else polyline[:-1]
    if not len(starts):
        return np.zeros(len(points))
    along = ends - starts
    length = np.maximum((along**2).sum(1), 1e-30)
    share = np.clip(((points[:, None] - starts) * along).sum(2) / length, 0, 1)
    nearest = starts + share[..., None] * along
    distance = ((points[:, None] - nearest) ** 2).sum(2)
    segment = distance.argmin(1)
    share = share[np.arange(len(points)), segment]
    where = segment + np.where(share < 1e-9, 0.0, np.where(share > 1 - 1e-9, 1.0, share))
    return np.mod(where, len(polyline)) if closed else where
