"""The list of parts."""

import bpy

from ..capture import ends


class ROTOTOON_UL_parts(bpy.types.UIList):
    """Name, closedness and depth of each part."""

    def draw_item(self, _context, layout, _data, item, _icon, _active_data, _active_property, _index=0, _flag=0):
        """Called by Blender."""
        row = layout.row(align=True)
        row.prop(item, "name", text="", emboss=False, icon="ERROR" if ends.wanted(item) else "NONE")
        icon = "MESH_CIRCLE" if item.closed else "IPO_EASE_IN_OUT"
        row.prop(item, "closed", text="", icon=icon, emboss=False)
        depth = row.row()
        depth.ui_units_x = 3
        depth.prop(item, "depth", text="", emboss=False)


def headings(layout) -> None:
    """What the columns of the list are, above it."""
    row = layout.row(align=True)
    row.active = False
    row.label(text="Part")
    side = row.row()
    side.alignment = "RIGHT"
    side.label(text="Closed")
    side.label(text="Depth")


CLASSES = (ROTOTOON_UL_parts,)
