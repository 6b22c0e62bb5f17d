"""The overlay of Match Strokes: lines in the colours of the pairs, and numbers on plates beside them.

Lines of the earlier key are wide, and their plates have the pair's colour. Lines of the later key are narrow, and their plates are
black. Numbers without a free place are left out until the artist zooms in.
"""

from __future__ import annotations

import bpy
import numpy as np

from ..blender import windows
from . import label_places
from .pairing import Mark, Pairing, on_screen

_SIDES = ((1.0, 3.5), (0.9, 1.75))
"""Opacity and width of the lines: of the earlier key, of the later key."""
_FONT, _PADDING = 13, (5.0, 4.0)
_MOST = 400
"""Largest count of numbers on the screen."""
_INK = (0.04, 0.04, 0.04)


class PairOverlay:
    """Draws the marks of a pairing in every 3D view until it is closed."""

    def __init__(self, pairing: Pairing):
        self._pairing = pairing
        self._marks: list[Mark] = []
        self._anchors = label_places.anchors([])
        self._drawn = label_places.drawn([])
        self._batches: list = []
        add = bpy.types.SpaceView3D.draw_handler_add
        self._handles = [
            add(self._draw_lines, (), "WINDOW", "POST_VIEW"),
            add(self._draw_labels, (), "WINDOW", "POST_PIXEL"),
        ]

    def close(self) -> None:
        """Stops drawing."""
        for handle in self._handles:
            bpy.types.SpaceView3D.draw_handler_remove(handle, "WINDOW")
        self._handles = []

    def refresh(self) -> None:
        """Shows the current pairs."""
        self._marks = [mark for mark in self._pairing.marks() if np.isfinite(mark.points).all() and len(mark.points)]
        lines = [mark.points for mark in self._marks]
        self._anchors, self._drawn = label_places.anchors(lines), label_places.drawn(lines)
        self._batches = []
        windows.redraw_views()

    def _laid(self, shader) -> list:
        """Batches of the lines of each key; the narrow lines are drawn over the wide ones."""
        from gpu_extras.batch import batch_for_shader

        laid = []
        for side in (0, 1):
            own = [mark for mark in self._marks if mark.side == side and len(mark.points) > 1]
            if not own:
                continue
            ends = [np.repeat(mark.points, 2, axis=0)[1:-1] for mark in own]
            colours = [np.tile((*mark.colour, _SIDES[side][0]), (len(each), 1)) for mark, each in zip(own, ends)]
            vertices = {"pos": _single(ends), "color": _single(colours)}
            laid.append((_SIDES[side][1], batch_for_shader(shader, "LINES", vertices)))
        return laid

    def _draw_lines(self) -> None:
        import gpu

        shader = gpu.shader.from_builtin("POLYLINE_SMOOTH_COLOR")
        if self._marks and not self._batches:
            self._batches = self._laid(shader)
        region = bpy.context.region
        gpu.state.blend_set("ALPHA")
        gpu.state.depth_test_set("NONE")
        shader.bind()
        shader.uniform_float("viewportSize", (region.width, region.height))
        for width, batch in self._batches:
            shader.uniform_float("lineWidth", width * bpy.context.preferences.system.ui_scale)
            batch.draw(shader)
        gpu.state.blend_set("NONE")

    def _draw_labels(self) -> None:
        region, view = bpy.context.region, bpy.context.region_data
        if view is None or not self._marks:
            return
        size, matrix = (region.width, region.height), np.array(view.perspective_matrix)
        places = on_screen(self._anchors.reshape(-1, 3), matrix, size).reshape(self._anchors.shape[:-1] + (2,))
        seen = ((places[:, :, 1] >= 0) & (places[:, :, 1] < size)).all(-1).any(-1)
        lengths = np.ptp(places[:, :, 1], axis=1).sum(-1)
        # Pairs made by hand come first, then short lines, which have the fewest places.
        order = sorted(np.flatnonzero(seen), key=lambda i: (not self._marks[i].by_hand, lengths[i]))[:_MOST]
        if order:
            covered = label_places.Covered(on_screen(self._drawn, matrix, size), size)
            self._label([self._marks[i] for i in order], places[order], covered, size)

    def _label(self, marks: list[Mark], places: np.ndarray, covered: label_places.Covered, size) -> None:
        import blf

        scale = bpy.context.preferences.system.ui_scale
        blf.size(0, _FONT * scale)
        texts = [f"[{mark.label}]" if mark.by_hand else mark.label for mark in marks]
        height = blf.dimensions(0, "0")[1]
        extents = np.array([(blf.dimensions(0, text)[0] / 2, height / 2) for text in texts]) + np.array(_PADDING) * scale
        found = label_places.arrange(places, extents, covered, size, scale)
        shown = [(m, text, e, at) for m, text, e, at in zip(marks, texts, extents, found) if at is not None]
        _draw_plates([(mark, extent, *at) for mark, _, extent, at in shown], scale)
        for mark, text, extent, ((x, y), _) in shown:
            blf.color(0, *(_INK if mark.side == 0 else mark.colour), 1.0)
            blf.position(0, x - extent[0] + _PADDING[0] * scale, y - height / 2, 0)
            blf.draw(0, text)


def _draw_plates(plates: list[tuple], scale: float) -> None:
    """Draws plates under the numbers, with stems to their lines."""
    import gpu
    from gpu_extras.batch import batch_for_shader

    if not plates:
        return
    corners = np.array([(-1, -1), (1, -1), (1, 1), (-1, -1), (1, 1), (-1, 1)])
    stems, boxes, fills, inks = [], [], [], []
    for mark, extent, middle, on_line in plates:
        stems.extend((middle, on_line))
        colour = (*mark.colour, 1.0)
        # The later key's black plate gets a rim in the colour of the pair, the earlier key's coloured plate a black rim.
        for grown, fill in ((scale, _INK if mark.side == 0 else mark.colour), (0, mark.colour if mark.side == 0 else _INK)):
            boxes.append(np.array(middle) + corners * (extent + grown))
            fills.append(np.tile((*fill, 1.0), (len(corners), 1)))
        inks.extend((colour, colour))
    gpu.state.blend_set("ALPHA")
    lines = gpu.shader.from_builtin("POLYLINE_SMOOTH_COLOR")
    lines.bind()
    lines.uniform_float("viewportSize", gpu.state.viewport_get()[2:])
    lines.uniform_float("lineWidth", scale)
    stems = np.c_[np.array(stems), np.zeros(len(stems))]
    batch_for_shader(lines, "LINES", {"pos": _single([stems]), "color": _single([np.array(inks)])}).draw(lines)
    flat = gpu.shader.from_builtin("SMOOTH_COLOR")
    places = np.vstack(boxes)
    places = np.c_[places, np.zeros(len(places))]
    batch_for_shader(flat, "TRIS", {"pos": _single([places]), "color": _single(fills)}).draw(flat)
    gpu.state.blend_set("NONE")


def _single(rows: list[np.ndarray]) -> np.ndarray:
    return np.ascontiguousarray(np.vstack(rows), np.float32)
