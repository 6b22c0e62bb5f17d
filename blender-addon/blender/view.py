"""The 3D view and the mode in which an artist goes on: what the camera sees, Draw Mode, and a brush for contours.

Only a window has these. Without one, every function here does nothing and says so.
"""

from __future__ import annotations

import contextlib
from collections.abc import Iterator

import bpy

BRUSH = "Rototoon Contour"
WIDTH = 0.03
"""Width of a contour in scene units, where the footage is 10 units wide."""
SIMPLIFY = 0.008
"""How far a drawn line may be from its simplified one in scene units: about a pixel of the footage."""
HAND = {
    "use_settings_postprocess": True,
    "simplify_factor": SIMPLIFY,
    "pen_smooth_factor": 0.4,
    "pen_smooth_steps": 2,
    "pen_subdivision_steps": 0,
    "use_pressure": False,
    "use_strength_pressure": False,
    "use_settings_random": False,
    "pen_strength": 1.0,
    # In a new brush these are 0 or empty, with which Blender 5.2 draws invisible lines of thousands of points.
    "hardness": 1.0,
    "aspect": (1.0, 1.0),
    "stroke_type": "STROKE",
    "curve_type": "POLY",
    "input_samples": 10,
    "active_smooth_factor": 0.35,
    "simplify_pixel_threshold": 1.0,
    "fill_factor": 1.0,
    "conversion_threshold": 0.001,
}
"""A line of one width and strength, with few points."""


LINE = {"size": 14, "use_pressure_size": False, "use_locked_size": "SCENE", "unprojected_size": WIDTH}


def view_of(context) -> tuple | None:
    """Window, area and drawing region of a 3D view: the active one if it is one, otherwise the largest."""
    if bpy.app.background or context.window is None:
        return None
    areas = [area for area in context.window.screen.areas if area.type == "VIEW_3D"]
    if context.area is not None and context.area.type == "VIEW_3D":
        areas = [context.area]
    if not areas:
        return None
    area = max(areas, key=lambda area: area.width * area.height)
    return context.window, area, next(region for region in area.regions if region.type == "WINDOW")


@contextlib.contextmanager
def in_view(context) -> Iterator[bpy.types.Area | None]:
    """The context of a 3D view; `None` without a window."""
    found = view_of(context)
    if found is None:
        yield None
        return
    window, area, region = found
    with context.temp_override(window=window, area=area, region=region):
        yield area


def leave_mode(context) -> None:
    """Goes to Object Mode, in which objects can be made and chosen."""
    ob = context.view_layer.objects.active
    if ob is not None and ob.mode != "OBJECT":
        with in_view(context):
            bpy.ops.object.mode_set(mode="OBJECT")


def look_through_camera(context, camera: bpy.types.Object | None = None) -> None:
    """Shows what a camera sees, as large as it fits between toolbar and sidebar. Without one it is the scene's."""
    with in_view(context) as area:
        if area is None:
            return
        space = area.spaces.active
        space.use_local_camera = camera is not None and camera != context.scene.camera
        if space.use_local_camera:
            space.camera = camera
        space.region_3d.view_perspective = "CAMERA"
        bpy.ops.view3d.view_center_camera()
        _between_bars(area, space.region_3d)


def _between_bars(area, view) -> None:
    """Moves the camera's frame into the middle between the bars that lie over the view, and makes it smaller by as much.

    Blender's zoom z stands for the factor (z / 50 + √2)² / 4. An offset of 1 moves the frame by twice the view's width times this factor.
    """
    whole = next(region for region in area.regions if region.type == "WINDOW")
    left = sum(region.width for region in area.regions if region.type == "TOOLS" and _lies_over(region, whole))
    right = sum(region.width for region in area.regions if region.type == "UI" and _lies_over(region, whole))
    if left + right >= 0.8 * whole.width:
        return
    root = 2**0.5
    factor = (view.view_camera_zoom / 50 + root) ** 2 / 4 * (1 - (left + right) / whole.width)
    view.view_camera_zoom = ((4 * factor) ** 0.5 - root) * 50
    view.view_camera_offset = ((right - left) / whole.width / (4 * factor), 0.0)


def _lies_over(region, whole) -> bool:
    return region.width > 1 and whole.x <= region.x < whole.x + whole.width


def look_from_front(context) -> None:
    """Shows the selected objects from the front, where a new reference image faces."""
    with in_view(context) as area:
        if area is not None:
            bpy.ops.view3d.view_axis(type="FRONT")
            bpy.ops.view3d.view_selected()


def begin_to_draw(context) -> bool:
    """Goes to Draw Mode with the brush for contours. Returns whether there was a window for it."""
    with in_view(context) as area:
        if area is None:
            return False
        bpy.ops.object.mode_set(mode="PAINT_GREASE_PENCIL")
        bpy.ops.wm.tool_set_by_id(name="builtin.brush")
        _take_brush()
        return True


def contour_brush() -> bpy.types.Brush:
    """The brush for contours. It is made once in a file; an artist may change it."""
    brush = bpy.data.brushes.get(BRUSH)
    if brush is not None:
        return brush
    brush = bpy.data.brushes.new(BRUSH, mode="PAINT_GREASE_PENCIL")
    for name, value in HAND.items():
        if name in brush.gpencil_settings.bl_rna.properties:
            setattr(brush.gpencil_settings, name, value)
    for name, value in LINE.items():
        if name in brush.bl_rna.properties:
            setattr(brush, name, value)
    brush.asset_mark()
    return brush


def _take_brush() -> None:
    """Makes the brush for contours the active one. Brushes of a file are chosen as its assets."""
    name = contour_brush().name
    # If Blender refuses, the artist draws with the brush that is active.
    with contextlib.suppress(RuntimeError):
        bpy.ops.brush.asset_activate(asset_library_type="LOCAL", relative_asset_identifier=f"Brush/{name}")
