"""What the artist corrected on generated strokes: pins and centres.

Tracking notes where it put each point. A point that lies elsewhere now was moved by the artist and becomes a pin; if all
points moved alike the artist moved the part as a whole, which corrects its centre. Earlier pins and centres stay until
they are released. Positions of pins are kept bit for bit, so that a correction which was not touched is equal from run
to run, and its span need not be solved again.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from ..blender import grease_pencil as gp
from ..blender.placement import Mapper
from .contours import Contours, Part

MOVED = 0.05
"""Pixels: less than this is no movement; far above single precision, far below what a hand can mean."""
ALIKE = 0.1
"""Points moved alike if their shifts differ from the mean shift by less than this share of it…"""
ALIKE_FLOOR = 0.25
"""…or by less than this many pixels."""


@dataclass
class Corrections:
    """Corrections of one part by scene frame."""

    pins: dict[int, dict[int, np.ndarray]] = field(default_factory=dict)
    """Pixels by frame and control point."""
    centers: dict[int, np.ndarray] = field(default_factory=dict)
    """Pixels by frame."""
    held: dict[int, np.ndarray] = field(default_factory=dict)
    """By frame, the stroke's points in layer space as the artist left them."""


def detect(found: Contours, mapper: Mapper) -> dict[int, Corrections]:
    """Corrections by part number, for frames strictly between keys of the part, or beside its only key."""
    return {part.number: _of_part(part, found, mapper) for part in found.parts}


def _of_part(part: Part, found: Contours, mapper: Mapper) -> Corrections:
    corrections = Corrections()
    for frame, stroke in part.made.items():
        if not correctable(part.keys, frame):
            continue
        drawing = found.drawings[stroke.layer, frame]
        if not gp.has(drawing.handle, gp.TRACKED):
            continue
        pinned = drawing.value(gp.PIN)[stroke.span].copy()
        center = drawing.value(gp.CENTER)[stroke.index].astype(np.float64)
        tracked = drawing.value(gp.TRACKED)[stroke.span]
        has_center = center[2] != 0
        if not np.array_equal(tracked, stroke.points):
            mapping = mapper.at(stroke.layer, frame)
            points = mapping.to_pixels(stroke.points)
            moved, whole = compare(mapping.to_pixels(tracked), points)
            if whole:
                center, has_center = _single(np.append(points.mean(0), 1.0)), True
            else:
                pinned |= moved
        if pinned.any():
            points = mapper.at(stroke.layer, frame).to_pixels(stroke.points)
            corrections.pins[frame] = {int(i): points[i] for i in np.flatnonzero(pinned)}
            corrections.held[frame] = stroke.points
        if has_center:
            corrections.centers[frame] = center[:2]
    return corrections


def correctable(keys, frame: int) -> bool:
    """Whether a correction on a frame has an effect: it lies between two keys, or beside the only one."""
    if not keys or frame in keys:
        return False
    return len(keys) == 1 or min(keys) < frame < max(keys)


def compare(before: np.ndarray, after: np.ndarray) -> tuple[np.ndarray, bool]:
    """Which points moved, and whether all of them moved alike; pixels (N, 2)."""
    shift = after - before
    moved = np.linalg.norm(shift, axis=1) > MOVED
    if len(shift) < 2 or not moved.all():
        return moved, False
    mean = shift.mean(0)
    spread = np.linalg.norm(shift - mean, axis=1).max()
    return moved, bool(spread < max(ALIKE * np.linalg.norm(mean), ALIKE_FLOOR))


def _single(values: np.ndarray) -> np.ndarray:
    """Rounded to what the file can hold, so that it is read back equal."""
    return values.astype(np.float32).astype(np.float64)


def release(drawing, points: np.ndarray | None) -> int:
    """Releases pins (all, or where the mask `points` says) and centres of a drawing's generated strokes.

    Where a released point lies now counts as tracked, so that it is not taken for moved again. Returns how many.
    """
    starts = gp.offsets(drawing)
    total, strokes = int(starts[-1]), len(starts) - 1
    mask = np.ones(total, bool) if points is None else points
    made = gp.value(drawing, gp.MADE, strokes)
    mask = mask & np.repeat(made, np.diff(starts))
    position, tracked = gp.positions(drawing, total), gp.get(drawing, gp.TRACKED, total)
    if tracked is None:
        return 0
    pinned = gp.value(drawing, gp.PIN, total)
    moved = (position != tracked).any(1)
    whole = np.zeros(strokes, bool)
    if total:
        whole = np.add.reduceat(mask, np.minimum(starts[:-1], total - 1)) > 0
    centers = gp.value(drawing, gp.CENTER, strokes)
    released = int(((pinned | moved) & mask).sum() + ((centers[:, 2] != 0) & whole).sum())
    tracked[mask] = position[mask]
    pinned[mask] = False
    centers[whole] = 0
    gp.put(drawing, gp.TRACKED, tracked)
    gp.put(drawing, gp.PIN, pinned)
    gp.put(drawing, gp.CENTER, centers)
    return released
