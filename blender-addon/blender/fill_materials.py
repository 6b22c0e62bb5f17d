"""Materials of paint: one for each colour, named by it. To change the material's fill changes the colour on all frames."""

from __future__ import annotations

import bpy
import numpy as np

from . import grease_pencil as gp
from .line_materials import encoded, to_linear

NAME = "Paint "
"""Beginning of the names. The colour as hexadecimal digits follows."""
SAME = 0.6 / 255
"""Largest difference of a channel between colours that share a material."""


def material(ob: bpy.types.Object, colour: np.ndarray) -> int:
    """Index of the object's material for a colour (sRGB, 0 to 1). It is made if there is none."""
    for place, known in enumerate(ob.data.materials):
        style = known.grease_pencil if known is not None else None
        if style is None or not known.name.startswith(NAME) or not _fills(style):
            continue
        if np.abs(encoded(np.array(style.fill_color[:3], np.float64)) - colour).max() <= SAME:
            return place
    return _make(ob, colour)


def _fills(style) -> bool:
    """Whether strokes with a material are filled. From Blender 5.1 on, strokes say so themselves."""
    return gp.FILL_BY_ID or style.show_fill


def _make(ob: bpy.types.Object, colour: np.ndarray) -> int:
    digits = "".join(f"{round(255 * float(v)):02x}" for v in colour)
    made = bpy.data.materials.new(NAME + digits)
    bpy.data.materials.create_gpencil_data(made)
    style = made.grease_pencil
    style.color = style.fill_color = (*to_linear(np.asarray(colour, np.float64)), 1.0)
    if not gp.FILL_BY_ID:
        style.show_stroke, style.show_fill = False, True
    ob.data.materials.append(made)
    return len(ob.data.materials) - 1
