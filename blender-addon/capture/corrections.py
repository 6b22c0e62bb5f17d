"""The artist's corrections of generated strokes: pins and centres.

Tracking stores where it put each point. If a point is elsewhere now, the artist moved it, and it becomes a pin. If all points
moved in the same way, the artist moved the whole line. The object's setting `moved_line` says what this means:

- `KEEP`: every point becomes a pin, so the line keeps place and shape, as a line that was turned or scaled does.
- `SETTLE`: only the centre is corrected. The part is looked for there, and takes its shape from the drawing.

Pins and centres stay until they are released. Positions of pins are kept bit for bit. So an unchanged correction is equal in every run,
and its span is not solved again. A centre that a file brought along stays, also with `KEEP`, until its line is moved again.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from ..blender import grease_pencil as gp
from ..blender.placement import Mapper
from ..common.wording import listed
from .contours import Contours, Part, Stroke

MOVED = 0.05
"""Pixels. A smaller shift is no movement. This is far above the error of single precision, and far below what a hand does on
purpose."""
ALIKE = 0.1
"""Points moved in the same way if their shifts differ from the mean shift by less than this share of it …"""
ALIKE_FLOOR = 0.25
"""… or by less than this number of pixels."""


@dataclass
class Corrections:
    """Corrections of one part by scene frame."""

    pins: dict[int, dict[int, np.ndarray]] = field(default_factory=dict)
    """Pixels by frame and index of the control point."""
    centers: dict[int, np.ndarray] = field(default_factory=dict)
    """Pixels by frame."""
    held: dict[int, np.ndarray] = field(default_factory=dict)
    """By frame the stroke's points in layer space, as the artist left them."""
    whole: list[int] = field(default_factory=list)
    """Frames on which the artist moved every point since the last time, and all of them hold: a line that was moved, turned or scaled."""
    sought: list[int] = field(default_factory=list)
    """Frames on which the artist moved the whole line since the last time, and its centre alone is corrected."""


def detect(found: Contours, mapper: Mapper, settles: bool = False) -> dict[int, Corrections]:
    """Corrections by part number, on frames strictly between two keys of the part, or beside its only key.

    With `settles`, a line that was moved as a whole corrects the part's centre only.
    """
    corrected = {place: drawing.corrected() for place, drawing in found.drawings.items()}
    return {part.number: _of_part(part, found, corrected, mapper, settles) for part in found.parts}


def _of_part(
    part: Part, found: Contours, corrected: dict[tuple[int, int], np.ndarray], mapper: Mapper, settles: bool
) -> Corrections:
    corrections = Corrections()
    for frame, stroke in part.made.items():
        if not corrected[stroke.layer, frame][stroke.index] or not correctable(part.keys, frame):
            continue
        drawing = found.drawings[stroke.layer, frame]
        pinned = drawing.value(gp.PIN)[stroke.span].copy()
        center = drawing.value(gp.CENTER)[stroke.index].astype(np.float64)
        tracked = drawing.value(gp.TRACKED)[stroke.span]
        has_center = center[2] != 0
        if not np.array_equal(tracked, stroke.points):
            mapping = mapper.at(stroke.layer, frame)
            points = mapping.to_pixels(stroke.points)
            moved, whole = compare(mapping.to_pixels(tracked), points)
            if moved.all():
                (corrections.sought if whole and settles else corrections.whole).append(frame)
            if whole and settles:
                center, has_center = _single(np.append(points.mean(0), 1.0)), True
            else:
                pinned |= moved
                # Points that all hold leave nothing to an older centre.
                has_center = has_center and not moved.all()
        if pinned.any():
            points = mapper.at(stroke.layer, frame).to_pixels(stroke.points)
            corrections.pins[frame] = {int(i): points[i] for i in np.flatnonzero(pinned)}
            corrections.held[frame] = stroke.points
        if has_center:
            corrections.centers[frame] = center[:2]
    return corrections


def lost(found: Contours, outward: bool) -> list[str]:
    """What is to be told of corrections that the next Track removes. `outward` is whether it tracks parts with one key."""
    recounted: dict[str, set[int]] = {}
    names = {part.number: part.name for part in found.parts}
    for stroke in found.old:
        if _is_corrected(found, stroke):
            recounted.setdefault(names[stroke.part], set()).add(stroke.frame)
    beyond: dict[str, set[int]] = {}
    for part in found.parts:
        tracked = len(part.keys) > 1 or outward
        frames = [frame for frame in part.made.keys() - part.keys.keys() if not tracked or not correctable(part.keys, frame)]
        frames = {frame for frame in frames if _is_corrected(found, part.made[frame])}
        if frames:
            beyond[part.name] = frames
    reasons = ((recounted, "its keys have another number of points"), (beyond, "no key holds it there"))
    return [
        f'your corrections of "{name}" on {listed(sorted(frames))} are gone, since {reason}: Undo brings them back'
        for lost_ones, reason in reasons
        for name, frames in lost_ones.items()
    ]


def _is_corrected(found: Contours, stroke: Stroke) -> bool:
    return stroke.layer not in found.closed and bool(found.drawings[stroke.layer, stroke.frame].corrected()[stroke.index])


def correctable(keys, frame: int) -> bool:
    """Whether a correction on a frame has an effect: the frame is between two keys, or beside the only key."""
    if not keys or frame in keys:
        return False
    return len(keys) == 1 or min(keys) < frame < max(keys)


def compare(before: np.ndarray, after: np.ndarray) -> tuple[np.ndarray, bool]:
    """Which points (N, 2) in pixels moved, and whether all of them moved in the same way."""
    shift = after - before
    moved = np.linalg.norm(shift, axis=1) > MOVED
    if len(shift) < 2 or not moved.all():
        return moved, False
    mean = shift.mean(0)
    spread = np.linalg.norm(shift - mean, axis=1).max()
    return moved, bool(spread < max(ALIKE * np.linalg.norm(mean), ALIKE_FLOOR))


def _single(values: np.ndarray) -> np.ndarray:
    """Values rounded to single precision, as in the file, so that they are read back equal."""
    return values.astype(np.float32).astype(np.float64)


def release(drawing, points: np.ndarray | None) -> int:
    """Releases pins and centres of a drawing's generated strokes; with the mask `points`, only there.

    The current place of a released point counts as tracked, so that the point does not count as moved again. Returns the number
    of released pins and centres.
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
