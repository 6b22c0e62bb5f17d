"""Pieces of a picture that follow parts: a triangle mesh inside each closed contour.

It is the Delaunay triangulation of the contour and of a grid inside. The grid is coarse enough to be fast and fine enough to bend.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from mathutils import Vector
from mathutils.geometry import delaunay_2d_cdt
from rototoon.documents import by_frame

from ..blender.errors import Problem
from ..blender.picture_mesh import Piece

CELLS = 12
"""Number of cells of the grid along a part's longer side."""
INSIDE = 1
"""Blender's number for triangles inside the given faces."""


def pieces(project: dict[str, Any], border: float) -> list[Piece]:
    """Meshes of a drawing's closed parts, `border` pixels larger than their contours."""
    found = []
    for part in project["parts"]:
        contour = next(iter(by_frame(part["keys"]).values()), None)
        if part["closed"] and contour is not None and len(contour) > 2:
            found.append(triangulated(part["name"], widened(np.asarray(contour, np.float64), border)))
    if not found:
        raise Problem("No closed contour on the drawing: the picture is cut along closed contours")
    return found


def widened(ring: np.ndarray, border: float) -> np.ndarray:
    """Moves a closed line outward by `border`."""
    if not border:
        return ring
    way = np.roll(ring, -1, 0) - np.roll(ring, 1, 0)
    normal = np.stack([way[:, 1], -way[:, 0]], 1)
    normal /= np.maximum(np.linalg.norm(normal, axis=1, keepdims=True), 1e-9)
    x, y = ring.T
    turned = np.sign((x * np.roll(y, -1) - np.roll(x, -1) * y).sum()) or 1.0
    return ring + normal * border * turned


def triangulated(name: str, ring: np.ndarray) -> Piece:
    """The mesh inside a closed line."""
    low, high = ring.min(0), ring.max(0)
    step = float((high - low).max()) / CELLS
    if step <= 0:
        raise Problem(f'The contour of "{name}" is a single spot')
    axes = [np.arange(a + step / 2, b, step) for a, b in zip(low, high)]
    grid = np.stack(np.meshgrid(*axes), -1).reshape(-1, 2)
    inner = grid[_well_inside(grid, ring, 0.4 * step)]
    given = np.concatenate([ring, inner])
    made = delaunay_2d_cdt([Vector(p) for p in given], [], [list(range(len(ring)))], INSIDE, 1e-6 * step)
    points, _, faces, origins = made[:4]
    # Blender may reorder points and add some. The given points come first, in their order.
    order = {}
    for number, sources in enumerate(origins):
        for source in sources:
            order.setdefault(source, number)
    numbers = [order[k] for k in range(len(given)) if k in order]
    numbers += [k for k in range(len(points)) if k not in set(numbers)]
    place = {number: k for k, number in reversed(list(enumerate(numbers)))}
    triangles = np.array([[place[k] for k in face] for face in faces if len(face) == 3], np.int32).reshape(-1, 3)
    return Piece(name, np.array([points[k] for k in numbers], np.float64), triangles)


def _well_inside(points: np.ndarray, ring: np.ndarray, least: float) -> np.ndarray:
    """Which points are inside a closed line, and at least a distance from it."""
    x, y = points.T
    inside, apart = np.zeros(len(points), bool), np.full(len(points), np.inf)
    for a, b in zip(ring, np.roll(ring, -1, 0)):
        along = b - a
        if along[1]:
            inside ^= ((a[1] > y) != (b[1] > y)) & (x < a[0] + (y - a[1]) / along[1] * along[0])
        share = np.clip(((points - a) @ along) / max(float(along @ along), 1e-12), 0, 1)
        apart = np.minimum(apart, np.linalg.norm(points - a - share[:, None] * along, axis=1))
    return inside & (apart >= least)
