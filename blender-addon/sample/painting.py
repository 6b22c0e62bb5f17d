"""Filled shapes as pixels, with smooth edges. Plain NumPy, no Blender.

A shape is a polygon. Each row of pixels is crossed by `ROWS` lines; on each the spans inside the polygon (even-odd rule) are exact
in x. A pixel's cover is the mean of its lines. Coordinates: pixels, x right, y down, origin at the outer top-left corner.
"""

from __future__ import annotations

import math
import struct
import zlib
from pathlib import Path

import numpy as np

ROWS = 4
"""Lines through each row of pixels."""


def cover(polygon: np.ndarray, width: int, height: int) -> tuple[slice, slice, np.ndarray]:
    """Rows and columns of the box around a polygon (N, 2), and the share of each of its pixels that the polygon covers."""
    low = np.maximum(np.floor(polygon.min(0)).astype(int), 0)
    high = np.minimum(np.ceil(polygon.max(0)).astype(int), (width, height))
    rows, columns = max(high[1] - low[1], 0), max(high[0] - low[0], 0)
    found = np.zeros((rows, columns), np.float32)
    a, b = polygon, np.roll(polygon, -1, 0)
    left = np.arange(columns) + low[0]
    for line in range(rows * ROWS):
        y = low[1] + (line + 0.5) / ROWS
        crossing = (a[:, 1] <= y) != (b[:, 1] <= y)
        start, end = a[crossing], b[crossing]
        xs = np.sort(start[:, 0] + (y - start[:, 1]) * (end[:, 0] - start[:, 0]) / (end[:, 1] - start[:, 1]))
        for first, last in zip(xs[::2], xs[1::2]):
            found[line // ROWS] += np.clip(np.minimum(last, left + 1) - np.maximum(first, left), 0, 1)
    return slice(low[1], low[1] + rows), slice(low[0], low[0] + columns), found / ROWS


def fill(picture: np.ndarray, polygon: np.ndarray, colour: tuple[int, int, int]) -> None:
    """Paints a polygon on a picture (H, W, 3) of floats."""
    rows, columns, share = cover(polygon, picture.shape[1], picture.shape[0])
    if share.size:
        picture[rows, columns] += share[..., None] * (np.asarray(colour, np.float32) - picture[rows, columns])


def curve(points: np.ndarray, steps: int = 6) -> np.ndarray:
    """A smooth closed line through points (N, 2): a Catmull-Rom spline (Catmull & Rom 1974), `steps` points for each piece."""
    before, after, beyond = np.roll(points, 1, 0), np.roll(points, -1, 0), np.roll(points, -2, 0)
    t = (np.arange(steps) / steps)[None, :, None]
    p0, p1, p2, p3 = (each[:, None] for each in (before, points, after, beyond))
    line = p1 + t / 2 * (p2 - p0 + t * (2 * p0 - 5 * p1 + 4 * p2 - p3 + t * (3 * (p1 - p2) + p3 - p0)))
    return line.reshape(-1, 2)


def grown(polygon: np.ndarray, by: float) -> np.ndarray:
    """A polygon whose points are moved outwards along their normals."""
    along = np.roll(polygon, -1, 0) - np.roll(polygon, 1, 0)
    normal = np.stack([along[:, 1], -along[:, 0]], 1) / np.maximum(np.linalg.norm(along, axis=1, keepdims=True), 1e-9)
    area = np.sum(polygon[:, 0] * np.roll(polygon[:, 1], -1) - polygon[:, 1] * np.roll(polygon[:, 0], -1))
    return polygon + by * math.copysign(1.0, area) * normal


def write_png(path: Path, picture: np.ndarray) -> None:
    """Writes a picture (H, W, 3) of values 0 to 255 as PNG. The file is complete, or it does not appear."""
    pixels = np.clip(np.rint(picture), 0, 255).astype(np.uint8)
    height, width, _ = pixels.shape

    def chunk(kind: bytes, data: bytes) -> bytes:
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

    header = struct.pack(">IIBBBBB", width, height, 8, 2, 0, 0, 0)
    rows = b"".join(b"\0" + row.tobytes() for row in pixels)
    data = b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) + chunk(b"IDAT", zlib.compress(rows, 9)) + chunk(b"IEND", b"")
    unfinished = path.with_suffix(".unfinished")
    unfinished.write_bytes(data)
    unfinished.replace(path)
