"""What all panels of the tab share: their place, and a button that opens their page of the documentation."""

from __future__ import annotations

from ..blender import grease_pencil as gp


class Panel:
    """A panel of the tab Rototoon."""

    bl_space_type = "VIEW_3D"
    bl_region_type = "UI"
    bl_category = "Rototoon"
    page = "artist/panels.html"
    """Page of the documentation that explains the panel."""

    def draw_header_preset(self, _context) -> None:
        """Called by Blender."""
        row = self.layout.row()
        row.emboss = "NONE"
        row.operator("rototoon.help", text="", icon="QUESTION").page = self.page


class DrawingPanel(Panel):
    """A panel of Grease Pencil objects."""

    @classmethod
    def poll(cls, context) -> bool:
        """Called by Blender."""
        return settings_of(context) is not None


def settings_of(context):
    """The settings of the active Grease Pencil object; `None` if there is none."""
    return context.object.rototoon if gp.is_drawing(context.object) else None
