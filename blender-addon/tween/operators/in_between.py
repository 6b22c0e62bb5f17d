"""In-between: draws the frames between keys."""

from dataclasses import replace

import bpy

from ...blender import strokes as st
from .. import charts, spacing_curve
from ..charts import WHOLE, Choices
from .tweening_base import LAYERS, SCOPES, Scoped, Tweening


class ROTOTOON_OT_in_between(Scoped, Tweening, bpy.types.Operator):
    bl_idname = "rototoon.in_between"
    bl_label = "In-between"
    bl_description = (
        "Draw the frames between keys. Strokes are matched in any order and direction. Groups of strokes swing along arcs, and "
        "turning strokes do not shrink. Your keys are never changed, and only what you changed is drawn again"
    )
    bl_options = {"REGISTER", "UNDO"}

    frames: bpy.props.EnumProperty(
        name="Frames",
        description="Between which keys",
        items=SCOPES,
    )
    layers: bpy.props.EnumProperty(name="Layers", description="On which layers", items=LAYERS, default="ALL")
    spacing: bpy.props.EnumProperty(
        name="Spacing", description="How far the movement has come on each in-between", items=charts.SPACINGS
    )
    chart: bpy.props.StringProperty(
        name="Chart",
        description="How far the movement has come on each in-between, in percent: 0 is the earlier key, 100 the later one. "
        "Values may go beyond. As many as there are in-betweens",
        default="10, 30, 70, 90",
    )
    curve: bpy.props.StringProperty(
        name="Curve",
        description="Times and shares of a spacing curve, such as 0 0, 0.3 0.8, 1 1. If empty, the curve in the panel",
        default="",
    )
    bounces: bpy.props.IntProperty(name="Bounces", description="Number of bounces", default=3, min=0, max=10)
    arcs: bpy.props.FloatProperty(
        name="Arcs",
        description="How much turning strokes move along arcs: 0 is straight, 1 is a full arc around the middle of the turn",
        default=0.5,
        min=0.0,
        max=1.0,
    )
    step: bpy.props.IntProperty(
        name="Frames Each",
        description="Number of frames that a drawing stays: 1 is on ones, 2 on twos",
        default=1,
        min=1,
        soft_max=4,
    )
    rigid: bpy.props.BoolProperty(
        name="Keep Shapes", description="Shapes bend and turn instead of shrinking", default=True
    )
    contacts: bpy.props.BoolProperty(
        name="Keep Contacts", description="Strokes that touch on both keys stay in touch", default=True
    )
    leaving: bpy.props.EnumProperty(
        name="New and Lost", description="Movement of strokes that only one of two keys has", items=charts.LEAVING
    )
    pegs: bpy.props.EnumProperty(name="Moves as One", description="Which strokes move as one", items=charts.PEGS)
    follow: bpy.props.BoolProperty(
        name="Follow Captured",
        description="Strokes that lie on a captured contour move with it, as it was tracked in the footage",
        default=True,
    )
    rest: bpy.props.BoolProperty(
        name="Rest at the Ends",
        description="A smooth movement begins and ends at rest. Otherwise it keeps its speed there",
        default=True,
    )

    def draw(self, _context):
        layout = self.layout
        layout.use_property_split = True
        layout.prop(self, "frames")
        layout.prop(self, "layers")
        layout.separator()
        layout.prop(self, "spacing")
        if self.spacing == "CHART":
            layout.prop(self, "chart")
        elif self.spacing == "BOUNCE":
            layout.prop(self, "bounces")
        elif self.spacing == "CURVE":
            layout.prop(self, "curve", placeholder="As drawn in the panel Tween")
        elif self.spacing == "SMOOTH":
            layout.prop(self, "rest")
        layout.prop(self, "arcs", slider=True)
        layout.prop(self, "step")
        layout.prop(self, "pegs")
        layout.prop(self, "follow")
        layout.separator()
        layout.prop(self, "rigid")
        layout.prop(self, "contacts")
        layout.prop(self, "leaving")

    def chosen_layers(self, context):
        return st.editable_layers(context.object, self.layers == "ACTIVE")

    def begin(self, context):
        if self.spacing == "CHART":
            charts.percentages(self.chart)
        curve = ()
        if self.spacing == "CURVE":
            curve = charts.places(self.curve) or spacing_curve.sampled()
        self._choices = Choices(
            self.spacing,
            self.chart if self.spacing == "CHART" else "",
            self.bounces,
            self.arcs,
            self.rigid,
            self.contacts,
            self.leaving,
            self.rest,
            self.step,
            curve,
            self.pegs,
            self.follow,
        )
        self.note_scope(context)
        return super().begin(context)

    def choose(self, name, found, record):
        spans = self.in_scope(name, found)
        if self.frames == "CURRENT" and found.edited:
            # An in-between that the artist changed is a key now. The spans on both its sides are drawn again.
            held = record.holding(*spans[0]) if spans else None
            every = zip(found.keys, found.keys[1:])
            spans = [span for span in every if span in spans or (held is not None and record.holding(*span) is held)]
        self._fit_chart(spans)
        chosen = {span: self._divided(span, found, record) or self._choices for span in spans}
        for span, choices in chosen.items():
            if choices.part == WHOLE:
                choices.need_chart(*span)
        return chosen

    def _fit_chart(self, spans) -> None:
        """Gives a chart that nobody wrote for these spans as many percentages as they have drawings. The button has no chart of its own: the artist writes it into
        the panel below the view, which Blender shows only of what succeeded."""
        if self.spacing != "CHART" or (self.properties.is_property_set("chart") and not charts.is_even(self.chart)):
            return
        counts = {len(self._choices.frames(*span)) for span in spans} - {0}
        if len(counts) == 1 and counts != {len(charts.percentages(self.chart))}:
            self.chart = charts.even(*counts)
            self._choices = replace(self._choices, chart=self.chart)

    def _divided(self, span, found, record) -> Choices | None:
        """The part of the spacing for a span beside an in-between that the artist changed, if its span was drawn with the same choices."""
        held = record.holding(*span)
        if held is None or not set(span) & set(found.edited) or replace(held.choices, part=WHOLE) != self._choices:
            return None
        return record.choices(*span)


CLASSES = (ROTOTOON_OT_in_between,)
