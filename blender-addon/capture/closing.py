"""The property *Closed* of a part: its lines are closed or opened with it.

`follow` is called when the artist clicks. The lines of keys and of generated frames follow at once, so the view shows what Track will
work with. Blender's undo step for the click holds both.
"""

from __future__ import annotations

import contextlib
from collections.abc import Iterator

import bpy
import numpy as np

from ..blender import grease_pencil as gp
from ..blender import guard

_kept = False
"""Whether the property is set from the lines, so that they stay as they are."""


@contextlib.contextmanager
def lines_kept() -> Iterator[None]:
    """Meanwhile the property changes alone: it follows from the lines."""
    global _kept
    _kept = True
    try:
        yield
    finally:
        _kept = False


def follow(part, context) -> None:
    """Closes or opens a part's lines after its property has changed."""
    if _kept:
        return
    ob = part.id_data
    left = guard.refusal(ob) or write(ob, part.number, part.closed)
    if left and not bpy.app.background and context.window is not None:
        context.window_manager.popup_menu(lambda menu, _context: menu.layout.label(text=left), title=part.name, icon="ERROR")


def write(ob: bpy.types.Object, number: int, closed: bool) -> str:
    """Closes or opens the lines of a part on all layers that are not locked. Returns which layers with such lines stay as they are."""
    layers = [layer for layer in gp.layers(ob, ob.rototoon.contours_layer) if _has_others(layer, number, closed)]
    for layer in guard.open_layers(layers, hidden=True):
        for handle, _ in gp.drawings(layer).values():
            wrong = _others(handle, number, closed)
            if wrong.any():
                flags = gp.value(handle, "cyclic", len(wrong))
                flags[wrong] = closed
                gp.put(handle, "cyclic", flags)
                gp.points_changed(handle)
    ob.data.update_tag()
    return guard.left_out(layers, hidden=True)


def _has_others(layer, number: int, closed: bool) -> bool:
    return any(_others(handle, number, closed).any() for handle, _ in gp.drawings(layer).values())


def _others(handle, number: int, closed: bool) -> np.ndarray:
    """Which strokes belong to the part and are not as it is."""
    count = len(gp.offsets(handle)) - 1
    return (gp.value(handle, gp.PART, count) == number) & (gp.value(handle, "cyclic", count) != closed)
