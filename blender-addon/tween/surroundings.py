"""Data of a sheet beside its drawings: the pegs of its layers, and the picture that strokes may leave."""

from __future__ import annotations

import numpy as np

from ..blender import camera as cameras
from ..blender import grease_pencil as gp
from ..blender import projection
from ..blender.errors import Problem
from . import layer_pegs, sheets


def prepare(ob, sheet: sheets.Sheet, points: np.ndarray) -> None:
    """Adds the pegs of its layers and the picture to a sheet, if its choices need them."""
    for which in {choices.pegs for choices in sheet.wanted.values()} - {"FOUND"}:
        sheet.pegs[which] = layer_pegs.paths_of(ob, sheet.layers, which)
    if any(choices.leaving == "LEAVE" for choices in sheet.choices):
        low, high = _picture(ob, sheet, points)
        sheet.plane.corner, sheet.size = low, tuple(float(side) for side in np.maximum(high - low, 1e-6))


def _picture(ob, sheet: sheets.Sheet, points: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Two corners of the picture on the sheet: of the camera's picture on the current frame, otherwise of a box around the
    drawing."""
    seen = projection.frame_of(ob)
    if seen is not None:
        view, (width, height) = seen
        corners = np.array([[0, 0], [width, 0], [width, height], [0, height]], np.float64)
        plane = (points.mean(0) if len(points) else np.zeros(3), sheet.plane.axes[2])
        try:
            mapping = cameras.Mapping(view, cameras.layer_to_world(ob, gp.find_layer(ob, sheet.layers[0])), plane)
            flat, _ = sheet.plane.flat(mapping.to_layer(corners), 0)
            return flat.min(0), flat.max(0)
        except Problem:
            # The plane is seen edge-on, so there is no picture to leave.
            pass
    flat, _ = sheet.plane.flat(points, 0) if len(points) else (np.zeros((1, 2)), None)
    size = np.ptp(flat, axis=0).max()
    return flat.min(0) - size, flat.max(0) + size
