"""The plane in which drawings lie, for work that needs no view: fits and in-betweens.

`camera.plane_of` serves pictures, so it prefers planes that a camera sees. Here nothing looks at the drawing. A floor plan in XY or
a side view in YZ is as good as a front view in XZ: projected to another plane it would become a line.
"""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

FRONT = np.array([0.0, 1.0, 0.0])
"""The normal of XZ, on which Blender draws first."""
_LINE = 1e-3
"""Points are on a line if they are at most this share of its length broad."""
_FACING = 0.05
"""A normal turns to the front if it has at least this share of it."""


def normal(drawings: Iterable[np.ndarray]) -> np.ndarray:
    """The normal of the plane of drawings, each as points (N, 3). The first that is not a line shows it.

    Lines that all lie on one line are in many planes. Of these it is the one that faces the front.
    """
    lines = []
    for points in drawings:
        shown, _ = _shown(points)
        if shown is not None:
            return shown
        lines.append(points)
    if not lines:
        return FRONT
    shown, direction = _shown(np.concatenate(lines))
    return _through(direction) if shown is None else shown


def _shown(points: np.ndarray) -> tuple[np.ndarray | None, np.ndarray]:
    """The normal that points show, if they are not on a line, and the direction in which they are longest."""
    points = np.asarray(points, np.float64)
    spread = points - (points.mean(0) if len(points) else 0.0)
    if len(points) < 3:
        return None, spread[0] / (np.linalg.norm(spread[0]) or 1.0) if len(points) else np.zeros(3)
    _, sizes, axes = np.linalg.svd(spread[:: max(len(spread) // 4096, 1)], full_matrices=False)
    if sizes[1] <= _LINE * sizes[0]:
        return None, axes[0] if sizes[0] > 0 else np.zeros(3)
    on_front = np.abs(points @ FRONT).max() <= max(1e-4 * np.abs(spread).max(), 1e-7)
    return FRONT if on_front else _turned(axes[2]), axes[0]


def axes(normal: np.ndarray) -> np.ndarray:
    """(3, 3): the directions right, down, and away from the plane."""
    aside = np.eye(3)[np.abs(normal).argmin()]
    across = np.cross(normal, aside)
    across /= np.linalg.norm(across)
    return np.stack([across, np.cross(normal, across), normal])


def _turned(normal: np.ndarray) -> np.ndarray:
    """Seen edge-on from the front, a plane is seen from above or from the right."""
    if abs(normal @ FRONT) >= _FACING:
        return normal
    return -normal if normal[np.abs(normal).argmax()] > 0 else normal


def _through(direction: np.ndarray) -> np.ndarray:
    for facing in (FRONT, np.array([0.0, 0.0, -1.0])):
        apart = facing - (facing @ direction) * direction
        if (length := np.linalg.norm(apart)) > 0.1:
            return apart / length
    raise AssertionError("no direction is along two axes")
