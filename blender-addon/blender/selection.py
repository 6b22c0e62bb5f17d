"""What is selected in Edit Mode: reading it, and selecting, such as a stroke that an artist is shown."""

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
    select_points(drawing, chosen)


def selected_points(drawing: bpy.types.bpy_struct) -> np.ndarray:
    """Which points are selected in edit mode. Without a stored selection all are, as in Blender itself."""
    starts = gp.offsets(drawing)
    attribute = drawing.attributes.get(".selection")
    if attribute is None:
        return np.ones(int(starts[-1]), np.bool_)
    if attribute.domain == "CURVE":
        return np.repeat(gp.get(drawing, ".selection", len(starts) - 1), np.diff(starts))
    return gp.get(drawing, ".selection", int(starts[-1]))


def select_points(drawing: bpy.types.bpy_struct, chosen: np.ndarray) -> None:
    """Selects only these points for edit mode."""
    attribute = drawing.attributes.get(".selection")
    if attribute is not None and (attribute.domain, attribute.data_type) != ("POINT", "BOOLEAN"):
        drawing.attributes.remove(attribute)
        attribute = None
    if attribute is None:
        attribute = drawing.attributes.new(".selection", "BOOLEAN", "POINT")
    attribute.data.foreach_set("value", np.ascontiguousarray(chosen, bool))


def selected_strokes(drawing: bpy.types.bpy_struct) -> np.ndarray:
    """Which strokes have a selected point in edit mode. Without a stored selection none has."""
    starts = gp.offsets(drawing)
    attribute = drawing.attributes.get(".selection")
    if attribute is None:
        return np.zeros(len(starts) - 1, bool)
    values = np.zeros(len(attribute.data), bool)
    attribute.data.foreach_get("value", values)
    if len(values) == len(starts) - 1 and attribute.domain == "CURVE":
        return values
    return np.array([values[a:b].any() for a, b in zip(starts, starts[1:])], bool)
