"""Parents of layers: objects and bones that carry them, their groups, and a second layer in the same place.

Blender carries a layer if the layer has a parent object or bone, or if its own transform is animated.
"""

from __future__ import annotations

import re

import bpy
import numpy as np
from mathutils import Matrix

from . import camera as cameras
from . import grease_pencil as gp
from .animated import curves


def carrier(ob, layer) -> tuple[str, str] | None:
    """The carrier of a layer: an object and its bone, or the layer's animated transform. `None` if the layer is still in its
    object."""
    if is_animated(ob, layer.name):
        return "own", layer.name
    if layer.parent is None:
        return None
    return f"object {layer.parent.name}", layer.parent_bone


def is_animated(ob, name: str) -> bool:
    """Whether a layer's own transform is animated."""
    data = ob.data.animation_data
    if data is None:
        return False
    paths = [curve.data_path for curve in (*data.drivers, *curves(ob.data))]
    pattern = re.compile(re.escape(f'layers["{bpy.utils.escape_identifier(name)}"].') + "(translation|rotation|scale)$")
    return any(pattern.search(path) for path in paths)


def in_carrier(layer) -> np.ndarray:
    """4×4: a layer's points to the space of its carrier."""
    local = np.array(layer.matrix_local, np.float64)
    return np.array(layer.matrix_parent_inverse, np.float64) @ local if layer.parent is not None else local


def groups_of(layer) -> list[str]:
    """Names of the groups that contain a layer, the outermost first."""
    names = []
    group = layer.parent_group
    while group is not None:
        names.insert(0, group.name)
        group = group.parent_group
    return names


ASIDE = " Hidden"
"""Suffix of the name of a layer with the hidden lines of another one."""


def beside(ob, layer, name: str):
    """The layer called `name`. If there is none, a new layer with the same place and the same carrier as `layer`."""
    found = ob.data.layers.get(name)
    if found is not None:
        return found
    found = gp.new_layer(ob, name)
    found.use_lights = layer.use_lights
    if layer.parent is None:
        found.translation, found.rotation, found.scale = layer.translation, layer.rotation, layer.scale
        return found
    found.parent, found.parent_bone = layer.parent, layer.parent_bone
    # Blender sets the inverse matrix of the parent, and scripts cannot. The layer's own transform makes up for it.
    own = np.linalg.inv(cameras.layer_to_world(ob, found)) @ cameras.layer_to_world(ob, layer)
    place, turn, size = Matrix((np.array(found.matrix_local) @ own).tolist()).decompose()
    found.translation, found.rotation, found.scale = place, turn.to_euler(), size
    return found
