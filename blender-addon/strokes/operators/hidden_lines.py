"""Remove Hidden Lines."""

import bpy

from ...blender import grease_pencil as gp
from ...blender import guard
from ...blender import strokes as st
from ...blender.errors import Problem
from ...blender.frames import kept
from ...common import jobs
from ...common.operators import Long, OnDrawing
from ...common.wording import counted, joined
from ...tween import rototoon_changes
from .. import hidden


class ROTOTOON_OT_hidden_lines(Long, OnDrawing, bpy.types.Operator):
    bl_idname = "rototoon.hidden_lines"
    bl_label = "Remove Hidden Lines"
    bl_description = (
        "Cut lines exactly where filled strokes in front cover them, on the frames that you choose. Locked and "
        "hidden layers are not cut"
    )
    bl_options = {"REGISTER", "UNDO"}

    order: bpy.props.EnumProperty(
        name="In Front",
        description="What covers what",
        items=(
            ("STROKES", "Layers and Strokes", "Higher layers cover lower ones. In a layer, later strokes cover earlier ones"),
            ("LAYERS", "Layers", "Higher layers cover lower ones. Strokes of one layer do not cover each other"),
        ),
    )
    covers: bpy.props.EnumProperty(
        name="Covers",
        description="Which strokes cover",
        items=(
            ("FILLED", "Filled", "Strokes with a fill"),
            ("CLOSED", "Closed", "Closed strokes too, filled or not"),
        ),
    )
    action: bpy.props.EnumProperty(
        name="Hidden Lines",
        description="What to do with hidden lines",
        items=(
            ("REMOVE", "Remove", "Delete them"),
            ("MOVE", "Move to Layer", "Move them to a layer of their own"),
        ),
    )
    frames: bpy.props.EnumProperty(
        name="Frames",
        description="Frames to cut",
        items=(
            ("CURRENT", "Current", "The drawings that show on the current frame"),
            ("RANGE", "Scene Range", "All frames of the scene. A held drawing gets a new frame where its hidden lines change"),
        ),
    )

    def begin(self, context):
        self._ob, scene = context.object, context.scene
        self._frames = [scene.frame_current]
        if self.frames == "RANGE":
            self._frames = hidden.frames_between(self._ob, scene.frame_start, scene.frame_end)
        if not any(not guard.is_hidden(layer) and gp.frame_numbers(layer) for layer in gp.every_layer(self._ob)):
            raise Problem("No drawings are visible: draw something, or show a layer")
        if not st.editable_layers(self._ob, active=False):
            raise Problem("No layer can be cut: unlock one. Contours are not changed, since tracking needs their points")
        self._need_open()
        self.warn(guard.left_out(st.drawn_layers(self._ob, active=False)))
        self._cuts = []
        return jobs.Stepper(self._steps(scene), "Looking at frames")

    def _need_open(self) -> None:
        """Raises a `Problem` if a layer that gets hidden lines may not be written."""
        if self.action == "MOVE":
            layers = st.editable_layers(self._ob, active=False)
            guard.need_named(self._ob, [layer.name + hidden.SUFFIX for layer in layers])

    def _steps(self, scene):
        choices = hidden.Choices(closed=self.covers == "CLOSED", by_stroke=self.order == "STROKES")
        with kept(scene):
            for index, frame in enumerate(self._frames):
                if frame != scene.frame_current:
                    scene.frame_set(frame)
                self._cuts.extend(hidden.cut_frame(self._ob, frame, choices))
                yield (index + 1) / len(self._frames)

    def finish(self, context, work) -> str:
        guard.need_open(gp.find_layer(self._ob, name) for name in sorted({cut.layer for cut in self._cuts if cut.changed}))
        self._need_open()
        with rototoon_changes.kept(self._ob) as made:
            drawings, parts = hidden.write(self._ob, self._cuts, self.action == "MOVE", self.frames == "CURRENT")
        self._ob.data.update_tag()
        if not drawings:
            return "Nothing is hidden"
        cut = {layer: {each.source for each in self._cuts if each.changed and each.layer == layer} for layer in made.frames}
        return joined(f"{counted(parts, 'hidden line')} on {counted(drawings, 'drawing')}", made.said(cut))


CLASSES = (ROTOTOON_OT_hidden_lines,)
