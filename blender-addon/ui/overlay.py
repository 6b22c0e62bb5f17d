"""The overlay of the 3D view: lost contours, pins, corrected centres, and confidence as colour.

A lost contour is a black line with a red one in it: one of the two stands out on white paper, on dark paint and on red.

`gather` also works in background. Only drawing needs the graphics card, and `register` starts it only in a window.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import bpy
import numpy as np

from ..blender import camera, guard
from ..blender import grease_pencil as gp
from ..capture import doubt, generated
from . import doubts

SURE = np.array([0.15, 0.85, 0.35, 1.0], np.float32)
UNSURE = np.array([0.95, 0.75, 0.1, 1.0], np.float32)
DOUBTFUL = np.array([0.95, 0.15, 0.1, 1.0], np.float32)
PIN_COLOUR = np.array([0.2, 0.55, 1.0, 1.0], np.float32)
LOST_EDGE, LOST_COLOUR = (0.0, 0.0, 0.0, 1.0), (1.0, 0.1, 0.1, 1.0)
LOST_WIDTH = 6.0
"""Pixels."""
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


@dataclass(frozen=True)
class Tracked:
    """The tracked contours of a visible layer on a frame."""

    handle: object
    starts: np.ndarray
    """First point of each stroke, and the number of all points."""
    made: np.ndarray
    """For each stroke whether Track made it."""
    points: np.ndarray
    """All points (N, 3) in the layer."""
    matrix: np.ndarray
    """From the layer to the world."""


def _tracked(ob, frame: int) -> Iterator[Tracked]:
    """The tracked contours of an object on a frame, by layer."""
    for layer in gp.layers(ob, ob.rototoon.contours_layer):
        found = gp.shown(layer, frame)
        if guard.is_hidden(layer) or found is None or found[0] != frame:
            continue
        _, handle, kind = found
        starts = gp.offsets(handle)
        made = generated.of(handle, kind)
        if made.any():
            yield Tracked(handle, starts, made, gp.positions(handle, int(starts[-1])), camera.layer_to_world(ob, layer))


def gather(ob, frame: int) -> list[Marks]:
    """The marks of an object on a frame."""
    settings = ob.rototoon
    marks = []
    for each in _tracked(ob, frame):
        if settings.show_confidence:
            marks.append(_marks_of_confidence(each))
        if settings.show_pins:
            marks += _marks_of_pins(each)
    return [mark for mark in marks if len(mark.points)]


def _marks_of_confidence(each: Tracked) -> Marks:
    every = np.repeat(each.made, np.diff(each.starts))
    sure = gp.value(each.handle, gp.CONFIDENCE, len(each.points))[every]
    return Marks(_world(each.points[every], each.matrix), colours(sure), 6.0)


def _marks_of_pins(each: Tracked) -> list[Marks]:
    """The held points, and the corrected centres."""
    starts, points = each.starts, each.points
    held = gp.value(each.handle, gp.PIN, len(points)) | _moved(each.handle, points)
    chosen = points[np.repeat(each.made, np.diff(starts)) & held]
    centres = gp.value(each.handle, gp.CENTER, len(each.made))[:, 2] != 0
    fixed = np.flatnonzero(each.made & centres & (np.diff(starts) > 0))
    middle = np.array([points[starts[i] : starts[i + 1]].mean(0) for i in fixed]).reshape(-1, 3)
    return [
        Marks(_world(chosen, each.matrix), np.tile(PIN_COLOUR, (len(chosen), 1)), 9.0),
        Marks(_world(middle, each.matrix), np.tile(CENTER_COLOUR, (len(fixed), 1)), 12.0),
    ]


def lost_lines(ob, frame: int) -> list[np.ndarray]:
    """The lines (N, 3) in the world of the contours that are lost on a frame. A closed one ends where it begins."""
    lines, means = [], []
    for each in _tracked(ob, frame):
        sure = gp.value(each.handle, gp.CONFIDENCE, len(each.points))
        cyclic = gp.value(each.handle, "cyclic", len(each.made))
        for index in np.flatnonzero(each.made & (np.diff(each.starts) > 1)):
            span = slice(each.starts[index], each.starts[index + 1])
            line = _world(each.points[span], each.matrix)
            lines.append(np.concatenate([line, line[:1]]) if cyclic[index] else line)
            means.append(float(np.nan_to_num(np.clip(sure[span], 0, 1), nan=0.0).mean()))
    return [line for line, verdict in zip(lines, doubt.lost(means), strict=True) if verdict]


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
    if not ob.visible_get():
        return
    settings, frame = ob.rototoon, context.scene.frame_current
    for strokes, colour, width in doubtful(ob, frame):
        _draw_lines(strokes, colour, width)
    if not settings.parts or not (settings.show_confidence or settings.show_pins or settings.show_lost):
        return
    import gpu
    from gpu_extras.batch import batch_for_shader

    if settings.show_lost:
        _draw_lines(lost_lines(ob, frame), LOST_COLOUR, LOST_WIDTH)

    shader = _shader(gpu)
    gpu.state.depth_test_set("NONE")
    gpu.state.blend_set("ALPHA")
    for mark in gather(ob, frame):
        gpu.state.point_size_set(mark.size)
        points = np.ascontiguousarray(mark.points, np.float32)
        batch_for_shader(shader, "POINTS", {"pos": points, "color": mark.colours}).draw(shader)
    gpu.state.blend_set("NONE")
    gpu.state.point_size_set(1.0)


def doubtful(ob, frame: int) -> list[tuple[list[np.ndarray], tuple, float]]:
    """The traced strokes and the regions that are in doubt on a frame, where they are marked: lines (N, 3) in the world, with their
    colour and width. Lost ones are last, so that they are on top."""
    groups: dict[tuple[bool, bool], list[np.ndarray]] = {}
    settings = ob.rototoon
    found = doubts.marked(ob, frame) if settings.show_doubts else []
    for each in found + (doubts.marked_regions(ob, frame) if settings.show_fill_doubts else []):
        groups.setdefault((each.lost, each.chosen), []).append(each.points)
    return [
        (groups[lost, chosen], LOST_COLOUR if lost else tuple(UNSURE.tolist()), LOST_WIDTH * (2 if chosen else 1))
        for lost, chosen in sorted(groups)
    ]


def _draw_lines(lines: list[np.ndarray], colour: tuple, line_width: float) -> None:
    """Draws lines: black, and a colour in it."""
    import gpu
    from gpu_extras.batch import batch_for_shader

    if not lines:
        return
    region, scale = bpy.context.region, bpy.context.preferences.system.ui_scale
    ends = np.ascontiguousarray(np.vstack([np.repeat(line, 2, axis=0)[1:-1] for line in lines]), np.float32)
    shader = gpu.shader.from_builtin("POLYLINE_SMOOTH_COLOR")
    gpu.state.depth_test_set("NONE")
    gpu.state.blend_set("ALPHA")
    shader.bind()
    shader.uniform_float("viewportSize", (region.width, region.height))
    for width, own in ((line_width, LOST_EDGE), (line_width / 2, colour)):
        shader.uniform_float("lineWidth", width * scale)
        colours = np.tile(np.asarray(own, np.float32), (len(ends), 1))
        batch_for_shader(shader, "LINES", {"pos": ends, "color": colours}).draw(shader)
    gpu.state.blend_set("NONE")


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
