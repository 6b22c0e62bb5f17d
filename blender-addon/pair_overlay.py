"""Pairs of strokes on the screen: coloured lines, with numbers at their middles. Drawn while Match Strokes runs."""

from __future__ import annotations

import bpy
import numpy as np

from .pairing import Pairing, on_screen

_SIDES = ((1.0, 3.0), (0.55, 1.5))
"""Opacity and width of the lines of the earlier and of the later key."""


class PairOverlay:
    """Draws the marks of a pairing in every 3D view, until it is closed."""

    def __init__(self, pairing: Pairing):
        self._pairing = pairing
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

    def _draw_lines(self) -> None:
        import gpu
        from gpu_extras.batch import batch_for_shader

        shader = gpu.shader.from_builtin("POLYLINE_UNIFORM_COLOR")
        region = bpy.context.region
        gpu.state.blend_set("ALPHA")
        gpu.state.depth_test_set("NONE")
        shader.bind()
        shader.uniform_float("viewportSize", (region.width, region.height))
        for mark in self._pairing.marks():
            if len(mark.points) < 2:
                continue
            opacity, width = _SIDES[mark.side]
            shader.uniform_float("lineWidth", width * bpy.context.preferences.system.ui_scale)
            shader.uniform_float("color", (*mark.colour, opacity))
            points = np.ascontiguousarray(mark.points, np.float32)
            batch_for_shader(shader, "LINE_STRIP", {"pos": points}).draw(shader)
        gpu.state.blend_set("NONE")

    def _draw_labels(self) -> None:
        import blf

        region, view = bpy.context.region, bpy.context.region_data
        if view is None:
            return
        matrix = np.array(view.perspective_matrix)
        scale = bpy.context.preferences.system.ui_scale
        for mark in self._pairing.marks():
            if not len(mark.points):
                continue
            middle = mark.points[len(mark.points) // 2][None]
            x, y = on_screen(middle, matrix, (region.width, region.height))[0]
            if not (0 <= x < region.width and 0 <= y < region.height):
                continue
            text = f"[{mark.label}]" if mark.by_hand else mark.label
            blf.size(0, (16 if mark.side == 0 else 13) * scale)
            width, height = blf.dimensions(0, text)
            blf.enable(0, blf.SHADOW)
            blf.shadow(0, 5, 0.0, 0.0, 0.0, 1.0)
            blf.color(0, *mark.colour, 1.0)
            blf.position(0, x - width / 2, y - height / 2 + (10 if mark.side == 0 else -10) * scale, 0)
            blf.draw(0, text)
            blf.disable(0, blf.SHADOW)


def redraw() -> None:
    """Has all 3D views drawn again."""
    for window in bpy.context.window_manager.windows:
        for area in window.screen.areas:
            if area.type == "VIEW_3D":
                area.tag_redraw()
