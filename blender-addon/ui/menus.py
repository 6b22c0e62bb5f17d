"""Menus: Rototoon in the menus of the 3D view and of files, a pie menu, and footage dropped into the view.

Search (F3) finds what the menus of the view contain, so every operator of the tab is in one of these.
"""

from __future__ import annotations

import bpy

from ..blender import grease_pencil as gp
from ..capture.operators.footage_from_file import FILTER


def _entries(layout, *names: str) -> None:
    for name in names:
        if name:
            layout.operator(f"rototoon.{name}")
        else:
            layout.separator()


class _Menu(bpy.types.Menu):
    names: tuple[str, ...] = ()

    def draw(self, _context):
        self.layout.operator_context = "INVOKE_DEFAULT"
        _entries(self.layout, *self.names)


class ROTOTOON_MT_strokes(_Menu):
    bl_idname = "ROTOTOON_MT_strokes"
    bl_label = "Strokes"
    names = ("fit_strokes", "hidden_lines")


class ROTOTOON_MT_tween(_Menu):
    bl_idname = "ROTOTOON_MT_tween"
    bl_label = "Tween"
    names = ("match_strokes", "in_between", "update_in_betweens", "suggest_breakdown", "clear_in_betweens")


class ROTOTOON_MT_lines(_Menu):
    bl_idname = "ROTOTOON_MT_lines"
    bl_label = "Lines"
    names = ("trace_drawing", "trace_image", "carry_strokes", "", "next_doubt", "accept_doubt", "match_lines", "spread_edits", "make_part", "", "clear_lines")


class ROTOTOON_MT_paint(_Menu):
    bl_idname = "ROTOTOON_MT_paint"
    bl_label = "Paint"
    names = ("paint_bucket", "fill_drawings", "", "recolour", "remove_recolour", "", "next_doubtful_region", "", "clear_fills")


class ROTOTOON_MT_style(_Menu):
    bl_idname = "ROTOTOON_MT_style"
    bl_label = "Style"
    names = ("depth_mark", "save_clip", "refresh_clips", "import_motion", "", "reshape_drawing", "reshape_picture", "apply_motion")

    def draw(self, _context):
        self.layout.operator_context = "INVOKE_DEFAULT"
        self.layout.operator_menu_enum("rototoon.choose_body", "body")
        self.layout.operator_menu_enum("rototoon.define_limbs", "point")
        _entries(self.layout, *self.names)


class ROTOTOON_MT_footage(_Menu):
    bl_idname = "ROTOTOON_MT_footage"
    bl_label = "Footage"
    names = ("footage_from_file", "footage_from_camera", "footage_from_reference", "", "conform")


class ROTOTOON_MT_main(_Menu):
    bl_idname = "ROTOTOON_MT_main"
    bl_label = "Rototoon"

    def draw(self, _context):
        layout = self.layout
        layout.operator_context = "INVOKE_DEFAULT"
        _entries(layout, "setup", "open_sample")
        layout.menu("ROTOTOON_MT_footage")
        _entries(layout, "", "draw_contours", "new_key", "match_contours", "", "track", "weakest_frame", "exchanged_parts", "unseen_part", "show_confidence", "hide_part", "hide_unseen")
        layout.operator_menu_enum("rototoon.release_pins", "which")
        _entries(layout, "clear_generated", "", "snap", "")
        for name in ("strokes", "tween", "lines", "paint", "style"):
            layout.menu(f"ROTOTOON_MT_{name}")
        _entries(layout, "", "import_document", "export_document", "contours_to_mask", "")
        _entries(layout, "send_to_farm", "collect_results", "", "help")


class ROTOTOON_MT_armature(_Menu):
    bl_idname = "ROTOTOON_MT_armature"
    bl_label = "Rototoon"
    names = ("save_clip_from_armature", "drive_bones", "guess_bones")


class ROTOTOON_MT_pie(bpy.types.Menu):
    bl_idname = "ROTOTOON_MT_pie"
    bl_label = "Rototoon"

    def draw(self, context):
        pie = self.layout.menu_pie()
        pie.operator("rototoon.new_key", icon="KEY_HLT")
        pie.operator("rototoon.track", icon="TRACKING_FORWARDS")
        pie.operator("rototoon.weakest_frame", icon="FRAME_NEXT")
        pie.operator("rototoon.draw_contours", icon="GREASEPENCIL")
        pie.operator("rototoon.show_confidence", icon="HIDE_OFF")
        pie.operator("rototoon.snap", icon="SNAP_ON")
        if gp.is_drawing(context.object):
            pie.prop(context.object.rototoon, "live", icon="FILE_REFRESH")
        else:
            pie.separator()
        pie.operator("rototoon.release_pins", icon="UNPINNED").which = "FRAME"


class ROTOTOON_FH_footage(bpy.types.FileHandler):
    bl_idname = "ROTOTOON_FH_footage"
    bl_label = "Rototoon Footage"
    bl_import_operator = "rototoon.setup"
    bl_file_extensions = FILTER.replace("*", "")

    @classmethod
    def poll_drop(cls, context):
        return context.area is not None and context.area.type == "VIEW_3D"


class ROTOTOON_FH_document(bpy.types.FileHandler):
    bl_idname = "ROTOTOON_FH_document"
    bl_label = "Rototoon Project"
    bl_import_operator = "rototoon.import_document"
    bl_export_operator = "rototoon.export_document"
    bl_file_extensions = ".json"

    @classmethod
    def poll_drop(cls, context):
        return context.area is not None and context.area.type == "VIEW_3D"


def _in_view(self, context) -> None:
    self.layout.separator()
    ob = context.object
    self.layout.menu("ROTOTOON_MT_armature" if ob is not None and ob.type == "ARMATURE" else "ROTOTOON_MT_main")


def _in_context(self, context) -> None:
    """The entries for the strokes under the mouse."""
    if not gp.is_drawing(context.object) or not context.object.rototoon.pattern:
        return
    layout = self.layout
    layout.separator()
    layout.operator_context = "INVOKE_DEFAULT"
    layout.operator("rototoon.new_key", icon="KEY_HLT")
    layout.operator("rototoon.track", icon="TRACKING_FORWARDS")
    layout.operator("rototoon.release_pins", text="Release Selected Pins", icon="UNPINNED").which = "SELECTED"
    layout.menu("ROTOTOON_MT_main")


def _import(self, _context) -> None:
    self.layout.operator("rototoon.import_document", text="Rototoon Project (.json)")


def _export(self, _context) -> None:
    self.layout.operator("rototoon.export_document", text="Rototoon Project (.json)")


_PLACES = (
    ("VIEW3D_MT_object", _in_view),
    ("VIEW3D_MT_edit_greasepencil", _in_view),
    ("VIEW3D_MT_paint_grease_pencil", _in_view),
    ("VIEW3D_MT_pose", _in_view),
    ("VIEW3D_MT_greasepencil_edit_context_menu", _in_context),
    ("VIEW3D_PT_greasepencil_draw_context_menu", _in_context),
    ("TOPBAR_MT_file_import", _import),
    ("TOPBAR_MT_file_export", _export),
)


def register() -> None:
    """Adds the entries to Blender's menus."""
    for name, draw in _PLACES:
        if hasattr(bpy.types, name):
            getattr(bpy.types, name).append(draw)


def unregister() -> None:
    """Removes them."""
    for name, draw in _PLACES:
        if hasattr(bpy.types, name):
            getattr(bpy.types, name).remove(draw)


CLASSES = (
    ROTOTOON_MT_strokes,
    ROTOTOON_MT_tween,
    ROTOTOON_MT_lines,
    ROTOTOON_MT_paint,
    ROTOTOON_MT_style,
    ROTOTOON_MT_footage,
    ROTOTOON_MT_main,
    ROTOTOON_MT_armature,
    ROTOTOON_MT_pie,
    ROTOTOON_FH_footage,
    ROTOTOON_FH_document,
)
