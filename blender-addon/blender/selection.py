"""Shows an artist a stroke: selects it for Edit Mode."""

from __future__ import annotations

import bpy
import numpy as np

from . import grease_pencil as gp
from . import guard


def select_stroke(ob: bpy.types.Object, layer: str, frame: int, index: int) -> None:
    """Selects the stroke with an index in the drawing of a scene frame, and its layer as the active one.

    A layer that is missing or closed stays as it is, and so do drawings that may not be changed.
    """
    found = gp.find_layer(ob, layer)
    if guard.refusal(ob) or found is None or not guard.open_layers([found]):
        return
    gp.activate(ob, found)
    drawing = gp.drawings(found)[frame][0]
    starts = gp.offsets(drawing)
    chosen = np.zeros(int(starts[-1]), bool)
    chosen[starts[index] : starts[index + 1]] = True
    gp.select_points(drawing, chosen)
