"""Drawings between keys."""

import bpy

from .. import charts, jobs, preferences, spacing_curve, tweening
from .. import grease_pencil as gp
from .. import keys as ks
from .. import strokes as st
from ..charts import Choices
from .base import Guarded, Long, drawing_poll

_LAYERS = (("ACTIVE", "Active", "The active layer"), ("ALL", "All", "All layers that are not locked"))


def tween_poll(cls, context) -> bool:
    """Poll: a Grease Pencil object with keys."""
    if not drawing_poll(cls, context):
        return False
    if not any(len(layer.frames) > 1 for layer in context.object.data.layers):
        cls.poll_message_set("Draw on two keys first")
        return False
    return True


class Tweening(Long):
    """Reads, has the library draw in a thread, and writes."""

    def choose(self, name: str, found: ks.Frames, record) -> dict[tuple[int, int], Choices]:
        """The spans of a layer that are wanted."""
        raise NotImplementedError

    def chosen_layers(self, context) -> list:
        """The layers that are worked on."""
        return st.editable_layers(context.object, active=False)

    def begin(self, context):
        self._ob = context.object
        self._current = context.scene.frame_current
        self._plan = tweening.plan(self._ob, self.chosen_layers(context), self.choose)
        if not self._plan.calls and not self._plan.current:
            raise tweening.nothing_to_draw(self._plan)
        plan, threads = self._plan, preferences.threads()
        return jobs.Worker(lambda progress: tweening.draw(plan, progress, threads))

    def finish(self, context, work) -> str:
        done = tweening.finish(self._ob, self._plan)
        spans = "1 span" if done.spans == 1 else f"{done.spans} spans"
        said = f"{done.drawings} in-betweens in {spans}" if done.spans else "Nothing had changed"
        if done.spans and self._plan.current:
            said += f", {self._plan.current} spans were as they should be"
        if done.keys:
            said += f", {done.keys} drawings that you had changed are keys now"
        if self._plan.blank:
            said += f", {self._plan.blank} spans with a blank key left"
        return said


class ROTOTOON_OT_in_between(Tweening, bpy.types.Operator):
    bl_idname = "rototoon.in_between"
    bl_label = "In-between"
    bl_description = (
        "Draw between keys: strokes find each other whatever their order and direction, what moves together swings along "
        "arcs, and nothing that turns shrinks. Your keys are never changed; only what you touched is drawn again"
    )
    bl_options = {"REGISTER", "UNDO"}

    frames: bpy.props.EnumProperty(
        name="Frames",
        description="Between which keys",
        items=(
            ("CURRENT", "Around the Playhead", "The two keys around the current frame"),
            ("SELECTED", "Selected Keys", "Neighbouring keys that are both selected"),
            ("RANGE", "Scene Range", "All keys within the scene's range"),
            ("ALL", "All", "All keys"),
        ),
    )
    layers: bpy.props.EnumProperty(name="Layers", description="On which layers", items=_LAYERS, default="ALL")
    spacing: bpy.props.EnumProperty(
        name="Spacing", description="How far the drawings between have come", items=charts.SPACINGS
    )
    chart: bpy.props.StringProperty(
        name="Chart",
        description="How far each drawing between has come, in percent: 0 is the earlier key, 100 the later one, and you may "
        "go beyond",
        default="10, 30, 70, 90",
    )
    curve: bpy.props.StringProperty(
        name="Curve",
        description="Times and shares of a spacing curve, such as 0 0, 0.3 0.8, 1 1; empty takes the one drawn in the panel",
        default="",
    )
    bounces: bpy.props.IntProperty(name="Bounces", description="How often it bounces", default=3, min=0, max=10)
    arcs: bpy.props.FloatProperty(
        name="Arcs",
        description="How much what turns moves along arcs: 0 is straight, 1 goes all the way round the turn's middle",
        default=0.5,
        min=0.0,
        max=1.0,
    )
    step: bpy.props.IntProperty(
        name="Frames Each",
        description="Frames that a drawing stays: 1 is on ones, 2 on twos",
        default=1,
        min=1,
        soft_max=4,
    )
    rigid: bpy.props.BoolProperty(
        name="Keep Shapes", description="Shapes bend and turn instead of shrinking through their middle", default=True
    )
    contacts: bpy.props.BoolProperty(
        name="Keep Contacts", description="Strokes that touch on both keys go on touching", default=True
    )
    leaving: bpy.props.EnumProperty(
        name="New and Lost", description="What strokes do that only one of two keys has", items=charts.LEAVING
    )
    pegs: bpy.props.EnumProperty(name="Moves as One", description="What moves as one", items=charts.PEGS)
    follow: bpy.props.BoolProperty(
        name="Follow Captured",
        description="Strokes that lie on a captured contour move as it was tracked in the footage",
        default=True,
    )
    rest: bpy.props.BoolProperty(
        name="Rest at the Ends",
        description="A smooth movement begins and ends at rest; otherwise it moves on with constant speed",
        default=True,
    )

    @classmethod
    def poll(cls, context):
        return tween_poll(cls, context)

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
        scene = context.scene
        self._range = scene.frame_start, scene.frame_end
        self._selected = {
            layer.name: {frame.frame_number for frame in layer.frames if frame.select}
            for layer in context.object.data.layers
        }
        self._now = scene.frame_current
        return super().begin(context)

    def choose(self, name, found, record):
        spans = list(zip(found.keys, found.keys[1:]))
        if self.frames == "CURRENT":
            around = ks.around(found.keys, self._now)
            # A drawing between that was changed is a key: what was around it is drawn again on both its sides.
            held = record.holding(*around) if around is not None else None
            touched = held is not None and bool(found.edited)
            spans = [span for span in spans if span == around or (touched and record.holding(*span) is held)]
        elif self.frames == "SELECTED":
            spans = [span for span in spans if set(span) <= self._selected[name]]
        elif self.frames == "RANGE":
            spans = [span for span in spans if self._range[0] <= span[0] and span[1] <= self._range[1]]
        return dict.fromkeys(spans, self._choices)


class ROTOTOON_OT_update_in_betweens(Tweening, bpy.types.Operator):
    bl_idname = "rototoon.update_in_betweens"
    bl_label = "Update In-betweens"
    bl_description = (
        "Draw again what your changes of keys and pairs touch, each span as you chose it; all else stays as it is. A drawing "
        "between that you changed becomes a key"
    )
    bl_options = {"REGISTER", "UNDO"}

    @classmethod
    def poll(cls, context):
        return tween_poll(cls, context)

    def choose(self, _name, found, record):
        spans = zip(found.keys, found.keys[1:])
        held = {span: record.holding(*span) or _swallowed(record, span) for span in spans}
        return {span: known.choices for span, known in held.items() if known is not None}


def _swallowed(record, span: tuple[int, int]):
    """The first of the spans that lie in another one, where a key between them is gone."""
    inside = [start for start, known in record.spans.items() if span[0] <= start and known.last <= span[1]]
    return record.spans[min(inside)] if inside else None


class ROTOTOON_OT_clear_in_betweens(Guarded, bpy.types.Operator):
    bl_idname = "rototoon.clear_in_betweens"
    bl_label = "Clear In-betweens"
    bl_description = "Remove the drawings that were made between keys; your own stay"
    bl_options = {"REGISTER", "UNDO"}

    frames: bpy.props.EnumProperty(
        name="Frames",
        description="Where",
        items=(
            ("ALL", "All", "All frames"),
            ("CURRENT", "Around the Playhead", "Those between the two keys around the current frame"),
        ),
    )
    layers: bpy.props.EnumProperty(name="Layers", description="On which layers", items=_LAYERS, default="ALL")

    @classmethod
    def poll(cls, context):
        return drawing_poll(cls, context)

    def run(self, context) -> str:
        ob = context.object
        removed = 0
        for layer in st.editable_layers(ob, self.layers == "ACTIVE"):
            span = (None, None)
            if self.frames == "CURRENT":
                keys = [n for n, found in gp.drawings(layer).items() if not ks.is_tweened(*found)]
                span = ks.around(keys, context.scene.frame_current)
                if span is None:
                    continue
            removed += tweening.clear(ob, [layer], *span)
        return f"{removed} in-betweens removed" if removed else "There are no in-betweens"


CLASSES = (ROTOTOON_OT_in_between, ROTOTOON_OT_update_in_betweens, ROTOTOON_OT_clear_in_betweens)
