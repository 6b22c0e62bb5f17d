"""Where an object's work stands: what the panels say, and which step comes next.

Reading it costs one look at the drawings that the artist made; of generated drawings only the pins are read. They are read from a copy,
which Blender does not allow while it draws panels. So panels are told what was read last, and a moment after a change `arrivals`
reads again.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import bpy
import numpy as np
from bpy.app.handlers import persistent

from ..blender import grease_pencil as gp


@dataclass
class Stand:
    """An object's content, counted."""

    footage: bool = False
    keys: dict[int, int] = field(default_factory=dict)
    """Number of the artist's contours by scene frame."""
    loose: dict[int, int] = field(default_factory=dict)
    """Number of those that belong to no part yet, by scene frame."""
    numbers: set[int] = field(default_factory=set)
    """Numbers of the parts that the artist's contours belong to."""
    tracked: int = 0
    """Number of generated drawings."""
    corrected: bool = False
    """Whether a generated contour has a pin or a corrected centre."""
    moved: bool = False
    """Whether generated points on the scene's frame were moved since the last Track."""
    snapped: bool = False
    copied: bool = False
    """Whether the contours on two key frames are equal: a key was copied, and is not fitted yet."""
    _shapes: set[bytes] = field(default_factory=set)

    @property
    def strokes(self) -> int:
        """Number of the artist's contours."""
        return sum(self.keys.values())


_kept: dict[int, Stand] = {}


def of(ob: bpy.types.Object) -> Stand:
    """Where the work on an object stood when it was read last."""
    stand = _kept.get(ob.session_uid)
    if stand is None or bpy.app.background:
        stand = read(ob)
    return stand


def read(ob: bpy.types.Object) -> Stand:
    """Counts an object's content."""
    settings = ob.rototoon
    stand = Stand(footage=bool(settings.pattern))
    current = bpy.context.scene.frame_current
    _kept[ob.session_uid] = stand
    if not stand.footage:
        return stand
    names = [layer.name for layer in gp.layers(ob, settings.contours_layer)]
    with gp.copied(ob.data) as data:
        for name in names:
            for frame, (handle, kind) in gp.drawings(data.layers[name]).items():
                _count(stand, frame, handle, kind)
                stand.corrected = stand.corrected or _is_corrected(handle, kind)
                stand.moved = stand.moved or (frame == current and _is_moved(handle))
    snapped = gp.find_layer(ob, settings.snapped_layer)
    stand.snapped = snapped is not None and bool(gp.frame_numbers(snapped))
    return stand


def _count(stand: Stand, frame: int, handle, kind: str) -> None:
    if kind == gp.GENERATED:
        stand.tracked += 1
        return
    starts = gp.offsets(handle)
    strokes = len(starts) - 1
    if not strokes:
        return
    made = gp.value(handle, gp.MADE, strokes)
    # On an artist's frame on which every stroke is marked, the marks are old: somebody has copied a generated frame.
    own = (np.diff(starts) > 0) & (~made if not made.all() else True)
    numbers = gp.value(handle, gp.PART, strokes)
    stand.tracked += bool(made.any() and not made.all())
    if own.any():
        stand.keys[frame] = stand.keys.get(frame, 0) + int(own.sum())
        shapes = gp.positions(handle, int(starts[-1]))[np.repeat(own, np.diff(starts))].tobytes()
        stand.copied = stand.copied or shapes in stand._shapes
        stand._shapes.add(shapes)
        stand.numbers.update(int(number) for number in numbers[own & (numbers > 0)])
    loose = int((own & (numbers == 0)).sum())
    if loose:
        stand.loose[frame] = stand.loose.get(frame, 0) + loose


def _is_corrected(handle, kind: str) -> bool:
    if kind != gp.GENERATED or not gp.has(handle, gp.PIN):
        return False
    starts = gp.offsets(handle)
    return bool(gp.value(handle, gp.PIN, int(starts[-1])).any() or gp.value(handle, gp.CENTER, len(starts) - 1)[:, 2].any())


def _is_moved(handle) -> bool:
    """Whether points are not where Track put them. Track makes them pins; before, only the frame at which the artist looks is read."""
    starts = gp.offsets(handle)
    total = int(starts[-1])
    tracked = gp.get(handle, gp.TRACKED, total)
    if tracked is None:
        return False
    made = np.repeat(gp.value(handle, gp.MADE, len(starts) - 1), np.diff(starts))
    return bool(((tracked != gp.positions(handle, total)).any(1) & made).any())


def has_generated(ob: bpy.types.Object) -> bool:
    """Whether Track has drawn anything. Reads no strokes, and keeps nothing: scripts may ask at any moment."""
    return any(
        kind == gp.GENERATED or gp.has(handle, gp.TRACKED)
        for layer in gp.layers(ob, ob.rototoon.contours_layer)
        for handle, kind in gp.drawings(layer).values()
    )


def forget(ob: bpy.types.Object) -> None:
    """The object has changed."""
    _kept.pop(ob.session_uid, None)


@persistent
def clear(*_args) -> None:
    """Called after a file was opened, and after undo and redo."""
    _kept.clear()
