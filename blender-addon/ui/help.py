"""Help: opens a page of the documentation, the one that comes with the extension or the one at the address in the preferences."""

from __future__ import annotations

from pathlib import Path

import bpy

from ..blender.preferences import preferences

SHIPPED = Path(__file__).resolve().parents[1] / "help"
"""The pages that come with the extension. Packing the extension puts them there."""
PAGES = (
    ("bpy.ops.rototoon.setup*", "artist/tutorial.html"),
    ("bpy.ops.rototoon.open_sample*", "artist/tutorial.html"),
    ("bpy.ops.rototoon.draw_contours*", "artist/tutorial.html"),
    ("bpy.ops.rototoon.new_key*", "artist/keys.html"),
    ("bpy.ops.rototoon.track*", "artist/panels.html#track"),
    ("bpy.ops.rototoon.*pins*", "artist/corrections.html"),
    ("bpy.ops.rototoon.weakest_frame*", "artist/corrections.html"),
    ("bpy.ops.rototoon.exchanged_parts*", "artist/corrections.html"),
    ("bpy.ops.rototoon.unseen_part*", "artist/corrections.html"),
    ("bpy.ops.rototoon.hide_unseen*", "artist/corrections.html"),
    ("bpy.ops.rototoon.hide_part*", "artist/corrections.html"),
    ("bpy.ops.rototoon.snap*", "artist/strokes.html"),
    ("bpy.ops.rototoon.fit_strokes*", "artist/strokes.html"),
    ("bpy.ops.rototoon.hidden_lines*", "artist/strokes.html"),
    ("bpy.ops.rototoon.contours_to_mask*", "artist/strokes.html"),
    ("bpy.ops.rototoon.trace_*", "artist/lines.html"),
    ("bpy.ops.rototoon.carry_strokes*", "artist/lines.html"),
    ("bpy.ops.rototoon.match_lines*", "artist/lines.html"),
    ("bpy.ops.rototoon.accept_doubt*", "artist/lines.html"),
    ("bpy.ops.rototoon.clear_lines*", "artist/lines.html"),
    ("bpy.ops.rototoon.spread_edits*", "artist/lines.html"),
    ("bpy.ops.rototoon.make_part*", "artist/lines.html"),
    ("bpy.ops.rototoon.paint_bucket*", "artist/lines.html"),
    ("bpy.ops.rototoon.fill_drawings*", "artist/lines.html"),
    ("bpy.ops.rototoon.*recolour*", "artist/lines.html"),
    ("bpy.ops.rototoon.next_doubtful_region*", "artist/lines.html"),
    ("bpy.ops.rototoon.clear_fills*", "artist/lines.html"),
    ("bpy.ops.rototoon.*between*", "artist/tween.html"),
    ("bpy.ops.rototoon.match_strokes*", "artist/tween.html"),
    ("bpy.ops.rototoon.suggest_breakdown*", "artist/tween.html"),
    ("bpy.ops.rototoon.*clip*", "artist/style.html"),
    ("bpy.ops.rototoon.reshape*", "artist/style.html"),
    ("bpy.ops.rototoon.*bones*", "artist/bones.html"),
    ("bpy.ops.rototoon.*", "artist/panels.html"),
    ("bpy.types.rototoon*", "artist/panels.html"),
)
"""Pages of the buttons, for Online Manual in their context menus."""


def address(page: str) -> str:
    """The address of a page such as `artist/panels.html#track`; empty if there is none."""
    online = preferences().help_address.strip()
    if online:
        return f"{online.rstrip('/')}/{page}"
    path, _, anchor = page.partition("#")
    file = SHIPPED / path
    return file.as_uri() + (f"#{anchor}" if anchor else "") if file.is_file() else ""


class ROTOTOON_OT_help(bpy.types.Operator):
    bl_idname = "rototoon.help"
    bl_label = "Rototoon Help"
    bl_description = "Open the page of the documentation that explains this panel, in the web browser. It needs no network"
    bl_options = {"INTERNAL"}

    page: bpy.props.StringProperty(name="Page", description="Page of the documentation", default="artist/panels.html")

    def execute(self, _context):
        """Called by Blender."""
        found = address(self.page)
        if not found:
            self.report(
                {"WARNING"},
                "This build has no documentation: set the Help Address in the preferences of the extension, "
                "or install the zip that `cargo xtask bundle` makes",
            )
            return {"CANCELLED"}
        if not bpy.app.background:
            bpy.ops.wm.url_open(url=found)
        self.report({"INFO"}, found)
        return {"FINISHED"}


def _manual():
    """Blender asks for this when somebody chooses Online Manual in a button's context menu."""
    start = address("artist/panels.html").removesuffix("artist/panels.html")
    return start, PAGES if start else ()


def register() -> None:
    """Adds the pages to Blender's manual."""
    bpy.utils.register_manual_map(_manual)


def unregister() -> None:
    """Removes them."""
    bpy.utils.unregister_manual_map(_manual)


CLASSES = (ROTOTOON_OT_help,)
