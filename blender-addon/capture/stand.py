"""Where an object's work stands: what the panels say, and which step comes next.

Reading it costs one look at the drawings that the artist made; of generated drawings only pins and confidence are read. They are read
from a copy, which Blender does not allow while it draws panels. So panels are told what was read last, and a moment after a change `arrivals`
reads again.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import bpy
import numpy as np
from bpy.app.handlers import persistent

from ..blender import grease_pencil as gp
from . import doubt, generated


@dataclass(frozen=True)
class Held:
    """What the artist's corrections hold on a frame."""

    lines: int
    """Number of lines of which every point is held."""
    points: int
    """Number of held points of other lines."""
    middles: int
    """Number of corrected centres."""


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
    held: dict[int, Held] = field(default_factory=dict)
    """By scene frame what pins and corrected centres hold there."""
    moved: bool = False
    """Whether generated points on the scene's frame were moved since the last Track."""
    line_moved: bool = False
    """Whether every point of a line was."""
    lost: list[int] = field(default_factory=list)
    """Scene frames with a lost contour. The list rises."""
    snapped: bool = False
    copied: bool = False
    """Whether the contours on two key frames are equal: a key was copied, and is not fitted yet."""
    _shapes: set[bytes] = field(default_factory=set)

    @property
    def corrected(self) -> bool:
        """Whether a generated contour has a pin or a corrected centre."""
        return bool(self.held)

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
    least: dict[int, float] = {}
    with gp.copied(ob.data) as data:
        for name in names:
            for frame, (handle, kind) in gp.drawings(data.layers[name]).items():
                _count(stand, frame, handle, kind, settings.stamp)
                _note_held(stand, frame, handle, kind)
                _note_least(least, frame, handle, kind)
                if frame == current:
                    _note_moved(stand, handle)
    stand.lost = sorted(frame for frame, verdict in zip(least, doubt.lost(list(least.values())), strict=True) if verdict)
    snapped = gp.find_layer(ob, settings.snapped_layer)
    stand.snapped = snapped is not None and bool(gp.frame_numbers(snapped))
    return stand


def _count(stand: Stand, frame: int, handle, kind: str, stamp: int) -> None:
    if kind == gp.GENERATED:
        stand.tracked += 1
        return
    starts = gp.offsets(handle)
    strokes = len(starts) - 1
    if not strokes:
        return
    foreign = generated.foreign(gp.value(handle, gp.OWNER, strokes), stamp)
    made = generated.of(handle, kind) & ~foreign
    own = (np.diff(starts) > 0) & ~made
    numbers = np.where(foreign, 0, gp.value(handle, gp.PART, strokes))
    stand.tracked += bool(made.any())
    if own.any():
        stand.keys[frame] = stand.keys.get(frame, 0) + int(own.sum())
        shapes = gp.positions(handle, int(starts[-1]))[np.repeat(own, np.diff(starts))].tobytes()
        stand.copied = stand.copied or shapes in stand._shapes
        stand._shapes.add(shapes)
        stand.numbers.update(int(number) for number in numbers[own & (numbers > 0)])
    loose = int((own & (numbers == 0)).sum())
    if loose:
        stand.loose[frame] = stand.loose.get(frame, 0) + loose


def _note_held(stand: Stand, frame: int, handle, kind: str) -> None:
    if kind != gp.GENERATED or not gp.has(handle, gp.PIN):
        return
    starts = gp.offsets(handle)
    pinned = _of_each(gp.value(handle, gp.PIN, int(starts[-1])), starts)
    whole = (pinned == np.diff(starts)) & (pinned > 0)
    middles = int((gp.value(handle, gp.CENTER, len(pinned))[:, 2] != 0).sum())
    if pinned.any() or middles:
        before = stand.held.get(frame, Held(0, 0, 0))
        stand.held[frame] = Held(
            before.lines + int(whole.sum()), before.points + int(pinned[~whole].sum()), before.middles + middles
        )


def _note_least(least: dict[int, float], frame: int, handle, kind: str) -> None:
    """Notes the least sure of a frame's tracked contours. If any contour is lost, this one is."""
    if not gp.has(handle, gp.CONFIDENCE):
        return
    means = doubt.means(handle)
    # The marks on a copied frame of which every stroke is generated are old, see `_count`.
    if len(means) and (kind == gp.GENERATED or len(means) < len(gp.offsets(handle)) - 1):
        least[frame] = min(least.get(frame, 1.0), float(means.min()))


def _note_moved(stand: Stand, handle) -> None:
    """Notes whether points are not where Track put them. Track makes them pins; before, only the frame at which the artist looks is read."""
    starts = gp.offsets(handle)
    total = int(starts[-1])
    tracked = gp.get(handle, gp.TRACKED, total)
    if tracked is None:
        return
    made = gp.value(handle, gp.MADE, len(starts) - 1)
    moved = _of_each((tracked != gp.positions(handle, total)).any(1), starts)
    stand.moved = stand.moved or bool((moved[made] > 0).any())
    stand.line_moved = stand.line_moved or bool((made & (moved > 0) & (moved == np.diff(starts))).any())


def _of_each(points: np.ndarray, starts: np.ndarray) -> np.ndarray:
    """For each stroke the number of its points that are true."""
    before = np.concatenate([[0], np.cumsum(points)])
    return before[starts[1:]] - before[starts[:-1]]


def has_generated(ob: bpy.types.Object) -> bool:
    """Whether Track has drawn anything. Reads no strokes, and keeps nothing: scripts may ask at any moment."""
    return any(
        any(True for _ in gp.handles(layer, gp.GENERATED)) or any(gp.has(handle, gp.TRACKED) for handle in gp.handles(layer))
        for layer in gp.layers(ob, ob.rototoon.contours_layer)
    )


def forget(ob: bpy.types.Object) -> None:
    """The object has changed."""
    _kept.pop(ob.session_uid, None)


@persistent
def clear(*_args) -> None:
    """Called after a file was opened, and after undo and redo."""
    _kept.clear()
