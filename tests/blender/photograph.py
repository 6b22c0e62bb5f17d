"""In a Blender with a window: install the zip, show what is to be seen, say when it is drawn.

Started by `cargo xtask photograph` as `blender --python photograph.py -- ZIP PROJECT READY WHAT`, where WHAT is `panel` (the
project tracked and snapped, with the tab beside it) or `pairs` (Match Strokes at work on two drawings).
"""

import math
import random
import sys
import time
from pathlib import Path

import addon_utils
import bpy

ZIP, PROJECT, READY = (Path(word).absolute() for word in sys.argv[sys.argv.index("--") + 1 :][:3])
WHAT = sys.argv[sys.argv.index("--") + 4]
MODULE = "bl_ext.user_default.rototoon"
TAB = "Rototoon"
_started = time.monotonic()


def prepare() -> None:
    """Everything that needs no drawn window."""
    addon_utils.enable("bl_pkg")
    bpy.ops.extensions.package_install_files(filepath=str(ZIP), repo="user_default", enable_on_install=True)
    if MODULE not in bpy.context.preferences.addons:
        raise RuntimeError(f"{ZIP} was not installed and enabled")
    for ob in list(bpy.data.objects):
        bpy.data.objects.remove(ob)
    SCENES[WHAT]()


def tracked() -> None:
    """The project with its tracks and paths."""
    bpy.ops.rototoon.import_document(filepath=str(PROJECT), keep_numbers=True)
    for operator in (bpy.ops.rototoon.track, bpy.ops.rototoon.snap):
        if operator("EXEC_DEFAULT") != {"FINISHED"}:
            raise RuntimeError(f"{operator} did not finish")
    bpy.context.scene.frame_set((bpy.context.scene.frame_start + bpy.context.scene.frame_end) // 3)


def ellipse(x, y, across, up, first=0.0, last=math.tau, steps=40):
    """Points of an ellipse or of a part of it, and whether it is closed."""
    closed = last - first >= math.tau
    turns = [first + (last - first) * k / (steps if closed else steps - 1) for k in range(steps)]
    return [(x + across * math.cos(t), y + up * math.sin(t)) for t in turns], closed


def figure() -> list:
    """The strokes of a figure, each with whether it is closed."""
    strokes = [ellipse(0, 1.6, 0.7, 0.8), ellipse(0, 1.35, 0.3, 0.2, 3.5, 5.9)]
    for side in (-1, 1):
        strokes.append(ellipse(0.25 * side, 1.7, 0.14, 0.18))
        strokes.append(ellipse(0.25 * side, 1.68, 0.05, 0.07))
        strokes.append(ellipse(0.25 * side, 2.0, 0.18, 0.1, 0.4, 2.7))
        strokes.append(([(0.3 * side, -0.9), (0.35 * side, -1.6), (0.4 * side, -2.2), (0.7 * side, -2.2)], False))
    lines = [
        [(0, 1.65), (0.1, 1.45), (-0.02, 1.45)],
        [(-0.2, 0.82), (-0.6, 0.6), (-0.5, -0.9), (0.5, -0.9), (0.6, 0.6), (0.2, 0.82)],
        [(-0.6, 0.6), (-1.2, 0.1), (-1.3, -0.6)],
        [(0.6, 0.6), (1.2, 0.1), (1.5, 0.7)],
        [(-0.5, -0.4), (0.5, -0.4)],
    ]
    lines += [[(-0.4 + 0.2 * k, 2.3), (-0.45 + 0.22 * k, 2.7)] for k in range(5)]
    return strokes + [(line, False) for line in lines]


def turned() -> list:
    """The figure drawn again further on: without its belt, in another order, every other stroke the other way round."""
    cosine, sine = math.cos(0.25), math.sin(0.25)
    strokes = []
    for k, (points, closed) in enumerate(figure()):
        moved = [(cosine * x - sine * y + 1.2, sine * x + cosine * y + 0.15) for x, y in points]
        if k != 14:
            strokes.append((moved[::-1] if k % 2 else moved, closed))
    random.Random(3).shuffle(strokes)
    return strokes


def drawn() -> None:
    """Two drawings of a figure."""
    data = getattr(bpy.data, "grease_pencils_v3", bpy.data.grease_pencils).new("Figure")
    ob = bpy.data.objects.new("Figure", data)
    bpy.context.collection.objects.link(ob)
    layer = data.layers.new("Lines")
    for frame, strokes in ((1, figure()), (13, turned())):
        drawing = layer.frames.new(frame).drawing
        drawing.add_strokes([len(points) for points, _ in strokes])
        for stroke, (points, closed) in zip(drawing.strokes, strokes):
            stroke.cyclic = closed
            for point, (x, y) in zip(stroke.points, points):
                point.position, point.radius = (x, 0, y), 0.012
    bpy.context.view_layer.objects.active = ob
    bpy.context.scene.frame_set(6)


SCENES = {"panel": tracked, "pairs": drawn}


def view() -> tuple[bpy.types.Area, bpy.types.Region]:
    """The 3D view and its sidebar."""
    area = next(area for area in bpy.context.window_manager.windows[0].screen.areas if area.type == "VIEW_3D")
    return area, next(region for region in area.regions if region.type == "UI")


def in_view():
    """The context of the 3D view."""
    area, _ = view()
    region = next(region for region in area.regions if region.type == "WINDOW")
    return bpy.context.temp_override(window=bpy.context.window_manager.windows[0], area=area, region=region)


def show() -> float | None:
    """Called by the timer until the tab is on screen."""
    area, sidebar = view()
    space = area.spaces.active
    if not space.show_region_ui or (WHAT == "panel" and space.region_3d.view_perspective != "CAMERA"):
        space.show_region_ui = True
        space.shading.type = "SOLID"
        if WHAT == "panel":
            space.region_3d.view_perspective = "CAMERA"
        area.tag_redraw()
        return 1.0
    try:
        # The tabs exist only once the region has been drawn.
        if sidebar.active_panel_category != TAB:
            sidebar.active_panel_category = TAB
            area.tag_redraw()
            return 1.0
    except (AttributeError, TypeError) as error:
        if time.monotonic() - _started < 120:
            return 1.0
        READY.write_text(f"failed: {error}", encoding="utf-8")
        return None
    if WHAT == "pairs":
        with in_view():
            bpy.ops.view3d.view_axis(type="FRONT")
            bpy.ops.view3d.view_all()
            bpy.ops.rototoon.match_strokes("INVOKE_DEFAULT")
    bpy.app.timers.register(lambda: READY.write_text("ready", encoding="utf-8") and None, first_interval=5.0)
    return None


def start() -> None:
    """Reports what went wrong to whoever waits."""
    try:
        prepare()
    except Exception as error:  # told to the waiting program, which has no other way to know
        READY.write_text(f"failed: {error}", encoding="utf-8")
        raise
    bpy.app.timers.register(show, first_interval=1.0)


bpy.app.timers.register(start, first_interval=1.0)
