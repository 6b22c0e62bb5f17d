"""Blender's windows."""

import bpy


def redraw_views() -> None:
    """Redraws all 3D views and their sidebars."""
    for window in bpy.context.window_manager.windows:
        for area in window.screen.areas if window.screen is not None else ():
            if area.type == "VIEW_3D":
                area.tag_redraw()
