"""What carries layers, and where the picture lies among them.

A layer that hangs on an object or a bone, or whose own place is animated, is carried by Blender: its strokes are drawn in the space
that is carried, as on a peg. Layers that one thing carries are drawn together.
"""

from __future__ import annotations

import re

import numpy as np

from . import camera as cameras
from . import layer_pegs, projection, sheets
from .errors import Problem


def carrier(ob, layer) -> tuple[str, str] | None:
    """What carries a layer: an object and its bone, or its own animated place; nothing where it lies still in the object."""
    if _is_animated(ob, layer.name):
        return "own", layer.name
    if layer.parent is None:
        return None
    return f"object {layer.parent.name}", layer.parent_bone


def _is_animated(ob, name: str) -> bool:
    """Whether a layer's own place is animated."""
    data = ob.data.animation_data
    if data is None:
        return False
    paths = [curve.data_path for curve in data.drivers]
    if data.action is not None:
        strips = [strip for layer in data.action.layers for strip in layer.strips]
        paths += [curve.data_path for strip in strips for bag in strip.channelbags for curve in bag.fcurves]
    pattern = re.compile(re.escape(f'layers["{name}"].') + "(translation|rotation|scale)$")
    return any(pattern.search(path) for path in paths)


def in_carrier(layer) -> np.ndarray:
    """4×4: a layer's points to the space of what carries it."""
    local = np.array(layer.matrix_local, np.float64)
    return np.array(layer.matrix_parent_inverse, np.float64) @ local if layer.parent is not None else local


def prepare(ob, sheet: sheets.Sheet, points: np.ndarray) -> None:
    """Gives a sheet the pegs of its layers and the picture, where these are asked for."""
    for which in {choices.pegs for choices in sheet.wanted.values()} - {"FOUND"}:
        sheet.pegs[which] = layer_pegs.paths_of(ob, sheet.layers, which)
    if any(choices.leaving == "LEAVE" for choices in sheet.choices):
        low, high = _picture(ob, sheet, points)
        sheet.plane.corner, sheet.size = low, tuple(float(side) for side in np.maximum(high - low, 1e-6))


def _picture(ob, sheet: sheets.Sheet, points: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Corners of the picture on the sheet: what the camera shows on the current frame, else about the drawing."""
    seen = projection.frame_of(ob)
    if seen is not None:
        view, (width, height) = seen
        corners = np.array([[0, 0], [width, 0], [width, height], [0, height]], np.float64)
        plane = (points.mean(0) if len(points) else np.zeros(3), sheet.plane.axes[2])
        try:
            mapping = cameras.Mapping(view, cameras.layer_to_world(ob, ob.data.layers[sheet.layers[0]]), plane)
            flat, _ = sheet.plane.flat(mapping.to_layer(corners), 0)
            return flat.min(0), flat.max(0)
        except Problem:
            # Seen edge-on: no picture to leave.
            pass
    flat, _ = sheet.plane.flat(points, 0) if len(points) else (np.zeros((1, 2)), None)
    size = np.ptp(flat, axis=0).max()
    return flat.min(0) - size, flat.max(0) + size
