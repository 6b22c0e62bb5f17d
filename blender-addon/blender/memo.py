"""Answers about an object's drawings that panels ask for at each redraw, kept until Blender reports a change.

Blender finds the drawing of a frame by a search through all frames of all layers. So a look at every drawing takes a time that grows with the
square of their number: 0.15 s for 20 layers of 500 frames. A panel asks half a dozen times whether a button has anything to do.

Scripts may ask at any moment, also before Blender has noticed a change. In background nothing is kept.
"""

from __future__ import annotations

from collections.abc import Callable

import bpy
from bpy.app.handlers import persistent

_kept: dict[tuple, bool] = {}


def kept(ob: bpy.types.Object, ask: Callable[[bpy.types.Object], bool]) -> bool:
    """The answer of a function of this add-on to a question about an object."""
    if bpy.app.background:
        return ask(ob)
    settings = ob.rototoon
    # The names say which layers are looked at.
    key = (ob.session_uid, ask.__module__, ask.__qualname__, settings.contours_layer, settings.snapped_layer, settings.fills_layer)
    if key not in _kept:
        _kept[key] = ask(ob)
    return _kept[key]


@persistent
def changed(_scene=None, depsgraph=None) -> None:
    """Called after each update of the scene."""
    # Blender lists the object too if only its strokes changed.
    if depsgraph is None or any(isinstance(update.id, bpy.types.Object) for update in depsgraph.updates):
        _kept.clear()


@persistent
def clear(*_args) -> None:
    """Called after a file was opened, and after undo and redo."""
    _kept.clear()
