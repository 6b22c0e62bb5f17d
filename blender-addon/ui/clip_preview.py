"""Pictures of clips: icons in the list, and the chosen clip's figure, which plays in the panel and beside the drawing.

`figure` and `gather` also work in background. Only drawing needs the graphics card, and `register` starts it only in a window.
"""

from __future__ import annotations

import bpy
import numpy as np
from bpy.app.handlers import persistent

from ..blender import camera as cameras
from ..blender import grease_pencil as gp
from ..blender import placement, windows
from ..blender.errors import Problem
from ..style import clip_browser
from ..style.clip_library import Row
from . import stick_figure
from .overlay import Marks

ICON, LARGE = 32, 160
"""Side lengths of pictures in pixels."""
STRIDE = 0.4
"""Half the width of a striding figure, as a share of its height."""
_icons = None
_keys: dict[str, int] = {}
_playing = ""


def icon(row: Row) -> int:
    """The icon of a clip in the list."""
    return _icon(f"{_name(row)} icon", row, len(row.postures) // 4, ICON)


def figure(row: Row, scene) -> int:
    """The icon of a clip's figure on the scene's frame."""
    global _playing
    if _playing != _name(row):
        # Only pictures of the chosen clip are kept.
        for key in [key for key in _keys if key.startswith("frame ")]:
            _drop(key)
        _playing = _name(row)
    index = posture_of(row, scene)
    return _icon(f"frame {index} {_playing}", row, index, LARGE)


def posture_of(row: Row, scene) -> int:
    """Index of a clip's posture on the scene's frame."""
    fps = scene.render.fps / scene.render.fps_base
    return stick_figure.moment(scene.frame_current, scene.frame_start, fps, row.rate, len(row.postures))


def pixels(row: Row, index: int, size: int) -> np.ndarray:
    """The picture of a posture (size, size, 4), the bottom row first."""
    return stick_figure.picture(row.body, stick_figure.fitted(row.postures, stick_figure.box(size))[index], size)


def _name(row: Row) -> str:
    return f"{row.file} {id(row)}"


def _icon(key: str, row: Row, index: int, size: int) -> int:
    global _icons
    if key in _keys:
        return _keys[key]
    if not len(row.postures):
        return 0
    if _icons is None:
        import bpy.utils.previews

        _icons = bpy.utils.previews.new()
    made = _icons.new(key)
    for kind in ("icon", "image") if size == ICON else ("image", "icon"):
        side = ICON if kind == "icon" else size
        setattr(made, f"{kind}_size", (side, side))
        getattr(made, f"{kind}_pixels_float").foreach_set(pixels(row, index, side).ravel())
    _keys[key] = made.icon_id
    return made.icon_id


def _drop(key: str) -> None:
    _keys.pop(key, None)
    if _icons is not None and key in _icons:
        del _icons[key]


def clear() -> None:
    """Forgets all pictures."""
    global _icons, _playing
    if _icons is not None:
        import bpy.utils.previews

        bpy.utils.previews.remove(_icons)
    _icons, _playing = None, ""
    _keys.clear()


def gather(ob, row: Row, scene) -> list[Marks]:
    """The figure's lines in the world, beside the drawing and of its height."""
    layers = gp.layers(ob, ob.rototoon.contours_layer)
    if not layers or not len(row.postures):
        return []
    layer = layers[0]
    mapping = placement.Mapper(ob, [scene.frame_current], {}, [layer.name]).at(0, scene.frame_current)
    matrix = cameras.layer_to_world(ob, layer)
    posture = stick_figure.fitted(row.postures, _box(ob, layer, mapping, scene))[posture_of(row, scene)]
    marks = []
    for point, line in stick_figure.lines(row.body, posture):
        world = mapping.to_layer(line) @ matrix[:3, :3].T + matrix[:3, 3]
        marks.append(Marks(world, np.tile([*stick_figure.colour(row.body, point), 1.0], (len(line), 1)), 3.0))
    return marks


def _box(ob, layer, mapping, scene) -> np.ndarray:
    """A box beside the drawing on the frame; without a drawing, in the middle of the picture."""
    size = np.array([ob.rototoon.width, ob.rototoon.height], np.float64)
    shown = [frame for frame in gp.drawings(layer) if frame <= scene.frame_current]
    handle = gp.drawings(layer)[max(shown)][0] if shown else None
    count = int(gp.offsets(handle)[-1]) if handle is not None else 0
    if not count:
        return np.array([[0.15, 0.15], [0.85, 0.85]]) * size
    points = mapping.to_pixels(gp.positions(handle, count))
    low, high = points.min(0), points.max(0)
    aside = STRIDE * (high[1] - low[1])
    middle = high[0] + aside if high[0] + 2 * aside <= size[0] or low[0] < 2 * aside else low[0] - aside
    # The box is wider than any figure, so its height decides the size.
    return np.array([[middle - 9 * aside, low[1]], [middle + 9 * aside, high[1]]])


def _draw() -> None:
    context = bpy.context
    ob = context.object
    if not gp.is_drawing(ob) or context.space_data is None or not context.space_data.overlay.show_overlays:
        return
    row = clip_browser.chosen()
    if row is None or not clip_browser.browser().in_view or not ob.rototoon.pattern:
        return
    try:
        marks = gather(ob, row, context.scene)
    except Problem:
        return
    import gpu
    from gpu_extras.batch import batch_for_shader

    shader = gpu.shader.from_builtin("POLYLINE_UNIFORM_COLOR")
    shader.bind()
    shader.uniform_float("viewportSize", (context.region.width, context.region.height))
    gpu.state.blend_set("ALPHA")
    gpu.state.depth_test_set("NONE")
    for mark in marks:
        shader.uniform_float("lineWidth", mark.size * context.preferences.system.ui_scale)
        shader.uniform_float("color", tuple(mark.colours[0]))
        points = np.ascontiguousarray(mark.points, np.float32)
        batch_for_shader(shader, "LINE_STRIP", {"pos": points}).draw(shader)
    gpu.state.blend_set("NONE")


@persistent
def _moved(*_args) -> None:
    """Redraws the figure in the sidebar when the scene's frame changes."""
    # A render changes frames in a thread of its own, which must not touch windows.
    if not bpy.app.is_job_running("RENDER") and clip_browser.chosen() is not None:
        windows.redraw_views()


_handle = None


def register() -> None:
    """Starts drawing, unless in background."""
    global _handle
    if not bpy.app.background:
        _handle = bpy.types.SpaceView3D.draw_handler_add(_draw, (), "WINDOW", "POST_VIEW")
        bpy.app.handlers.frame_change_post.append(_moved)


def unregister() -> None:
    """Stops drawing."""
    global _handle
    if _handle is not None:
        bpy.types.SpaceView3D.draw_handler_remove(_handle, "WINDOW")
        bpy.app.handlers.frame_change_post.remove(_moved)
        _handle = None
    clear()
