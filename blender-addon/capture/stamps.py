"""The stamp of an object, which its contours have too: it tells them from those that were pasted from another object, whose parts have other numbers.

A copy of an object has the same stamp, and parts that both get from then on have the same numbers. So whichever of them is written first gets another
stamp, and its contours with it.
"""

from __future__ import annotations

import secrets

import bpy
import numpy as np

from ..blender import grease_pencil as gp
from ..blender import guard
from . import generated


def settled(ob: bpy.types.Object) -> int:
    """The stamp of an object whose contours are to be written. It gets one if it has none, and another one if another object has the same."""
    settings = ob.rototoon
    before = settings.stamp or _brought(ob)
    if before and (not _is_shared(ob, before) or _has_locked(ob)):
        settings.stamp = before
        return before
    settings.stamp = secrets.randbelow(2**31 - 1) + 1
    if before:
        _mark(ob, before)
    return settings.stamp


def _brought(ob) -> int:
    """The stamp that all contours have, if they came from another object with the list of their parts; otherwise 0."""
    owners: set[int] = set()
    for layer in gp.layers(ob, ob.rototoon.contours_layer) if len(ob.rototoon.parts) else ():
        for handle in gp.handles(layer):
            strokes = len(gp.offsets(handle)) - 1
            owners.update(gp.value(handle, gp.OWNER, strokes)[gp.value(handle, gp.PART, strokes) != 0].tolist())
    return owners.pop() if len(owners) == 1 else 0


def _is_shared(ob, stamp: int) -> bool:
    return any(gp.is_drawing(other) and other != ob and other.rototoon.stamp == stamp for other in bpy.data.objects)


def _has_locked(ob) -> bool:
    """Whether a locked layer has contours: they could not get another stamp."""
    return any(gp.has(handle, gp.PART) for layer in gp.every_layer(ob) if guard.is_locked(layer) for handle in gp.handles(layer))


def _mark(ob, before: int) -> None:
    """Gives the object's stamp to its contours, which had the stamp `before` or none."""
    for layer in gp.every_layer(ob):
        for handle in gp.handles(layer):
            strokes = len(gp.offsets(handle)) - 1
            if not strokes or not gp.has(handle, gp.PART):
                continue
            owners = gp.value(handle, gp.OWNER, strokes)
            own = (gp.value(handle, gp.PART, strokes) != 0) & ~generated.foreign(owners, before)
            gp.put(handle, gp.OWNER, np.where(own, ob.rototoon.stamp, owners).astype(np.int32))
