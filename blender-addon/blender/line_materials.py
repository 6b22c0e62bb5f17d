"""Materials of traced lines and of solid shapes: one for each ink, named by its colour."""

from __future__ import annotations

import bpy
import numpy as np

from . import grease_pencil as gp
from . import materials

NAME = "Line "
"""Beginning of the names of materials of lines. The colour as hexadecimal digits follows."""
FILL_NAME = "Line Fill "
"""Beginning of the names of materials of solid shapes. Before Blender 5.1 the material also says that they have no line."""

BOTH_NAME = "Filled Line "
"""Beginning of the names of materials of lines that are filled. The colours of line and fill follow."""


def known(ob: bpy.types.Object, fill: bool = False) -> list[tuple[int, np.ndarray]]:
    """The object's materials of traced lines, or of solid shapes: index and colour (sRGB)."""
    found = []
    for place, material in enumerate(materials.of(ob)):
        style = material.grease_pencil if material is not None else None
        if style is not None and material.name.startswith(NAME) and material.name.startswith(FILL_NAME) == fill:
            found.append((place, encoded(np.array((style.fill_color if fill else style.color)[:3], np.float64))))
    return found


def make(ob: bpy.types.Object, colour: np.ndarray, fill: bool = False) -> int:
    """Makes a material for an ink (sRGB, 0 to 1), or for a shape that is filled with it. Returns its index."""
    digits = "".join(f"{round(255 * float(v)):02x}" for v in colour)
    material = bpy.data.materials.new((FILL_NAME if fill else NAME) + digits)
    bpy.data.materials.create_gpencil_data(material)
    style = material.grease_pencil
    style.color = (*to_linear(colour), 1.0)
    if fill:
        style.fill_color = style.color
        if not gp.FILL_BY_ID:
            style.show_stroke, style.show_fill = False, True
    return materials.append(ob, material)


def with_fill(ob: bpy.types.Object, line: np.ndarray, fill: np.ndarray, same: float) -> int:
    """Index of the object's material for a line and its fill (sRGB, 0 to 1), within `same`. It is made if there is none."""
    for place, material in enumerate(materials.of(ob)):
        style = material.grease_pencil if material is not None else None
        if style is None or not material.name.startswith(BOTH_NAME) or not (gp.FILL_BY_ID or style.show_fill and style.show_stroke):
            continue
        own = [encoded(np.array(colour[:3], np.float64)) for colour in (style.color, style.fill_color)]
        if max(np.abs(own[0] - line).max(), np.abs(own[1] - fill).max()) <= same:
            return place
    digits = ["".join(f"{round(255 * float(v)):02x}" for v in colour) for colour in (line, fill)]
    material = bpy.data.materials.new(BOTH_NAME + " ".join(digits))
    bpy.data.materials.create_gpencil_data(material)
    style = material.grease_pencil
    style.color, style.fill_color = (*to_linear(line), 1.0), (*to_linear(fill), 1.0)
    if not gp.FILL_BY_ID:
        style.show_stroke = style.show_fill = True
    return materials.append(ob, material)


def to_linear(colour: np.ndarray) -> np.ndarray:
    """sRGB-encoded values as linear ones."""
    return np.where(colour <= 0.04045, colour / 12.92, ((colour + 0.055) / 1.055) ** 2.4)


def encoded(linear: np.ndarray) -> np.ndarray:
    """Linear values as sRGB-encoded ones."""
    return np.where(linear <= 0.0031308, 12.92 * linear, 1.055 * linear.clip(0) ** (1 / 2.4) - 0.055)
