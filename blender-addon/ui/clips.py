"""The list of a library's clips, in the panels Style and Bones."""

from __future__ import annotations

import bpy

from ..blender import grease_pencil as gp
from ..style import clip_browser
from . import clip_preview


class ROTOTOON_UL_clips(bpy.types.UIList):
    """Character, motion and number of frames of each clip. Files that cannot be used come last."""

    def draw_item(self, _context, layout, _data, item, _icon, _active_data, _active_property, _index=0, _flag=0):
        """Called by Blender."""
        if item.trouble:
            row = layout.row()
            row.enabled = False
            row.label(text=" ".join(filter(None, (item.character, item.motion))), icon="ERROR")
            return
        found = clip_browser.shelf()
        row = found.find(item.character, item.motion) if found is not None else None
        split = layout.split(factor=0.5)
        split.label(text=item.character, icon_value=clip_preview.icon(row) if row is not None else 0)
        split = split.split(factor=0.7)
        split.label(text=item.motion if row is None or row.human else f"{item.motion} ({row.body.name})")
        split.label(text=str(item.frames))

    def draw_filter(self, _context, _layout):
        """Called by Blender. Draws nothing, since the filter is above the list."""

    def filter_items(self, _context, data, name):
        """Called by Blender."""
        wanted = data.character, data.motion
        return [self.bitflag_filter_item * clip_browser.fits(item, *wanted) for item in getattr(data, name)], []


def draw_browser(layout, context) -> None:
    """The list with its filter, and the chosen clip's figure."""
    listed = clip_browser.browser()
    if not clip_browser.is_listed(context.object):
        _read_soon(context.object)
    row = layout.row(align=True)
    row.prop(listed, "character", text="", icon="USER", placeholder="Character")
    row.prop(listed, "motion", text="", icon="ACTION", placeholder="Motion")
    row.operator("rototoon.refresh_clips", text="", icon="FILE_REFRESH")
    row.operator("rototoon.import_motion", text="", icon="IMPORT")
    layout.template_list("ROTOTOON_UL_clips", "", listed, "clips", listed, "active", rows=4)
    found = clip_browser.shelf()
    for trouble in found.troubles if found is not None else ():
        _wrapped(layout, trouble)
    chosen = clip_browser.chosen()
    if chosen is not None:
        layout.template_icon(clip_preview.figure(chosen, context.scene), scale=7.0)
        moment = 1 + round(clip_preview.posture_of(chosen, context.scene) * chosen.fps / chosen.rate)
        row = layout.row()
        body = "" if chosen.human else f", {chosen.body.name}"
        row.label(text=f"Frame {moment} of {chosen.frames}, {chosen.fps:g} fps{body}")
        if gp.is_drawing(context.object):
            row.prop(listed, "in_view", text="", icon="OVERLAY")
        if chosen.source:
            layout.label(text=chosen.source, icon="FILE_BLEND")
    elif 0 <= listed.active < len(listed.clips):
        _wrapped(layout, listed.clips[listed.active].trouble)


def _wrapped(layout, text: str, width: int = 44) -> None:
    column = layout.box().column(align=True)
    line = ""
    for word in text.split():
        if line and len(line) + len(word) >= width:
            column.label(text=line, icon="BLANK1")
            line = ""
        line = f"{line} {word}".strip()
    column.label(text=line, icon="ERROR")


_asked = ""


def _read_soon(ob) -> None:
    """Reads the library a moment later, since panels must not change data while they are drawn."""
    global _asked
    if bpy.app.background or _asked == ob.name:
        return
    _asked = name = ob.name

    def read():
        global _asked
        _asked = ""
        found = bpy.data.objects.get(name)
        # Meanwhile the extension may have been switched off.
        if hasattr(found, "rototoon"):
            clip_browser.refresh_for(found)

    bpy.app.timers.register(read, first_interval=0.01)


CLASSES = (ROTOTOON_UL_clips,)
