"""The panels below the steps, in the order of the work: footage, parts, track, snap, strokes, tween, lines, paint, style, document.

Only what an artist needs all the time is open at first.
"""

import bpy

from ..capture import absence, ends, exchanged, live, stand, unseen
from ..common.wording import counted
from ..paint import recolours
from ..style import clip_browser, limbs
from ..tween import spacing_curve
from .clips import draw_browser
from .lists import headings
from .panel import DrawingPanel, Panel, settings_of
from .start import lines_of, wrapped

CLOSED = {"DEFAULT_CLOSED"}


class ROTOTOON_PT_footage(Panel, bpy.types.Panel):
    bl_idname = "ROTOTOON_PT_footage"
    bl_label = "Footage"
    bl_options = CLOSED
    page = "artist/panels.html#footage"

    def draw(self, context):
        layout, settings = self.layout, settings_of(context)
        layout.operator("rototoon.setup", icon="ADD")
        column = layout.column(align=True)
        column.label(text="Other footage for the active object")
        column.operator("rototoon.footage_from_file", text="From File", icon="FILE_FOLDER")
        column.operator("rototoon.footage_from_camera", text="From Camera", icon="CAMERA_DATA")
        column.operator("rototoon.footage_from_reference", text="From Reference Image", icon="IMAGE_REFERENCE")
        if settings is None or not settings.pattern:
            return
        layout.operator("rototoon.conform", icon="FILE_REFRESH")
        column = layout.column()
        column.use_property_split = True
        column.use_property_decorate = False
        column.prop(settings, "pattern", text="Pictures")
        row = column.row(align=True)
        row.prop(settings, "first", text="First, Last")
        row.prop(settings, "last", text="")
        column.prop(settings, "hold_gaps")
        column.prop(settings, "frame_offset")
        column.prop(settings, "plane")
        column.prop(settings, "reference" if settings.plane == "REFERENCE" else "camera")
        layout.label(text=f"{settings.width} x {settings.height} pixels")


class ROTOTOON_PT_parts(DrawingPanel, bpy.types.Panel):
    bl_idname = "ROTOTOON_PT_parts"
    bl_label = "Parts"
    page = "artist/panels.html#parts"

    def draw(self, context):
        layout, settings = self.layout, settings_of(context)
        layout.use_property_decorate = False
        headings(layout)
        layout.template_list("ROTOTOON_UL_parts", "", settings, "parts", settings, "active_part", rows=4)
        now = stand.of(context.object)
        text = said_of_contours(settings, now)
        if text:
            wrapped(layout, text)
        column = layout.column(align=True)
        column.operator("rototoon.draw_contours", icon="GREASEPENCIL")
        column.operator("rototoon.new_key", icon="KEY_HLT")
        if now.loose:
            column.operator("rototoon.match_contours", icon="UV_SYNC_SELECT")
        layout.prop(settings, "contours_layer", text="Layer")


def said_of_contours(settings, now: stand.Stand) -> str:
    """What the list of parts does not show: that nothing is drawn, or which strokes wait for their part."""
    if not now.keys:
        return f'Nothing is drawn on the layer "{settings.contours_layer}" yet'
    if not now.loose:
        return ""
    count, frames = sum(now.loose.values()), sorted(now.loose)
    new = "1 new contour" if count == 1 else f"{count} new contours"
    where = f"frame {frames[0]}" if len(frames) == 1 else f"{len(frames)} frames"
    return f"{new} on {where}: Track finds the part of each"


ENDS = {
    ends.LOST: ("needs a key on frame {}", "need a key on frame {}", "KEY_HLT"),
    ends.CUT: ("ends before the cut on frame {}", "end before the cut on frame {}", "INFO"),
    ends.LEFT: ("left the picture on frame {}", "left the picture on frame {}", "INFO"),
}
"""Texts for one part and for several, and icon, for the end of tracks from a single key, by its reason."""


def said_of_ends(settings) -> list[tuple[str, str]]:
    """Text and icon for each end of tracks from a single key. Parts that end alike are counted: the list of parts marks them."""
    alike: dict[tuple[int, str], list[str]] = {}
    for part in settings.parts:
        for frame, reason in ends.of(part):
            alike.setdefault((frame + settings.frame_offset, reason), []).append(part.name)
    return [_said_of_end(names, frame, reason) for (frame, reason), names in alike.items()]


def _said_of_end(names: list[str], frame: int, reason: str) -> tuple[str, str]:
    one, several, icon = ENDS.get(reason, ENDS[ends.LOST])
    text = f"{names[0]} {one}" if len(names) == 1 else f"{len(names)} parts {several}"
    return text.format(frame), icon


def _draw_ends(layout, settings) -> None:
    said = said_of_ends(settings)
    if said:
        column = layout.box().column(align=True)
        for text, icon in said:
            column.label(text=text, icon=icon)


def _draw_question(layout, text: str, operator: str, **given):
    """A question that Track asks, in lines. A click on it goes there. Returns the column for answers."""
    column = layout.box().column(align=True)
    for line, shown in enumerate(lines_of(text, 30)):
        row = column.row()
        row.alignment = "LEFT"
        button = row.operator(operator, text=shown, icon="BLANK1" if line else "QUESTION", emboss=False)
        for name, value in given.items():
            setattr(button, name, value)
    return column


def _draw_questions(layout, ob) -> None:
    """What may have changed places, and what can probably not be seen, with a button that says that it is so."""
    for number, pair in enumerate(exchanged.of(ob)):
        _draw_question(layout, str(pair), "rototoon.exchanged_parts", pair=number)
    for number, question in enumerate(unseen.questions(ob)):
        column = _draw_question(layout, str(question), "rototoon.unseen_part", question=number)
        column.operator("rototoon.hide_unseen", text="Hide It There", icon="GHOST_ENABLED").question = number


def _is_hidden_here(context, settings) -> bool:
    """Whether the part that is chosen in the list is marked as hidden on the current frame."""
    if settings.active_part >= len(settings.parts):
        return False
    return absence.is_hidden(settings.parts[settings.active_part], context.scene.frame_current - settings.frame_offset)


def said_of_held(context) -> str:
    """What corrections hold on the scene's frame; empty if nothing is held there."""
    held = stand.of(context.object).held.get(context.scene.frame_current)
    if held is None:
        return ""
    counts = ((held.lines, "whole line"), (held.points, "point"), (held.middles, "middle"))
    return "Held here: " + ", ".join(counted(count, noun) for count, noun in counts if count)


class ROTOTOON_PT_track(DrawingPanel, bpy.types.Panel):
    bl_idname = "ROTOTOON_PT_track"
    bl_label = "Track"
    page = "artist/panels.html#track"

    def draw(self, context):
        layout, settings = self.layout, settings_of(context)
        layout.prop(settings, "preset")
        row = layout.row()
        row.scale_y = 1.5
        row.operator("rototoon.track", icon="TRACKING_FORWARDS")
        side = row.row()
        side.ui_units_x = 4
        side.prop(settings, "live", icon="FILE_REFRESH", toggle=True)
        if settings.live:
            text, icon = live.status(context.object)
            layout.label(text=text, icon=icon)
        _draw_ends(layout, settings)
        _draw_questions(layout, context.object)
        column = layout.column(align=True)
        column.operator("rototoon.weakest_frame", icon="FRAME_NEXT")
        icon = "HIDE_OFF" if settings.show_confidence else "HIDE_ON"
        column.operator("rototoon.show_confidence", icon=icon, depress=settings.show_confidence)
        hidden = _is_hidden_here(context, settings)
        column.operator("rototoon.hide_part", icon="GHOST_DISABLED" if hidden else "GHOST_ENABLED", depress=hidden)
        layout.prop(settings, "show_lost")
        # In the row of a label and a menu, Blender cuts off the label in a sidebar of its usual width.
        split = layout.split(factor=0.4)
        split.label(text="Moved Line:")
        split.prop(settings, "moved_line", text="")
        layout.prop(settings, "show_pins")
        held = said_of_held(context)
        if held:
            layout.label(text=held, icon="PINNED")
        row = layout.row(align=True)
        # Blender draws a menu of an operator as if it could always be chosen.
        row.enabled = bpy.ops.rototoon.release_pins.poll()
        row.operator_menu_enum("rototoon.release_pins", "which", text="Release Pins", icon="UNPINNED")
        layout.operator("rototoon.clear_generated", icon="TRASH")


class ROTOTOON_PT_snap(DrawingPanel, bpy.types.Panel):
    bl_idname = "ROTOTOON_PT_snap"
    bl_label = "Snap"
    bl_options = CLOSED
    page = "artist/panels.html#snap"

    def draw(self, context):
        settings = settings_of(context)
        self.layout.operator("rototoon.snap", icon="SNAP_ON")
        self.layout.prop(settings, "snapped_layer", text="Layer")


class ROTOTOON_PT_strokes(DrawingPanel, bpy.types.Panel):
    bl_idname = "ROTOTOON_PT_strokes"
    bl_label = "Strokes"
    bl_options = CLOSED
    page = "artist/strokes.html"

    def draw(self, _context):
        column = self.layout.column(align=True)
        column.operator("rototoon.fit_strokes", icon="IPO_EASE_IN_OUT")
        column.operator("rototoon.hidden_lines", icon="MOD_MASK")


SPACINGS = (
    (("LINEAR", "Linear"), ("EASE_IN", "Ease In"), ("EASE_OUT", "Ease Out")),
    (("EASE_IN_OUT", "In and Out"), ("BOUNCE", "Bounce")),
    (("CHART", "Chart"), ("CURVE", "Curve")),
)
"""Rows of buttons that draw in-betweens with a certain spacing."""


class ROTOTOON_PT_tween(DrawingPanel, bpy.types.Panel):
    bl_idname = "ROTOTOON_PT_tween"
    bl_label = "Tween"
    bl_options = CLOSED
    page = "artist/tween.html"

    def draw(self, context):
        layout = self.layout
        row = layout.row(align=True)
        row.operator("rototoon.match_strokes", icon="UV_SYNC_SELECT").layers = "ALL"
        side = row.row(align=True)
        side.ui_units_x = 5
        side.operator("rototoon.match_strokes", text="Active Layer").layers = "ACTIVE"
        column = layout.column(align=True)
        row = column.row(align=True)
        row.scale_y = 1.5
        row.operator("rototoon.in_between", icon="IPO_EASE_IN_OUT").frames = "CURRENT"
        for spacings in SPACINGS:
            row = column.row(align=True)
            for spacing, name in spacings:
                button = row.operator("rototoon.in_between", text=name)
                button.frames, button.spacing = "CURRENT", spacing
        node = spacing_curve.node()
        if node is not None:
            layout.template_curve_mapping(node, "mapping")
        column = layout.column(align=True)
        button = column.operator("rototoon.in_between", text="All Keys", icon="NEXT_KEYFRAME")
        button.frames = "ALL"
        column.operator("rototoon.update_in_betweens", icon="FILE_REFRESH")
        column.operator("rototoon.suggest_breakdown", icon="MARKER_HLT")
        layout.operator("rototoon.clear_in_betweens", icon="TRASH")


def pencil(layout, settings, heading: str, chosen: str, colour: str) -> None:
    """A pencil that counts if it is chosen, and its colour. Blender cuts the heading of a row to a few letters, and leaves that of a column whole."""
    row = layout.column(heading=heading).row(align=True)
    row.prop(settings, chosen, text="")
    part = row.row(align=True)
    part.active = getattr(settings, chosen)
    part.prop(settings, colour, text="")


class ROTOTOON_PT_lines(DrawingPanel, bpy.types.Panel):
    bl_idname = "ROTOTOON_PT_lines"
    bl_label = "Lines"
    bl_options = CLOSED
    page = "artist/lines.html"

    def draw(self, context):
        layout, settings = self.layout, settings_of(context)
        column = layout.column()
        column.use_property_split = True
        column.use_property_decorate = False
        column.prop(settings, "line_style")
        column.prop(settings, "line_sensitivity")
        for heading, chosen, colour in (("Leave Out", "line_leave_out", "line_left_out"), ("Paint Only", "line_paint_only", "line_border")):
            pencil(column, settings, heading, chosen, colour)
        column.prop(settings, "lines_layer", text="Layer")
        row = layout.row(align=True)
        row.scale_y = 1.5
        row.operator("rototoon.trace_drawing", icon="LINE_DATA").frames = "ALL"
        side = row.row(align=True)
        side.ui_units_x = 4
        side.operator("rototoon.trace_drawing", text="This Frame").frames = "CURRENT"
        column = layout.column(align=True)
        column.operator("rototoon.trace_image", icon="IMAGE_REFERENCE")
        column.operator("rototoon.carry_strokes", icon="TRACKING_FORWARDS")
        column = layout.column(align=True)
        row = column.row(align=True)
        row.operator("rototoon.next_doubt", icon="FRAME_NEXT")
        row.menu("ROTOTOON_MT_doubts", text="", icon="DOWNARROW_HLT")
        column.operator("rototoon.accept_doubt", icon="CHECKMARK")
        column.operator("rototoon.match_lines", icon="UV_SYNC_SELECT")
        column.operator("rototoon.spread_edits", icon="NEXT_KEYFRAME")
        column.operator("rototoon.make_part", icon="MOD_MASK")
        layout.prop(settings, "show_doubts")
        layout.operator("rototoon.clear_lines", icon="TRASH")


class ROTOTOON_PT_paint(DrawingPanel, bpy.types.Panel):
    bl_idname = "ROTOTOON_PT_paint"
    bl_label = "Paint"
    bl_options = CLOSED
    page = "artist/lines.html#paint"

    def draw(self, context):
        layout, settings = self.layout, settings_of(context)
        column = layout.column()
        column.use_property_split = True
        column.use_property_decorate = False
        colour = column.column()
        colour.active = not settings.fill_nothing
        colour.prop(settings, "fill_colour")
        column.prop(settings, "fill_nothing")
        column.prop(settings, "fills_layer", text="Layer")
        # Beside a label of this length there is no room for it.
        layout.prop(settings, "fill_confidence")
        layout.operator("rototoon.paint_bucket", icon="BRUSH_DATA")
        row = layout.row(align=True)
        row.scale_y = 1.5
        row.operator("rototoon.fill_drawings", icon="COLOR").frames = "ALL"
        side = row.row(align=True)
        side.ui_units_x = 4
        side.operator("rototoon.fill_drawings", text="This Frame").frames = "CURRENT"
        column = layout.column(align=True)
        column.operator("rototoon.recolour", icon="UV_SYNC_SELECT")
        entries = recolours.entries(context.object)
        for place in range(len(settings.recolours)):
            row = column.row(align=True)
            row.label(text=entries[place].said() if place in entries else "Its material is gone")
            row.operator("rototoon.remove_recolour", text="", icon="X").place = place
        layout.operator("rototoon.next_doubtful_region", icon="FRAME_NEXT")
        layout.prop(settings, "show_fill_doubts")
        layout.operator("rototoon.clear_fills", icon="TRASH")


class ROTOTOON_PT_style(DrawingPanel, bpy.types.Panel):
    bl_idname = "ROTOTOON_PT_style"
    bl_label = "Style"
    bl_options = CLOSED
    page = "artist/style.html"

    def draw(self, context):
        layout, settings = self.layout, settings_of(context)
        layout.use_property_decorate = False
        layout.operator_menu_enum("rototoon.choose_body", "body", text=f"Body: {limbs.body_name(context.object)}", icon="ARMATURE_DATA")
        layout.operator_menu_enum("rototoon.define_limbs", "point", text="Define Limbs", icon="BONE_DATA")
        count = len(limbs.defined(context.object))
        lines = [counted(count, "limb")] if count else ["Draw a line across a limb", f'on the layer "{limbs.LAYER}"']
        labels = layout.column(align=True)
        for line in lines:
            labels.label(text=line)
        layout.operator("rototoon.depth_mark", icon="OVERLAY")
        layout.prop(settings, "clips_folder")
        layout.operator("rototoon.save_clip", icon="FILE_TICK")
        draw_browser(layout, context)
        chosen = clip_browser.chosen()
        column = layout.column(align=True)
        reshape = column.operator("rototoon.reshape_drawing", icon="MOD_ARMATURE")
        picture = column.operator("rototoon.reshape_picture", icon="MESH_GRID")
        row = column.row(align=True)
        row.enabled = chosen is None or chosen.human
        apply = row.operator("rototoon.apply_motion", icon="ARMATURE_DATA")
        if chosen is not None:
            reshape.character, reshape.motion = chosen.character, chosen.motion
            picture.character, picture.motion = chosen.character, chosen.motion
            apply.content, apply.motion = chosen.character, chosen.motion


class ROTOTOON_PT_document(Panel, bpy.types.Panel):
    bl_idname = "ROTOTOON_PT_document"
    bl_label = "Document"
    bl_options = CLOSED
    page = "artist/panels.html#document"

    def draw(self, _context):
        row = self.layout.row(align=True)
        row.operator("rototoon.import_document", text="Import", icon="IMPORT")
        row.operator("rototoon.export_document", text="Export", icon="EXPORT")
        self.layout.operator("rototoon.contours_to_mask", icon="MOD_MASK")
        column = self.layout.column(align=True)
        column.operator("rototoon.send_to_farm", text="Send to Farm…", icon="NETWORK_DRIVE")
        column.operator("rototoon.collect_results", text="Collect Results…", icon="IMPORT")


CLASSES = (
    ROTOTOON_PT_footage,
    ROTOTOON_PT_parts,
    ROTOTOON_PT_track,
    ROTOTOON_PT_snap,
    ROTOTOON_PT_strokes,
    ROTOTOON_PT_tween,
    ROTOTOON_PT_lines,
    ROTOTOON_PT_paint,
    ROTOTOON_PT_style,
    ROTOTOON_PT_document,
)
