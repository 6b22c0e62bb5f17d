"""Drawings of the artist that lie on nothing: their picture was drawn anew.

What: a drawing that the artist has made or changed stays as it is, whatever its picture shows. Where the picture was replaced under the same name, its
strokes lie beside the new lines. `find` compares each such drawing with the lines of its own picture, `strokes_off` says which of its strokes lie for
the most part off these lines, and `mark` notes them on the strokes (`rototoon_off_ink`).

How: the picture is traced for itself, all its ink, in any colour. A point of a stroke is on a line if one is nearer than two of the picture's line widths.
A stroke with more than half of its length elsewhere is off. A drawing is named if a tenth of its length is in such strokes.

Why so: the corrected drawing of a test had 0 of 4,720 px off its picture's lines, and 1,123 px after the picture was drawn anew, with 8 of 44 strokes for the most
part off. A stroke or two that an artist adds where the picture has none are no sign of another picture.

Limits: what lies on another line by chance counts as on the ink. Strokes beyond the picture's edge are not looked at. Traced for itself a picture costs
about what it costs in the run; the library remembers it.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from rototoon.lines import Traced

from ..blender import grease_pencil as gp
from ..blender import stroke_lines
from ..blender import strokes as st

if TYPE_CHECKING:
    from . import plan as pl

NEAR = 2.0
"""Distance at which a line still explains a point, in widths of a line."""
LEAST = 1.5
"""Width of a line in pixels at least, and where the picture tells none."""
MOST = 0.5
"""Share of a stroke's length from which on it is off."""
NAMED = 0.1
"""Share of a drawing's length in such strokes from which on the drawing is named."""

Trace = Callable[[dict[str, Any], str, tuple[int, int]], Traced]
"""Traces the pictures of a document in a folder, from the first to the last number."""


def find(plan: pl.Plan, trace: Trace) -> None:
    """Traces the pictures of the artist's drawings for themselves. Uses no Blender."""
    for group in (each for each in plan.groups if each.new):
        own = {frame for layer in group.layers for frame in layer.keys if plan.first <= frame <= plan.last}
        for frame in sorted(own - plan.inks.keys()):
            number = frame - plan.offset
            plan.inks[frame] = trace({**group.document, "drawings": []}, group.folder, (number, number))


def strokes_off(content: st.Content, mapping, found: Traced, size: tuple[int, int]) -> np.ndarray:
    """For each stroke of a drawing of the artist: whether it lies for the most part off the lines of its picture. If these are few, none is, and neither
    on a picture without lines: there the artist drew what the film has not."""
    if not len(found.tracks):
        return np.zeros(len(content.sizes), bool)
    points, ends = np.asarray(found.points, np.float64).reshape(-1, 2), np.asarray(found.point_offsets)
    lines = [dense(points[a:b], bool(shut)) for a, b, shut in zip(ends, ends[1:], np.asarray(found.closed), strict=False)]
    ink = Ink(lines, np.asarray(found.widths, np.float64), size)
    shares, lengths = np.zeros(len(content.sizes)), np.zeros(len(content.sizes))
    for i, line in enumerate(stroke_lines.lines(content)):
        if len(line) and np.isfinite(line).all():
            points = dense(mapping.to_pixels(line))
            lengths[i], shares[i] = len(points), ink.off(points)
    off = shares > MOST
    return off if lengths[off].sum() > NAMED * max(lengths.sum(), 1.0) else np.zeros_like(off)


def mark(handle, off: np.ndarray) -> None:
    """Notes the strokes that are off on a drawing."""
    if off.any() or gp.has(handle, gp.OFF_INK):
        gp.put(handle, gp.OFF_INK, off)


class Ink:
    """The places of a picture that lines explain."""

    def __init__(self, lines: Sequence[np.ndarray], widths: np.ndarray, size: tuple[int, int]):
        width, height = size
        self._mask = np.zeros((height, width), bool)
        known = widths[np.isfinite(widths)]
        reach = NEAR * max(float(np.median(known)) if len(known) else 0.0, LEAST)
        places = np.floor(np.concatenate(lines)).astype(int) if lines else np.zeros((0, 2), int)
        span = np.arange(-int(reach), int(reach) + 1)
        for dx, dy in ((dx, dy) for dx in span for dy in span if dx * dx + dy * dy <= reach * reach):
            x, y = places[:, 0] + dx, places[:, 1] + dy
            inside = (x >= 0) & (x < width) & (y >= 0) & (y < height)
            self._mask[y[inside], x[inside]] = True

    def off(self, points: np.ndarray) -> float:
        """The share of points in the picture that no line explains."""
        places = np.floor(points).astype(int)
        inside = ((places >= 0) & (places < self._mask.shape[::-1])).all(1)
        if not inside.any():
            return 0.0
        x, y = places[inside].T
        return float((~self._mask[y, x]).mean())


def dense(points: np.ndarray, closed: bool = False) -> np.ndarray:
    """Points on a line, one a pixel."""
    line = np.concatenate([points, points[:1]]) if closed else points
    along = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(line, axis=0), axis=1))])
    where = np.arange(0.0, along[-1] + 0.5)
    return np.stack([np.interp(where, along, line[:, k]) for k in (0, 1)], 1)
