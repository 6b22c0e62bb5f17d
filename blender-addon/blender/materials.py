"""The materials that an object shows. A slot that is linked to the object has the object's own material, and its data another one."""

from __future__ import annotations

import bpy


def of(ob: bpy.types.Object) -> list[bpy.types.Material | None]:
    """The materials of an object by the index that strokes have."""
    return [slot.material for slot in ob.material_slots]


def append(ob: bpy.types.Object, material: bpy.types.Material) -> int:
    """Gives an object one more material. Returns its index. One without any gets an empty slot before it: its strokes have the index 0, and keep their
    look."""
    if not len(ob.data.materials):
        ob.data.materials.append(None)
    ob.data.materials.append(material)
    return len(ob.data.materials) - 1
