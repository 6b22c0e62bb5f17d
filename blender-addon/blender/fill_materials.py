"""Materials of paint: one for each colour, named by it. To change the material's fill changes the colour on all frames.

A colour of paint is its material: its name says which colour it is, and its fill how it looks. Two materials of one look stay two colours.
"""

from __future__ import annotations

import bpy
import numpy as np

from . import grease_pencil as gp
from . import materials
from .line_materials import encoded, to_linear

NAME = "Paint "
"""Beginning of the names. The colour as hexadecimal digits follows."""
OWN = "rototoon_paint"
"""Property of materials that were made here. They stay so under another name."""
ASKED = "rototoon_paint_name"
"""Property of materials that were made for a name which Blender changed: another material has it, or it is too long."""
NOTHING = "No Paint"
"""Name of the material of shapes whose region stays without paint. Its fill is transparent, and so is that of each such material."""
SAME = 0.6 / 255
"""Largest difference of a channel between colours that share a material."""


def material(ob: bpy.types.Object, colour: np.ndarray) -> int:
    """Index of the object's material for a colour (sRGB, 0 to 1). It is made if there is none."""
    for place, known in enumerate(materials.of(ob)):
        style = known.grease_pencil if known is not None else None
        if style is None or not known.name.startswith(NAME) or not _fills(style) or style.fill_color[3] <= 0.0:
            continue
        if np.abs(encoded(np.array(style.fill_color[:3], np.float64)) - colour).max() <= SAME:
            return place
    return _make(ob, colour)


def names_of(ob: bpy.types.Object) -> list[str | None]:
    """The names of the object's materials: of the colours of paint."""
    return [material.name if material is not None and material.grease_pencil is not None else None for material in materials.of(ob)]


def names_of_strokes(ob: bpy.types.Object, content) -> list[str | None]:
    """For each stroke the name of its colour, that of its material. A tint makes another colour of it, which has no name."""
    names = names_of(ob) or [None]
    index = np.clip(content.strokes("material_index"), 0, len(names) - 1)
    return [names[i] if tint <= 0 else None for i, tint in zip(index, content.strokes("fill_color")[:, 3])]


def named(ob: bpy.types.Object, name: str, colour: np.ndarray) -> int:
    """Index of the object's material for a colour with a name. A material of that name is taken where its look agrees, or it was made here:
    then the artist has changed its look since. Otherwise one is made."""
    for place, own in enumerate(materials.of(ob)):
        if own is not None and own.name == name and _serves(own, colour):
            return place
    for place, own in enumerate(materials.of(ob)):
        if own is not None and _stands_for(own, name) and _serves(own, colour):
            return place
    other = bpy.data.materials.get(name)
    if other is not None and _serves(other, colour):
        return materials.append(ob, other)
    return _append(ob, name, colour)


def _stands_for(material: bpy.types.Material, name: str) -> bool:
    """Whether a material was made for a name that Blender changed, and was not renamed since."""
    return material.get(ASKED) == name and (material.name.startswith(name) or name.startswith(material.name))


def _serves(material: bpy.types.Material, colour: np.ndarray) -> bool:
    style = material.grease_pencil
    if style is None or not _fills(style) or style.fill_color[3] <= 0.0:
        return False
    same = np.abs(encoded(np.array(style.fill_color[:3], np.float64)) - colour).max() <= SAME
    return bool(same or material.get(OWN) or material.name.startswith(NAME))


def is_colour(material: bpy.types.Material | None) -> bool:
    """Whether a material is a colour of paint: it has a fill that is seen."""
    style = material.grease_pencil if material is not None else None
    return style is not None and bool(_fills(style)) and style.fill_color[3] > 0.0


def look(material: bpy.types.Material) -> np.ndarray:
    """The colour of a material's fill, sRGB."""
    return encoded(np.array(material.grease_pencil.fill_color[:3], np.float64))


def nothing(ob: bpy.types.Object) -> int:
    """Index of the object's material of shapes whose region stays without paint. It is made if there is none."""
    for place, bare in enumerate(bare_of(ob)):
        if bare and _fills(materials.of(ob)[place].grease_pencil):
            return place
    place = _append(ob, NOTHING, np.ones(3))
    style = materials.of(ob)[place].grease_pencil
    style.color = style.fill_color = (1.0, 1.0, 1.0, 0.0)
    return place


def is_paint(name: str) -> bool:
    """Whether a material was made here."""
    material = bpy.data.materials.get(name)
    return name.startswith(NAME) or bool(material is not None and material.get(OWN))


def bare_of(ob: bpy.types.Object) -> np.ndarray:
    """For each of the object's materials: whether its fill is transparent, which says that a region stays without paint."""
    styles = [material.grease_pencil if material is not None else None for material in materials.of(ob)]
    return np.array([style is not None and style.fill_color[3] <= 0.0 for style in styles], bool)


def are_bare(ob: bpy.types.Object, content) -> np.ndarray:
    """For each stroke: whether its fill is transparent, and no tint covers that."""
    bare = bare_of(ob)
    if not len(bare):
        return np.zeros(len(content.sizes), bool)
    index = np.clip(content.strokes("material_index"), 0, len(bare) - 1)
    return bare[index] & (content.strokes("fill_color")[:, 3] <= 0.0)


def _fills(style) -> bool:
    """Whether strokes with a material are filled. From Blender 5.1 on, strokes say so themselves."""
    return gp.FILL_BY_ID or style.show_fill


def _make(ob: bpy.types.Object, colour: np.ndarray) -> int:
    return _append(ob, NAME + "".join(f"{round(255 * float(v)):02x}" for v in colour), colour)


def _append(ob: bpy.types.Object, name: str, colour: np.ndarray) -> int:
    made = bpy.data.materials.new(name)
    made[OWN] = True
    if made.name != name:
        made[ASKED] = name
    bpy.data.materials.create_gpencil_data(made)
    style = made.grease_pencil
    style.color = style.fill_color = (*to_linear(np.asarray(colour, np.float64)), 1.0)
    if not gp.FILL_BY_ID:
        style.show_stroke, style.show_fill = False, True
    return materials.append(ob, made)
