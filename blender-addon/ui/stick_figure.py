"""Stick figures of skeleton clips: their lines, and small pictures. Plain NumPy.

The left side, the right side and the middle have different colours, so that it is clear which leg is in front.
"""

from __future__ import annotations

import math

import numpy as np
from rototoon.style import Skeleton

RINGED = ("head", "head_top")
"""A line between these key points is drawn as a ring: the head of a human."""
LEFT, RIGHT, MIDDLE = (0.36, 0.68, 1.0), (1.0, 0.62, 0.25), (0.52, 0.52, 0.52)
"""They are seen on the panels of the dark and of the light theme."""
MARGIN = 0.08
"""Margin of a picture, as a share of its side."""


def colour(body: Skeleton, point: int) -> tuple[float, float, float]:
    """Colour of the line that ends at a key point."""
    name = body.points[point]
    return LEFT if name.startswith("l_") else RIGHT if name.startswith("r_") else MIDDLE


def lines(body: Skeleton, posture: np.ndarray, ring: int = 16) -> list[tuple[int, np.ndarray]]:
    """Lines (N, 2) of a posture (key points, 2), each with the key point at its end. Right ones come last, so they are in front."""
    found, heads = [], []
    for child in range(1, len(body.points)):
        ends = posture[[body.parents[child], child]]
        if (body.points[body.parents[child]], body.points[child]) == RINGED:
            heads.append((child, _circle(ends, ring)))
        else:
            found.append((child, ends))
    found.sort(key=lambda line: (body.points[line[0]].startswith("r_"), not body.points[line[0]].startswith("l_")))
    return found + heads


def _circle(ends: np.ndarray, ring: int) -> np.ndarray:
    """The circle whose diameter has these ends."""
    angles = np.linspace(0, 2 * np.pi, ring + 1)
    radius = np.linalg.norm(ends[1] - ends[0]) * 0.5
    return ends.mean(0) + radius * np.stack([np.cos(angles), np.sin(angles)], 1)


def fitted(postures: np.ndarray, box: np.ndarray) -> np.ndarray:
    """Postures (F, key points, 2) of a clip in a box ((left, top), (right, bottom)): all at one scale and place, on the bottom of
    the box."""
    # The figure stays in its place: with room for a walk it would be too small.
    postures = postures - postures[:, :1] * [1.0, 0.0]
    low, high = postures.min((0, 1)), postures.max((0, 1))
    size = np.maximum(high - low, 1e-9)
    scale = float(((box[1] - box[0]) / size).min())
    foot = np.array([(low[0] + high[0]) / 2, high[1]])
    return (postures - foot) * scale + [(box[0][0] + box[1][0]) / 2, box[1][1]]


def picture(body: Skeleton, posture: np.ndarray, size: int, thickness: float | None = None) -> np.ndarray:
    """Float RGBA (size, size, 4) of a posture in pixels, x right, y down. Row 0 of the picture is its bottom row."""
    half = max(size / 40, 0.6) if thickness is None else thickness / 2
    result = np.zeros((size, size, 4), np.float32)
    for point, line in lines(body, posture):
        # Only pixels near the line.
        reach = half + 1
        (left, top), (right, bottom) = line.min(0) - reach, line.max(0) + reach
        columns = slice(*np.clip([int(left), int(right) + 1], 0, size))
        rows = slice(*np.clip([int(size - bottom), int(size - top) + 1], 0, size))
        x, y = np.meshgrid(np.arange(size)[columns] + 0.5, size - np.arange(size)[rows] - 0.5)
        distance = np.full(x.shape, np.inf)
        for a, b in zip(line[:-1], line[1:]):
            np.minimum(distance, _distance(x, y, a, b), out=distance)
        cover = np.clip(half + 0.5 - distance, 0, 1)[..., None]
        result[rows, columns] += cover * (np.array([*colour(body, point), 1.0]) - result[rows, columns])
    result[..., :3] /= np.maximum(result[..., 3:], 1e-6)
    return result


def _distance(x: np.ndarray, y: np.ndarray, a: np.ndarray, b: np.ndarray) -> np.ndarray:
    along = b - a
    share = ((x - a[0]) * along[0] + (y - a[1]) * along[1]) / max(float(along @ along), 1e-12)
    share = np.clip(share, 0, 1)
    return np.hypot(x - a[0] - share * along[0], y - a[1] - share * along[1])


def box(size: int) -> np.ndarray:
    """The box of a figure in a square picture."""
    return np.array([[MARGIN, MARGIN], [1 - MARGIN, 1 - MARGIN]]) * size


def moment(frame: int, start: int, fps: float, own_fps: float, count: int) -> int:
    """Index of the posture on a frame of the scene. The clip starts on the scene's first frame and repeats."""
    return math.floor((frame - start) * own_fps / fps + 1e-6) % max(count, 1)
