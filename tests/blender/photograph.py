"""In a Blender with a window: install the zip, import a project, track and snap it, show the tab, say when it is drawn.

Started by `cargo xtask photograph` as `blender --python photograph.py -- ZIP PROJECT READY`.
"""

import sys
import time
from pathlib import Path

import addon_utils
import bpy

ZIP, PROJECT, READY = (Path(word).absolute() for word in sys.argv[sys.argv.index("--") + 1 :][:3])
MODULE = "bl_ext.user_default.rototoon"
TAB = "Rototoon"
_started = time.monotonic()


def prepare() -> None:
    """Everything that needs no drawn window."""
    bpy.context.preferences.view.show_splash = False
    addon_utils.enable("bl_pkg")
    bpy.ops.extensions.package_install_files(filepath=str(ZIP), repo="user_default", enable_on_install=True)
    if MODULE not in bpy.context.preferences.addons:
        raise RuntimeError(f"{ZIP} was not installed and enabled")
    for ob in list(bpy.data.objects):
        bpy.data.objects.remove(ob)
    bpy.ops.rototoon.import_document(filepath=str(PROJECT), keep_numbers=True)
    for operator in (bpy.ops.rototoon.track, bpy.ops.rototoon.snap):
        if operator("EXEC_DEFAULT") != {"FINISHED"}:
            raise RuntimeError(f"{operator} did not finish")
    bpy.context.scene.frame_set((bpy.context.scene.frame_start + bpy.context.scene.frame_end) // 3)


def view() -> tuple[bpy.types.Area, bpy.types.Region]:
    """The 3D view and its sidebar."""
    area = next(area for area in bpy.context.window_manager.windows[0].screen.areas if area.type == "VIEW_3D")
    return area, next(region for region in area.regions if region.type == "UI")


def show() -> float | None:
    """Called by the timer until the tab is on screen."""
    area, sidebar = view()
    space = area.spaces.active
    if not space.show_region_ui or space.region_3d.view_perspective != "CAMERA":
        space.show_region_ui = True
        space.shading.type = "SOLID"
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
    bpy.app.timers.register(lambda: READY.write_text("ready", encoding="utf-8") and None, first_interval=3.0)
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
