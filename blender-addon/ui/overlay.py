"""The overlay of the 3D view: pins, corrected centres, and confidence as colour.

`gather` also works in background. Only drawing needs the graphics card, and `register` starts it only in a window.
"""

from __future__ import annotations

from dataclasses import dataclass

import bpy
import numpy as np

from ..blender import camera
from ..blender import grease_pencil as gp

SURE = np.array([0.15, 0.85, 0.35, 1.0], np.float32)
UNSURE = np.array([0.95, 0.75, 0.1, 1.0], np.float32)
DOUBTFUL = np.array([0.95, 0.15, 0.1, 1.0], np.float32)
PIN_COLOUR = np.array([0.2, 0.55, 1.0, 1.0], np.float32)
CENTER_COLOUR = np.array([0.85, 0.35, 1.0, 1.0], np.float32)


@dataclass
class Marks:
    """Points (N, 3) in the world, and their colours (N, 4)."""

    points: np.ndarray
    colours: np.ndarray
    size: float


def colours(confidence: np.ndarray) -> np.ndarray:
    """Colours (N, 4) of confidence: 0 is red, 0.5 yellow, 1 green."""
    share = np.clip(confidence, 0, 1)[:, None]
    low = DOUBTFUL + (UNSURE - DOUBTFUL) * (2 * share)
    high = UNSURE + (SURE - UNSURE) * (2 * share - 1)
    return np.where(share < 0.5, low, high).astype(np.float32)


def gather(ob, frame: int) -> list[Marks]:
    """The marks of an object on a frame."""
    settings = ob.rototoon
    marks = []
    for layer in gp.layers(ob, settings.contours_layer):
        found = gp.drawings(layer).get(frame)
        if layer.hide or found is None:
            continue
        handle, kind = found
        starts = gp.offsets(handle)
        made = gp.value(handle, gp.MADE, len(starts) - 1)
        if not made.any() or (kind != gp.GENERATED and made.all()):
            continue
        total, matrix = int(starts[-1]), camera.layer_to_world(ob, layer)
        points, every = gp.positions(handle, total), np.repeat(made, np.diff(starts))
        if settings.show_confidence:
            sure = gp.value(handle, gp.CONFIDENCE, total)[every]
            marks.append(Marks(_world(points[every], matrix), colours(sure), 6.0))
        if settings.show_pins:
            chosen = points[every & (gp.value(handle, gp.PIN, total) | _moved(handle, points))]
            marks.append(Marks(_world(chosen, matrix), np.tile(PIN_COLOUR, (len(chosen), 1)), 9.0))
            fixed = np.flatnonzero(made & (gp.value(handle, gp.CENTER, len(made))[:, 2] != 0) & (np.diff(starts) > 0))
            middle = np.array([points[starts[i] : starts[i + 1]].mean(0) for i in fixed]).reshape(-1, 3)
            marks.append(Marks(_world(middle, matrix), np.tile(CENTER_COLOUR, (len(fixed), 1)), 12.0))
    return [mark for mark in marks if len(mark.points)]


def _world(points: np.ndarray, matrix: np.ndarray) -> np.ndarray:
    return points @ matrix[:3, :3].T + matrix[:3, 3]


def _moved(handle, points: np.ndarray) -> np.ndarray:
    """Points that the artist moved since the last Track."""
    tracked = gp.get(handle, gp.TRACKED, len(points))
    return np.zeros(len(points), bool) if tracked is None else (tracked != points).any(1)


def _draw() -> None:
    context = bpy.context
    ob = context.object
    if not gp.is_drawing(ob) or context.space_data is None or not context.space_data.overlay.show_overlays:
        return
    settings = ob.rototoon
    if not settings.parts or not (settings.show_confidence or settings.show_pins):
        return
    import gpu
    from gpu_extras.batch import batch_for_shader

    shader = _shader(gpu)
    gpu.state.depth_test_set("NONE")
    gpu.state.blend_set("ALPHA")
    for mark in gather(ob, context.scene.frame_current):
        gpu.state.point_size_set(mark.size)
        points = np.ascontiguousarray(mark.points, np.float32)
        batch_for_shader(shader, "POINTS", {"pos": points, "color": mark.colours}).draw(shader)
    gpu.state.blend_set("NONE")
    gpu.state.point_size_set(1.0)


def _shader(gpu):
    try:
        return gpu.shader.from_builtin("POINT_FLAT_COLOR")
    except ValueError:
        return gpu.shader.from_builtin("FLAT_COLOR")


_handle = None


def register() -> None:
    """Starts drawing, unless in background."""
    global _handle
    if not bpy.app.background:
        _handle = bpy.types.SpaceView3D.draw_handler_add(_draw, (), "WINDOW", "POST_VIEW")


def unregister() -> None:
    """Stops drawing."""
    global _handle
    if _handle is not None:
        bpy.types.SpaceView3D.draw_handler_remove(_handle, "WINDOW")
        _handle = None
