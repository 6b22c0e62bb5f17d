"""Layer points to pixels on the current frame, with or without footage."""

from __future__ import annotations

import bpy
import numpy as np

from . import camera as cameras
from . import placement

FRONT_SCALE = 100.0
"""Pixels per unit if there is neither footage nor a camera."""


class Projection:
    """Maps layer points to pixels.

    These are pixels of the object's footage if it has some, otherwise of the scene's camera, otherwise of the front view.
    """

    def __init__(self, ob: bpy.types.Object):
        self._ob = ob
        self._view = _view(ob)

    def pixels(self, layer, points: np.ndarray) -> np.ndarray:
        """Pixels (N, 2) of points (N, 3) of a layer."""
        return cameras.Mapping(self._view, cameras.need_size(self._ob, cameras.layer_to_world(self._ob, layer))).to_pixels(points)

    def scale(self, layer, points: np.ndarray) -> float:
        """Pixels per unit of the layer, at the mean of some points."""
        middle = np.asarray(points, np.float64).mean(0)
        # The view may foreshorten one of the three axes to nothing. The longest one is the best measure.
        corners = middle + 1e-3 * np.vstack([np.zeros(3), np.eye(3)])
        seen = self.pixels(layer, corners)
        return float(np.linalg.norm(seen[1:] - seen[0], axis=1).max() / 1e-3)


def world_scale(ob: bpy.types.Object, layer) -> float:
    """World units per unit of the layer."""
    return float(np.linalg.norm(cameras.layer_to_world(ob, layer)[:3, :3], axis=0).max())


def frame_of(ob: bpy.types.Object) -> tuple[cameras.View, tuple[int, int]] | None:
    """The view and the size of its picture: those of the object's footage, otherwise of the scene's camera, otherwise `None`."""
    settings, scene = ob.rototoon, bpy.context.scene
    if settings.width and settings.height:
        return placement.view_of(ob), (settings.width, settings.height)
    if scene.camera is None:
        return None
    return _view(ob), (scene.render.resolution_x, scene.render.resolution_y)


def _view(ob: bpy.types.Object) -> cameras.View:
    scene = bpy.context.scene
    if ob.rototoon.width and ob.rototoon.height:
        return placement.view_of(ob)
    if scene.camera is not None:
        render = scene.render
        return cameras.camera_view(scene, scene.camera, render.resolution_x, render.resolution_y, cameras.RENDERED)
    front = np.array([[1.0, 0, 0, 0], [0, 0, 1, 0], [0, -1, 0, 0], [0, 0, 0, 1]])
    return cameras.View(front, False, np.array([[FRONT_SCALE, 0, 0], [0, -FRONT_SCALE, 0]]))
