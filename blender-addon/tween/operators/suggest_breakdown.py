"""Suggest Breakdown: goes to the frame on which a breakdown helps most, and marks it."""

import bpy

from ...blender import guard, preferences
from ...blender import strokes as st
from ...common import jobs
from ...common.operators import Long
from .. import suggesting, tweening
from ..charts import Choices
from .tweening_base import LAYERS, SCOPES, OnKeys, Scoped

MARKER = "Breakdown?"
"""Name of the marker. A second suggestion moves it; rename it to keep it."""


class ROTOTOON_OT_suggest_breakdown(OnKeys, Scoped, Long, bpy.types.Operator):
    bl_idname = "rototoon.suggest_breakdown"
    bl_label = "Suggest Breakdown"
    bl_description = (
        "Go to the frame on which one more drawing helps most, and mark it on the timeline: the frame that brings the in-betweens nearest "
        "to the footage. Without footage that shows the movement it is the middle of the span that moves most"
    )
    bl_options = {"REGISTER", "UNDO"}
    changes = guard.NOTHING

    frames: bpy.props.EnumProperty(name="Frames", description="Between which keys", items=SCOPES, default="ALL")
    layers: bpy.props.EnumProperty(name="Layers", description="On which layers", items=LAYERS, default="ALL")
    look: bpy.props.BoolProperty(
        name="Look at the Footage",
        description="Compare the in-betweens with the pictures of the object's footage, if it has any",
        default=True,
    )

    def begin(self, context):
        self.note_scope(context)
        ob, self._scene = context.object, context.scene
        guard.need_own(self._scene)
        pictures = suggesting.pictures_of(ob) if self.look else None
        layers = st.editable_layers(ob, self.layers == "ACTIVE")
        self.warn(guard.left_out(st.drawn_layers(ob, self.layers == "ACTIVE")))
        plan = self._plan = tweening.plan(ob, layers, self._choose, again=True)
        if not plan.calls:
            raise tweening.nothing_to_draw(plan)
        pixels = suggesting.to_pixels(ob, plan, pictures)
        self._offset, threads = (0 if pictures is None else pictures.offset), preferences.threads()

        def work(progress):
            tweening.draw(plan, lambda share, step: progress(0.5 * share, step), threads)
            groups = suggesting.groups(plan, pixels)
            return suggesting.suggested(groups, pictures, lambda share, step: progress(0.5 + 0.5 * share, step), threads)

        return jobs.Worker(work)

    def _choose(self, name, found, record):
        usual = Choices(follow=True)
        return {span: record.choices(*span) or usual for span in self.in_scope(name, found)}

    def finish(self, _context, work) -> str:
        found = work.result
        if found is None:
            raise tweening.nothing_to_draw(self._plan)
        frame = found.frame + self._offset
        marker = self._scene.timeline_markers.get(MARKER)
        if marker is None:
            marker = self._scene.timeline_markers.new(MARKER, frame=frame)
        marker.frame = frame
        self._scene.frame_set(frame)
        return suggesting.sentence(found, self._offset)


CLASSES = (ROTOTOON_OT_suggest_breakdown,)
