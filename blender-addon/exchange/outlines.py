"""A document's contours as outlines for a mask. A part's outline has the same number of points on all frames."""

from __future__ import annotations

import numpy as np
from rototoon.documents import by_frame

from ..blender.masks import Outline
from ..capture import absence, snapping
from ..common import kept

SPACING = 4.0
"""Distance between the points of snapped lines, in pixels of the picture."""
MOST_POINTS = 200
"""Largest number of points of one segment."""


def outlines(document: dict, offset: int, snapped: bool) -> list[Outline]:
    """The outlines of a document's parts, the nearest first, as masks list their layers. `offset` is added to its frames."""
    found = []
    for part in sorted(document["parts"], key=lambda part: -part["depth"]):
        points = by_frame(part["keys"]) | by_frame(part.get("tracks"))
        curves = _complete(by_frame(part.get("curves")), points, part["closed"]) if snapped else {}
        counts = _counts(curves)
        frames = {
            frame + offset: _line(np.asarray(points[frame], np.float64), curves.get(frame), counts, part["closed"])
            for frame in sorted(points)
            if len(points[frame])
        }
        if frames:
            absent = {frame + offset for first, last in kept.pairs(part.get(absence.FIELD, []), int) for frame in _inside(first, last, points)}
            found.append(Outline(part["name"], part["closed"], frames, frozenset(absent - frames.keys())))
    return found


def _inside(first: int, last: int, points: dict[int, list]) -> range:
    """The frames of a time between the first and the last contour."""
    return range(max(first, min(points)), min(last, max(points)) + 1)


def _complete(curves: dict[int, list], points: dict[int, list], closed: bool) -> dict[int, list]:
    """The snapped lines that have a path for each segment."""
    return {f: paths for f, paths in curves.items() if snapping.complete(paths, len(points.get(f, ())), closed)}


def _counts(curves: dict[int, list]) -> np.ndarray:
    """Number of points of each segment, without its end; empty without snapped lines."""
    lengths = [[np.linalg.norm(np.diff(path, axis=0), axis=1).sum() for path in paths] for paths in curves.values()]
    if not lengths:
        return np.zeros(0, int)
    return np.clip(np.ceil(np.max(lengths, axis=0) / SPACING), 1, MOST_POINTS).astype(int)


def _line(points: np.ndarray, paths: list | None, counts: np.ndarray, closed: bool) -> np.ndarray:
    if not len(counts):
        return points
    straight = [np.stack((points[i], points[(i + 1) % len(points)])) for i in range(len(counts))]
    rows = [_resample(np.asarray(path, np.float64), n) for path, n in zip(paths or straight, counts, strict=True)]
    return np.concatenate(rows if closed else [*rows, points[-1:]])


def _resample(path: np.ndarray, count: int) -> np.ndarray:
    """`count` points at equal distances along a line, without its end."""
    along = np.concatenate(([0.0], np.cumsum(np.linalg.norm(np.diff(path, axis=0), axis=1))))
    wanted = np.linspace(0.0, along[-1], count, endpoint=False)
    return np.stack([np.interp(wanted, along, path[:, axis]) for axis in (0, 1)], axis=1)
