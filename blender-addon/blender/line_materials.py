"""Materials of traced lines: one for each ink, named by its colour."""

from __future__ import annotations

import bpy
import numpy as np

NAME = "Line "
"""Beginning of their names. The colour as hexadecimal digits follows."""


def known(ob: bpy.types.Object) -> list[tuple[int, np.ndarray]]:
    """The object's materials of traced lines: index and colour (sRGB)."""
    found = []
    for place, material in enumerate(ob.data.materials):
        style = material.grease_pencil if material is not None else None
        if style is not None and material.name.startswith(NAME):
            found.append((place, _encoded(np.array(style.color[:3], np.float64))))
    return found


def make(ob: bpy.types.Object, colour: np.ndarray) -> int:
    """Makes a material for an ink (sRGB, 0 to 1). Returns its index."""
    material = bpy.data.materials.new(NAME + "".join(f"{round(255 * float(v)):02x}" for v in colour))
    bpy.data.materials.create_gpencil_data(material)
    material.grease_pencil.color = (*to_linear(colour), 1.0)
    ob.data.materials.append(material)
    return len(ob.data.materials) - 1


def to_linear(colour: np.ndarray) -> np.ndarray:
    """sRGB-encoded values as linear ones."""
    return np.where(colour <= 0.04045, colour / 12.92, ((colour + 0.055) / 1.055) ** 2.4)


def _encoded(linear: np.ndarray) -> np.ndarray:
    return np.where(linear <= 0.0031308, 12.92 * linear, 1.055 * linear.clip(0) ** (1 / 2.4) - 0.055)
