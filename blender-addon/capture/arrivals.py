"""New contours become parts while the artist draws, so that the list of parts is true at every moment.

Blender's handler only notes that an object may have new strokes. When nothing has changed for a moment and no tool is at work, a timer
looks. It acts only where the answer cannot become another one by what the artist draws next:

- All contours are on one frame: each new one is a new part.
- Every part has its contour on the frame: they are matched together, as Track does.

Parts without a contour stay in the list: their contours may come back from the clipboard, or from a layer that has another name for a moment.
Elsewhere the strokes wait for Track or Match Contours, and the panel says how many wait. Locked layers are left alone.

A drawn line whose ends nearly meet is joined. Like the results of Live, the marks get no undo step of their own: they follow
from the strokes, and after undo and redo they are made again.
"""

from __future__ import annotations

import time
import traceback

import bpy
from bpy.app.handlers import persistent
from rototoon import RototoonError

from ..blender import grease_pencil as gp
from ..blender import guard, windows
from ..blender.errors import Problem
from . import contours, document, identity, live, stand

DELAY = 0.2
"""Seconds without a change before the timer looks."""
MOST = 4000
"""Largest number of strokes of an object that are looked at while the artist draws. Reading so many takes about 0.05 s."""

FEW = 12
"""Largest number of new contours on a frame that are matched while the artist draws. Matching one takes about 0.01 s."""

_due: dict[int, float] = {}


@persistent
def changed(_scene=None, depsgraph=None) -> None:
    """Called after each update of the scene."""
    if depsgraph is None or bpy.app.background:
        return
    for update in depsgraph.updates:
        if isinstance(update.id, bpy.types.Object):
            note(update.id.original)


@persistent
def undone(*_args) -> None:
    """Called after undo and redo."""
    if not bpy.app.background and bpy.context.object is not None:
        note(bpy.context.object)


def note(ob: bpy.types.Object) -> None:
    """Notes that an object may have new strokes."""
    if not _is_ours(ob):
        return
    _due[ob.session_uid] = time.monotonic()
    if not bpy.app.timers.is_registered(_tick):
        bpy.app.timers.register(_tick, first_interval=DELAY)


def _is_ours(ob: bpy.types.Object) -> bool:
    return gp.is_drawing(ob) and bool(ob.rototoon.pattern)


@persistent
def reset(*_args) -> None:
    """Forgets everything and stops the timer."""
    _due.clear()
    if bpy.app.timers.is_registered(_tick):
        bpy.app.timers.unregister(_tick)


def _tick() -> float | None:
    now = time.monotonic()
    if live.held_off() or any(now - since < DELAY for since in _due.values()):
        return DELAY
    try:
        for ob in [ob for ob in bpy.context.scene.objects if ob.session_uid in _due and _is_ours(ob)]:
            look(ob)
        windows.redraw_views()
    except Exception:  # noqa: BLE001 - a fault must not stop the timer for good
        traceback.print_exc()
    _due.clear()
    return None


def look(ob: bpy.types.Object) -> bool:
    """Makes parts of an object's new contours where that is certain. Returns whether anything changed."""
    layers = gp.layers(ob, ob.rototoon.contours_layer)
    found = stand.read(ob)
    if guard.refusal(ob) or not _is_certain(ob, found) or any(guard.is_locked(layer) for layer in layers):
        return False
    try:
        guard.need(ob)
        reading = contours.read(ob)
        mapper = document.mapper_of(ob, reading)
        decisions = identity.decide(reading, mapper, ob.rototoon.next_number)
        identity.write(ob, reading, decisions)
    except (Problem, RototoonError):
        # Track says what is wrong; nobody has pressed a button here.
        return False
    _join_ends(reading, decisions.created)
    ob.data.update_tag()
    stand.read(ob)
    return True


def _is_certain(ob: bpy.types.Object, found: stand.Stand) -> bool:
    if found.strokes + found.tracked * max(len(ob.rototoon.parts), 1) > MOST:
        return False
    listed = {part.number for part in ob.rototoon.parts}
    if not found.loose:
        return bool(found.numbers - listed)
    if len(found.keys) == 1:
        return True
    few = sum(found.loose.values()) <= FEW
    # Without tracked contours, parts whose contours were deleted are known.
    drawn = listed if found.tracked else listed & found.numbers
    return few and bool(drawn) and all(found.keys[frame] == len(drawn) for frame in found.loose)


def _join_ends(found: contours.Contours, created: list[contours.Part]) -> None:
    for part in created:
        for stroke in part.keys.values():
            if part.closed and not stroke.cyclic:
                drawing = found.drawings[stroke.layer, stroke.frame]
                flags = gp.value(drawing.handle, "cyclic", len(drawing.strokes))
                flags[stroke.index] = True
                gp.put(drawing.handle, "cyclic", flags)
                gp.points_changed(drawing.handle)
